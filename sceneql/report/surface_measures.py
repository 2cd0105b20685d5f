"""Measures of implicit surfaces: errors and run times of rays and of meshes."""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any, cast

from sceneql import pipeline
from sceneql.failure import RunFailure
from sceneql.kinds import Picture

if TYPE_CHECKING:
    from renderers.tracing.probe import Probe
    from sceneql.frame import Implicit, SeenFrame
    from sceneql.graph import SimulationGraph

TOLERANCES = (1e-3, 1e-5, 1e-7, 1e-9, 1e-11)
REFERENCE = 1e-14
"""Tolerance of the reference by certified intervals, finer than all that it judges."""
SAMPLES = tuple(2**k for k in range(4, 13))
CELLS = (16, 32, 64, 128, 256)
"""Numbers of cells along the longest side of an object's box."""
SIZES = 4_000, 16_000, 64_000
"""Largest numbers of pixels of the pictures: larger pictures are reduced."""
REPEATS = 3
ENOUGH_SECONDS = 3.0
"""Time of a run [s] after which it is not repeated, and no finer one is made."""


@dataclass(frozen=True, slots=True)
class RayRun:
    """A run on a picture's implicit surfaces, by one ray through the center of each pixel."""

    renderer: str
    width: int
    height: int
    """Height of the picture [pixels]."""
    setting: float
    """Tolerance of `trace`, or number of samples on a ray of `march`."""
    seconds: float
    """Median run time [s] without compilation, with `trace`'s preparation of a frame."""
    pixels: int
    """Number of pixels where the reference meets a surface."""
    wrong: int
    """Number of pixels that meet a surface where the reference does not, or vice versa, or are undecided."""
    undecided: int
    depth_error: float
    """[m] Mean over the pixels that meet a surface in both."""
    largest_depth_error: float
    """[m]"""
    normal_error: float
    """[rad] Mean angle between the normals there."""


@dataclass(frozen=True, slots=True)
class MeshRun:
    """A mesh of an implicit object."""

    name: str
    cell: float
    """[m]"""
    seconds: float
    """Median run time [s] without compilation."""
    triangles: int
    volume: float
    """[m^3]"""
    area: float
    """[m^2]"""
    euler: int
    boundary_edges: int
    hausdorff: float
    """[m] Hausdorff distance from the finest mesh; NaN for that itself."""
    volume_error: float
    """Error relative to the value extrapolated from the two finest meshes."""
    area_error: float


def pictured(graph: SimulationGraph) -> list[SeenFrame]:
    """The first picture of a scene with only its implicit objects, in increasing sizes; empty where it has none.

    Raises RunFailure where all of them are empty.
    """
    from sceneql.frame import Implicit

    for name in graph.cameras:
        moment = next(pipeline.simulate(graph, [0.0]))
        shapes = [shape for shape in moment.lower(graph.drawn[name]) if isinstance(shape, Implicit)]
        if not shapes:
            continue  # before a camera is asked, which may need a dry run
        _there(graph, shapes)
        output = cast(Picture, graph.tasks[name].kind)
        width, height = output.pixels
        shares = (min(1.0, math.sqrt(pixels / (width * height))) for pixels in SIZES)
        sizes = dict.fromkeys((max(1, round(share * width)), max(1, round(share * height))) for share in shares)
        frames: list[SeenFrame] = [pipeline.frame_of(graph, name, size, moment, 0) for size in sizes]
        return [
            replace(frame, shapes=tuple(shape for shape in frame.shapes if isinstance(shape, Implicit)))
            for frame in frames
        ]
    return []


def _there(graph: SimulationGraph, shapes: list[Implicit]) -> None:
    """Raise RunFailure where all of the implicit objects are empty."""
    from sceneql.run.never_drawn import look

    present: dict[str, str] = {}
    look(shapes, [], graph.tasks, present)
    if all(present.values()):
        name, why = next(iter(present.items()))
        raise RunFailure(f"nothing of it is there to measure: {why}", part=name, time=0.0, span=graph.tasks[name].span)


def timed(work: Callable[[], Any]) -> tuple[Any, float]:
    """The result of ``work``, and its median time [s]; the caller has run it once before."""
    times: list[float] = []
    while len(times) < REPEATS and sum(times) < ENOUGH_SECONDS:
        started = time.perf_counter()
        found = work()
        times.append(time.perf_counter() - started)
    return found, statistics.median(times)


def ray_runs(frame: SeenFrame) -> Iterator[RayRun]:
    """Runs of `trace` over tolerances and of `march` over samples, against certified intervals alone.

    Objects that `trace` intersects in packets at its usual tolerance are intersected in packets here.
    """
    from renderers.tracing.probe import probe

    truth = probe(frame, REFERENCE, certain=True)
    probe(frame)
    for tolerance in TOLERANCES:
        found, seconds = timed(partial(probe, frame, tolerance))
        yield compared("trace", tolerance, seconds, found, truth)
    probe(frame, march=1)
    for samples in SAMPLES:
        found, seconds = timed(partial(probe, frame, march=samples))
        yield compared("march", samples, seconds, found, truth)
        if seconds > ENOUGH_SECONDS:
            return


def compared(renderer: str, setting: float, seconds: float, found: Probe, truth: Probe) -> RayRun:
    """The errors of a run; pixels that the reference leaves undecided do not count."""
    import numpy as np

    known = ~truth.undecided
    seen, there = np.isfinite(found.depth), np.isfinite(truth.depth)
    both = seen & there & known & ~found.undecided
    off = np.abs(found.depth[both] - truth.depth[both])
    across = np.linalg.norm(np.cross(found.normals[both], truth.normals[both]), axis=-1)
    turned = np.arctan2(across, np.einsum("ij,ij->i", found.normals[both], truth.normals[both]))
    some = both.any()
    return RayRun(
        renderer=renderer,
        width=truth.depth.shape[1],
        height=truth.depth.shape[0],
        setting=setting,
        seconds=seconds,
        pixels=int((there & known).sum()),
        wrong=int((((seen != there) | found.undecided) & known).sum()),
        undecided=int(found.undecided.sum()),
        depth_error=float(off.mean()) if some else math.nan,
        largest_depth_error=float(off.max()) if some else math.nan,
        normal_error=float(turned.mean()) if some else math.nan,
    )


def mesh_runs(shape: Implicit) -> list[MeshRun]:
    """Meshes of a solid with decreasing cells, as by the command ``mesh``."""
    from sceneql.mesh.cubes.refine import refined
    from sceneql.mesh.distance import hausdorff
    from sceneql.mesh.measures import area, edge_counts, euler_characteristic, volume

    side = max(high - low for low, high in zip(shape.low, shape.high, strict=True))
    refined(shape.tape, shape.low, shape.high, side / CELLS[0])
    made = []
    for cells in CELLS:
        cell = side / cells
        (polygons, left), seconds = timed(partial(refined, shape.tape, shape.low, shape.high, cell))
        made.append((left.cell or cell, seconds, polygons.vertices, polygons.triangles))
        if seconds > ENOUGH_SECONDS:
            break
    volumes = [volume(vertices, triangles) for _, _, vertices, triangles in made]
    areas = [area(vertices, triangles) for _, _, vertices, triangles in made]
    finest = made[-1][2:]
    return [
        MeshRun(
            name=shape.name,
            cell=cell,
            seconds=seconds,
            triangles=len(triangles),
            volume=volumes[k],
            area=areas[k],
            euler=euler_characteristic(triangles),
            boundary_edges=edge_counts(triangles)[1],
            hausdorff=math.nan if k == len(made) - 1 else hausdorff((vertices, triangles), finest),
            volume_error=relative(volumes[k], extrapolated(volumes)),
            area_error=relative(areas[k], extrapolated(areas)),
        )
        for k, (cell, seconds, vertices, triangles) in enumerate(made)
    ]


def extrapolated(values: list[float]) -> float:
    """The limit of values whose errors fall by four from one to the next (Richardson 1911)."""
    return values[-1] if len(values) < 2 else (4.0 * values[-1] - values[-2]) / 3.0


def relative(value: float, truth: float) -> float:
    """Relative error; NaN where the truth is zero."""
    return abs(value - truth) / abs(truth) if truth else math.nan
