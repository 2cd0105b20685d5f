"""Packets of rays for implicit solids: rays are collected, intersected together, then traced with the answers."""

from __future__ import annotations

import threading
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from renderers.tracing import layout
from renderers.tracing.scratch import asked_rays
from renderers.tracing.solids.bundles_kernels import RAYS, meet_asked
from renderers.tracing.solids.skins_kernels import LANES, skin_hits
from sceneql.field.packets.packets import Memory, lined
from sceneql.field.packets.point_blocks_kernels import BLOCKS
from sceneql.field.roots.clips import clip_rows, clips_of
from sceneql.field.tape.own_coordinates import in_own_coordinates
from sceneql.frame import Implicit

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from renderers.tracing.scene_kernels import Scene
    from sceneql.frame import Floats, Ints, Shape, Tape


_of_thread = threading.local()
"""Memories of each thread from the last picture; a rigidly moved solid has the same tape in its own coordinates."""


def _memory(tape: Tape, kept: list[Memory]) -> Memory:
    """Working memory for a tape, taken from ``kept`` if that has one for an equal tape."""
    for i, memory in enumerate(kept):
        if memory.tape is tape or all(
            np.array_equal(one, other)
            for one, other in (
                (memory.tape.code, tape.code),
                (memory.tape.constants, tape.constants),
                (memory.tape.parts, tape.parts),
            )
        ):
            return kept.pop(i)
    return Memory(tape, RAYS, clip_rows(tape))


@lru_cache(maxsize=4)
def own_tapes(tapes: tuple[Tape | None, ...]) -> tuple[Ints, Ints, Floats]:
    """The shapes' tapes in their own coordinates, for ``skins_kernels.own_tape``: (n, 6) ranges, integers, reals.

    Ranges are 0 for None.
    """
    ranges = np.zeros((len(tapes), 6), dtype=np.int32)
    codes, numbers = [np.empty(0, dtype=np.int32)], [np.empty(0)]
    at = last = 0
    for row, tape in zip(ranges, tapes, strict=True):
        if tape is not None:
            count, some = len(tape.constants), len(tape.parts)
            row[:] = at, len(tape.code), last, count, last + count, some
            codes.append(tape.code.ravel())
            numbers += [tape.constants, tape.parts.ravel()]
            at, last = at + tape.code.size, last + count + tape.parts.size
    return ranges, np.concatenate(codes), np.concatenate(numbers)


class Packets:
    """Memory of one thread to intersect rays with implicit solids; ``solids``: their indices among ``shapes``."""

    def __init__(self, shapes: tuple[Shape, ...], solids: list[int]) -> None:
        self.solids = solids
        kept = list(getattr(_of_thread, "memories", ()))
        self.memories: list[Memory] = []
        self.bounds: list[tuple[Floats, ...]] = []
        own: list[Tape | None] = [None] * len(shapes)
        matrices = np.zeros((len(shapes), 12))
        for i in self.solids:
            shape = shapes[i]
            assert isinstance(shape, Implicit)
            tape, matrix = in_own_coordinates(shape.tape)
            if tape is not shape.tape:
                own[i], matrices[i] = tape, matrix.ravel()
            self.memories.append(_memory(tape, kept))
            box, clips = np.array([shape.low, shape.high], dtype=np.float64), clips_of(shape.tape)
            reach = float(np.abs(box).max()) ** np.array([2.0] * 6 + [1.0] * 3 + [0.0])
            self.bounds.append((box, clips, np.abs(clips) @ reach, matrix))
        _of_thread.memories = self.memories
        self.asked_last: Floats | None = None
        self.calls: list[tuple[Any, ...]] = []
        """Arguments of ``meet_asked`` for the list of rays ``asked_last``."""
        self.chosen, self.spans = np.empty((2, 1 + RAYS), dtype=np.int64), np.empty((3, 2, RAYS))
        tapes = [shape.tape for i in solids if isinstance(shape := shapes[i], Implicit)]
        tapes += [shape.paint for i in solids if isinstance(shape := shapes[i], Implicit) and shape.paint is not None]
        rows, parts = max(len(tape.code) for tape in tapes), max(len(tape.parts) for tape in tapes)
        memory = lined((rows, LANES)), lined((rows, 3, LANES)), lined((6, LANES))
        bases = np.full(len(shapes), -1)
        blocks = [(i, one.blocks) for i, one in zip(solids, self.memories, strict=True) if one.blocks is not None]
        at = 0
        for i, one in blocks:
            bases[i], at = at, at + one.shape[1]
        every = np.concatenate([np.zeros((BLOCKS, 1), dtype=np.float32), *(one for _, one in blocks)], axis=1)
        bases[bases >= 0] += 1
        listed = np.empty(parts, dtype=np.int64)
        lists = np.empty((2, rows, 4), dtype=np.int32), np.empty((parts, 8)), every, bases, listed
        self.of_skins = *memory, *lists, matrices, *own_tapes(tuple(own))

    def asked(self, rays: int) -> Floats:
        """Empty list of rays (1 + rays, columns); see scene_kernels.ASKED."""
        return asked_rays(rays, self.solids)

    def of_rays(self, asked: Floats) -> list[tuple[Any, ...]]:
        """Arguments of ``meet_asked`` for a list of rays, by solids."""
        if self.asked_last is not asked:
            self.asked_last, self.calls = asked, []
            for k, (memory, bounds) in enumerate(zip(self.memories, self.bounds, strict=True)):
                more = *bounds, asked, layout.ANSWERS + k, self.chosen, self.spans
                self.calls.append((*memory.bundle, memory.found, *memory.rest, *more))
        return self.calls

    def meet(self, asked: Floats) -> None:
        """Write the first crossings of all listed rays with the solids into ``asked``."""
        for arguments in self.of_rays(asked):
            meet_asked(*arguments)

    def skin(self, scene: Scene, hits: NDArray[int64], met: Floats, skins: Floats) -> None:
        """Normals and colors of the solids at ``hits``: see skins_kernels.skin_hits."""
        skin_hits(scene, hits, met, skins, *self.of_skins)


def solids_in_lanes(shapes: tuple[Shape, ...]) -> list[int]:
    """Indices of the implicit solids that packets intersect: all but sheets."""
    return [i for i, shape in enumerate(shapes) if isinstance(shape, Implicit) and shape.within is None]
