# mypy: ignore-errors
"""The variant of a cube's configuration by the trilinear interpolant of its corner values, or by f at its saddles."""

from sceneql.compiled.kernels import inlined
from sceneql.field.tape.tape_kernels import value
from sceneql.field.tape.tape_ops import MAX, MIN

CASES = "int32[::1], int32[:, :, ::1], int32[:, :, ::1]"
"""Types of (first, faces, tunnel) of cases.Cases."""
BIG = 1.0e100


@inlined
def column(k):
    """The lower corner of the k-th of the four edges along z, in order around the cube."""
    return k ^ (k >> 1)


@inlined
def in_column(values, k, negative):
    """The corner of a column with a given sign."""
    low = column(k)
    return low if (values[low] < 0.0) == negative else low + 4


@inlined
def tunneled(values, tunnel, variant):
    """(the variant with a tunnel where two regions are connected inside the cube, else the variant itself, the share
    of the way along z at which the slice shows it, and whether the regions are negative).

    In a slice across the columns a, b, c, d whose signs alternate, the saddle has the sign of a and c if ac > bd
    (Chernyaev 1995). A connection inside passes through a saddle point of the interpolant, and the slice through that
    shows it; so slices across one axis suffice.
    """
    for turn in range(2):
        sign = 1.0 - 2.0 * turn
        low = 0.0
        high = 1.0
        for k in range(4):
            flip = sign if k % 2 == 0 else -sign
            v0 = flip * values[column(k)]
            v1 = flip * values[column(k) + 4]
            if v0 <= 0.0 and v1 <= 0.0:
                high = -1.0
            elif v0 < 0.0:
                low = max(low, v0 / (v0 - v1))
            elif v1 < 0.0:
                high = min(high, v0 / (v0 - v1))
        if low >= high:
            continue
        a = values[0]
        b = values[1]
        c = values[3]
        d = values[2]
        da = values[4] - a
        db = values[5] - b
        dc = values[7] - c
        dd = values[6] - d
        q0 = a * c - b * d
        q1 = a * dc + c * da - b * dd - d * db
        q2 = da * dc - db * dd
        first = q0 + low * (q1 + low * q2)
        last = q0 + high * (q1 + high * q2)
        most, least = max(first, last), min(first, last)
        at_most, at_least = (low if first > last else high), (low if first < last else high)
        if q2 != 0.0:
            t = -0.5 * q1 / q2
            if low < t and t < high:
                extreme = q0 + t * (q1 + t * q2)
                if extreme > most:
                    most, at_most = extreme, t
                if extreme < least:
                    least, at_least = extreme, t
        if most > 0.0:
            found = tunnel[variant, in_column(values, 0, sign < 0.0), in_column(values, 2, sign < 0.0)]
            if found >= 0:
                return found, at_most, sign < 0.0
        if least < 0.0:
            found = tunnel[variant, in_column(values, 1, sign > 0.0), in_column(values, 3, sign > 0.0)]
            if found >= 0:
                return found, at_least, sign > 0.0
    return variant, 0.0, False


@inlined
def clamp(values):
    """Keep 8 corner values within BIG; NaN counts as large."""
    for at in range(8):
        v = values[at]
        values[at] = min(max(v, -BIG), BIG) if v == v else BIG


@inlined
def saddle(a, b, c, d):
    """Where in a square, from 0 to 1 along either axis, what is linear along both has its saddle.

    a and b are the values at the ends of the first axis, c and d those beside them along the second; signs alternate.
    """
    bend = a - b - c + d
    return (a - c) / bend, (a - b) / bend


@inlined
def decide(values, config, first, faces, tunnel):
    """The variant of a cube with 8 corner values, clamped; NaN counts as large."""
    variant = first[config]
    clamp(values)
    for k in range(6):
        p = faces[config, k, 0]
        if p < 0:
            break
        q = values[faces[config, k, 1]] * values[faces[config, k, 3]]
        if values[p] * values[faces[config, k, 2]] > q:
            variant += 1 << k
    return tunneled(values, tunnel, variant)[0]


@inlined
def branch(code, scratch):
    """The row that min and max at a tape's end take f from, at the place of which ``value`` left the rows."""
    row = code.shape[0] - 1
    while code[row, 0] == MAX or code[row, 0] == MIN:
        left, right = code[row, 1], code[row, 2]
        first = scratch[left, 0] > scratch[right, 0] if code[row, 0] == MAX else scratch[left, 0] < scratch[right, 0]
        row = left if first else right
    return row


@inlined
def at_share(code, constants, parts, scratch, grid, i, j, k, x, y, z):
    """(f, its ``branch``) at a place in the cube from node (i, j, k) on, from 0 to 1 along each axis."""
    h = grid[3]
    f = value(code, constants, parts, scratch, grid[0] + (i + x) * h, grid[1] + (j + y) * h, grid[2] + (k + z) * h)
    return f, branch(code, scratch)


@inlined
def of_several(code, constants, parts, scratch, grid, i, j, k, low, high):
    """Whether the corners from ``low`` to ``high`` of the cube from node (i, j, k) on take f from several branches."""
    if code[code.shape[0] - 1, 0] != MAX and code[code.shape[0] - 1, 0] != MIN:
        return False
    first = -1
    for c in range(8):
        if c & low == low and c | high == high:
            row = at_share(
                code, constants, parts, scratch, grid, i, j, k, float(c & 1), float(c >> 1 & 1), float(c >> 2)
            )[1]
            if first >= 0 and row != first:
                return True
            first = row
    return False


@inlined
def decide_by_field(code, constants, parts, scratch, grid, i, j, k, values, config, first, faces, tunnel):
    """As ``decide``, of the cube from node (i, j, k) on, but where f is of several branches by itself at the saddles.

    Where a field is cut by another, as a sheet near the face of a ball, f inside says nothing of how far the sides of
    the sheet are: the interpolant would tear it. Cubes that share a face find the same there.
    """
    variant = first[config]
    clamp(values)
    for n in range(6):
        p = faces[config, n, 0]
        if p < 0:
            break
        q, r, s = faces[config, n, 1], faces[config, n, 2], faces[config, n, 3]
        joined = values[p] * values[r] > values[q] * values[s]
        low, high = p & q & r & s, p | q | r | s
        if of_several(code, constants, parts, scratch, grid, i, j, k, low, high):
            plane = low ^ high  # the bits of the two axes along the face
            u = 1 if plane & 1 else 2
            v = plane ^ u
            a, b = saddle(values[low], values[low | u], values[low | v], values[high])
            f = at_share(
                code, constants, parts, scratch, grid, i, j, k,
                a if u == 1 else float(low & 1), a if u == 2 else b if v == 2 else float(low >> 1 & 1),
                b if v == 4 else float(low >> 2),
            )[0]  # fmt: skip
            joined = f < 0.0
        variant += 1 << n if joined else 0
    found, z, negative = tunneled(values, tunnel, variant)
    if found != variant and of_several(code, constants, parts, scratch, grid, i, j, k, 0, 7):
        x, y = saddle(
            values[0] + z * (values[4] - values[0]), values[1] + z * (values[5] - values[1]),
            values[2] + z * (values[6] - values[2]), values[3] + z * (values[7] - values[3]),
        )  # fmt: skip
        f = at_share(code, constants, parts, scratch, grid, i, j, k, x, y, z)[0]
        return found if (f < 0.0) == negative else variant
    return found
