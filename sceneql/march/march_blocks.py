"""The march of an island whose bodies do not interact: block by block, on all threads.

A block is an island of its own, small enough for a core's cache. The division into blocks follows from the number of
bodies alone, so the bytes do not depend on the threads.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from itertools import accumulate
from typing import TYPE_CHECKING

import numpy as np

import sceneql.system.channels as channels
from sceneql.compiled.kernels import compiled, over_tiles, thread_count
from sceneql.island import layout
from sceneql.march import march_blocks_kernels as kernels
from sceneql.march.march import ENTRIES_A_CALL, March
from sceneql.march.march_kernels import PAUSED, REACHED, REJECTED, STEPS

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.island.island import IslandAssembly
    from sceneql.island.system import System
    from sceneql.march.assembled import Block
    from sceneql.system import Stepper

FLOATS = ("_y0", "_rate0", "_y1", "_rate1", "_sample", "_work", "_settings", "floats", "_gaps", "_clock")
"""Arrays of a march, in the order of the kernels' columns from Y0 on."""
FULL = ("_y1", "_settings", "floats", "_clock")
"""The arrays that are not all zeros before the first step."""
TILES = 16
"""Number of runs of blocks for each thread, each run one compiled call."""


class BlockMarch(March):
    """The march of an island in blocks; arrays that it returns are valid until the next call."""

    def __init__(self, system: System, stepper: Stepper, end: float, blocks: Sequence[Block]) -> None:
        super().__init__(system, stepper, end)
        self._parts = blocks
        self._blocks = [March(block.system, stepper, end) for block in blocks]
        self._table = np.zeros((len(blocks), kernels.COLUMNS), dtype=np.int64)
        self._gather()
        n = len(system.y)
        self._now, self._slope = np.zeros(n), np.zeros(n)
        self._sums = np.zeros((len(blocks), 2, len(blocks[0].sums)))
        self.prepared_text = f"in {len(blocks)} blocks of bodies, each for itself"

    def _gather(self) -> None:
        """Gather the arrays of the blocks' marches into one array of floats and one of integers."""
        floats, words = [], []
        for march, part in zip(self._blocks, self._parts, strict=True):
            floats += [getattr(march, name) for name in FLOATS]
            places = np.array(part.places, dtype=np.int64).ravel()
            sums = np.array([here for _, here in part.sums], dtype=np.int64)
            words += [march._numbers, march.system.ints, march._leaving, march._counts, places, sums]
        starts = list(accumulate(map(len, floats), initial=0))
        self._arena, self._words = np.zeros(starts[-1]), np.concatenate(words)
        counting = list(accumulate(map(len, words), initial=0))
        each = kernels.INTS_END - kernels.NUMBERS
        for k, (march, row) in enumerate(zip(self._blocks, self._table, strict=True)):
            ends = starts[k * len(FLOATS) : (k + 1) * len(FLOATS) + 1]
            row[: len(ends)] = ends
            for name, first, last in zip(FLOATS, ends[:-1], ends[1:], strict=True):
                if name in FULL:
                    self._arena[first:last] = getattr(march, name)
                setattr(march, name, self._arena[first:last])
            row[kernels.NUMBERS : kernels.INTS_END + 1] = counting[k * each : (k + 1) * each + 1]
            march._counts = self._words[row[kernels.COUNTING] : row[kernels.PLACES]]
            row[kernels.SIZE] = len(march.system.y)

    def advance(self, t: float) -> tuple[Floats, Floats]:
        """State and rate (n,) at an instant [s]. Raises the earliest RunFailure of the blocks."""
        started = time.perf_counter() - compiled.seconds
        t = min(t, self.end)
        blocks = len(self._blocks)
        if not self._started:
            self._started = True
            for block in self._blocks:
                block._start()
        tiles = min(blocks, TILES * thread_count())
        functions, table, sums = self._blocks[0]._engaged.functions, self._table.ravel(), self._sums.ravel()
        y, rate = self._now, self._slope

        def work(k: int) -> None:
            first, last = blocks * k // tiles, blocks * (k + 1) // tiles
            numbers = (functions, first, last, t, self.end, ENTRIES_A_CALL)
            while kernels.advance(*numbers, self._arena, self._words, table, y, rate, sums) == PAUSED:
                pass

        over_tiles(tiles, work)
        failed = np.flatnonzero(self._table[:, kernels.STATUS] != REACHED)
        if len(failed):
            first = min(failed, key=lambda k: self._blocks[k].time)
            self._blocks[first].fail(int(self._table[first, kernels.STATUS]))
        for k, (there, _) in enumerate(self._parts[0].sums):
            y[there], rate[there] = self._sums[:, :, k].sum(axis=0)
        self._floats_time = np.nan
        self._add_up(time.perf_counter() - compiled.seconds - started)
        return y, rate

    def _add_up(self, seconds: float) -> None:
        """Update the statistics; all blocks take the same steps."""
        done, first = self.statistics, self._blocks[0]
        done.steps, done.evaluations = int(first._counts[STEPS]), int(first.floats[channels.RATES])
        done.rejected = sum(int(block._counts[REJECTED]) for block in self._blocks)
        done.seconds += seconds

    def floats_at(self, t: float, y: Floats) -> Floats:
        """The island's floats, with varying values evaluated at a time [s]."""
        if self._floats_time != t and self.system.structure.varying:
            from sceneql.island.inputs_kernels import refresh

            ints = self.system.ints
            table = ints[layout.TABLE_AT]
            refresh(t, y, self.floats, ints[ints[table] : ints[table + 1]])
        if self._floats_time != t:
            for part, at in zip(self._parts, self._table[:, kernels.FLOATS], strict=True):
                for there, here, count in part.changes:
                    self.floats[there : there + count] = self._arena[at + here : at + here + count]
        self._floats_time = t
        return self.floats

    def memory(self, name: str, assembly: IslandAssembly, t: float, y: Floats) -> tuple[Floats, tuple[int, ...]]:
        """A contact's memory, as floats and integers of all blocks."""
        at = self._table[:, kernels.FLOATS]
        ints = [int(at[k]) + n for k, part in enumerate(self._parts) for n in part.assembly.remembered(name)]
        return self._arena, tuple(ints)
