# mypy: ignore-errors
"""The variant of a cube's configuration by the trilinear interpolant of its corner values."""

from sceneql.compiled.kernels import inlined

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
    """The variant with a tunnel where two regions are connected inside the cube, else the variant itself.

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
        most = max(first, last)
        least = min(first, last)
        if q2 != 0.0:
            t = -0.5 * q1 / q2
            if low < t and t < high:
                extreme = q0 + t * (q1 + t * q2)
                most = max(most, extreme)
                least = min(least, extreme)
        if most > 0.0:
            found = tunnel[variant, in_column(values, 0, sign < 0.0), in_column(values, 2, sign < 0.0)]
            if found >= 0:
                return found
        if least < 0.0:
            found = tunnel[variant, in_column(values, 1, sign > 0.0), in_column(values, 3, sign > 0.0)]
            if found >= 0:
                return found
    return variant


@inlined
def decide(values, config, first, faces, tunnel):
    """The variant of a cube with 8 corner values, clamped; NaN counts as large."""
    variant = first[config]
    for at in range(8):
        v = values[at]
        values[at] = min(max(v, -BIG), BIG) if v == v else BIG
    for k in range(6):
        p = faces[config, k, 0]
        if p < 0:
            break
        q = values[faces[config, k, 1]] * values[faces[config, k, 3]]
        if values[p] * values[faces[config, k, 2]] > q:
            variant += 1 << k
    return tunneled(values, tunnel, variant)
