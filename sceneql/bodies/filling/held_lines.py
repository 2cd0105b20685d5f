"""Lines and points of a solid that holds and loads name, as chains of edges of its mesh. Imports numpy."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.bodies.elements.element_mesh import ElementMesh, OnLine, Onto, unit
from sceneql.bodies.elements.hold import AXES, Part
from sceneql.bodies.filling.kept_creases import CREASE
from sceneql.bodies.filling.outer import Outer
from sceneql.bodies.filling.split_lines import ROUNDING, Line, Split, Surface
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Call, Expr, Symbol, walk

if TYPE_CHECKING:
    from numpy import bool_
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints

FARTHEST = 0.15
"""Largest distance of an edge's middle from a line that the edge is on, as a share of the edge."""
STEPS, APART = 8, 1e-4
"""Most steps of Newton's method onto a line, and the distance, as a share of an edge, of its differences."""


def factors(expr: Expr) -> Iterator[Expr]:
    """The factors of a formula that is a product: the conditions that all have to hold."""
    if isinstance(expr, Call) and expr.op == "mul":
        for one in expr.args:
            yield from factors(one)
    else:
        yield expr


def line_of(part: Part, axes: Floats | None) -> Line | None:
    """The line that an equality in a part's `where` tells, of places along axes, the columns (3, 3); None: no line."""
    if part.where is None:
        return None
    equations, rest = [], []
    for one in factors(part.where.expr):
        if isinstance(one, Call) and one.op == "eq" and any(isinstance(node, Symbol) for node in walk(one)):
            equations.append(one)
        else:
            rest.append(one)
    if not equations:
        return None

    def value(expr: Expr, places: Floats) -> Any:
        real = places if axes is None else places @ axes.T
        known = {Symbol(axis): real[:, k] for k, axis in enumerate(AXES)}
        return np.broadcast_to(np.asarray(evaluate(expr, known, arrays=True), dtype=float), len(places))

    def differs(equation: Call, places: Floats) -> Floats:
        one, two = (value(side, places) for side in equation.args)
        found: Floats = one - two
        return found

    def lies(places: Floats) -> NDArray[bool_]:
        held = np.ones(len(places), dtype=bool)
        for one in rest:
            held &= value(one, places) != 0.0
        return held

    return Line([partial(differs, one) for one in equations], lies)


@dataclass(frozen=True, slots=True, eq=False)
class Cut:
    """Tetrahedra whose vertices stand on lines and points."""

    points: Floats
    """(n, 3) [m]."""
    cells: Ints
    """(t, 4)."""
    parents: Any
    """(t,) the tetrahedron before that each is a part of."""
    on: Mapping[str, Any]
    """By name of a part: (n,) bool, the vertices on its line, or the number of its point's vertex."""
    inside: frozenset[str]
    """Names of the lines that needed no new vertices: nodes inside that stand there belong to them."""
    put: tuple[int, int]
    """How many vertices were added, and moved."""


class Lines:
    """The lines and points of a solid's holds and loads."""

    def __init__(self, parts: Mapping[str, Part], axes: Floats | None = None) -> None:
        self.lines = {name: line for name, part in parts.items() if (line := line_of(part, axes)) is not None}
        self.points = {
            name: np.asarray(part.near) if axes is None else np.asarray(part.near) @ axes
            for name, part in parts.items()
            if part.near is not None and part.within is None
        }

    def __bool__(self) -> bool:
        """Whether there are any."""
        return bool(self.lines or self.points)

    def cut(self, points: Floats, cells: Ints, surface: Surface, more: bool) -> Cut:
        """Give the lines and points vertices in tetrahedra (t, 4); ``more``: elements have nodes between vertices."""
        split, size, on, inside = Split(points, cells, surface), float(np.ptp(points, axis=0).max()), {}, set()
        for line in self.lines.values():
            split.kept |= split.standing(line)
        for name, line in self.lines.items():
            before = split.added, split.moved
            on[name] = split.cut(line)
            if before == (split.added, split.moved):
                inside.add(name)
        found: dict[str, Any] = {name: split.pierce(place, size, more) for name, place in self.points.items()}
        for name, one in on.items():
            later = split.standing(self.lines[name])  # where other lines cross it, and points stand on it
            later[: len(one)] = one
            found[name] = later
        put = split.added, split.moved
        return Cut(split.points, split.cells.astype(cells.dtype), split.parents, found, frozenset(inside), put)

    def curved(self, cut: Cut, onto: Onto | None) -> Onto:
        """``onto`` for a mesh of ``cut``, by which nodes between vertices of lines are moved onto these, too."""
        onto = onto or Onto(lambda places, normals: places, lambda places, normals, sides: np.full_like(places, np.nan))
        return replace(onto, line=partial(self._along, cut, onto.surface))

    def _along(
        self, cut: Cut, surface: Callable[[Floats, Floats], Floats], mesh: ElementMesh, places: Floats
    ) -> Floats:
        """Nodes (n, 3) of a mesh of ``cut``, those between vertices of curved lines moved onto these on the surface.

        ``places`` (n, 3): the nodes as they are on the surface; ``surface`` as of Onto.
        """
        found, faces, outer = places, mesh.faces, _outer(mesh)
        for name, line in self.lines.items():
            chain = Chain.of(mesh, outer, faces, places, cut.on[name])
            for equation in line.equations:
                found = chain.moved(equation, found, surface)
        return found

    def marked(self, cut: Cut, mesh: ElementMesh) -> ElementMesh:
        """The mesh of ``cut`` with the nodes of the lines and points."""
        lines: dict[str, OnLine] = {}
        faces, outer = mesh.faces, _outer(mesh)
        for name, on in cut.on.items():
            if name in self.points:
                if on >= 0:
                    lines[name] = OnLine(np.array([on]), np.zeros((0, 3), dtype=np.int64), False)
                continue
            line, chain = self.lines[name], Chain.of(mesh, outer, faces, mesh.points, on)
            held = line.rest(chain.middles)
            for equation in line.equations:
                held &= chain.distances(equation) <= FARTHEST * chain.lengths
            nodes = np.concatenate([np.flatnonzero(on), chain.nodes[held, 2:].ravel()])
            lines[name] = OnLine(np.unique(nodes), chain.nodes[held], name in cut.inside)
        return replace(mesh, lines=lines, put=cut.put)


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """Outer edges of a mesh between vertices on a line."""

    nodes: Any
    """(k, 2 or 3) their ends, and the node between them."""
    middles: Floats
    """(k, 3) [m] their middles."""
    lengths: Floats
    """(k,) [m]."""
    normals: Floats
    """(k, 3) unit normals there."""
    aside: Floats
    """(k, 3) unit directions along the surface, across each edge; zero at creases, from which nothing moves."""

    @classmethod
    def of(cls, mesh: ElementMesh, outer: Outer, faces: Ints, places: Floats, on: Any) -> Chain:
        """The edges with both ends in ``on`` (corners,) bool, of a mesh with nodes at places (n, 3)."""
        which = np.flatnonzero(on[outer.ends].all(axis=1))
        nodes = outer.ends[which]
        a, b = places[nodes[:, 0]], places[nodes[:, 1]]
        middles = 0.5 * (a + b)
        if mesh.element.edges:
            own = faces[outer.beside[which, 0]]
            after = np.argmax((own[:, :3, None] != nodes[:, None]).all(axis=2), axis=1)
            nodes = np.column_stack([nodes, own[np.arange(len(own)), 3 + (after + 1) % 3]])
            middles = places[nodes[:, 2]]
        lengths = np.linalg.norm(b - a, axis=1)
        normals = unit(outer.across[outer.beside[which]].sum(axis=1))
        aside = np.where(outer.sharp[which, None], 0.0, unit(np.cross(normals, b - a)))
        return cls(nodes, middles, lengths, normals, aside)

    def distances(self, equation: Callable[[Floats], Floats]) -> Floats:
        """How far (k,) [m] the middles are from where an equation holds, by its gradient."""
        value, apart = equation(self.middles), APART * self.lengths
        size = np.abs(value).max(initial=0.0)
        slopes = [_slope(equation, self.middles, np.eye(3)[[axis]], apart) for axis in range(3)]
        slope = np.linalg.norm(slopes, axis=0)
        away: Floats = np.abs(value) / np.maximum(slope, 1e-300)
        return np.where((np.abs(value) <= ROUNDING * size) & (slope == 0.0), 0.0, away)

    def moved(
        self,
        equation: Callable[[Floats], Floats],
        places: Floats,
        surface: Callable[[Floats, Floats], Floats],
    ) -> Floats:
        """Nodes (n, 3) with those of the edges' middles moved across the edges onto where an equation holds."""
        if self.nodes.shape[1] == 2:
            return places
        away = self.distances(equation) / self.lengths
        some = np.flatnonzero((away > ROUNDING) & (away <= FARTHEST) & self.aside.any(axis=1))
        start, aside, normals = places[self.nodes[some, 2]], self.aside[some], self.normals[some]
        apart = APART * self.lengths[some]
        far = np.zeros(len(some))

        def at(far: Floats) -> Floats:
            found = start + far[:, None] * aside
            return surface(found, normals)

        for _ in range(STEPS):
            here, beyond = equation(at(far)), equation(at(far + apart))
            slope = (beyond - here) / apart
            steep = np.abs(slope) > 0.0
            far = far - np.where(steep, here / np.where(steep, slope, 1.0), 0.0)
        near = np.isfinite(far) & (np.abs(far) <= FARTHEST * self.lengths[some])
        found = places.copy()
        found[self.nodes[some[near], 2]] = at(far)[near]
        return found


def surface_of(onto: Onto | None) -> Surface:
    """How vertices are put onto the surface: of an object, by ``onto``; of a mesh of planes, without."""
    if onto is None:
        return Surface()

    def moved(places: Floats, outer: Outer, which: Any) -> Floats:
        found, normals = places.copy(), outer.across[outer.beside[which]]
        sharp = outer.sharp[which]
        found[~sharp] = onto.surface(places[~sharp], unit(normals[~sharp].sum(axis=1)))
        if sharp.any():
            on = onto.crease(places[sharp], normals[sharp], outer.sides[which[sharp]])
            met = ~np.isnan(on).any(axis=1)
            found[np.flatnonzero(sharp)[met]] = on[met]
        return found

    return Surface(CREASE, moved, onto.surface)


def _slope(equation: Callable[[Floats], Floats], places: Floats, way: Floats, apart: Floats) -> Floats:
    """Derivatives (k,) of an equation at places (k, 3) along a direction (1, 3), by central differences."""
    move = apart[:, None] * way
    found: Floats = (equation(places + move) - equation(places - move)) / (2.0 * apart)
    return found


def _outer(mesh: ElementMesh) -> Outer:
    return Outer.of(mesh.points, mesh.cells[:, :4], CREASE)
