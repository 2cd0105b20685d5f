"""The march of an island whose bodies feel no other one: block by block, whole steps at a time, on all threads.

A block is an island of its own, small enough for a core's cache. Which bodies are in which one follows from their
number alone, so the bytes do not depend on the threads.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from sceneql.failure import RunFailure
from sceneql.kernels import over_tiles
from sceneql.simulation.march import March

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.simulation.assembled import Block
    from sceneql.simulation.island import IslandAssembly, System
    from sceneql.system import Stepper


class BlockMarch(March):
    """An island in blocks; what it gives is valid until it is advanced again."""

    def __init__(self, system: System, stepper: Stepper, end: float, blocks: Sequence[Block]) -> None:
        super().__init__(system, stepper, end)
        self._parts = blocks
        self._blocks = [March(block.system, stepper, end) for block in blocks]
        # In one array, so that what contacts remember can be read as if it were one island's.
        self._room = max(len(block.floats) for block in self._blocks)
        self._memory = np.zeros((len(blocks), self._room))
        for block, room in zip(self._blocks, self._memory, strict=True):
            room[: len(block.floats)] = block.floats
            block.floats = room[: len(block.floats)]
        n = len(system.y)
        self._now, self._slope = np.zeros(n), np.zeros(n)
        self.prepared_text = f"in {len(blocks)} blocks of bodies, each for itself"

    def advance(self, t: float) -> tuple[Floats, Floats]:
        """State and rate at an instant [s], of all blocks. Raises the earliest RunFailure of theirs."""
        started = time.perf_counter()
        t = min(t, self.end)
        y, rate = self._now, self._slope
        failures: dict[int, RunFailure] = {}
        parts: list[list[tuple[float, float]]] = [[] for _ in self._blocks]

        def work(k: int) -> None:
            try:
                own, slope = self._blocks[k].view(t)
            except RunFailure as failure:
                failures[k] = failure
                return
            for there, here, count in self._parts[k].places:
                y[there : there + count] = own[here : here + count]
                rate[there : there + count] = slope[here : here + count]
            for _, here in self._parts[k].sums:
                parts[k].append((own[here], slope[here]))

        over_tiles(len(self._blocks), work)
        if failures:
            raise min(failures.items(), key=lambda item: (item[1].time, item[0]))[1]
        for row, (there, _) in enumerate(self._parts[0].sums):
            y[there], rate[there] = np.sum([part[row] for part in parts], axis=0)
        self._floats_time = np.nan
        self._add_up(time.perf_counter() - started)
        return y, rate

    def _add_up(self, seconds: float) -> None:
        """The cost so far: all blocks take the same steps."""
        done, first = self.statistics, self._blocks[0].statistics
        done.steps, done.evaluations = first.steps, first.evaluations
        done.rejected = sum(block.statistics.rejected for block in self._blocks)
        done.seconds += seconds

    def floats_at(self, t: float, y: Floats) -> Floats:
        """The island's floats with the values that vary at a time [s]."""
        if self._floats_time != t and self.system.structure.varying:
            from sceneql.simulation.inputs_kernels import refresh

            ints = self.system.ints
            refresh(t, y, self.floats, ints[ints[ints[2]] : ints[ints[2] + 1]])
        self._floats_time = t
        return self.floats

    def memory(self, name: str, assembly: IslandAssembly, t: float, y: Floats) -> tuple[Floats, tuple[int, ...]]:
        """What a contact remembers, as floats and integers of all blocks."""
        ints = [k * self._room + at for k, part in enumerate(self._parts) for at in part.assembly.remembered(name)]
        return self._memory.ravel(), tuple(ints)
