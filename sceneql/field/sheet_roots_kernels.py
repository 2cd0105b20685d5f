# mypy: ignore-errors
"""First roots of a tape along a ray with or without a change of sign: where it meets a sheet."""

from sceneql.field.certified_kernels import CROSSES, TOUCHES, certify, hidden, told
from sceneql.field.enclosure_kernels import segment
from sceneql.field.isolation_kernels import BACK, search
from sceneql.field.slope_kernels import on_ray
from sceneql.field.tape_ops import HIT, MISS, TAPE, UNDECIDED, WHOLE
from sceneql.kernels import lean, woven

POLES = 16
"""Changes of sign without a root that are passed on one ray."""


@woven
def side_of(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, start, t1, near):
    """(side, t) as ``told``: by the enclosure at the start, which is sooner, and only else by intervals."""
    c0, c1, e, status = segment(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, start, start, True)
    if status == WHOLE and abs(c0) - abs(c1) > e:
        return (1 if c0 > 0.0 else -1), start
    return told(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, start, t1, near, 1.0)


@woven
def is_defined(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, near):
    """Whether f is a number all around the place t: no pole, no jump of its domain."""
    _, _, _, status = segment(
        code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t - 0.01 * near, t + 0.01 * near, True
    )
    if status != WHOLE:
        _, _, _, _, status = on_ray(
            code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t - 0.01 * near, t + 0.01 * near, 1.0
        )
    return status == WHOLE


@lean(
    f"Tuple((int64, float64))({TAPE}, float64, float64, float64, float64, float64, float64, float64, float64, float64)"
)
def surface_root(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t0, t1, tolerance):
    """(status, t) of the first root of f on the ray o + t d, t in [t0, t1], with or without a change of sign.

    HIT: all before t is proved to have none, and at t is one, up to rounding: see ``certify``. MISS: none is there.
    UNDECIDED: all before t is proved. Where f jumps or has a pole is no root.
    """
    near = tolerance * (t1 - t0)
    start = t0
    for _ in range(POLES):
        side, start = side_of(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, start, t1, near)
        if side == 0:
            return UNDECIDED, start
        side = min(side, 1)
        status, t = search(
            code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, start, t1, tolerance, float(side), False
        )
        if status == MISS:
            return MISS, t1
        if status == UNDECIDED:
            kind, _, place, _, _ = hidden(
                code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, t, start, t1, 0.1 * near, float(side)
            )
            if kind == CROSSES or kind == TOUCHES:
                status = HIT
                t = place
        if status == UNDECIDED:
            t = max(t - BACK * (t1 - t0), start)
            status, t = certify(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, t1, near, 1.0, False, True)
            if status != HIT:
                return status, t
        if is_defined(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, near):
            return HIT, t
        start = t + near
        if not start < t1:
            return MISS, t1
    return UNDECIDED, start
