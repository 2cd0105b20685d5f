# mypy: ignore-errors
"""Prepares a slice of a bundle of rays: its lanes, its parts, and the rays whose outcome these decide at once."""

import numpy as np

from sceneql.compiled.kernels import inlined
from sceneql.field.roots import beam_kernels as beams
from sceneql.field.roots import density_march_kernels as march
from sceneql.field.roots.beam_kernels import WIDE
from sceneql.field.roots.density_march_kernels import HALF, LESS, MORE, ONE, ZERO, F
from sceneql.field.tape.single_kernels import lane
from sceneql.field.tape.tape_ops import HIT, MISS

SPOT, SPANS, BEAM_ROW, OWN_ROW, SPARE, ROOM = WIDE, WIDE + 7, WIDE + 10, WIDE + 11, WIDE + 12, WIDE + 18
BASE = 6
"""Rows of ``room`` (ROOM, n): rays; lanes (place, direction, begin of the slice on the ray); where parts are entered
and left along the axis of a beam, and their largest density in it; the bundle's beam and a packet's; working memory of
both."""
NARROW, HAIR = F(2.0e-5), F(1.0e-6)
"""Bracket width, and margin of the search beyond the parts, both relative to the length of the ray."""
TWO, THREE = F(2.0), F(3.0)
CLEARLY = F(1.001)
"""Densities above so many times the threshold prove the inside if their rounding is below the excess."""
INFINITE = F(np.inf)
GOLDEN = F(0.4472136)
"""1/sqrt(5)."""


@inlined
def pick(source, live, n, target):
    """Gather a row of the rays into the lanes."""
    for i in range(n):
        target[i] = source[np.uint64(live[i])]


@inlined
def place_lanes(room, live, state, given, n, fresh, begin, end, lowest):
    """Set the rays of n lanes at the begin of a slice, and where it ends on them; lanes behind the ``given`` get no
    length."""
    bases = room[SPOT + BASE]
    far, behind, stretch = room[SPARE], room[SPARE + 1], room[SPARE + 2]
    if fresh:
        own = slice(live[0], live[0] + n)
        far, behind, stretch = room[beams.FAR, own], room[beams.BEHIND, own], room[beams.STRETCH, own]
    else:
        for row, target in ((beams.FAR, far), (beams.BEHIND, behind), (beams.STRETCH, stretch)):
            pick(room[row], live, n, target)
    sliced = lowest > 0.5
    for i in range(n):
        stop = far[i]
        base, last = (begin - behind[i]) * stretch[i], (end - behind[i]) * stretch[i]
        base = base if base > 0.0 else 0.0
        base = base if base < stop else stop
        last = last if last > base else base
        last = last if last < stop else stop
        base = base if sliced else 0.0
        bases[i] = base
        state[march.END + i] = F((last if sliced else stop) - base)
        state[march.FINE + i] = F(stop)
        state[march.AT_A + i] = INFINITE
        state[march.AT_B + i] = -INFINITE
        state[march.TOP + i] = ZERO
        state[march.DEEP + i] = INFINITE
    for i in range(given, n):
        state[march.END + i] = -INFINITE
    for axis in range(3):
        spot, way = room[SPOT + axis], room[SPOT + 3 + axis]
        if fresh:
            place, along = room[beams.PX + axis, own], room[beams.DX + axis, own]
            for i in range(n):
                d = along[i]
                way[i] = d
                spot[i] = place[i] + bases[i] * d
        else:
            pick(room[beams.PX + axis], live, n, spot)
            pick(room[beams.DX + axis], live, n, way)
            for i in range(n):
                spot[i] += bases[i] * way[i]


@lane
def densest(p, t, inverse, end):
    """The largest u of a point in 0..``end``."""
    s = t if t < end else end
    s = t - (s if s > ZERO else ZERO)
    u = p - inverse * (s * s)
    return u if u > ZERO else ZERO


@inlined
def set_part(part, room, row, state, n, level):
    """Write the table row of a part, and widen AT_A..AT_B to where lanes are within its reach; returns how many are.

    ``level`` is the u at which the part alone has the threshold.
    """
    cx, cy, cz, radius = part[0], part[1], part[2], part[6]
    inverse = 1.0 / (radius * radius)
    x, y, z = room[SPOT], room[SPOT + 1], room[SPOT + 2]
    dx, dy, dz = room[SPOT + 3], room[SPOT + 4], room[SPOT + 5]
    for i in range(n):
        wx, wy, wz = cx - x[i], cy - y[i], cz - z[i]
        t = wx * dx[i] + wy * dy[i] + wz * dz[i]
        row[i] = F(1.0 - inverse * (wx * wx + wy * wy + wz * wz - t * t))
        row[march.T + i] = F(t)
    reach = F(radius)
    weight = F(part[7])
    most = weight if weight > ZERO else ZERO
    inverse_single = F(inverse)
    lanes = np.int32(0)
    for i in range(n):
        p, t = row[i], row[march.T + i]
        half = reach * np.sqrt(p if p > ZERO else ZERO)
        row[march.Q + i] = t - GOLDEN * half
        near = (p > ZERO) & (t + half > ZERO) & (t - half < state[march.END + i])
        entry, exit = state[march.AT_A + i], state[march.AT_B + i]
        first = entry if entry < t - half else t - half
        last = exit if exit > t + half else t + half
        state[march.AT_A + i] = first if near else entry
        state[march.AT_B + i] = last if near else exit
        lanes = np.int32(lanes + (np.int32(1) if near else np.int32(0)))
        top = densest(p, t, inverse_single, state[march.END + i])
        state[march.TOP + i] += most * (top * top * top) if near else ZERO
        lift = p - level
        inner = t - reach * np.sqrt(lift if lift > ZERO else ZERO)
        deep = state[march.DEEP + i]
        inside = (lift > ZERO) & (inner > ZERO) & (inner < state[march.END + i]) & (inner < deep)
        state[march.DEEP + i] = inner if inside else deep
    row[march.WEIGHT] = weight
    row[march.INVERSE] = inverse_single
    return lanes


@inlined
def reach_threshold(state, n, threshold, close, drift):
    """Whether in some lane all parts together may reach the threshold."""
    lanes = np.int32(0)
    for i in range(n):
        off = close + drift * state[march.END + i]
        lanes = np.int32(lanes + (np.int32(1) if state[march.TOP + i] > threshold - off else np.int32(0)))
    return lanes > 0


@inlined
def tighten(table, rows, state, n, threshold, close, drift):
    """Narrow AT_A..AT_B of n lanes to where the parts are dense enough for the threshold.

    Even with all others at their maxima, a part must contribute the rest. For densities above the threshold ``close`` +
    ``drift`` t bounds the rounding of a sum; that of a contribution grows in proportion to the density.
    """
    scale = TWO / threshold if threshold > ZERO else ZERO
    for k in range(rows):
        row = table[k]
        weight, inverse = row[march.WEIGHT], row[march.INVERSE]
        if not weight > ZERO:
            continue
        share, reach = ONE / weight, ONE / np.sqrt(inverse)
        for i in range(n):
            p, t, end = row[i], row[march.T + i], state[march.END + i]
            top = densest(p, t, inverse, end)
            excess = (state[march.TOP + i] * (MORE + scale * (close + drift * end)) - threshold) * share
            least = top * top * top - excess
            # A lower bound of the cube root: 1 + z + z >= 3 z^(2/3) for z = least/top^3.
            level = THREE * LESS * least * top / (top * top * top + TWO * least if least > ZERO else ONE)
            half = reach * np.sqrt(p - level if p > level else ZERO)
            entry, exit = state[march.AT_A + i], state[march.AT_B + i]
            first = entry if entry > t - half else t - half
            last = exit if exit < t + half else t + half
            state[march.AT_A + i] = first if least > ZERO else entry
            state[march.AT_B + i] = last if least > ZERO else exit


@inlined
def start_lanes(state, n, threshold, close, drift, negative, anywhere):
    """Begin the search in each lane where the slice's parts are dense enough; returns in how many lanes.

    A lane whose parts together cannot reach the threshold is a MISS. Without negative parts, a place where a single
    part exceeds it is inside. ``close`` + ``drift`` t: see ``density_march_kernels.advance``.
    """
    positive = not negative
    looking = np.int32(0)
    for i in range(n):
        way = state[march.FINE + i]
        low = state[march.AT_A + i] - HAIR * way
        high = state[march.AT_B + i] + HAIR * way
        low = low if low > ZERO else ZERO
        high = high if high < state[march.END + i] else state[march.END + i]
        deep = state[march.DEEP + i]
        off = close + drift * high
        known = positive & (off < (CLEARLY - ONE) * threshold) & (deep < high) & (deep > low)
        state[march.A + i] = low
        state[march.B + i] = deep if known else (high if anywhere else HALF * (low + high))
        state[march.END + i] = high
        state[march.FINE + i] = NARROW * way
        state[march.TRIES + i] = ZERO
        state[march.ROOT + i] = low
        live = (low < high) & (state[march.TOP + i] > threshold - off)
        met = known & anywhere
        state[march.STATE + i] = F(HIT) if met else (march.LIVE if live else F(MISS))
        looking = np.int32(looking + (np.int32(1) if live & (not met) else np.int32(0)))
    for i in range(n, march.LANES):
        state[march.STATE + i] = F(MISS)
    return looking
