"""Films of the common implicit scenes as a user makes them: script, lowering, `trace`, PNG files; by the frame."""

from __future__ import annotations

import statistics
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from renderers.encoders import png
from sceneql import pipeline

FRAMES = 48
SCENE = """
clock: {{end: {end} s, fps: 24}}
define: {{{names}}}
models: {{wheel: {{motion: {{rotation: {{about: y, angle: 60 deg*time/(1 s)}}}}}}}}
objects:
{objects}
lights: {{key: {{sun: {{elevation: 42 deg, azimuth: -40 deg, angle: 0 deg, strength: 1}}}}}}
cameras: {{eye: {{orthographic: {{look_along: -0.5 -0.4 -0.75, look_at: 0 0 0 m, height: {height} m}}}}}}
outputs: {{film: {{images: {{size: 640 360, renderer: tracer}}}}}}
renderers: {{tracer: {{trace: {{samples: {samples}, diffuse_bounces: {bounces}}}}}}}
"""
CLAY = "material: matte"
STAGES = {
    "lowering": ("sceneql.tools:frame_of", "sceneql.run.never_drawn:look"),
    "packing": ("renderers.tracing.draw:pack", "renderers.tracing.solids.bundles:Packets.__init__"),
    "roots": ("renderers.tracing.solids.bundles:meet_asked", "renderers.tracing.solids.plain_lanes_kernels:meet_plain"),
    "hits": tuple(
        f"renderers.tracing.{where}"
        for where in (
            "waves:list_pixels", "waves:meet_first", "solids.bundles:skin_hits", "waves:describe_hits",
            "waves:ask_paths", "waves:advance_paths", "waves:end_pixels", "waves:fill_background",
        )
    ),
    "light": (
        *(
            f"renderers.tracing.waves:{name}"
            for name in ("look_from", "step_all", "look_about", "dress_hits", "follow_all", "light_paths")
        ),
        "renderers.tracing.light.look_lanes_kernels:list_looks",
        "renderers.tracing.light.look_lanes_kernels:tell_looks",
    ),
    "filter": (
        *(f"renderers.tracing.draw:{name}" for name in ("lay_out", "widen", "deepen", "spread_sky", "choose")),
        *(f"renderers.tracing.waves:{name}" for name in ("refine", "soften")),
        "renderers.tracing.draw:list_cuts",
    ),
    "shading": ("renderers.tracing.draw:shade_rows",),
    "edges": tuple(
        f"renderers.tracing.waves:{name}" for name in ("list_edges", "list_samples", "look_from_samples", "add_samples")
    ),
    "develop": ("renderers.develop:develop",),
    "PNG": ("renderers.encoders.png:Writer.write",),
}  # fmt: skip
"""The functions of each stage; what is in none of them is Python, and what else a frame takes."""


def script(objects: str, height: float, names: str = "", samples: int = 1, bounces: int = 256) -> str:
    """A film of objects, in YAML, seen from a window so many meters high."""
    end = (FRAMES - 1) / 24
    return SCENE.format(
        end=f"{end:.6f}", objects=objects, height=f"{height:g}", names=names, samples=samples, bounces=bounces
    )


def scripts(scenes: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """(name, script) of nothing but a ball of 8 pixels, of a ball on a plane, and of the scenes that are solids."""
    yield "empty", script("  ball: {sphere: {radius: 0.04 m}}", 3.6)
    yield (
        "ball on plane",
        script(f"  ball: {{sphere: {{{CLAY}}}}}\n  floor: {{plane: {{position: 0 -1 0 m, {CLAY}}}}}", 4),
    )
    for name, scene in scenes.items():
        height = 2.1 * scene["clip"]
        if "parts" in scene:
            rows = np.asarray(scene["parts"])
            centers = ", ".join(f"[{x:.9g} m, {y:.9g} m, {z:.9g} m]" for x, y, z in rows[:, :3])
            radii = ", ".join(f"{r:.9g} m" for r in rows[:, 3])
            shape = f"points: [{centers}], radius: [{radii}], threshold: {scene['threshold']}, {CLAY}"
            turned = "thing: {group: {children: [blobs], rotation: wheel.rotation}}"
            yield name, script(f"  blobs: {{blobby: {{{shape}}}}}\n  {turned}", height)
        elif scene.get("mode") != "surface":
            where = ", ".join(f"{key}: {value}" for key, value in scene.get("where", {}).items())
            shape = f'field: "{scene["f"]}", bounds: {{ball: {scene["clip"]}}}, rotation: wheel.rotation, {CLAY}'
            yield name, script(f"  thing: {{implicit: {{{shape}}}}}", height, where)


@contextmanager
def timed(spent: dict[str, float]) -> Iterator[None]:
    """Add the processor time of each stage to ``spent``, without that of stages within it."""
    kept: list[tuple[Any, str, Any]] = []
    inner = [0.0]

    def wrapped(stage: str, function: Callable[..., Any]) -> Callable[..., Any]:
        def call(*args: Any, **options: Any) -> Any:
            begin = time.thread_time()
            inner.append(0.0)
            try:
                return function(*args, **options)
            finally:
                took = time.thread_time() - begin
                spent[stage] = spent.get(stage, 0.0) + took - inner.pop()
                inner[-1] += took

        return call

    for stage, names in STAGES.items():
        for name in names:
            module, _, path = name.partition(":")
            *owners, last = path.split(".")
            owner = import_module(module)
            for part in owners:
                owner = getattr(owner, part)
            kept.append((owner, last, getattr(owner, last)))
            setattr(owner, last, wrapped(stage, getattr(owner, last)))
    try:
        yield
    finally:
        for owner, last, function in reversed(kept):
            setattr(owner, last, function)


def film(text: str, stages: bool = False) -> dict[str, float]:
    """ms of processor time of a frame, ``all`` of it and by stages: medians over the film but its first two frames."""
    marks: list[tuple[float, dict[str, float]]] = []
    spent: dict[str, float] = {}
    write = png.Writer.write

    def marked(writer: Any, picture: Any) -> None:
        write(writer, picture)
        marks.append((time.process_time(), dict(spent)))

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "film.yaml")
        path.write_text(text, encoding="utf-8")
        graph = pipeline.load(path)
        png.Writer.write = marked
        try:
            if stages:
                with timed(spent):
                    pipeline.render(graph, folder=Path(folder))
            else:
                pipeline.render(graph, folder=Path(folder))
        finally:
            png.Writer.write = write
    frames = list(pairwise(marks[1:]))
    found = {"all": 1e3 * statistics.median(b[0] - a[0] for a, b in frames)}
    for stage in STAGES if stages else ():
        found[stage] = 1e3 * statistics.median(b[1].get(stage, 0.0) - a[1].get(stage, 0.0) for a, b in frames)
    if stages:
        found["Python and the rest"] = found["all"] - float(np.sum([found[stage] for stage in STAGES]))
    return found
