# mypy: ignore-errors
"""First roots along a ray from outward-rounded intervals of f and df/dt: for pieces that enclosures left undecided.

A piece of the ray is cleared by the bounds of f on it, by the mean value form f(m) + (t - m) df/dt, or, where df/dt
keeps one sign, by f at one end; else it is cut where the mean value form allows no root, or halved, the first part
first (Moore 1966; Hansen and Walster 2004, chapter 9). Rounding is outward throughout, so a cleared piece is proved.
"""

import numpy as np

from sceneql.compiled.kernels import lean, woven
from sceneql.field.enclose.slope_kernels import on_ray
from sceneql.field.roots.bracket_kernels import FINE, lowest, polished
from sceneql.field.tape import tape_ops as ops

EVALUATIONS = 1000
"""Pieces examined on one ray before it is left undecided."""
SPLIT = 0.4609375
"""Where pieces are halved: off the middle, so that a root at an end of a piece does not become an end of its halves."""
WIDEST = 1.0e-3
"""Half of the widest piece, relative to the ray, over which rounding may spread a root of even multiplicity."""
CROSSES, TOUCHES, JUMPS, ABSENT, UNKNOWN, BLURRED = range(6)
"""What an undecided piece may contain: a change of sign; a root without one; a pole or an edge of the domain of f;
little or nothing, since f is undefined at both ends; unknown; unknown, as rounding hides the sign far around."""
SHORTEST = 4.0e-15
"""Width of a piece, relative to its place on the ray, that is not cut further."""
NEARBY = 64.0
"""How far an edge of the domain is searched behind a piece undefined at both ends, in the shortest steps."""
UNDEFINED = 2
SURE = 1.0 - 1.0e-14


@woven
def surely(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, sign, touching):
    """(side, bounds of sign df/dt (2)) at t: 1 where sign f is proved > 0, -1 where < 0, UNDEFINED, or 0 if open.

    Where it is proved to be exactly 0, as on a block between steps, is outside, except with ``touching``: 1.
    """
    low, high, least, most, status = on_ray(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, t, sign)
    if status == ops.NOWHERE:
        return UNDEFINED, least, most
    if low > 0.0 or (low == 0.0 and high == 0.0 and not touching):
        return 1, least, most
    return (-1 if status == ops.WHOLE and high < 0.0 else 0), least, most


@woven
def told(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t0, t1, least, sign):
    """(side, t) of ``surely`` at the first of some places from t0 on where it is not 0; steps grow fourfold."""
    t = t0
    step = 0.125 * least
    side, _, _ = surely(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, sign, True)
    while side == 0 and step < WIDEST * (t1 - t0) + least:
        t = min(t0 + step, t1)
        step *= 4.0
        side, _, _ = surely(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t, sign, True)
    return side, t


@lean(
    f"Tuple((int64, int64, float64, float64, float64))({ops.TAPE}, float64, float64, float64, float64, float64,"
    " float64, float64, float64, float64, float64, float64, float64, boolean)",
    inner=True,
)
def hidden(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, a, b, t0, t1, least, sign, touching):
    """(kind, side at the end, place, from, to): what the undecided piece a..b, within t0..t1, contains.

    from..to is a..b, extended by fourfold growing steps until at each end sign f is proved: < 0, or undefined, or > 0
    and falling at the first end or rising at the last. CROSSES: sign f goes from > 0 to < 0. TOUCHES: it is > 0 at both
    ends, with a minimum between. JUMPS: it is undefined at one end, or goes from > 0 to < 0 while it rises at both, as
    at a pole. ABSENT: it is undefined at both ends, so that no edge of the domain is near.
    BLURRED: sign f is proved at neither end, as far as rounding may spread a root.
    """
    reach = WIDEST * (t1 - t0) + 2.0 * least
    step = least
    before = a
    first, gone, falling = surely(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, before, sign, touching)
    while (first == 0 or (first == 1 and not falling < 0.0)) and before > t0 and step < reach:
        before = max(a - step, t0)
        first, gone, falling = surely(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, before, sign, touching)
        step *= 4.0
    step = least
    after = b
    last, rising, _ = surely(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, after, sign, touching)
    while after < t1 and step < (NEARBY * least if first == UNDEFINED == last else reach):
        if last == -1 or (last == 1 and rising > 0.0) or (last == UNDEFINED and first != UNDEFINED):
            break
        after = min(b + step, t1)
        last, rising, _ = surely(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, after, sign, touching)
        step *= 4.0
    place = a
    kind = UNKNOWN
    if first > 0 and last == -1:
        place = polished(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, before, after, sign)
        kind = JUMPS if first == UNDEFINED or (gone > 0.0 and rising > 0.0) else CROSSES
    elif first == 1 and last == 1 and falling < 0.0 and rising > 0.0:
        place = lowest(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, before, after, sign)
        near = 4.0 * FINE * abs(place)
        low, _, _, _, _ = on_ray(
            code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, place - near, place + near, sign
        )
        kind = UNKNOWN if low > 0.0 else TOUCHES
    elif (first == UNDEFINED and last == 1) or (first == 1 and last == UNDEFINED):
        kind = JUMPS
    elif first == UNDEFINED and last == UNDEFINED:
        kind = ABSENT
    elif first == 0 and last == 0:
        kind = BLURRED
    return kind, last, place, before, after


@lean(
    f"Tuple((int64, float64))({ops.TAPE}, float64, float64, float64, float64, float64,"
    " float64, float64, float64, float64, float64, boolean, boolean)"
)
def certify(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t0, t1, finest, sign, anywhere, touching):
    """(status, t) of the first place in [t0, t1] where sign f < 0 begins, or with ``anywhere`` of any such place.

    With ``touching`` the first root of f instead, also one without a change of sign: where f is zero up to its
    rounding, and df/dt changes sign. UNDECIDED: everything before t is proved, and a piece there no longer than
    ``finest`` is not. Roots so near to an end of [t0, t1] that rounding hides the sign of f are skipped: a ray may
    begin on a surface.
    """
    a = t0
    end = t1
    found = ops.MISS  # outcome at `end`
    where = t1
    least = max(finest, 4.0e-15 * (abs(t0) + abs(t1)))
    if touching:
        side, a = told(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t0, t1, least, sign)
        if side == 0:
            return ops.UNDECIDED, a
        if side < 0:
            sign = -sign
    b = end
    eager = True  # examine pieces that rounding hides before they are narrowed down
    for count in range(EVALUATIONS):
        if count > 0 and not a < end:
            return found, where
        width = b - a
        middle = a + SPLIT * width
        low, high, slope0, slope1, status = on_ray(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, a, b, sign)
        if status == ops.WHOLE and high < 0.0:
            return ops.HIT, a
        clear = status == ops.NOWHERE or low > 0.0 or (low == 0.0 and not touching)
        below = above = 0.0
        if not clear:
            below, above, _, _, known = on_ray(
                code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, middle, middle, sign
            )
            if known == ops.WHOLE and above < 0.0:
                if anywhere:
                    return ops.HIT, middle
                if width <= least and (status == ops.WHOLE or not touching):
                    return ops.HIT, polished(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, a, middle, sign)
                if width > least:
                    b = end = where = middle
                    found = ops.HIT
                    continue
        if status == ops.WHOLE and not clear:
            reach = WIDEST * (t1 - t0) + least  # bound of the distance over which rounding hides the sign of f
            if slope0 > 0.0:
                low, high, _, _, _ = on_ray(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, a, a, sign)
                clear = high >= 0.0 and low >= -slope0 * reach
            elif slope1 < 0.0:
                low, high, _, _, _ = on_ray(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, b, b, sign)
                if high < 0.0:
                    return ops.HIT, polished(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, a, b, sign)
                clear = low > 0.0 or (b == end and low >= slope1 * reach)
                if not clear and b < end:
                    b = min(b + width, end)
                    continue
        if not clear and (width <= least or (eager and status == ops.WHOLE and below <= 0.0 <= above)):
            first = a if width <= least else middle
            last = b if width <= least else middle
            kind, behind, place, before, after = hidden(
                code,
                constants,
                parts,
                scratch,
                ox,
                oy,
                oz,
                dx,
                dy,
                dz,
                first,
                last,
                t0,
                t1,
                0.125 * least,
                sign,
                touching,
            )
            if kind == BLURRED and first > a:
                kind, _, _, _, _ = hidden(
                    code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, a, a, t0, t1, 0.125 * least, sign, touching
                )
                if kind == BLURRED:  # nothing behind a can be the first root: halving would end there
                    return ops.UNDECIDED, a
                kind = BLURRED
            if (kind == ABSENT or (kind == JUMPS and behind > 0)) and width > SHORTEST * (abs(a) + abs(b)):
                b = middle
                continue
            if width <= least or kind != UNKNOWN:
                if kind == JUMPS and (touching or behind > 0):
                    if behind < 0:
                        sign = -sign
                        end = t1
                        found = ops.MISS
                    a = after
                    b = min(a + 2.0 * width, end)
                    continue
                found = ops.HIT if kind == CROSSES or kind == (TOUCHES if touching else JUMPS) else ops.UNDECIDED
                b = end = max(before, a)
                where = place if found == ops.HIT else b
                continue
            eager = False
        if not clear and status == ops.WHOLE and below > 0.0:
            # f >= below - slope1 (middle - t) before the middle, and >= below + slope0 (t - middle) behind it.
            blur = 1.0e-15 * (abs(a) + abs(b))
            free = middle - below / slope1 * SURE + blur if slope1 > 0.0 else -np.inf
            if free > a:
                b = free
                continue
            free = middle + below / -slope0 * SURE - blur if slope0 < 0.0 else np.inf
            clear = free >= b
            if not clear:
                a = max(a, free)
                continue
        if clear:
            a = b
            b = min(a + 2.0 * width, end)
        else:
            b = middle
    return ops.UNDECIDED, a
