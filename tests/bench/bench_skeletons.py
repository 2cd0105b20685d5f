"""Skeletons met in packets, beside the certified routine ray by ray.

Run it as ``python tests/bench/bench_skeletons.py``. Camera rays in tiles of 16 x 16, rays to a sun from where they hit,
and to the sky: one direction for each tile. Processor time of a ray, less for single rays what a call from Python takes
(that of rays without a length). A ray is wrong where the certified routine says otherwise; of single rays every eighth
is timed and compared.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from plain_tapes import implicit
from sceneql.field.packets import ray_rows
from sceneql.field.packets.packets import Memory
from sceneql.field.skeleton.skeleton import KERNELS, Skeleton
from sceneql.field.tape.own_coordinates import in_own_coordinates
from sceneql.field.tape.tape_ops import HIT, INSIDE, UNDECIDED
from sceneql.field.tape.tape_solid import cast, field_gradients
from sceneql.frame import Floats, Tape
from sceneql.shapes.spline import smooth
from test_curved_skeletons import curves

WIDTH, HEIGHT, TILE, EVERY = 640, 352, 16, 8
SUN = np.array([0.5, 0.7, 0.5])
LIFT = 2.5e-4
"""How far off the surface shadow rays begin, as `trace` has it: a twentieth of a pixel's radius, nearly."""


def newt() -> Skeleton:
    """A body whose radius changes, of some sixty curves."""
    t = np.linspace(-1.0, 1.0, 12)
    points = np.column_stack([1.6 * t, 0.3 * np.sin(3.0 * t), 0.3 * np.cos(2.0 * t) - 0.2])
    return curves(*smooth(points, 0.25 + 0.1 * np.cos(4.0 * t), False))


def cage(kernel: str) -> Skeleton:
    """Cones between points at random, each to the next."""
    chance = np.random.default_rng(1)
    points, radii = chance.uniform([-1.4, -0.7, -0.5], [1.4, 0.7, 0.5], (41, 3)), chance.uniform(0.12, 0.3, 41)
    ends = np.stack([points[:-1], points[1:], points[:-1]], axis=1)
    both = np.stack([radii[:-1], radii[1:]], axis=1)
    return Skeleton(ends, both, np.ones(40), np.arange(40.0), KERNELS.index(kernel))


def leaves() -> Skeleton:
    """Triangles."""
    chance = np.random.default_rng(2)
    middles = chance.uniform([-1.4, -0.7, -0.5], [1.4, 0.7, 0.5], (40, 1, 3))
    corners = middles + 0.25 * chance.normal(size=(40, 3, 3))
    return Skeleton(corners, np.full((40, 2), 0.15), np.ones(40), np.arange(40.0))


def solid(skeleton: Skeleton, moved: bool) -> Tape:
    """Where its density is more than 0.3; perhaps turned and off the origin."""
    turn = np.array([[0.8, 0.0, 0.6, 0.2], [0.0, 1.0, 0.0, -0.1], [-0.6, 0.0, 0.8, 0.1]])

    def formula(b, op, c):  # type: ignore[no-untyped-def]
        place = b.affine(turn, b.x, b.y, b.z) if moved else (b.x, b.y, b.z)
        return op("sub", c(0.3), b.skeleton(skeleton, *place))

    return implicit(formula)


Rays = tuple[Floats, Floats, Floats]


def met(tape: Tape, bundles: list[Rays], anywhere: bool) -> tuple[list[tuple[Floats, Floats]], float, int]:
    """(status and place of each bundle, seconds, rays that were certified alone)."""
    own, matrix = in_own_coordinates(tape)
    memory = Memory(own, TILE * TILE)
    found, seconds, certified = [], 0.0, 0
    for origins, directions, far in bundles:
        n = len(far)
        memory.rays[:] = 0.0
        memory.rays[:3, :n] = matrix[:, :3] @ origins.T + matrix[:, 3:]
        memory.rays[3:6, :n], memory.rays[7, :n] = matrix[:, :3] @ directions.T, far
        begun = time.process_time()
        certified += memory.settle(TILE * TILE, anywhere)[1]
        seconds += time.process_time() - begun
        found.append((memory.found[ray_rows.FOUND_STATUS, :n].copy(), memory.found[ray_rows.FOUND_ROOT, :n].copy()))
    return found, seconds, certified


def alone(tape: Tape, bundles: list[Rays]) -> tuple[list[Floats], float]:
    """(outcomes of every eighth ray of each bundle, seconds a ray)."""
    outcomes, seconds, rays = [], 0.0, 0
    for origins, directions, far in bundles:
        few = origins[::EVERY], directions[::EVERY]
        for ends, sign in ((far[::EVERY], 1.0), (np.zeros(len(far[::EVERY])), -1.0)):
            begun = time.process_time()
            status, _ = cast(tape, *few, np.zeros(len(ends)), ends)
            seconds += sign * (time.process_time() - begun)
            if sign > 0.0:
                outcomes.append(status)
        rays += len(few[0])
    return outcomes, seconds / rays


def camera() -> list[Rays]:
    """Rays of a picture, tile by tile."""
    y, x = np.mgrid[:TILE, :TILE]
    bundles = []
    for top in range(0, HEIGHT, TILE):
        for left in range(0, WIDTH, TILE):
            across, up = (left + x.ravel() + 0.5 - WIDTH / 2) / WIDTH, (HEIGHT / 2 - top - y.ravel() - 0.5) / WIDTH
            ways = np.column_stack([0.55 * across, 0.55 * up, np.full(across.size, -1.0)])
            ways /= np.linalg.norm(ways, axis=1)[:, None]
            bundles.append((np.tile([0.0, 0.0, 6.5], (len(ways), 1)), ways, np.full(len(ways), 12.0)))
    return bundles


def from_hits(
    tape: Tape, bundles: list[Rays], found: list[tuple[Floats, Floats]], way: Callable[[], Floats]
) -> list[Rays]:
    """Rays from where those hit, where they leave the surface: ``way()`` gives the direction of a tile."""
    out = []
    for (origins, directions, _), (status, place) in zip(bundles, found, strict=True):
        hit = status == HIT
        if hit.sum() < 8:
            continue
        places = origins[hit] + place[hit, None] * directions[hit]
        normals = field_gradients(tape, places)
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        ways = np.tile(way(), (len(places), 1))
        free = (ways * normals).sum(axis=1) > 0.0
        if free.any():
            out.append(((places + LIFT * normals)[free], ways[free], np.full(free.sum(), 4.0)))
    return out


def main() -> None:
    """A line for each skeleton, at rest and moved, and each kind of ray."""
    chance = np.random.default_rng(3)

    def to_sky() -> Floats:
        way = chance.normal(size=3)
        unit: Floats = way / np.linalg.norm(way)
        return unit

    skeletons = {"newt": newt(), "cones": cage("wyvill"), "gaussian cones": cage("gaussian"), "triangles": leaves()}
    for name, moved in ((name, moved) for name in skeletons for moved in (False, True)):
        tape, first = solid(skeletons[name], moved), camera()
        met(tape, first[:50], False)  # compiles
        met(tape, first[:50], True)
        found, _, _ = met(tape, first, False)
        kinds = {
            "camera": (first, False),
            "sun": (from_hits(tape, first, found, lambda: SUN / np.linalg.norm(SUN)), True),
            "sky": (from_hits(tape, first, found, to_sky), True),
        }
        for kind, (bundles, anywhere) in kinds.items():
            together, seconds, certified = met(tape, bundles, anywhere)
            outcomes, single = alone(tape, bundles)
            count = sum(len(far) for _, _, far in bundles)
            wrong = undecided = 0
            for (status, _), exact in zip(together, outcomes, strict=True):
                told = (status[::EVERY] != UNDECIDED) & (exact != UNDECIDED)
                wrong += int(((status[::EVERY] == HIT) != np.isin(exact, [HIT, INSIDE]))[told].sum())
                undecided += int((status == UNDECIDED).sum())
            each, label = seconds / count, name + (", moved" if moved else "")
            print(
                f"{label:22s} {kind:6s} {count:6d} rays: {1e6 * each:5.2f} us in packets, {1e6 * single:5.2f} alone: "
                f"{single / each:4.1f} times; {certified} certified, {undecided} undecided, {wrong} wrong"
            )


if __name__ == "__main__":
    main()
