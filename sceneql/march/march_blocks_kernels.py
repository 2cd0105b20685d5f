# mypy: ignore-errors
"""The march of several blocks of an island (march_blocks.py), one after the other, in one compiled call.

All floats of all blocks are in one array and all integers in another; a row of COLUMNS integers has the offsets of a
block's arrays.
"""

import numpy as np
from numba import types

import sceneql.system.channels as channels
from sceneql.compiled.kernels import kernel, lean_inlined
from sceneql.compiled.pointers_kernels import AT_DENSE, AT_RATE, dense_at, rate_at
from sceneql.march import march_kernels as marching
from sceneql.system.signatures_kernels import A, F, I, N

Y0, RATE0, Y1, RATE1, SAMPLE, WORK, SETTINGS, FLOATS, GAPS, CLOCK, FLOATS_END = range(11)
NUMBERS, INTS, LEAVING, COUNTING, PLACES, SUMS, INTS_END = range(11, 18)
SIZE, STATUS, LOOKED, COLUMNS = range(18, 22)
"""Entries of a block's state; status of its march; whether a frame was interpolated after the last step."""


@lean_inlined
def add_to(whole, part, places):
    """Copy a block's entries to their places in the island's state."""
    for k in range(0, places.size, 3):
        there, here = whole[places[k] : places[k] + places[k + 2]], part[places[k + 1] : places[k + 1] + places[k + 2]]
        for i in range(there.size):
            there[i] = here[i]


@kernel(types.int64(I, N, N, F, F, N, A, I, I, A, A, A))
def advance(functions, first, last, target, end, most, arena, words, table, y, rate, sums):
    """March blocks first..last-1 to a target [s] and write their part of the island's state and rate (n,) there.

    ``most``: entries to step over for a block; PAUSED where that was not enough: call again. Else REACHED; each block
    has its status in table[.., STATUS]. sums (blocks, 2, sums): entries that are sums over bodies, in state and rate.
    """
    rate_of, dense = rate_at(functions[AT_RATE]), dense_at(functions[AT_DENSE])
    for b in range(first, last):
        row = table[COLUMNS * b : COLUMNS * (b + 1)]
        if row[STATUS] != marching.REACHED:
            continue
        n = row[SIZE]
        y0, y1 = arena[row[Y0] : row[Y0] + n], arena[row[Y1] : row[Y1] + n]
        rate0, rate1 = arena[row[RATE0] : row[RATE0] + n], arena[row[RATE1] : row[RATE1] + n]
        sample, work = arena[row[SAMPLE] : row[WORK]], arena[row[WORK] : row[SETTINGS]]
        settings, floats = arena[row[SETTINGS] : row[FLOATS]], arena[row[FLOATS] : row[GAPS]]
        clock = arena[row[CLOCK] : row[CLOCK] + marching.CLOCKS]
        numbers, ints = words[row[NUMBERS] : row[INTS]], words[row[INTS] : row[LEAVING]]
        counts = words[row[COUNTING] : row[COUNTING] + marching.COUNTS]
        if clock[marching.T1] < target:
            if counts[marching.HELD] != 0 and row[LOOKED] != 0:
                # The frame has evaluated terms elsewhere: write again what contacts read of them at the step's end.
                counted = floats[channels.RATES]
                rate_of(clock[marching.T1], y1, sample, floats, ints)
                floats[channels.RATES] = counted
            row[LOOKED] = 0
            counts[marching.LEFT] = 1 + most // n
            status = marching.march(
                functions, target, end, y0, rate0, y1, rate1, sample, work, settings, numbers, floats, ints,
                arena[row[GAPS] : row[CLOCK]], words[row[LEAVING] : row[COUNTING]], clock, counts,
            )  # fmt: skip
            if counts[marching.SWAPPED] != 0:
                row[Y0], row[Y1], row[RATE0], row[RATE1] = row[Y1], row[Y0], row[RATE1], row[RATE0]
                y0, y1, rate0, rate1 = y1, y0, rate1, rate0
                counts[marching.SWAPPED] = 0
            if status == marching.PAUSED:
                return marching.PAUSED
            if status != marching.REACHED:
                row[STATUS] = status
                continue
        now, slope = y1, rate1
        if target < clock[marching.T1]:
            h = clock[marching.T1] - clock[marching.T0]
            theta = (target - clock[marching.T0]) / h
            if counts[marching.ALTERED] != 0:
                marching.hermite(theta, h, y0, rate0, y1, rate1, work, settings, numbers, sample)
            else:
                dense(theta, h, y0, rate0, y1, rate1, work, settings, numbers, sample)
            now, slope = sample, np.empty(n)
            counted = floats[channels.RATES]
            rate_of(target, now, slope, floats, ints)
            floats[channels.RATES] = counted
            row[LOOKED] = 1
        places, of_sums = words[row[PLACES] : row[SUMS]], words[row[SUMS] : row[INTS_END]]
        add_to(y, now, places)
        add_to(rate, slope, places)
        for k in range(of_sums.size):
            sums[(2 * b) * of_sums.size + k] = now[of_sums[k]]
            sums[(2 * b + 1) * of_sums.size + k] = slope[of_sums[k]]
    return marching.REACHED
