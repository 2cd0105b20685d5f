"""Stages of a picture that trace rays in waves: the rays of a wave are listed first, so that packets intersect them.

A wave is one of: the camera's rays of some tiles; the shadow rays and sky rays from their hits; one step of all their
paths, mirrored and refracted rays with the light on their surfaces. Rays are traced one by one if they light surfaces
that hide the sky, and in scenes without shapes for packets but with more than a few balls, boxes and floors.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from renderers.tracing import layout
from renderers.tracing.camera_kernels import TILE
from renderers.tracing.filter.edges_kernels import TRIAL, add_samples, list_edges, list_samples, look_from_samples
from renderers.tracing.filter.hard_kernels import soften
from renderers.tracing.filter.planes_kernels import LANES
from renderers.tracing.filter.refine_kernels import refine
from renderers.tracing.gather_kernels import PATH
from renderers.tracing.light import look_lanes_kernels as looks
from renderers.tracing.light.bounce_kernels import WAY, dress_hits, follow_all, look_about, step_all
from renderers.tracing.light.ways import few_of, ways_follower
from renderers.tracing.path_hits_kernels import bend_paths, dress_paths, meet_paths
from renderers.tracing.record_kernels import COLUMNS
from renderers.tracing.scratch import asked_rays, begun, given_up, scratch_beside
from renderers.tracing.solids.plain_lanes import lanes_for
from renderers.tracing.solids.whole_bands import bands_gatherer, in_one_call
from renderers.tracing.tiles_kernels import fill_background
from renderers.tracing.waves_kernels import (
    advance_paths,
    ask_paths,
    describe_hits,
    end_paths,
    end_pixels,
    light_paths,
    list_pixels,
    look_from,
    meet_first,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from renderers.tracing.scene_kernels import Scene
    from renderers.tracing.solids.bundles import Packets

    Array = NDArray[Any]

TILES, RAYS = 10, 40
"""Size of a wave of the camera's rays, and of a list of rays, in tiles; a wave's memory stays in a core's cache."""
MORE_TILES, MORE_RAYS = 40, 80
"""Sizes in scenes without light from around whose waves are led from here: for most pictures a wave is a whole band, to
save calls from Python."""


class Waves:
    """Working memory of a thread for bands of a picture, at most TILE rows high.

    All of it is written before it is read: zeros in each frame would take a thirtieth of its time.
    """

    def __init__(self, scene: Scene, packets: Packets | None, rows: int, columns: int, layers: int) -> None:
        """``packets``: intersect solids in packets, if not None; ``rows``: of scratch; ``columns``: of visibility;
        ``layers``: of records."""
        self.scene, self.packets = scene, packets
        around = scene.reals[layout.HAS_LIGHT] != 0.0
        in_one = in_one_call(scene, packets, layers)
        few = around or in_one
        self.tiles = TILES if few else MORE_TILES
        room, rays = (TILE * TILE * count for count in (self.tiles, RAYS if few else MORE_RAYS))
        width = -(-int(scene.reals[layout.WIDTH]) // TILE) * TILE
        self.asked = asked_rays(rays) if packets is None else packets.asked(rays)
        self.scratch = scratch_beside(self.asked, scene, rows)
        self.lanes = lanes_for(scene, packets is not None)
        if self.lanes is not None:
            from renderers.tracing.solids.plain_lanes_kernels import meet_plain

            self.meet_plain: Callable[..., None] = meet_plain
            self.asked[0, layout.ALONE] = 1.0
        self.listed = packets is not None or self.lanes is not None
        lights, others = scene.ints[layout.LIGHT_COUNT], scene.ints[[layout.EMBERS, layout.MISTS]]
        alone = self.asked[0, layout.ALONE] != 0.0
        self.looks = np.zeros(looks.ROOM) if alone and lights <= looks.MOST_LIGHTS and not others.any() else None
        self.waiting = np.empty(2 + rays, dtype=np.int64)
        self.cones, self.each = np.empty((room, 3)), np.arange(room, dtype=np.int64)
        self.at = np.empty((-(-width // TILE // self.tiles), room), dtype=np.int64)
        self.awaited: list[tuple[Callable[[int, int], int], int, int]] = []
        """What is to be run again when the light paths have ended that waves of a band have begun: see ``_ask``."""
        some = room if layers > 1 or scene.ints[layout.HAS_THIN] else 1  # no path begins in a wholly matte scene
        self.paths, self.of = np.empty((some, PATH)), np.empty(some, dtype=np.int64)
        self.hits, self.met, self.skins = np.empty(room, dtype=np.int64), np.empty((room, 5)), np.empty((room, 6))
        self.gathered = np.empty((room, 4))
        count = 2 * (1 + rays) if self.listed and around else 1
        self.ways, self.live, self.ways_hit = (
            np.empty((count, WAY)),
            np.empty(count, np.int64),
            np.empty(count, np.int64),
        )
        self.ways_met, self.ways_skins = np.empty((count, 5)), np.empty((count, 6))
        own = self.ways, self.live, self.ways_hit, self.ways_met, self.ways_skins
        self.follow = ways_follower(scene, packets, self.lanes, self.scratch, self.asked, *own)
        self.marks, self.same = (
            np.empty((TILE, -(-width // LANES) * LANES), np.float32),
            np.empty(LANES, np.float32),
        )
        self.edges, self.sums = np.empty(width * TILE, dtype=np.int64), np.empty((room, 4))
        self.own = np.empty((layers, room, COLUMNS), dtype=np.float32)
        self.found = np.empty((layers, room, columns), dtype=np.float32)
        self.spares = np.empty((some, COLUMNS), dtype=np.float32)
        self.whole: Callable[..., tuple[int, int]] | None = None
        if in_one and self.looks is not None:
            memory = self.at[0], self.cones, self.gathered, self.paths, self.of, self.hits, self.met, self.skins
            more = self.ways, self.looks
            self.whole = bands_gatherer(scene, packets, self.lanes, self.scratch, self.asked, *memory, *more)

    def gather(
        self, start: int, stop: int, reached: Array, busy: Array, mirrored: Array, records: Array, visibility: Array,
        final: bool, radiance: Array,
    ) -> tuple[int, int, int]:  # fmt: skip
        """Fill rows start..stop, of one or more bands, of L layers.

        That is records (L, h w, COLUMNS), radiance (h w, 3) and visibility (L, h w, V). Returns the numbers of pixels
        with an undecided root, of those with a second record, and of rays given up. Radiance is the part that needs no
        visibility, or all of it if visibility is ``final``. Rays are traced only in ``reached`` tiles; tiles with a hit
        become ``busy``, those with a second record ``mirrored``.
        """
        if self.whole is not None:
            band = start, stop, reached, busy, mirrored, records, visibility, final, radiance
            unsure, lost = self.whole(*band)
            return unsure, 0, lost
        rest = reached, busy, mirrored, records, visibility, final, radiance
        bands = [self._gather_band(at, min(at + TILE, stop), *rest) for at in range(start, stop, TILE)]
        undecided, seconds, lost = map(sum, zip(*bands, strict=True))
        return undecided, seconds, lost

    def _gather_band(
        self, start: int, stop: int, reached: Array, busy: Array, mirrored: Array, records: Array, visibility: Array,
        final: bool, radiance: Array,
    ) -> tuple[int, int, int]:  # fmt: skip
        """Run ``gather`` for a band of at most TILE rows, by waves that are led from here."""
        begun(self.scratch)
        undecided = seconds = 0
        fill_background(self.scene, start, stop, reached, busy, mirrored, records, radiance)
        tiles = np.flatnonzero(reached[start // TILE])
        for wave, first in enumerate(range(0, len(tiles), self.tiles)):
            some, at = tiles[first : first + self.tiles], self.at[wave]
            doubted, more = self._gather(start, stop, some, at, busy, mirrored, records, visibility, final, radiance)
            undecided, seconds = undecided + doubted, seconds + more
        self._end_ways()
        return undecided, seconds, given_up(self.scratch, int(self.scene.ints[layout.SHAPE_COUNT]))

    def _gather(
        self, start: int, stop: int, tiles: Array, at: Array, busy: Array, mirrored: Array, records: Array,
        visibility: Array, final: bool, radiance: Array,
    ) -> tuple[int, int]:  # fmt: skip
        """Run ``gather`` for some tiles, but for the light of paths that begin there: see ``_end_ways``."""
        scene, asked = self.scene, self.asked
        count = list_pixels(scene, start, stop, tiles, asked, self.cones, at)
        if not self._follow(count, at, records):  # no pixel has a second record: none is looked for
            records, visibility = records[:1], visibility[:1]

        def look(first: int, last: int) -> int:
            if self.looks is not None and asked[0, layout.MODE] == layout.ASKING:
                return int(looks.list_looks(scene, asked, first, last, at, records, visibility, self.looks))
            telling = self.looks is not None and asked[0, layout.MODE] == layout.TELLING
            kernel = looks.tell_looks if telling else look_from
            return int(kernel(scene, self.scratch, asked, self.ways, first, last, at, records, visibility))

        self._ask(0, count, look, together=True)
        light = at, records, visibility, final, radiance
        counts: tuple[int, int] = end_pixels(scene, self.gathered[:count], *light, busy, mirrored)
        return counts

    def refine(self, start: int, stop: int, *more: Array) -> None:
        """Run refine_kernels.refine on the pixels start..stop of a layer."""
        begun(self.scratch)
        own = self.scene, self.scratch, self.asked, self.ways
        self._ask(start, stop, lambda i, end: refine(*own, i, end, self.waiting, *more))

    def soften(self, cuts: Array, records: Array, visibility: Array, radiance: Array) -> None:
        """Sample the edges ``cuts`` of hard shadows, from hard_kernels.list_cuts."""
        begun(self.scratch)
        own = self.scene, self.scratch, self.asked
        self._ask(0, len(cuts), lambda i, end: soften(*own, i, end, cuts, records, visibility, radiance))

    def smooth(
        self, start: int, stop: int, points: Array, undecided: int, busy: Array, planes: Array, records: Array,
        radiance: Array, visibility: Array, picture: Array,
    ) -> None:  # fmt: skip
        """Fill rows start..stop of ``picture`` (n, 3): ``radiance``, and at edges rays through ``points`` (s, 2)."""
        begun(self.scratch)
        scene = self.scene
        width, size = int(scene.reals[layout.WIDTH]), planes.shape[1] * LANES // self.marks.shape[1]
        light, own = (records, radiance), (self.marks, self.same, self.edges)
        doubted = undecided + int(scene.ints[layout.HAS_THIN])
        count = list_edges(start, stop, width, size, doubted, busy, planes, *light, picture, *own)
        some = len(self.gathered) // TRIAL
        for first in range(0, count, some):
            edges = self.edges[first : min(first + some, count)]
            self.sums[:] = [0.0, 0.0, 0.0, 1.0]
            for used in range(0, len(points), TRIAL):
                edges = self._sample(edges, points, used, records, radiance, visibility, picture)

    def _sample(
        self, edges: Array, points: Array, used: int, records: Array, radiance: Array, visibility: Array,
        picture: Array,
    ) -> Array:  # fmt: skip
        """Take up to TRIAL more samples of the pixels ``edges``; returns those that need more."""
        scene, some = self.scene, points[used : used + TRIAL]
        each, count = len(some), len(some) * len(edges)
        own, found = self.own, self.found
        list_samples(scene, some, edges, self.asked, self.cones)
        own[1:, :count] = 0.0
        self._follow(count, self.each, own)
        more = each, edges, records, visibility, own, found
        self._ask(0, count, lambda i, end: look_from_samples(scene, self.scratch, self.asked, self.ways, i, end, *more))
        light = records, radiance, self.gathered, own, found
        left = add_samples(scene, each, used + each, len(points), edges, *light, self.sums, picture)
        return edges[:left]

    def _follow(self, count: int, at: Array, records: Array) -> int:
        """Trace ``count`` listed rays of the camera, and their paths to the end; see waves_kernels.meet_first.

        Returns the number of paths.
        """
        self._meet()
        scene, asked, cones, gathered, met, spares = (
            self.scene,
            self.asked,
            self.cones,
            self.gathered,
            self.met,
            self.spares,
        )
        out = at, records, gathered
        own = self.paths, self.of, self.hits, met
        started, hits = meet_first(scene, self.scratch, asked, count, cones, *out, *own)
        if hits and self.packets is not None:
            self.packets.skin(scene, self.hits[:hits], met, self.skins)
            describe_hits(scene, asked, cones, *out, self.hits[:hits], met, self.skins)
        if not started:
            return 0
        paths, of = self.paths[:started], self.of[:started]
        own_at = at[of]
        while True:
            if self.packets is not None:
                self._dress(paths)
            if advance_paths(scene, self.scratch, asked, paths, own_at, records, spares):
                self._ask(0, started, lambda i, end: self._light(i, end, paths))
            if not ask_paths(paths, asked):
                break
            self._meet()
        end_paths(paths, of, gathered)
        return int(started)

    def _dress(self, paths: Array) -> None:
        """Compute normals of implicit solids at the hits of live paths, and beside these places."""
        assert self.packets is not None
        scene, hits, met, skins = self.scene, self.hits, self.met, self.skins
        count = meet_paths(scene, self.scratch, self.asked, paths, hits, met)
        if count:
            self.packets.skin(scene, hits[:count], met, skins)
            count = dress_paths(scene, paths, hits[:count], met, skins, self.spares)
        if count:
            self.packets.skin(scene, hits[:count], met, skins)
            bend_paths(paths, hits[:count], skins)

    def _meet(self) -> None:
        """Intersect all listed rays."""
        if self.packets is not None:
            self.packets.meet(self.asked)
        if self.lanes is not None:
            self.meet_plain(self.scene, self.asked, self.lanes)

    def _light(self, start: int, stop: int, paths: Array) -> int:
        """Light surfaces beyond the records of paths start..stop; returns the first path that is left."""
        end: int = light_paths(
            self.scene, self.scratch, self.asked, self.ways, start, stop, paths, self.spares, self.found[0]
        )
        return end

    def _ask(self, start: int, stop: int, work: Callable[[int, int], int], together: bool = False) -> None:
        """Run ``work`` twice on each part of start..stop whose rays fit the list: to list them, and with the answers.

        A third run follows after light paths from around have ended, if there are any; ``together``: not before
        ``_end_ways``, so that the paths of several calls make one wave. Without a list, ``work`` runs only once, on
        all.
        """
        if not self.listed:
            work(start, stop)
            return
        head = self.asked[0]
        while start < stop:
            if head[layout.WAYS] + len(self.asked) > len(self.ways):
                self._end_ways()
            before = int(head[layout.WAYS])
            end = self._twice(start, stop, work)
            if head[layout.WAYS] == before:
                pass
            elif together:
                self.awaited.append((work, start, end))
            else:
                self.light_ways(before)
                head[layout.MODE], head[layout.NEXT] = layout.ENDING, before
                work(start, end)
                head[layout.WAYS] = before
            start = end

    def _end_ways(self) -> None:
        """Follow the light paths that calls of ``_ask`` have begun together, and run what awaits them."""
        head = self.asked[0]
        if head[layout.WAYS] > 0:
            self.light_ways(0)
            head[layout.MODE], head[layout.NEXT] = layout.ENDING, 0
            for work, start, end in self.awaited:
                work(start, end)
            head[layout.WAYS] = 0
        self.awaited.clear()

    def _twice(self, start: int, stop: int, work: Callable[[int, int], int]) -> int:
        """List the rays of as much of start..stop as fits, and use the answers; returns the end of that part."""
        head = self.asked[0]
        head[layout.MODE], head[layout.NEXT] = layout.ASKING, 1
        end = work(start, stop)
        if head[layout.NEXT] > 1:
            self._meet()
        head[layout.MODE], head[layout.NEXT] = layout.TELLING, 1
        work(start, end)
        return end

    def light_ways(self, first: int) -> None:
        """Follow the light paths from the ``first`` on to their ends, in waves; the last few one by one."""
        if self.follow is not None:
            self.follow(first)
            return
        scene, asked, ways, live, hits = self.scene, self.asked, self.ways, self.live, self.ways_hit
        last = int(asked[0, layout.WAYS])
        count = last - first
        live[:count] = np.arange(first, last)
        few = few_of(self.lanes, asked)
        while True:
            count, some = look_about(scene, self.scratch, ways, live, count, hits, self.ways_met)
            if count < few:
                asked[0, layout.MODE] = layout.PLAIN
                follow_all(scene, self.scratch, asked, ways, live[:count])
                return
            if some and self.packets is not None:
                self.packets.skin(scene, hits[:some], self.ways_met, self.ways_skins)
                dress_hits(ways, hits[:some], self.ways_skins)
            start = 0
            while start < count:
                start = self._twice(
                    start, count, lambda i, end: step_all(scene, self.scratch, asked, ways, live, i, end)
                )
