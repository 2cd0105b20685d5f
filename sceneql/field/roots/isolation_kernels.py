# mypy: ignore-errors
"""First roots of a tape along a ray, proved by enclosures: no Lipschitz bound has to be given.

From the start of the ray on, a segment is rejected when its enclosure c0 + c1 tau +- e has no zero, and the next one is
twice as long; else the segment is cut where the enclosure allows no zero, and halved where that gains little. So the
ray before a root returned is proved to be outside, up to the tolerance.
"""

from numba import types
from numba.core.sigutils import normalize_signature

from sceneql.compiled.kernels import kernel, woven
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.field.enclose.enclosure_kernels import segment
from sceneql.field.enclose.slope_kernels import on_ray
from sceneql.field.roots.bracket_kernels import FINE, along
from sceneql.field.roots.certified_kernels import certify
from sceneql.field.tape import tape_ops as ops

ARGUMENTS, OUTCOME = normalize_signature(
    f"Tuple((int64, float64))({ops.TAPE}, float64, float64, float64, float64, float64, float64,"
    " float64, float64, float64, float64, boolean, boolean)"
)
BEYOND = OUTCOME(*ARGUMENTS)
beyond = lazy("sceneql.field.roots.jumps_kernels:beyond", BEYOND)
LEAPS = types.boolean(*ARGUMENTS[:12])
leaps = lazy("sceneql.field.roots.jumps_kernels:leaps", LEAPS)
EVALUATIONS = 2000
"""Enclosures spent on one ray before it is left undecided."""
BACK = 2.0e-3
"""How far before the place where enclosures got stuck the certified intervals begin, relative to the ray."""


@kernel(
    f"Tuple((int64, float64))({ops.TAPE}, float64, float64, float64, float64, float64, float64,"
    " float64, float64, float64, float64, boolean)",
    _nrt=False,
    inner=True,
)
def search(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t0, t1, tolerance, sign, anywhere):
    """(status, t) of the first entry into {sign f < 0}, or with ``anywhere`` of any place in it; never INSIDE.

    UNDECIDED: everything before t is proved outside; ``certify`` may decide what is there.
    """
    a = t0
    b = t1
    end = t1
    held = False  # {sign f < 0} is proved at `end`, so that a root lies before it
    cut_from = t1  # cut_from..cut_to is proved outside
    cut_to = t1
    least = max(tolerance * (t1 - t0), 1.0e-15 * (abs(t0) + abs(t1)))
    outcome = ops.UNDECIDED
    survey = True
    for _ in range(EVALUATIONS):
        c0, c1, e, status = segment(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, a, b, survey)
        survey = False
        c0 *= sign
        c1 *= sign
        width = b - a
        if status == ops.NOWHERE or c0 - abs(c1) > e:
            a = cut_to if b == cut_from else b
            if a >= end:
                outcome = ops.HIT if held else ops.MISS
                a = end
                break
            b = min(a + 2.0 * width, end)
            if cut_from > a:
                b = min(b, cut_from)
            continue
        if status == ops.WHOLE and (c0 - c1 < -e or (anywhere and c0 - abs(c1) < -e)):
            outcome = ops.HIT
            break
        middle = 0.5 * (a + b)
        half = 0.5 * width
        blur = 1.0e-15 * (abs(a) + abs(b))
        root = middle
        if e < abs(c0) + abs(c1):
            start = a
            if c1 < 0.0:
                root = min(max(middle - half * (c0 / c1), a), b)
                start = max(a, middle + half * ((e - c0) / c1) - blur)
                stop = middle - half * ((c0 + e) / c1) + blur
                if status == ops.WHOLE and stop < b:
                    held = True
                    b = stop
                    end = stop
            elif c1 > 0.0:
                stop = middle + half * ((e - c0) / c1) + blur
                if stop < b:
                    cut_from = stop
                    cut_to = b
                    b = stop
            a = min(start, b)
        if held and b == end and b - a <= FINE * (abs(a) + abs(b)):
            outcome = ops.HIT
            a = min(max(root, a), b)
            break
        if b - a >= 0.5 * width or b - a <= 1.0e-4 * least:
            if b - a <= least:
                if held and b == end:  # rounding allows no narrower bracket
                    outcome = ops.HIT
                    a = min(max(root, a), b)
                break
            b = a + 0.5 * (b - a)
    return outcome, a


@woven
def begin_of_proof(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, t0, t1):
    """Where the certified intervals begin on [t0, t1] after enclosures got stuck at t: at t where f is undefined, as at
    an edge of its domain; else BACK before it, so that f is safely away from zero."""
    _, _, _, _, status = on_ray(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, t, 1.0)
    return t if status == ops.NOWHERE else max(t - BACK * (t1 - t0), t0)


@woven
def isolate(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t0, t1, tolerance, sign, anywhere):
    """As ``search``, continued by certified intervals where enclosures get stuck, and past jumps where these do."""
    status, t = search(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t0, t1, tolerance, sign, anywhere)
    if status == ops.UNDECIDED:
        t = begin_of_proof(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, t0, t1)
        finest = tolerance * (t1 - t0)
        status, t = certify(
            code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, t1, finest, sign, anywhere, False
        )
        if status == ops.UNDECIDED:
            status, t = beyond(
                code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, t1, finest, sign, anywhere, False
            )
    return status, t


@woven
def first_root(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t0, t1, tolerance):
    """(status, t) of the first entry of the ray o + t d, t in [t0, t1], into the solid {f < 0}.

    HIT: the ray is proved outside before t, and inside begins at t. INSIDE: t0 is inside already. MISS: all of [t0, t1]
    is proved outside. UNDECIDED: at t a feature smaller than ``tolerance`` (t1 - t0), such as a root of even
    multiplicity, was neither proved nor excluded. d need not be a unit vector; undefined places are outside.
    """
    status, t = isolate(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t0, t1, tolerance, 1.0, False)
    if status == ops.HIT and t - t0 <= tolerance * (t1 - t0):
        if along(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t0) < 0.0:
            return ops.INSIDE, t0
    return status, t


@woven
def exit_root(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t0, t1, tolerance):
    """As ``first_root``, for the way out: the first entry into {f > 0}."""
    status, t = isolate(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t0, t1, tolerance, -1.0, False)
    if status == ops.HIT and t - t0 <= tolerance * (t1 - t0):
        if along(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t0) > 0.0:
            return ops.INSIDE, t0
    return status, t


@woven
def any_root(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t0, t1, tolerance):
    """For shadow rays: HIT where the ray meets the solid in [t0, t1], MISS if it is proved not to, else UNDECIDED."""
    return isolate(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t0, t1, tolerance, 1.0, True)[0]
