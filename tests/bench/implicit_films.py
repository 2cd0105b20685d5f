"""Films of the common implicit scenes as a user makes them: script, lowering, `trace`, PNG files; by the frame."""

from __future__ import annotations

import re
import statistics
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from importlib import import_module
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from renderers.encoders import png
from renderers.trace import Trace
from sceneql import pipeline

FRAMES = 48
SCENE = """
clock: {{end: {end} s, fps: 24}}
define: {{{names}}}
models: {{wheel: {{motion: {{rotation: {{about: y, angle: 60 deg*time/(1 s)}}}}}}{models}}}
forces: {{{forces}}}
objects:
{objects}
lights: {{key: {{sun: {{elevation: 42 deg, azimuth: -40 deg, angle: 0 deg, strength: 1}}}}}}
cameras: {{eye: {{orthographic: {{look_along: -0.5 -0.4 -0.75, look_at: 0 0 0 m, height: {height} m}}}}}}
outputs: {{film: {{images: {{size: 640 360, renderer: tracer}}}}}}
renderers: {{tracer: {{trace: {{samples: {samples}, diffuse_bounces: {bounces}}}}}}}
"""
CLAY = "material: matte"
MOST = 256
"""Of `diffuse_bounces`: the default."""
MANY = 1000
"""Points from which on they are drawn moving by a simulation, too."""
STAGES = {
    "lowering": ("sceneql.tools:frame_of", "sceneql.run.never_drawn:look"),
    "packing": ("renderers.tracing.draw:pack", "renderers.tracing.solids.bundles:Packets.__init__"),
    "roots": ("renderers.tracing.solids.bundles:meet_asked", "renderers.tracing.solids.plain_lanes_kernels:meet_plain"),
    "bands": ("renderers.tracing.solids.whole_bands_kernels:gather_bands",),
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
        "renderers.tracing.waves:Waves.light_ways",
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
"""The functions of each stage."""
DRAW = "Trace.draw"
CALLS = 10000
"""Of a function that does nothing, to time the timers."""


def script(objects: str, height: float, names: str = "", models: str = "", forces: str = "") -> str:
    """A film of objects, in YAML, seen from a window so many meters high: a ray a pixel."""
    end = (FRAMES - 1) / 24
    more = {"names": names, "models": models, "forces": forces, "samples": 1, "bounces": MOST}
    return SCENE.format(end=f"{end:.6f}", objects=objects, height=f"{height:g}", **more)


def like_for_like(text: str) -> str:
    """The same film without light that surfaces reflect onto others, of which the peer has none."""
    return text.replace(f"diffuse_bounces: {MOST}", "diffuse_bounces: 0")


def softly(text: str) -> str:
    """The same film by an area light and a sky, its things glossy over a matte floor, with 8 rays at edges."""
    lines = text.replace("angle: 0 deg", "angle: 3 deg").replace("samples: 1", "samples: 8").splitlines()
    lines = [line if "floor:" in line else line.replace(CLAY, "material: glossy") for line in lines]
    if "floor:" not in text:
        height = float(re.findall(r"height: (\S+) m", text)[-1])
        lines.insert(lines.index("objects:") + 1, f"  floor: {{plane: {{position: 0 {-height / 2.1:g} 0 m, {CLAY}}}}}")
    return "\n".join(lines).replace("lights: {", "lights: {fill: {sky: {}}, ") + "\n"


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
            if len(rows) > MANY:
                moved = shape.replace(f"[{centers}]", "cloud.positions")
                cloud = f", cloud: {{particles: {{positions: [{centers}], velocity: 0 0.3 0 m/s}}}}"
                pull = "down: {gravity: {strength: 0.3 m/s^2}}"
                yield f"{name} moving", script(f"  blobs: {{blobby: {{{moved}}}}}", height, "", cloud, pull)
        elif scene.get("mode") != "surface":
            where = ", ".join(f"{key}: {value}" for key, value in scene.get("where", {}).items())
            shape = f'field: "{scene["f"]}", bounds: {{ball: {scene["clip"]}}}, rotation: wheel.rotation, {CLAY}'
            yield name, script(f"  thing: {{implicit: {{{shape}}}}}", height, where)


class Stages:
    """Processor time [ms] of each stage since the beginning, without that of stages within it, and of the timers."""

    def __init__(self) -> None:
        self.spent: dict[str, float] = dict.fromkeys(STAGES, 0.0)
        self.calls = 0
        self._inner = [0.0]
        nothing = self.wrapped("nothing", lambda: None)
        begin = time.thread_time()
        for _ in range(CALLS):
            nothing()
        took = 1e3 * (time.thread_time() - begin)
        self.own, self.around = self.spent.pop("nothing") / CALLS, took / CALLS
        self.calls = 0
        self._inner = [0.0]

    def wrapped(self, stage: str, function: Callable[..., Any]) -> Callable[..., Any]:
        """A function whose calls are counted to a stage."""

        def call(*args: Any, **options: Any) -> Any:
            begin = time.thread_time()
            self._inner.append(0.0)
            try:
                return function(*args, **options)
            finally:
                took = 1e3 * (time.thread_time() - begin)
                self.spent[stage] = self.spent.get(stage, 0.0) + took - self._inner.pop()
                self._inner[-1] += took
                self.calls += 1

        vars(call)["overloads"] = getattr(function, "overloads", None)  # for those who call it by its address, untimed
        return call

    def now(self) -> dict[str, float]:
        """What is spent so far; the timers' own part of it is ``timers``."""
        return self.spent | {"timers": self.around * self.calls}


@contextmanager
def timed(stages: Stages) -> Iterator[None]:
    """Count the functions of all stages inside the block."""
    kept: list[tuple[Any, str, Any]] = []
    for stage, names in STAGES.items():
        for name in names:
            module, _, path = name.partition(":")
            *owners, last = path.split(".")
            owner = import_module(module)
            for part in owners:
                owner = getattr(owner, part)
            kept.append((owner, last, getattr(owner, last)))
            setattr(owner, last, stages.wrapped(stage, getattr(owner, last)))
    try:
        yield
    finally:
        for owner, last, function in reversed(kept):
            setattr(owner, last, function)


def film(text: str, by_stages: bool = False) -> dict[str, float]:
    """ms of processor time of a frame, ``all`` of it, ``Trace.draw`` alone and by stages: medians over the film but its
    first two frames.

    What is in no stage is Python, without what the timers take.
    """
    marks: list[dict[str, float]] = []
    stages = Stages()
    write, draw, drawing = png.Writer.write, Trace.draw, 0.0

    def drawn(renderer: Any, frame: Any) -> Any:
        nonlocal drawing
        begin = time.process_time()
        found = draw(renderer, frame)
        drawing += 1e3 * (time.process_time() - begin)
        return found

    def marked(writer: Any, picture: Any) -> None:
        write(writer, picture)
        marks.append({"all": 1e3 * time.process_time(), DRAW: drawing} | stages.now())

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "film.yaml")
        path.write_text(text, encoding="utf-8")
        graph = pipeline.load(path)
        png.Writer.write, Trace.draw = marked, drawn
        try:
            with timed(stages) if by_stages else nullcontext():
                pipeline.render(graph, folder=Path(folder))
        finally:
            png.Writer.write, Trace.draw = write, draw
    found = {name: statistics.median(b[name] - a[name] for a, b in pairwise(marks[1:])) for name in marks[0]}
    if not by_stages:
        return {"all": found["all"], DRAW: found[DRAW]}
    del found[DRAW]
    timers = found.pop("timers")
    found["all"] -= timers
    found["Python"] = found["all"] - sum(found[stage] for stage in STAGES)
    return found
