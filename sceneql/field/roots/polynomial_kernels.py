# mypy: ignore-errors
"""Polynomials along rays: on a ray a tape of sums and products alone is a polynomial, whose coefficients it computes.

Coefficients are float64, in tau of [-1, 1] over the searched piece of a ray; ``lanes`` has ABREAST numbers for each
coefficient of an operation, one per ray. Their rounding is bounded once for a bundle: with bounds of |x|, |y|, |z|, the
absolute values of an operation's coefficients add up to at most the value of the operation at these bounds with all
signs positive.
"""

from sceneql.compiled.kernels import inlined
from sceneql.field.tape import tape_ops as ops

POLYNOMIAL, DEGREES = 3, 4
"""Of a plan: the row of the polynomial p of a field p or max(p, g), -1 without one; then, for each row up to that one,
its degree (-1: not needed), and the offset of its coefficients in ``lanes``, in units of ABREAST."""
ABREAST = 128
"""Rays that are processed together."""
UNIT = 1.2e-16
ONE, TWO, THREE, FOUR = ABREAST, 2 * ABREAST, 3 * ABREAST, 4 * ABREAST


@inlined
def line(a, b, out, n):
    """The product of two linear polynomials."""
    for i in range(n):
        a0, a1, b0, b1 = a[i], a[ONE + i], b[i], b[ONE + i]
        out[i] = a0 * b0
        out[ONE + i] = a0 * b1 + a1 * b0
        out[TWO + i] = a1 * b1


@inlined
def parabola(a, b, out, n):
    """The product of two quadratic polynomials."""
    for i in range(n):
        a0, a1, a2, b0, b1, b2 = a[i], a[ONE + i], a[TWO + i], b[i], b[ONE + i], b[TWO + i]
        out[i] = a0 * b0
        out[ONE + i] = a0 * b1 + a1 * b0
        out[TWO + i] = a0 * b2 + a1 * b1 + a2 * b0
        out[THREE + i] = a1 * b2 + a2 * b1
        out[FOUR + i] = a2 * b2


@inlined
def scale(a, number, degree, out):
    """A polynomial times a number, in all lanes."""
    for i in range((degree + 1) * ABREAST):
        out[i] = number * a[i]


@inlined
def multiply(a, da, b, db, out, n):
    """The product of polynomials of degrees da and db."""
    if da == 1 and db == 1:
        line(a, b, out, n)
        return
    if da == 2 and db == 2:
        parabola(a, b, out, n)
        return
    if da == 0 or db == 0:
        scale(b if da == 0 else a, a[0] if da == 0 else b[0], max(da, db), out)
        return
    for k in range(da + db + 1):
        row = out[k * ABREAST :]
        first = max(k - db, 0)
        left, right = a[first * ABREAST :], b[(k - first) * ABREAST :]
        for i in range(n):
            row[i] = left[i] * right[i]
        m = first + 1
        last = min(k, da)
        while m < last:
            left, right = a[m * ABREAST :], b[(k - m - 1) * ABREAST :]
            for i in range(n):
                row[i] += left[i] * right[ONE + i] + left[ONE + i] * right[i]
            m += 2
        if m == last:
            left, right = a[m * ABREAST :], b[(k - m) * ABREAST :]
            for i in range(n):
                row[i] += left[i] * right[i]


@inlined
def add(a, da, b, db, sign, out):
    """a + sign b, in all lanes."""
    both = (min(da, db) + 1) * ABREAST
    for i in range(both):
        out[i] = a[i] + sign * b[i]
    if da > db:
        scale(a[both:], 1.0, da - db - 1, out[both:])
    elif db > da:
        scale(b[both:], sign, db - da - 1, out[both:])


@inlined
def coefficients(code, constants, plan, rays, first, middle, half, n, lanes):
    """Coefficients on pieces of the n rays (RAY, k) from ``first`` on, given by their middles [t] and half lengths."""
    rows = plan[POLYNOMIAL] + 1
    for k in range(rows):
        degree = plan[DEGREES + k]
        if degree < 0:
            continue
        op, left, right = code[k, 0], code[k, 1], code[k, 2]
        out = lanes[plan[DEGREES + rows + k] * ABREAST :]
        if op == ops.CONSTANT:
            number = constants[left]
            for i in range(ABREAST):
                out[i] = number
        elif op >= ops.X and op <= ops.Z:
            place, way = rays[op - ops.X, first:], rays[op - ops.X + 3, first:]
            for i in range(n):
                out[i] = place[i] + middle[i] * way[i]
                out[ONE + i] = half[i] * way[i]
        else:
            a, b = lanes[plan[DEGREES + rows + left] * ABREAST :], lanes[plan[DEGREES + rows + right] * ABREAST :]
            da, db = plan[DEGREES + left], plan[DEGREES + right]
            if op == ops.MUL or op == ops.SQUARE:
                multiply(a, da, b, db, out, n)
            elif op == ops.ADD or op == ops.SUB:
                add(a, da, b, db, 1.0 if op == ops.ADD else -1.0, out)
            else:
                scale(a, -1.0 if op == ops.NEG else 1.0, da, out)


@inlined
def rounding(code, constants, plan, sizes, work):
    """Bounds of the errors of p and of its derivative in tau, as ``polynomial_steps_kernels`` uses them.

    ``sizes``: bounds of |x|, |y|, |z|, then of the error of each in units. ``work`` gets the sum of absolute
    coefficients of each operation, and its error in units of that.
    """
    rows = plan[POLYNOMIAL] + 1
    for k in range(rows):
        degree = plan[DEGREES + k]
        if degree < 0:
            continue
        op, left, right = code[k, 0], code[k, 1], code[k, 2]
        a, b, e, f = work[2 * left], work[2 * right], work[2 * left + 1], work[2 * right + 1]
        if op == ops.CONSTANT:
            a, e = abs(constants[left]), 0.0
        elif op >= ops.X and op <= ops.Z:
            a, e = sizes[op - ops.X], sizes[op - ops.X + 3]
        elif op == ops.MUL or op == ops.SQUARE:
            a, e = a * b, e + f + degree + 2.0
        elif op == ops.ADD or op == ops.SUB:
            a, e = a + b, max(e, f) + 1.0
        work[2 * k], work[2 * k + 1] = a, e
    degree = plan[DEGREES + rows - 1]
    # Moved to another middle m by Horner's scheme, a coefficient is off by 2 d units of the sum of |c_j| |m|^(j - k),
    # and |m| and the half length together are at most 1.
    units = work[2 * rows - 1] + 8.0 * degree + 20.0
    return 2.0 * UNIT * units * work[2 * rows - 2] * max(degree, 1)
