# mypy: ignore-errors
"""First roots of a tape along a ray with or without a change of sign: intersections with sheets."""

import numpy as np

from sceneql.compiled.kernels import lean, woven
from sceneql.field.enclose.enclosure_kernels import segment
from sceneql.field.enclose.slope_kernels import on_ray
from sceneql.field.roots.bracket_kernels import FINE
from sceneql.field.roots.certified_kernels import CROSSES, TOUCHES, certify, hidden, told
from sceneql.field.roots.isolation_kernels import begin_of_proof, beyond, leaps, search
from sceneql.field.tape import tape_ops as ops

POLES = 16
"""Changes of sign without a root that are passed on one ray."""
NEARER = 0.95
"""Ratio of |f| at half the distance to a root, at most, to |f| at the distance: for |x|^k it is 1/2^k."""
NO_ROOT = -2
"""A further value beside the sides of f."""


@woven
def side_of(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, start, t1, near):
    """(side, t, whole): as ``told``, or NO_ROOT for start..t1; and whether f is proved to be defined all over that.

    An enclosure of start..t1 mostly decides, else one at the start; both are cheaper than intervals.
    """
    c0, c1, e, status = segment(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, start, t1, True)
    whole = status == ops.WHOLE
    side, t = 0, start
    if status == ops.NOWHERE or abs(c0) - abs(c1) > e:
        side = NO_ROOT
    elif whole and abs(c0 - c1) > e:
        side = 1 if c0 > c1 else -1
    else:
        c0, c1, e, status = segment(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, start, start, True)
        if status == ops.WHOLE and abs(c0) - abs(c1) > e:
            side = 1 if c0 > 0.0 else -1
        else:
            side, t = told(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, start, t1, near, 1.0)
    return side, t, whole


@woven
def is_defined(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, near):
    """Whether f is defined all around t: no pole and no edge of its domain."""
    _, _, _, status = segment(
        code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t - 0.01 * near, t + 0.01 * near, True
    )
    if status != ops.WHOLE:
        _, _, _, _, status = on_ray(
            code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t - 0.01 * near, t + 0.01 * near, 1.0
        )
    return status == ops.WHOLE


@woven
def nears_zero(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, near):
    """Whether f, not proved to be defined all around t, tends to zero there from both sides, where it is defined.

    As acos(1 - |x|), which rounding keeps intervals from proving defined. At a jump |f| hardly shrinks at half the
    distance, and at a pole it grows.
    """
    reach = max(near, 4.0 * FINE * abs(t))
    for side in (-1.0, 1.0):
        a, b = t + side * reach, t + 2.0 * side * reach
        low, high, _, _, first = on_ray(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, a, a, 1.0)
        least, most, _, _, last = on_ray(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, b, b, 1.0)
        if first == ops.NOWHERE or last == ops.NOWHERE or not abs(low + high) < np.inf:
            return False
        if first == ops.WHOLE and last == ops.WHOLE and not abs(low + high) < NEARER * abs(least + most):
            return False
    return True


@woven
def is_root(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, near):
    """Whether f, defined all around t, has a root there instead of a jump over zero.

    The root is searched as far away as ``search`` may have left it.
    """
    for k in range(code.shape[0]):
        op = code[k, 0]
        if op == ops.FLOOR or op == ops.SIGN or op == ops.ATAN2:
            reach = max(near, 4.0 * FINE * abs(t))
            return not leaps(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, reach)
    return True


@lean(
    f"Tuple((int64, float64))({ops.TAPE}, float64, float64, float64, float64, float64, float64, float64, float64,"
    " float64)"
)
def surface_root(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t0, t1, tolerance):
    """(status, t) of the first root of f on the ray o + t d, t in [t0, t1], with or without a change of sign.

    HIT: none is before t, proved, and there is one at t, up to rounding: see ``certify``. MISS: there is none.
    UNDECIDED: none is before t, proved. Jumps and poles of f are no roots.
    """
    near = tolerance * (t1 - t0)
    start = t0
    for _ in range(POLES):
        side, start, whole = side_of(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, start, t1, near)
        if side == 0:
            return ops.UNDECIDED, start
        if side == NO_ROOT:
            return ops.MISS, t1
        side = min(side, 1)
        status, t = search(
            code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, start, t1, tolerance, float(side), False
        )
        if status == ops.MISS:
            return ops.MISS, t1
        if status == ops.UNDECIDED:
            way = float(side)
            kind, _, place, _, _ = hidden(
                code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, t, start, t1, 0.1 * near, way, True
            )
            if kind == CROSSES or kind == TOUCHES:
                status = ops.HIT
                t = place
        if status == ops.UNDECIDED:
            t = begin_of_proof(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, start, t1)
            status, t = certify(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, t1, near, 1.0, False, True)
            if status == ops.UNDECIDED:
                status, t = beyond(
                    code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, t1, near, 1.0, False, True
                )
            if status != ops.HIT:
                return status, t
        if whole or is_defined(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, near):
            if is_root(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, near):
                return ops.HIT, t
        elif nears_zero(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, near):
            return ops.UNDECIDED, t
        start = t + near
        if not start < t1:
            return ops.MISS, t1
    return ops.UNDECIDED, start
