"""Meshes as the command ``mesh`` writes them, beside numpy's grid and scikit-image: time at equal Hausdorff distance.

What judges is neither of both: f is written in numpy, the true surface is found by changes of sign along lines and
halving, and from where the distance is largest points climb on along the surface until it grows no more.
"""

from __future__ import annotations

import gc
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

import sceneql.report.mesh as command
from sceneql import pipeline
from sceneql.mesh.distance import to_triangles
from sceneql.mesh.measures import euler_characteristic
from sceneql.mesh.polygons import Polygons
from sceneql.mesh.write_mesh import write

CELLS = 32, 64, 128
"""Ours, along the side of the box."""
NODES = 32, 48, 64, 96, 128, 192, 256
"""The peer's, along each side."""
OTHERS = 37, 50, 81, 99
"""Cells at which Euler characteristic and folds alone are told."""
LINES, ALONG, HALVINGS = 24, 256, 45
"""Lines along each axis (squared) on which the true surface is sought, places on each, halvings of a change of sign."""
CLIMBERS, CHILDREN, CLIMBS, SHORTER = 128, 8, 12, 0.7
"""Points that climb; new places of each in a round, rounds, and factor of their reach from one to the next."""
JUDGED = 3000
"""Points of the mesh, the farthest by |f| / |grad f|, whose distance from the surface is measured."""
RAYS, REACHES, NEAREST, FARTHEST = 24, 16, 1.0e-5, 0.05
"""Rays from a point along which a change of sign is sought, places on each, the nearest and farthest by the box."""
NEAR = 48
"""Triangles of about one size among which the nearest is sought."""
STEP = 1.0e-6
"""Of differences, relative to the box."""
SCENE = """
clock: {{end: 1 s}}
define: {{{define}}}
objects: {{thing: {thing}}}
outputs: {{still: {{image: {{}}}}}}
"""
PLAIN = {"max": np.maximum, "min": np.minimum, "abs": np.abs, "sqrt": np.sqrt, "sin": np.sin, "cos": np.cos}
Field = Callable[[Any, Any, Any], Any]


@dataclass(frozen=True)
class Subject:
    """A solid as a script and in numpy."""

    name: str
    thing: str
    f: Field
    grid: Callable[[int], Any]
    """f on n^3 nodes of the box."""
    half: float
    """Half the side of the box [m]."""
    euler: int | None
    """True Euler characteristic; None where the solid touches itself, so that it cannot be told."""
    define: str = ""


def in_numpy(text: str, where: dict[str, str]) -> Field:
    """A formula of x, y and z as a function; ``where`` gives its constants."""
    names: dict[str, Any] = dict(PLAIN)

    def value(formula: str, **more: Any) -> Any:
        code = formula.replace("^", "**").replace("lambda", "lambda_")
        return eval(code, {"__builtins__": {}}, names | more)

    for name, formula in where.items():
        names[name.replace("lambda", "lambda_")] = value(formula)
    return lambda x, y, z: value(text, x=x, y=y, z=z)


def of_formula(name: str, text: str, half: float, euler: int | None, where: dict[str, str]) -> Subject:
    """A subject whose grid is evaluated slab by slab, so that intermediate arrays stay in the cache."""
    f = in_numpy(text, where)

    def grid(n: int) -> Any:
        x, y, z = np.meshgrid(*[np.linspace(-half, half, n)] * 3, indexing="ij", sparse=True)
        return np.concatenate(
            [np.broadcast_to(f(x[k : k + 8], y, z), (len(x[k : k + 8]), n, n)) for k in range(0, n, 8)]
        )

    box = f"{{box: [{-half} {-half} {-half}, {half} {half} {half}]}}"
    define = ", ".join(f"{key}: {value}" for key, value in where.items())
    return Subject(name, f'{{implicit: {{field: "{text}", bounds: {box}}}}}', f, grid, half, euler, define)


def slopes(f: Field, at: Any, size: float) -> Any:
    """(n, 3) gradients at points (n, 3) by central differences."""
    h = STEP * size
    steps = h * np.eye(3)
    with np.errstate(all="ignore"):
        return np.stack([(f(*(at + step).T) - f(*(at - step).T)) / (2 * h) for step in steps], axis=1)


def projected(f: Field, points: Any, size: float, steps: int = 8) -> tuple[Any, Any]:
    """Points moved to the surface by Newton's method along the gradient, and (n,) whether each arrived."""
    at = points.copy()
    with np.errstate(all="ignore"):
        for _ in range(steps):
            gradients = slopes(f, at, size)
            moves = (f(*at.T) / (gradients**2).sum(axis=1))[:, None] * gradients
            lengths = np.linalg.norm(moves, axis=1)
            moves *= np.minimum(1.0, 0.02 * size / np.maximum(lengths, 1e-300))[:, None]
            at -= np.where(np.isfinite(moves), moves, 0.0)
    return at, np.isfinite(moves).all(axis=1) & (lengths < 1e-9 * size)


class Truth:
    """The true surface of a subject by its points."""

    def __init__(self, subject: Subject) -> None:
        self.f, self.size = subject.f, 2 * subject.half
        self.points = np.concatenate([self._met(axis, subject.half) for axis in range(3)])
        self.tree = cKDTree(self.points)
        self.spacing = float(np.median(self.tree.query(self.points, 4)[0][:, 3]))

    def _met(self, axis: int, half: float) -> Any:
        """(n, 3) roots of f along lines parallel to an axis."""
        rng = np.random.default_rng(axis)
        u, v = ((np.indices((LINES, LINES)) + rng.random((2, LINES, LINES))) / LINES * 2 - 1).reshape(2, -1) * half
        t = np.linspace(-half, half, ALONG)

        def inside(*tuv: Any) -> Any:
            return self.f(*(tuv[(k - axis) % 3] for k in range(3))) < 0

        signs = inside(*np.broadcast_arrays(t[None], u[:, None], v[:, None]))
        row, column = np.nonzero(signs[:, 1:] != signs[:, :-1])
        low, high, u, v, sign = t[column], t[column + 1], u[row], v[row], signs[row, column]
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            same = inside(middle, u, v) == sign
            low, high = np.where(same, middle, low), np.where(same, high, middle)
        return np.stack([(low, u, v)[(k - axis) % 3] for k in range(3)], axis=1)

    def off(self, points: Any) -> Any:
        """(n,) distances of points from the surface: of feet found from them, from the two nearest known points and
        from the nearest change of sign around them, which is found at nodes too, where Newton's method is slow.
        """
        beside, near = self.tree.query(points, 2)
        changed = self._changed(points)
        best = np.minimum(beside.min(axis=1), np.linalg.norm(changed - points, axis=1))
        for start in (points, self.points[near[:, 0]], self.points[near[:, 1]], changed):
            at = start
            for turn in range(4):
                if turn or start is not points:
                    n = slopes(self.f, at, self.size)
                    n /= np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-300)
                    at = points - np.einsum("ij,ij->i", points - at, n)[:, None] * n
                at, arrived = projected(self.f, at, self.size, 4)
                best = np.minimum(best, np.where(arrived, np.linalg.norm(at - points, axis=1), np.inf))
        return best

    def _changed(self, points: Any) -> Any:
        """(n, 3) the nearest change of sign of f found along rays from points; far away where there is none."""
        ways = np.random.default_rng(3).standard_normal((RAYS, 3))
        ways /= np.linalg.norm(ways, axis=1, keepdims=True)
        reach = np.concatenate([[0.0], np.geomspace(NEAREST, FARTHEST, REACHES)]) * self.size

        def inside(of: Any, along: Any) -> Any:
            return self.f(*(np.moveaxis(points[of] + along[..., None] * ways, -1, 0))) < 0

        best, best_at = np.full(len(points), self.size), np.zeros(len(points), dtype=int)
        for few in np.array_split(np.arange(len(points)), 1 + len(points) // 300):
            at = (few[:, None],)
            sign = inside(at, np.zeros((len(few), RAYS)))
            low, high = np.zeros((len(few), RAYS)), np.full((len(few), RAYS), np.inf)
            for radius in reach[1:]:
                open_yet = np.isinf(high)
                other = inside(at, np.full((len(few), RAYS), radius)) != sign
                high = np.where(open_yet & other, radius, high)
                low = np.where(open_yet & ~other, radius, low)
            met = np.isfinite(high)
            high = np.where(met, high, self.size)
            for _ in range(HALVINGS):
                middle = 0.5 * (low + high)
                same = inside(at, middle) == sign
                low, high = np.where(same & met, middle, low), np.where(same | ~met, high, middle)
            best[few], best_at[few] = high.min(axis=1), high.argmin(axis=1)
        return points + best[:, None] * ways[best_at]

    def hausdorff(self, vertices: Any, triangles: Any) -> float:
        """Largest distance [m] found between a mesh and the surface, in both directions."""
        corners = vertices[triangles]
        away = distances_from(corners)
        rng, at, far = np.random.default_rng(2), self.points, away(self.points)
        best = np.argsort(-far)[:CLIMBERS]
        at, far, reach, rows = at[best], far[best], self.spacing, np.arange(len(best))
        for _ in range(CLIMBS):
            tries = np.repeat(at, CHILDREN, axis=0)
            tries, arrived = projected(self.f, tries + reach * rng.standard_normal(tries.shape), self.size)
            found = np.where(arrived, away(tries), -1.0).reshape(len(at), -1)
            k = found.argmax(axis=1)
            at = np.where((found[rows, k] > far)[:, None], tries.reshape(len(at), -1, 3)[rows, k], at)
            far, reach = np.maximum(far, found[rows, k]), SHORTER * reach
        sides = 0.5 * (corners + np.roll(corners, 1, axis=1))
        places = np.concatenate([corners.mean(axis=1), sides.reshape(-1, 3), corners.reshape(-1, 3)])
        with np.errstate(all="ignore"):
            first = np.abs(self.f(*places.T)) / np.linalg.norm(slopes(self.f, places, self.size), axis=1)
        judged = places[np.argsort(-np.where(np.isfinite(first), first, np.inf))[:JUDGED]]
        return float(max(far.max(), self.off(judged).max()))


def distances_from(corners: Any) -> Callable[[Any], Any]:
    """Function of points (n, 3): distances from triangles (t, 3, 3), the nearest sought among those of each size."""
    middles = corners.mean(axis=1)
    radius = np.linalg.norm(corners - middles[:, None], axis=2).max(axis=1)
    kind = np.ceil(np.log2(np.maximum(radius, 1e-300)) / 1.5).astype(int)
    kind = np.maximum(kind, kind.max() - 6)
    classes = [(corners[kind == k], cKDTree(middles[kind == k])) for k in np.unique(kind)]

    def found(points: Any) -> Any:
        best = np.full(len(points), np.inf)
        for of, tree in classes:
            _, near = tree.query(points, min(NEAR, len(of)))
            best = np.minimum(best, to_triangles(points[:, None], of[near.reshape(len(points), -1)]).min(axis=1))
        return best

    return found


@contextmanager
def kept() -> Iterator[dict[str, Any]]:
    """The polygons of the last mesh that the command made, as ``polygons``."""
    last: dict[str, Any] = {}
    whole = command._of_solid

    def keep(*args: Any) -> Any:
        made = whole(*args)
        last["polygons"] = made.polygons
        return made

    command._of_solid = keep
    try:
        yield last
    finally:
        command._of_solid = whole


def table(subject: Subject, rounds: int) -> None:
    """Print a subject's table: processor time (medians of runs in turns) and distance, the peer's time at ours."""
    from skimage.measure import marching_cubes

    truth, half = Truth(subject), subject.half
    with kept() as last, tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        script = folder / "scene.yaml"
        script.write_text(SCENE.format(thing=subject.thing, define=subject.define), encoding="utf-8")
        graph = pipeline.load(script, pruned=False)

        def ours(cells: int) -> tuple[Any, Any, Any]:
            account = command.mesh(graph, "thing", folder / "ours.ply", cell=2 * half / cells)
            return last["polygons"].vertices, last["polygons"].triangles, account

        def peers(nodes: int) -> tuple[Any, Any, Any]:
            vertices, triangles, normals, _ = marching_cubes(subject.grid(nodes), 0.0)
            vertices = vertices.astype(float) * (2 * half / (nodes - 1)) - half
            write(folder / "theirs.ply", Polygons(vertices, triangles, normals))  # the same file as ours
            return vertices, triangles, None

        ours(CELLS[0])  # compiles
        runs = [("ours", ours, cells) for cells in CELLS] + [("theirs", peers, nodes) for nodes in NODES]
        spent: dict[tuple[str, int], list[float]] = {(who, n): [] for who, _, n in runs}
        errors, made = {}, {}
        gc.collect()
        gc.disable()  # as timeit does: what it goes through is the bench's, for whoever comes first
        for turn in range(rounds):
            for who, make, n in runs:
                make(n)  # both meet their own data in the caches, not what a run of 256^3 nodes before left there
                start = time.process_time()
                found = make(n)
                spent[who, n].append(time.process_time() - start)
                if not turn:
                    made[who, n] = found
        gc.enable()
        errors = {key: truth.hausdorff(*found[:2]) for key, found in made.items()}
        seconds = {key: float(np.median(times)) for key, times in spent.items()}
        curve = [(errors["theirs", n], seconds["theirs", n]) for n in NODES]
        for (who, n), (_, triangles, account) in made.items():
            line = f"{subject.name:13} {who:6} {n:4}: {1e3 * seconds[who, n]:7.1f} ms, {errors[who, n]:.2e} m off,"
            line += f" {len(triangles):7} triangles, Euler characteristic {euler_characteristic(triangles)}"
            if account is not None:
                sign, peer = at_equal(curve, errors[who, n])
                line += f", {account.folded} folded; the peer at that distance {sign}{1e3 * peer:.1f} ms, ratio {sign}"
                line += f"{peer / seconds[who, n]:.2f}"
            print(line, flush=True)
        for cells in OTHERS:
            _, triangles, account = ours(cells)
            euler = euler_characteristic(triangles)
            verdict = "" if subject.euler in (None, euler) else f", NOT {subject.euler}"
            print(f"{subject.name:13} {cells:4} cells: Euler characteristic {euler}{verdict}, {account.folded} folded")


def at_equal(curve: list[tuple[float, float]], error: float) -> tuple[str, float]:
    """Seconds of the peer for an error, between its runs in the logarithm; ``>`` and ``<`` outside of them."""
    off, took = np.array(curve).T
    off = np.minimum.accumulate(off)
    if not off[-1] <= error <= off[0]:
        return (">", float(took[-1])) if error < off[-1] else ("<", float(took[0]))
    return "", float(np.exp(np.interp(np.log(error), np.log(off[::-1]), np.log(took[::-1]))))
