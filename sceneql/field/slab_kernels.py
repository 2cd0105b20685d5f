# mypy: ignore-errors
"""Beams around the columns of a bundle of rays, in float64, cut in slabs along their way."""

import numpy as np

from sceneql.field.affine_kernels import GROW, HALF, PAD, ZERO, F
from sceneql.field.packet_kernels import C1, E, place
from sceneql.field.tape_ops import NOWHERE, WHOLE
from sceneql.kernels import inlined

PLACE, WAY, PLACE_OFF, WAY_OFF, BEGIN, STOP = 0, 3, 6, 9, 12, 13
BEAM = 14
"""Rows of beams: middle of the places of its rays at its begin, and of their directions; how far they are off both;
begin and end."""


@inlined
def bundle(rays, count, groups, beams):
    """Enclose the rays of each group in a beam; the begin of the earliest ray, where all beams are taken to begin.

    A group of rays without any length ends before it begins. Groups are lanes here: ray j belongs to j % groups.
    """
    t0, t1 = rays[6], rays[7]
    begin = np.inf
    for g in range(groups):
        low, high = np.inf, -np.inf
        for first in range(g, count, groups):
            j = np.uint64(first)
            if t0[j] < t1[j]:
                low = t0[j] if t0[j] < low else low
                high = t1[j] if t1[j] > high else high
        beams[BEGIN, g], beams[STOP, g] = low, high
        begin = low if low < begin else begin
    if begin == np.inf:
        return begin
    for axis in range(3):
        place, way = rays[axis], rays[3 + axis]
        for g in range(groups):
            low = d_low = np.inf
            high = d_high = -np.inf
            for first in range(g, count, groups):
                j = np.uint64(first)
                if t0[j] < t1[j]:
                    d = way[j]
                    p = place[j] + begin * d
                    low = p if p < low else low
                    high = p if p > high else high
                    d_low = d if d < d_low else d_low
                    d_high = d if d > d_high else d_high
            beams[PLACE + axis, g], beams[PLACE_OFF + axis, g] = low, high
            beams[WAY + axis, g], beams[WAY_OFF + axis, g] = d_low, d_high
    return begin


@inlined
def join(beams, groups, whole):
    """The beam around all beams into column ``whole``, then each as middle and how far off."""
    beams[STOP, whole] = -np.inf
    beams[BEGIN, whole] = np.inf
    for g in range(groups):
        beams[BEGIN, whole] = min(beams[BEGIN, whole], beams[BEGIN, g])
        beams[STOP, whole] = max(beams[STOP, whole], beams[STOP, g])
    for axis in range(6):
        row = axis if axis < 3 else axis + WAY - 3
        low = np.inf
        high = -np.inf
        for g in range(groups):
            low = min(low, beams[row, g])
            high = max(high, beams[row + PLACE_OFF, g])
        beams[row, whole] = low
        beams[row + PLACE_OFF, whole] = high
        for g in range(whole + 1):
            low, high = beams[row, g], beams[row + PLACE_OFF, g]
            beams[row, g] = 0.5 * (low + high)
            beams[row + PLACE_OFF, g] = 0.5 * (high - low)


@inlined
def place_slabs(beams, g, base, begin, end, point, lane, slabs):
    """Enclose so many slabs, from begin to end, of a beam whose places are those at ``base``, from a lane on."""
    depth = F((end - begin) / slabs)
    late = begin - base
    for axis in range(3):
        row = point[axis]
        d = F(beams[WAY + axis, g])
        o = F(beams[PLACE + axis, g] + late * beams[WAY + axis, g])
        off = F(beams[PLACE_OFF + axis, g] + (end - base) * beams[WAY_OFF + axis, g]) * GROW
        for k in range(slabs):
            place(row, lane + k, o, d, (F(k) + HALF) * depth, HALF * depth * GROW)
        for k in range(slabs):
            row[E + lane + k] += off


@inlined
def left_of_slabs(last, status, lane, slabs):
    """(first, last, end of the first run) of the slabs that are not proved outside; first = slabs: none."""
    first = slabs
    final = -1
    run = slabs
    for k in range(slabs):
        i = lane + k
        m = abs(last[C1 + i])
        e = last[E + i] * GROW + PAD * (abs(last[i]) + m)
        if status[i] == F(NOWHERE) or last[i] - m > e:
            if first < slabs and run == slabs:
                run = k
            continue
        first = min(first, k)
        final = k
    return first, final, run


@inlined
def first_inside(last, status, lane, slabs):
    """The first of the slabs that is proved to be inside; -1: none."""
    for k in range(slabs):
        i = lane + k
        m = abs(last[C1 + i])
        e = last[E + i] * GROW + PAD * (abs(last[i]) + m)
        if status[i] == F(WHOLE) and last[i] + m + e < ZERO:
            return k
    return -1
