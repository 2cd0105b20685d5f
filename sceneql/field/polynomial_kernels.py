# mypy: ignore-errors
"""Polynomials along rays: a tape of sums and products alone is, on a ray, a polynomial whose coefficients it gives.

Coefficients are float64, in tau of [-1, 1] over the searched piece of a ray; ``work`` has a row for each coefficient of
each operation. Their rounding is bounded once for a bundle: with |x|, |y|, |z| at most some sizes, the absolute values
of an operation's coefficients add up to no more than the operation on sizes with all signs positive.
"""

from sceneql.field.affine_kernels import F
from sceneql.field.hunt_kernels import A, B
from sceneql.field.packet_kernels import C1, LANES, E
from sceneql.field.tape_ops import ADD, CONSTANT, MUL, NEG, SQUARE, SUB, WHOLE, X, Z
from sceneql.kernels import inlined

POLYNOMIAL, DEGREES = 3, 4
"""Of a plan: the row of the polynomial p of a field p or max(p, g), -1 where there is none; then, for each row up to
that, its degree (-1: it is not needed), and the rows of ``work`` at which its coefficients begin."""
MIDDLE, HALF_WAY, COEFFICIENTS = 0, 1, 2
"""Rows of a ray's polynomial: middle and half length of the piece of the ray, from its own start; coefficients."""
UNIT = 1.2e-16


@inlined
def multiply(work, a, da, b, db, out, n):
    """The product of polynomials of degrees da and db whose coefficients are rows from a and b on."""
    for k in range(da + db + 1):
        row = work[out + k]
        first = max(k - db, 0)
        left, right = work[a + first], work[b + k - first]
        for i in range(n):
            row[i] = left[i] * right[i]
        for m in range(first + 1, min(k, da) + 1):
            left, right = work[a + m], work[b + k - m]
            for i in range(n):
                row[i] += left[i] * right[i]


@inlined
def square(work, a, degree, out, n):
    """The square of a polynomial, its mixed products taken once."""
    for k in range(2 * degree + 1):
        row = work[out + k]
        for i in range(n):
            row[i] = 0.0
        first = max(k - degree, 0)
        for m in range(first, (k + 1) // 2):
            left, right = work[a + m], work[a + k - m]
            for i in range(n):
                row[i] += left[i] * right[i]
        half = work[a + k // 2]
        if k % 2 == 0:
            for i in range(n):
                row[i] = 2.0 * row[i] + half[i] * half[i]
        else:
            for i in range(n):
                row[i] += row[i]


@inlined
def add(work, a, da, b, db, sign, out, n):
    """a + sign b."""
    for k in range(max(da, db) + 1):
        row = work[out + k]
        if k <= da and k <= db:
            left, right = work[a + k], work[b + k]
            for i in range(n):
                row[i] = left[i] + sign * right[i]
        elif k <= da:
            left = work[a + k]
            for i in range(n):
                row[i] = left[i]
        else:
            right = work[b + k]
            for i in range(n):
                row[i] = sign * right[i]


@inlined
def coefficients(code, constants, plan, pieces, n, work, out):
    """Coefficients on n lanes' pieces of rays (6, LANES), whose MIDDLE and HALF_WAY ``out`` (k, LANES) has."""
    middle, half = out[MIDDLE], out[HALF_WAY]
    rows = plan[POLYNOMIAL] + 1
    for k in range(rows):
        degree, at = plan[DEGREES + k], plan[DEGREES + rows + k]
        if degree < 0:
            continue
        op, left, right = code[k, 0], code[k, 1], code[k, 2]
        if op == CONSTANT:
            number = constants[left]
            row = work[at]
            for i in range(n):
                row[i] = number
        elif op >= X and op <= Z:
            axis = op - X
            place, way = work[at], work[at + 1]
            for i in range(n):
                place[i] = pieces[axis, i] + middle[i] * pieces[3 + axis, i]
                way[i] = half[i] * pieces[3 + axis, i]
        else:
            a, b = plan[DEGREES + rows + left], plan[DEGREES + rows + right]
            da, db = plan[DEGREES + left], plan[DEGREES + right]
            if op == MUL:
                multiply(work, a, da, b, db, at, n)
            elif op == SQUARE:
                square(work, a, da, at, n)
            elif op == ADD or op == SUB:
                add(work, a, da, b, db, 1.0 if op == ADD else -1.0, at, n)
            else:
                sign = -1.0 if op == NEG else 1.0
                for m in range(da + 1):
                    source, row = work[a + m], work[at + m]
                    for i in range(n):
                        row[i] = sign * source[i]
    degree, at = plan[DEGREES + rows - 1], plan[DEGREES + 2 * rows - 1]
    for k in range(degree + 1):
        source, row = work[at + k], out[COEFFICIENTS + k]
        for i in range(n):
            row[i] = source[i]


@inlined
def rounding(code, constants, plan, sizes, work):
    """How far a polynomial enclosed by ``enclose_polynomials`` may be off where |x|, |y|, |z| are at most ``sizes``.

    Of an operation, column 0 of ``work`` has the sum of absolute values, column 1 the error in units of that.
    """
    rows = plan[POLYNOMIAL] + 1
    for k in range(rows):
        degree = plan[DEGREES + k]
        if degree < 0:
            continue
        op, left, right = code[k, 0], code[k, 1], code[k, 2]
        a, b, e, f = work[left, 0], work[right, 0], work[left, 1], work[right, 1]
        if op == CONSTANT:
            work[k, 0], work[k, 1] = abs(constants[left]), 0.0
        elif op >= X and op <= Z:
            work[k, 0], work[k, 1] = sizes[op - X], 4.0
        elif op == MUL or op == SQUARE:
            work[k, 0], work[k, 1] = a * b, e + f + degree + 2.0
        elif op == ADD or op == SUB:
            work[k, 0], work[k, 1] = a + b, max(e, f) + 1.0
        else:
            work[k, 0], work[k, 1] = a, e
    degree = plan[DEGREES + rows - 1]
    # Moved to another middle, sums of up to 2^degree times the coefficients are rounded.
    units = work[rows - 1, 1] + 4.0 * (degree + 1) * 2.0**degree
    return 2.0 * UNIT * units * work[rows - 1, 0]


@inlined
def enclose_polynomials(table, degree, lanes, off, work, last, status, n):
    """First-order enclosures of polynomials ``table`` (k, LANES) on n lanes' segments, as of ``packet_kernels``.

    The polynomial is moved to the middle of the segment by Horner's scheme. Of its powers in tau of [-1, 1] tau^2 lies
    in [0, 1] and tau^3 within 1/4 of 3/4 tau.
    """
    middle, half = work[degree + 1], work[degree + 2]
    for i in range(n):
        a, b = float(lanes[A * LANES + i]), float(lanes[B * LANES + i])
        scale = 1.0 / table[HALF_WAY, i]
        middle[i] = (0.5 * (a + b) - table[MIDDLE, i]) * scale
        half[i] = 0.5 * (b - a) * scale * (1.0 + 4.0e-16)
    for k in range(degree + 1):
        source, row = table[COEFFICIENTS + k], work[k]
        for i in range(n):
            row[i] = source[i]
    for k in range(degree):
        for m in range(degree - 1, k - 1, -1):
            row, above = work[m], work[m + 1]
            for i in range(n):
                row[i] += middle[i] * above[i]
    value, slope, rest = work[0], work[1], work[degree + 3]
    for i in range(n):
        slope[i] *= half[i]
        rest[i] = off
        middle[i] = half[i]
    for k in range(2, degree + 1):
        row = work[k]
        for i in range(n):
            middle[i] *= half[i]
            row[i] *= middle[i]
        if k == 2:
            for i in range(n):
                value[i] += 0.5 * row[i]
                rest[i] += 0.5 * abs(row[i])
        elif k == 3:
            for i in range(n):
                slope[i] += 0.75 * row[i]
                rest[i] += 0.25 * abs(row[i])
        else:
            for i in range(n):
                rest[i] += abs(row[i])
    for i in range(n):
        last[i] = F(value[i])
        last[C1 + i] = F(slope[i])
        last[E + i] = F(rest[i])
        status[i] = F(WHOLE)
