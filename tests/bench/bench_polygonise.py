"""Polygonising the common scenes, beside a numpy grid with scikit-image; errors of volumes and topology.

Run it as ``python tests/bench/bench_polygonise.py [CELLS] [ROUNDS]``; scikit-image is needed for the comparison. Ours
evaluates, extracts, brings the vertices onto the surface and computes normals; what cells may hide is timed apart.
"""

from __future__ import annotations

import json
import os
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from sceneql.field.builder import TapeBuilder
from sceneql.mesh.measures import edge_counts, euler_characteristic, volume
from sceneql.mesh.polygonise import polygonise
from sceneql.mesh.unresolved import unresolved
from sceneql.quantities.bind import bind
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.expression import Symbol
from sceneql.quantities.parser import parse_expression
from sceneql.quantities.span import Source, Span

SCENES = json.loads((Path(__file__).parent / "scenes" / "implicit.json").read_text(encoding="utf-8"))["scenes"]
PHI = (1 + 5**0.5) / 2
BARS = {"steiner": 5, "barth_sextic": 5, "blob40": 40}
SHAPES = {
    "ball": ("sqrt(x^2 + y^2 + z^2) - 1", 1.1, 4 * np.pi / 3),
    "torus": ("(sqrt(x^2 + y^2) - 1)^2 + z^2 - 0.16", 1.5, 2 * np.pi**2 * 0.16),
    "capsule": ("sqrt((x - min(max(x, -0.5), 0.5))^2 + y^2 + z^2) - 0.4", 1.0, np.pi * 0.16 * (1 + 1.6 / 3)),
    "steiner": ("max(x^2*y^2 + y^2*z^2 + z^2*x^2 - x*y*z, sqrt(x^2 + y^2 + z^2) - 0.6)", 0.6, 1 / 6),
}


def register(build: TapeBuilder, text: str, where: dict[str, str]) -> int:
    """Register of a formula; ``where`` gives its constants as formulas of those before."""
    known = {"x": build.x, "y": build.y, "z": build.z}
    for name, formula in (where | {"": text}).items():
        found = Diagnostics()
        tree = parse_expression(formula, Span(Source("scene", formula), 0, len(formula)))
        expr = bind(tree, lambda parts, span: Symbol(".".join(parts)) if parts[0] in known else None, found)
        found.raise_errors()
        assert expr is not None
        known[name] = build.expression(expr, known)
    return known[""]


def scene_tape(name: str) -> Any:
    """The tape of a common scene, cut by its ball."""
    scene, build = SCENES[name], TapeBuilder()
    if "parts" in scene:
        parts = [[*row[:3], *row[:3], row[3], 1.0] for row in scene["parts"]]
        density = build.density(np.array(parts), build.x, build.y, build.z)
        value = build.op("sub", build.constant(scene["threshold"]), density)
    else:
        value = register(build, scene["f"], scene.get("where", {}))
    ball = register(build, f"sqrt(x^2 + y^2 + z^2) - {scene['clip']}", {})
    return build.finish(build.op("max", value, ball))


def grid_values(name: str, n: int) -> Any:
    """f of a common scene on a grid of n^3 nodes, as one writes it in numpy."""
    scene = SCENES[name]
    t = np.linspace(-scene["clip"], scene["clip"], n)
    x, y, z = np.meshgrid(t, t, t, indexing="ij", sparse=True)
    if name == "steiner":
        f = x**2 * y**2 + y**2 * z**2 + z**2 * x**2 - x * y * z
    elif name == "barth_sextic":
        planes = (PHI**2 * x**2 - y**2) * (PHI**2 * y**2 - z**2) * (PHI**2 * z**2 - x**2)
        f = (1 + 2 * PHI) * (x**2 + y**2 + z**2 - 1) ** 2 - 4 * planes
    else:
        f = np.full((n, n, n), scene["threshold"])
        for a, b, c, radius in scene["parts"]:
            f -= np.maximum(1 - ((x - a) ** 2 + (y - b) ** 2 + (z - c) ** 2) / radius**2, 0) ** 3
    return np.maximum(f, np.sqrt(x**2 + y**2 + z**2) - scene["clip"])


def median(work: Callable[[], object], rounds: int) -> tuple[float, float]:
    """Medians of the wall and processor seconds of a call."""
    walls, cpus = [], []
    for _ in range(rounds):
        wall, cpu = time.perf_counter(), time.process_time()
        work()
        walls.append(time.perf_counter() - wall)
        cpus.append(time.process_time() - cpu)
    return statistics.median(walls), statistics.median(cpus)


def compare(cells: int, rounds: int) -> None:
    """Time against scikit-image, in turn so that both meet the same machine."""
    from skimage.measure import marching_cubes

    for name, bar in BARS.items():
        tape, half = scene_tape(name), SCENES[name]["clip"]
        box = ((-half,) * 3, (half,) * 3, 2 * half / cells)
        polygonise(tape, *box)
        seconds = {}
        for threads in (1, 2):
            os.environ["SCENEQL_THREADS"] = str(threads)
            seconds[threads] = median(lambda box=box, tape=tape: polygonise(tape, *box), rounds)
        few = 1 if name == "blob40" else max(1, rounds // 2)
        peer = median(lambda name=name: marching_cubes(grid_values(name, cells), 0.0), few)
        hidden = median(lambda box=box, tape=tape: unresolved(tape, *box), 1)
        print(
            f"{name:13} ours {seconds[1][0] * 1e3:.0f} / {seconds[2][0] * 1e3:.0f} ms (1 / 2 threads), CPU"
            f" {seconds[1][1] * 1e3:.0f} ms; numpy + scikit-image {peer[0] * 1e3:.0f} ms, CPU {peer[1] * 1e3:.0f} ms;"
            f" ratio {peer[0] / seconds[2][0]:.1f} (bar {bar}), of CPU {peer[1] / seconds[1][1]:.1f};"
            f" what cells may hide {hidden[0] * 1e3:.0f} ms",
            flush=True,
        )


def converge() -> None:
    """Volumes at 64, 128 and 256 cells, their order, and what extrapolation from the last two gives."""
    for name, (text, half, exact) in SHAPES.items():
        build = TapeBuilder()
        tape = build.finish(register(build, text, {}))
        errors = []
        for cells in (64, 128, 256):
            found = polygonise(tape, (-half,) * 3, (half,) * 3, 2 * half / cells)
            errors.append(1 - volume(found.vertices, found.triangles) / exact)
        order = np.log2(errors[1] / errors[2])
        print(
            f"{name:13} volume error {errors[2]:.2e} at 256, order {order:.3f}, extrapolated"
            f" {abs(4 * errors[2] - errors[1]) / 3:.1e}; Euler {euler_characteristic(found.triangles)}, open edges"
            f" {edge_counts(found.triangles)[1]}",
            flush=True,
        )


if __name__ == "__main__":
    compare(int(sys.argv[1]) if len(sys.argv) > 1 else 256, int(sys.argv[2]) if len(sys.argv) > 2 else 7)
    converge()
