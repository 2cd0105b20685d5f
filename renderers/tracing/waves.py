"""The stages of a picture that trace rays: rays of a wave are listed first, so that packets can intersect them.

Shadow rays and rays to the sky of a whole band make a wave, and so does each step of all its paths: camera, mirrored
and refracted rays, with the light on their surfaces. Single are rays that light what hides the sky, and all where no
shape suits packets.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from renderers.tracing import layout
from renderers.tracing.camera_kernels import TILE
from renderers.tracing.filter.edges_kernels import TRIAL, add_samples, begin_samples, list_edges, look_from_samples
from renderers.tracing.filter.planes_kernels import KEYS, LANES, WIDE
from renderers.tracing.filter.refine_kernels import refine
from renderers.tracing.gather_kernels import PATH
from renderers.tracing.record_kernels import COLUMNS
from renderers.tracing.scratch import scratch
from renderers.tracing.waves_kernels import advance_paths, ask_paths, begin_paths, end_paths, light_paths, look_from

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from renderers.tracing.scene_kernels import Scene
    from renderers.tracing.solids.bundles import Packets

    Array = NDArray[Any]

ROOM = 10 * TILE * TILE
"""Paths of a wave: few enough that their memory stays in a core's cache."""
RAYS = 4 * ROOM
"""Rays listed at a time."""


class Waves:
    """A thread's working memory for bands of a picture, at most TILE rows high."""

    def __init__(self, scene: Scene, packets: Packets | None, rows: int, columns: int) -> None:
        """``packets`` to intersect solids by, or None; ``rows`` of scratch and ``columns`` of visibility."""
        self.scene, self.packets = scene, packets
        self.scratch = scratch(rows)
        self.scratch[-1 - int(scene.ints[layout.SHAPE_COUNT]) : -1, 0] = np.nan
        width = -(-int(scene.reals[layout.WIDTH]) // TILE) * TILE
        self.pixels = width * TILE
        self.asked = np.zeros((1 + RAYS, layout.ANSWERS)) if packets is None else packets.asked(RAYS)
        self.paths, self.at = np.zeros((ROOM, PATH)), np.arange(ROOM, dtype=np.int64)
        self.marks, self.same = np.zeros((TILE, width + LANES), np.float32), np.zeros(LANES, np.float32)
        self.edges, self.sums = np.zeros(self.pixels, dtype=np.int64), np.zeros((ROOM, 4))
        self.own = np.zeros((2, ROOM, COLUMNS), dtype=np.float32)
        self.found = np.zeros((2, ROOM, columns), dtype=np.float32)
        self.spares = np.zeros((ROOM, COLUMNS), dtype=np.float32)

    def gather(self, start: int, stop: int, records: Array, radiance: Array, visibility: Array) -> tuple[int, int]:
        """Fill rows start..stop: records (2, h w, COLUMNS), radiance (h w, 3), visibility (2, h w, V).

        Returns the number of pixels with an undecided root, and with a second record. Radiance is the part that needs
        no visibility.
        """
        undecided = seconds = 0
        for first in range(0, self.pixels, ROOM):
            doubted, more = self._gather(start, stop, first, records, radiance, visibility)
            undecided, seconds = undecided + doubted, seconds + more
        return undecided, seconds

    def _gather(
        self, start: int, stop: int, first: int, records: Array, radiance: Array, visibility: Array
    ) -> tuple[int, int]:
        """As ``gather``, for ROOM pixels from ``first`` on."""
        scene, asked, at = self.scene, self.asked, np.empty_like(self.at)
        count = begin_paths(scene, start, stop, first, records, self.paths, at)
        self._follow(self.paths[:count], at, records)
        self._ask(0, count, lambda i, end: look_from(scene, self.scratch, asked, i, end, at, records, visibility))
        counts: tuple[int, int] = end_paths(self.paths[:count], at, records, radiance)
        return counts

    def refine(self, start: int, stop: int, records: Array, visibility: Array, means: Array, fine: Array) -> None:
        """As refine_kernels.refine."""
        more = records, visibility, means, fine
        self._ask(start, stop, lambda i, end: refine(self.scene, self.scratch, self.asked, i, end, *more))

    def smooth(
        self, start: int, stop: int, points: Array, undecided: int, planes: Array, records: Array, radiance: Array,
        visibility: Array, picture: Array,
    ) -> None:  # fmt: skip
        """Fill rows start..stop of ``picture`` (n, 3): ``radiance``, but edges by rays through ``points`` (s, 2)."""
        scene = self.scene
        width, size = int(scene.reals[layout.WIDTH]), KEYS + visibility.shape[2] * WIDE
        light, own = (records, radiance), (self.marks, self.same, self.edges)
        doubted = undecided + int(scene.ints[layout.HAS_THIN])
        count = list_edges(start, stop, width, size, doubted, planes, *light, picture, *own)
        some = len(self.paths) // TRIAL
        for first in range(0, count, some):
            edges = self.edges[first : min(first + some, count)]
            self.sums[:] = [0.0, 0.0, 0.0, 1.0]
            for used in range(0, len(points), TRIAL):
                edges = self._sample(edges, points, used, records, radiance, visibility, picture)

    def _sample(
        self, edges: Array, points: Array, used: int, records: Array, radiance: Array, visibility: Array,
        picture: Array,
    ) -> Array:  # fmt: skip
        """Take some more samples of pixels; returns the pixels that need still more."""
        scene, some = self.scene, points[used : used + TRIAL]
        each, count = len(some), len(some) * len(edges)
        paths, own, found = self.paths[:count], self.own, self.found
        begin_samples(scene, some, edges, paths, own)
        self._follow(paths, self.at, own)
        more = each, edges, records, visibility, own, found
        self._ask(0, count, lambda i, end: look_from_samples(scene, self.scratch, self.asked, i, end, *more))
        light = records, radiance, paths, own, found
        left = add_samples(scene, each, used + each, len(points), edges, *light, self.sums, picture)
        return edges[:left]

    def _follow(self, paths: Array, at: Array, records: Array) -> None:
        """Follow paths to their ends."""
        while ask_paths(paths, self.asked):
            if self.packets is not None:
                self.packets.meet(self.asked)
            if advance_paths(self.scene, self.scratch, self.asked, paths, at, records, self.spares):
                self._ask(0, len(paths), lambda i, end: self._light(i, end, paths))

    def _light(self, start: int, stop: int, paths: Array) -> int:
        """Light surfaces beyond the records of paths start..stop; returns where it ends."""
        end: int = light_paths(self.scene, self.scratch, self.asked, start, stop, paths, self.spares, self.found[0])
        return end

    def _ask(self, start: int, stop: int, work: Callable[[int, int], int]) -> None:
        """Do ``work`` twice on each part of start..stop whose rays fit the list: to list them, and with their answers.

        Without packets only once, on all of it.
        """
        if self.packets is None:
            work(start, stop)
            return
        while start < stop:
            self.asked[0, [layout.MODE, layout.NEXT]] = layout.ASKING, 1
            end = work(start, stop)
            self.packets.meet(self.asked)
            self.asked[0, [layout.MODE, layout.NEXT]] = layout.TELLING, 1
            work(start, end)
            start = end
