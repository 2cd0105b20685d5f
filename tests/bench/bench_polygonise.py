"""Polygonising the common scenes, beside a numpy grid with scikit-image, PyMCubes and VTK; errors of the meshes.

Run it as ``python tests/bench/bench_polygonise.py [CELLS] [ROUNDS]``; peers that are not installed are left out. First
meshes by the command ``mesh`` at equal distance from the true surface (``mesh_errors``), then extraction alone: ours
evaluates, extracts, brings the vertices onto the surface and computes normals. The peers get a numpy grid evaluated
slab by slab, so that intermediate arrays stay in the cache; for the blobs also with each blob in its own box alone.
fidget's figures are quoted from another machine.
"""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import mesh_errors
import numpy as np

from sceneql.field.skeleton.skeleton import Skeleton
from sceneql.field.tape.builder import TapeBuilder
from sceneql.field.tape.tape_solid import field_gradients
from sceneql.mesh.cubes.polygonise import polygonise
from sceneql.mesh.cubes.refine import refined
from sceneql.mesh.dual.sharp import polygonise_sharp
from sceneql.mesh.measures import curved_volume, edge_counts, euler_characteristic, volume
from sceneql.quantities.bind import bind
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.expression import Symbol
from sceneql.quantities.parser import parse_expression
from sceneql.quantities.span import Source, Span

FOLDER = Path(__file__).parent / "scenes"
SCENES = json.loads((FOLDER / "implicit.json").read_text(encoding="utf-8"))["scenes"]
ELSEWHERE = json.loads((FOLDER / "elsewhere.json").read_text(encoding="utf-8"))
"""What other programs took for them on another machine."""
PHI = (1 + 5**0.5) / 2
SLAB = 8
"""Layers of nodes that numpy evaluates at a time."""
MODULES = {"scikit-image": "skimage", "PyMCubes": "mcubes", "VTK FlyingEdges": "vtkmodules"}
Mesh = tuple[Any, Any]
BARS = {"steiner": 5, "barth_sextic": 5, "blob40": 40}
GRIDS = (64, 96, 128, 192, 256)
VOLUMES = {
    "ball": ("sqrt(x^2 + y^2 + z^2) - 1", 1.1, 4 * np.pi / 3),
    "torus": ("(sqrt(x^2 + y^2) - 1)^2 + z^2 - 0.16", 1.5, 2 * np.pi**2 * 0.16),
    "capsule": ("sqrt((x - min(max(x, -0.5), 0.5))^2 + y^2 + z^2) - 0.4", 1.0, np.pi * 0.16 * (1 + 1.6 / 3)),
    "steiner": ("max(x^2*y^2 + y^2*z^2 + z^2*x^2 - x*y*z, sqrt(x^2 + y^2 + z^2) - 0.6)", 0.6, 1 / 6),
}
WAYS = {"plain": polygonise, "refined": lambda *box: refined(*box)[0], "sharp": polygonise_sharp}
MERGING = 2 * (1 - 0.15 ** (1 / 3)) ** 0.5
"""Distance at which two of Wyvill's kernels of radius 1 part at the threshold 0.3."""
CLOSED = {
    "ball": ("sqrt(x^2 + y^2 + z^2) - 1", 1.1, 2),
    "torus": ("(sqrt(x^2 + y^2) - 1)^2 + z^2 - 0.16", 1.5, 0),
    "capsule": ("sqrt((x - min(max(x, -0.5), 0.5))^2 + y^2 + z^2) - 0.4", 1.0, 2),
    "tanglecube": ("x^4 - 5*x^2 + y^4 - 5*y^2 + z^4 - 5*z^2 + 11.8", 3.0, -8),
    "shell": ("abs(sqrt(x^2 + y^2 + z^2) - 0.7) - 0.05", 0.8, 4),
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
        rows = np.array(scene["parts"])
        count = len(rows)
        points = Skeleton(
            rows[:, None, :3].repeat(3, axis=1), rows[:, 3:].repeat(2, axis=1), np.ones(count), np.arange(count)
        )
        density = build.skeleton(points, build.x, build.y, build.z)
        value = build.op("sub", build.constant(scene["threshold"]), density)
    else:
        value = register(build, scene["f"], scene.get("where", {}))
    ball = register(build, f"sqrt(x^2 + y^2 + z^2) - {scene['clip']}", {})
    return build.finish(build.op("max", value, ball))


def slab_values(name: str, x: Any, y: Any, z: Any, boxed: bool) -> Any:
    """f of a common scene on the nodes of the sparse grid x, y, z, as one writes it in numpy."""
    scene = SCENES[name]
    if name == "steiner":
        f = x**2 * y**2 + y**2 * z**2 + z**2 * x**2 - x * y * z
    elif name == "barth_sextic":
        planes = (PHI**2 * x**2 - y**2) * (PHI**2 * y**2 - z**2) * (PHI**2 * z**2 - x**2)
        f = (1 + 2 * PHI) * (x**2 + y**2 + z**2 - 1) ** 2 - 4 * planes
    else:
        f = np.full((x.size, y.size, z.size), scene["threshold"])
        for a, b, c, radius in scene["parts"]:
            part = tuple(
                slice(*np.searchsorted(t.ravel(), [m - radius, m + radius])) if boxed else slice(None)
                for t, m in ((x, a), (y, b), (z, c))
            )
            u, v, w = x[part[0]] - a, y[:, part[1]] - b, z[:, :, part[2]] - c
            f[part] -= np.maximum(1 - (u**2 + v**2 + w**2) / radius**2, 0) ** 3
    return np.maximum(f, np.sqrt(x**2 + y**2 + z**2) - scene["clip"])


def grid_values(name: str, half: float, n: int, boxed: bool) -> Any:
    """f of a common scene on a grid of n^3 nodes."""
    x, y, z = np.meshgrid(*[np.linspace(-half, half, n)] * 3, indexing="ij", sparse=True)
    values = np.empty((n, n, n))
    for k in range(0, n, SLAB):
        values[k : k + SLAB] = slab_values(name, x[k : k + SLAB], y, z, boxed)
    return values


def by_scikit_image(values: Any) -> Mesh:
    """Lewiner's marching cubes, vertices in cells."""
    from skimage.measure import marching_cubes

    vertices, triangles, _, _ = marching_cubes(values, 0.0)
    return vertices, triangles


def by_pymcubes(values: Any) -> Mesh:
    """Marching cubes of PyMCubes, vertices in cells."""
    from mcubes import marching_cubes

    vertices, triangles = marching_cubes(values, 0.0)
    return vertices, triangles


def by_flying_edges(values: Any) -> Mesh:
    """VTK's FlyingEdges3D, vertices in cells."""
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D

    image = vtkImageData()
    image.SetDimensions(*values.shape)
    image.GetPointData().SetScalars(numpy_to_vtk(values.ravel()))  # VTK's x runs fastest: axes in reverse
    edges = vtkFlyingEdges3D()
    edges.SetInputData(image)
    edges.SetValue(0, 0.0)
    edges.ComputeNormalsOff()
    edges.Update()
    found = edges.GetOutput()
    vertices = vtk_to_numpy(found.GetPoints().GetData())[:, ::-1]
    triangles = vtk_to_numpy(found.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return vertices, triangles


PEERS = {"scikit-image": by_scikit_image, "PyMCubes": by_pymcubes, "VTK FlyingEdges": by_flying_edges}


def medians(work: Callable[[], object], rounds: int) -> Any:
    """(2,) medians of the wall and the processor seconds of a call; the latter hardly feel what else runs."""
    spent = []
    for _ in range(rounds):
        wall, cpu = time.perf_counter(), time.process_time()
        work()
        spent.append((time.perf_counter() - wall, time.process_time() - cpu))
    return np.median(spent, axis=0)


def flaws(tape: Any, vertices: Any, triangles: Any) -> str:
    """Open edges, and the part of triangles that face inward: against the gradient in their middle."""
    few = triangles[:: max(1, len(triangles) // 50_000)]
    a, b, c = (vertices[few[:, k]].astype(float) for k in range(3))
    facing = (np.cross(b - a, c - a) * field_gradients(tape, (a + b + c) / 3)).sum(axis=1)
    inward = (facing < 0).mean()
    # A library may count its triangles clockwise throughout.
    inward, turned = (1 - inward, ", clockwise") if inward > 0.5 else (inward, "")
    return f"{edge_counts(triangles)[1]} open edges, {100 * inward:.2g} % inward{turned}"


def row(name: str, who: str, spent: Any, ours: dict[int, Any], mesh: Mesh, tape: Any) -> None:
    """Print a line of the table: wall against ours on two threads, processor seconds against ours on one."""
    vertices, triangles = mesh
    off = ""
    if name == "steiner":
        off = f", volume off by {abs(abs(volume(vertices.astype(float), triangles)) * 6 - 1):.1e}"
    print(
        f"{name:13} {who:30} {spent[0] * 1e3:7.1f} ms, ratio {spent[0] / ours[2][0]:6.1f};"
        f" CPU {spent[1] * 1e3:7.1f} ms, ratio {spent[1] / ours[1][1]:6.1f}; {flaws(tape, vertices, triangles)}{off}",
        flush=True,
    )


def compare(cells: int, rounds: int) -> None:
    """Time and flaws beside the peers, in turn so that all meet the same machine."""
    for name, bar in BARS.items():
        tape, half = scene_tape(name), 1.02 * SCENES[name]["clip"]
        box = ((-half,) * 3, (half,) * 3, 2 * half / cells)
        found = polygonise(tape, *box)
        seconds = {}
        for threads in (1, 2):
            os.environ["SCENEQL_THREADS"] = str(threads)
            seconds[threads] = medians(partial(polygonise, tape, *box), rounds)
        for threads, spent in seconds.items():
            row(name, f"ours, {threads} threads", spent, seconds, (found.vertices, found.triangles), tape)
        scale = 2 * half / (cells - 1)
        for boxed in (False, True) if "parts" in SCENES[name] else (False,):
            few = 3 if boxed or name != "blob40" else 1
            evaluated = medians(partial(grid_values, name, half, cells, boxed), few)
            values = grid_values(name, half, cells, boxed)
            for peer, made in PEERS.items():
                if find_spec(MODULES[peer]) is None:
                    continue
                spent = evaluated + medians(partial(made, values), 3)
                vertices, triangles = made(values)
                who = f"numpy{', boxed,' if boxed else ''} + {peer}"
                row(name, who, spent, seconds, (vertices * scale - half, triangles), tape)
        beside = quoted("meshes", name, 1e3 * seconds[1][0]) if cells == 256 else ""
        print(f"{name:13} bar beside numpy + scikit-image: {bar}{beside}", flush=True)


def quoted(what: str, name: str, ours: float) -> str:
    """What fidget took for a scene on another machine, beside the ms that we took here on one thread."""
    found = ELSEWHERE[what]["fidget 0.5 JIT"].get(name)
    if found is None:
        return ""
    took = " / ".join(f"{ms:.0f}" for ms in found)
    return f"; fidget elsewhere {took} ms, ratio {found[0] / ours:.1f}"


def tape_of(text: str) -> Any:
    """The tape of a formula."""
    build = TapeBuilder()
    return build.finish(register(build, text, {}))


def converge() -> None:
    """Volumes on grids of 64 to 256 cells: their orders, and what extrapolation from the last two gives.

    Flat, in the triangles, and curved, with what their normals tell of the surface over them. The lines in which
    Steiner's solid meets itself are wedges that close at six points, at which the curvature has no bound: there cells
    of a side h do not show what lies in h x h x sqrt(h), whatever the rule, so that the flat volume's error is
    a h^2 - b h^2.5 with some parts in a hundred that vary from grid to grid. Of the curved volume of refined cells,
    where the smooth faces are of order 4 and the creases and tips cut finer, only a h^2 is left.
    """
    for name, (text, half, exact) in VOLUMES.items():
        tape = tape_of(text)
        for how, made in WAYS.items():
            flat, curved = [], []
            for cells in GRIDS:
                start = time.perf_counter()
                found = made(tape, (-half,) * 3, (half,) * 3, 2 * half / cells)
                spent = time.perf_counter() - start
                flat.append(1 - volume(found.vertices, found.triangles) / exact)
                curved.append(1 - curved_volume(found.vertices, found.triangles, found.normals) / exact)
            print(f"{name:8} {how:8} {len(found.triangles)} triangles in {spent:.2f} s", flush=True)
            for what, errors in (("flat", flat), ("curved", curved)):
                order = -np.polyfit(np.log(GRIDS), np.log(np.abs(errors)), 1)[0]
                halved = [np.log2(abs(errors[k] / errors[k + 2])) for k in (0, 2)]
                rest = abs(4 * errors[-1] - errors[-3]) / 3
                print(
                    f"{'':8} {what:8} volume off by {abs(errors[-1]):.2e} at 256, order {order:.3f} (64 to 128"
                    f" {halved[0]:.3f}, 128 to 256 {halved[1]:.3f}), extrapolated {rest:.1e} ({rest * exact:.1e} m^3)",
                    flush=True,
                )


def hang_together(cells: int) -> None:
    """Euler characteristics, open edges and inward triangles of closed shapes, by each way."""
    for name, (tape, half, expected) in closed_shapes().items():
        for how in WAYS:
            found = WAYS[how](tape, (-half,) * 3, (half,) * 3, 2 * half / cells)
            euler = euler_characteristic(found.triangles)
            verdict = "" if euler == expected else f", NOT {expected}"
            print(
                f"{name:14} {how:8} Euler characteristic {euler}{verdict}; "
                f"{flaws(tape, found.vertices, found.triangles)}; {len(found.triangles)} triangles",
                flush=True,
            )


def closed_shapes() -> dict[str, tuple[Any, float, int]]:
    """Tapes of closed smooth shapes, half the sides of their boxes [m], and their Euler characteristics."""
    found = {name: (tape_of(text), half, euler) for name, (text, half, euler) in CLOSED.items()}
    for name, off, euler in (("two joined", -1e-3, 2), ("two apart", 1e-3, 4)):
        build = TapeBuilder()
        x = 0.5 * (MERGING + off)
        ends = np.array([[[-x, 0.0, 0.0]] * 3, [[x, 0.0, 0.0]] * 3])
        points = Skeleton(ends, np.ones((2, 2)), np.ones(2), np.arange(2))
        density = build.skeleton(points, build.x, build.y, build.z)
        found[name] = build.finish(build.op("sub", build.constant(0.3), density)), 1.4, euler
    return found


def subjects() -> Iterator[mesh_errors.Subject]:
    """Closed smooth solids, the common scenes that are solids, cut by their balls, and the blobs."""
    for name in ("ball", "torus", "capsule", "tanglecube"):
        yield mesh_errors.of_formula(name, *CLOSED[name], {})
    for name in ("steiner", "barth_sextic", "kummer", "gyroid"):
        scene = SCENES[name]
        text = f"max({scene['f']}, sqrt(x^2 + y^2 + z^2) - {scene['clip']})"
        # Steiner's solid is four pieces that touch; the nodes of the others are joined or not as cells fall.
        euler = 8 if name == "steiner" else None
        yield mesh_errors.of_formula(name, text, 1.02 * scene["clip"], euler, scene.get("where", {}))
    scene, half = SCENES["blob40"], 1.02 * SCENES["blob40"]["clip"]
    centers = ", ".join("[{:.9g} m, {:.9g} m, {:.9g} m]".format(*part[:3]) for part in scene["parts"])
    radii = ", ".join(f"{part[3]:.9g} m" for part in scene["parts"])
    thing = f"{{blobby: {{points: [{centers}], radius: [{radii}], threshold: {scene['threshold']}}}}}"
    rows = np.array(scene["parts"])

    def blobs(x: Any, y: Any, z: Any) -> Any:
        return scene["threshold"] - sum(
            np.maximum(1 - ((x - a) ** 2 + (y - b) ** 2 + (z - c) ** 2) / r**2, 0) ** 3 for a, b, c, r in rows
        )

    yield mesh_errors.Subject("blob40", thing, blobs, partial(grid_values, "blob40", half, boxed=True), half, -12)


if __name__ == "__main__":
    if find_spec("skimage") is not None:
        for subject in subjects():
            mesh_errors.table(subject, int(sys.argv[2]) if len(sys.argv) > 2 else 3)
    compare(int(sys.argv[1]) if len(sys.argv) > 1 else 256, int(sys.argv[2]) if len(sys.argv) > 2 else 7)
    converge()
    hang_together(128)
