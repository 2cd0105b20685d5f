"""Lines and points on the surface of a tetrahedral mesh, which get vertices where they have none. Imports numpy.

A line is where a function of the place is zero. Where it crosses an outer edge near one of its ends, the end moves
there along the surface, if the tetrahedra around it keep their shape; other edges that it crosses are split, with all
tetrahedra around them. So it becomes a chain of outer edges. A vertex moves to a point likewise, or an edge or a face
is split there.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.bodies.filling.kept_creases import around, keeps_shape, shapes
from sceneql.bodies.filling.outer import Outer

if TYPE_CHECKING:
    from numpy import bool_
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints

MOVED = 0.25
"""The end of an edge may move to a crossing within this share of the edge's length."""
LEAST = 0.05
"""A crossing nearer to an end, as a share of the edge, splits no edge: the end counts as on the line."""
WITHIN = 1e-3
"""A vertex is on a line where its value is so small relative to the differences along the edges around it."""
ROUNDING = 1e-9
"""The like, relative to the largest value of all vertices; of places, relative to the mesh's size."""
INSIDE = 0.25
"""A place deeper below the surface, as a share of the shortest side of the face there, is one of the inside."""
FLATTEST = 0.01
"""Least shape (kept_creases.shapes) of tetrahedra whose new vertex is on a curved surface; else it is on the edge."""
STEPS, LAST = 60, 1e-15
"""Most steps of the search for a crossing, and the last width, as a share of the edge."""
APART = 1e-3
"""Distance of the points that tell a surface's normal, as a share of that to the surface."""


@dataclass(frozen=True, slots=True, eq=False)
class Line:
    """A line on a surface; with several equations the points, or the line, where all hold."""

    equations: Sequence[Callable[[Floats], Floats]]
    """Functions of places (k, 3) [m] whose values (k,) are zero on it."""
    rest: Callable[[Floats], NDArray[bool_]]
    """Whether places (k, 3) lie in the part of space to which it is confined."""


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """How vertices are put onto the surface of an object."""

    cosine: float | None = None
    """As of Outer.of."""
    onto: Callable[[Floats, Outer, Any], Floats] | None = None
    """Moves places (k, 3) on outer edges (k,) onto the object; None: they are on it."""
    onto_face: Callable[[Floats, Floats], Floats] | None = None
    """Moves places (k, 3) along unit normals (k, 3) onto it, likewise."""
    real: Callable[[Floats, Any], Floats] | None = None
    """Of elements with curved edges: places (k, 3) in the elements of numbers (k,), of those in the straight ones."""


class Split:
    """A tetrahedral mesh in which lines and points get vertices."""

    def __init__(self, points: Floats, cells: Ints, surface: Surface) -> None:
        self.points, self.surface = points.copy(), surface
        self.cells: Any = cells.astype(np.int64)
        self.parents = np.arange(len(cells))
        self.added, self.moved = 0, 0
        self.kept = np.zeros(len(points), dtype=bool)
        """(n,) vertices that stay where they are, since lines or points have them."""

    def outer(self) -> Outer:
        """The surface."""
        return Outer.of(self.points, self.cells, self.surface.cosine)

    def places(self) -> Floats:
        """The real places (n, 3) of the vertices."""
        if self.surface.real is None:
            return self.points
        used, first = np.unique(self.cells, return_index=True)
        found = self.points.copy()
        found[used] = self.surface.real(self.points[used], self.parents[first // 4])
        return found

    def standing(self, line: Line) -> NDArray[bool_]:
        """(n,) the vertices that stand on a line."""
        places = self.places()
        found: NDArray[bool_] = line.rest(places)
        for equation in line.equations:
            found = found & (self._signs(equation(places)) == 0)
        return found

    def cut(self, line: Line) -> NDArray[bool_]:
        """(n,) the outer vertices on a line, after the edges that it crosses were split."""
        on, equations = None, list(line.equations)
        if len(equations) > 1:
            equations.sort(key=self._in_faces, reverse=True)
        for equation in equations:
            on = self._cut(equation, line, on)
        assert on is not None
        return on

    def _in_faces(self, equation: Callable[[Floats], Floats]) -> int:
        """How many outer edges lie where an equation holds."""
        zero = self._signs(equation(self.places())) == 0
        return int(np.count_nonzero(zero[self.outer().ends].all(axis=1)))

    def _signs(self, values: Floats) -> Any:
        """(n,) -1, 0 or 1: on which side of a line vertices with values (n,) are."""
        differ = np.zeros(len(values))
        for a, b in ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)):
            one, two = self.cells[:, a], self.cells[:, b]
            change = np.nan_to_num(np.abs(values[one] - values[two]))
            np.maximum.at(differ, one, change)
            np.maximum.at(differ, two, change)
        known = np.abs(values[np.isfinite(values)])
        near = np.abs(values) <= np.maximum(WITHIN * differ, ROUNDING * known.max(initial=0.0))
        return np.where(near | np.isnan(values), 0, np.sign(np.nan_to_num(values))).astype(int)

    def _cut(self, equation: Callable[[Floats], Floats], line: Line, among: NDArray[bool_] | None) -> NDArray[bool_]:
        """(n,) as `cut`, for one equation; ``among`` (n,): vertices on those before, between which edges are split."""
        outer, places = self.outer(), self.places()
        values = equation(places)
        sign = self._signs(values)
        sign[np.isnan(values)] = 2
        on = np.zeros(len(places), dtype=bool)
        on[outer.faces.ravel()] = True
        on &= (sign == 0) & line.rest(places)
        near = np.ones(len(outer.faces), dtype=bool)
        for other in line.equations:
            there = self._signs(other(places))[outer.faces]
            near &= (there.min(axis=1) <= 0) & (there.max(axis=1) >= 0)
        a, b = outer.ends.T
        crossed = (sign[a] * sign[b] == -1) & near[outer.beside].any(axis=1)
        if among is not None:
            on &= among
            crossed &= among[a] & among[b]
        which = np.flatnonzero(crossed)
        owners = self.parents[outer.owners(self.cells)[outer.beside[which, 0]]]
        shares, stored, real = self._crossings(equation, values, outer, which, owners)
        held = line.rest(real)
        which, shares, stored = which[held], shares[held], stored[held]
        self._move(outer, which, shares, stored, on)
        left = ~on[outer.ends[which]].any(axis=1)
        before = len(self.points)
        self._split(outer.ends[which[left]], shares[left], stored[left])
        return np.concatenate([on, np.ones(len(self.points) - before, dtype=bool)])

    def _crossings(
        self, equation: Callable[[Floats], Floats], values: Floats, outer: Outer, which: Any, owners: Any
    ) -> tuple[Floats, Floats, Floats]:
        """Shares (k,) of outer edges at which an equation of values (n,) holds; places there; the real places there."""
        start, end = (self.points[outer.ends[which, k]] for k in (0, 1))

        def at(shares: Floats) -> tuple[Floats, Floats]:
            found = start + shares[:, None] * (end - start)
            if self.surface.onto is not None:
                found = self.surface.onto(found, outer, which)
            return found, found if self.surface.real is None else self.surface.real(found, owners)

        low, high = np.zeros(len(which)), np.ones(len(which))
        one, two = (values[outer.ends[which, k]] for k in (0, 1))
        side, last = np.sign(one), np.zeros(len(which))
        enough = LAST * np.abs(values[np.isfinite(values)]).max(initial=0.0)
        shares = one / np.where(one == two, 1.0, one - two)
        stored, real = at(shares)
        for _ in range(STEPS if len(which) else 0):
            found = equation(real)
            same = np.sign(found) == side
            # Regula falsi (Illinois): an end that stays twice counts half.
            one = np.where(same, found, np.where(last == -1, 0.5 * one, one))
            two = np.where(same, np.where(last == 1, 0.5 * two, two), found)
            low, high, last = np.where(same, shares, low), np.where(same, high, shares), np.where(same, 1, -1)
            done = (np.abs(found) <= enough) | (high - low < LAST)
            if done.all():
                break
            part = np.clip(one / np.where(done | (one == two), 1.0, one - two), 0.0, 1.0)
            shares = np.where(done, shares, low + (high - low) * part)
            stored, real = at(shares)
        return shares, stored, real

    def _move(self, outer: Outer, which: Any, shares: Floats, stored: Floats, on: Any) -> None:
        """Move ends of outer edges to crossings near them, where they may; adds vertices to the line's ``on`` (n,)."""
        if not len(which):
            return
        far = np.stack([shares, 1.0 - shares], axis=1)
        length = np.linalg.norm(np.diff(self.points[outer.ends[which]], axis=1)[:, 0], axis=1)
        distances = far * length[:, None]
        cells, starts = around(self.cells, len(self.points))
        for k in np.argsort(distances, axis=None, kind="stable").tolist():
            edge, end = divmod(k, 2)
            vertex = outer.ends[which[edge], end]
            if far[edge, end] > MOVED or on[outer.ends[which[edge]]].any():
                continue
            may = outer.free[vertex] or (outer.along[vertex] and outer.sharp[which[edge]])
            own = self.cells[cells[starts[vertex] : starts[vertex + 1]]]
            place = stored[edge]
            may = may and not self.kept[vertex] and self.surface.real is None
            if may and keeps_shape(self.points, own, vertex, place):
                self.points[vertex] = place
                self.moved += 1
                on[vertex] = self.kept[vertex] = True
            elif far[edge, end] < LEAST:
                on[vertex] = self.kept[vertex] = True

    def _split(self, ends: Any, shares: Floats, stored: Floats) -> None:
        """Split edges (k, 2) at places (k, 3); the places of those that would be too flat are ``shares`` along them."""
        left = np.arange(len(ends))
        while len(left):
            cells, starts = around(self.cells, len(self.points))
            touched = np.zeros(len(self.cells), dtype=bool)
            later: list[int] = []
            gone, made, parents, new = (list[Any]() for _ in range(4))
            for k in left.tolist():
                a, b = ends[k]
                own = cells[starts[a] : starts[a + 1]]
                own = own[(self.cells[own] == b).any(axis=1)]
                if touched[own].any():
                    later.append(k)
                    continue
                touched[own] = True
                number = len(self.points) + len(new)
                both = np.concatenate([np.where(self.cells[own] == end, number, self.cells[own]) for end in (a, b)])
                straight = self.points[a] + shares[k] * (self.points[b] - self.points[a])
                known = self.points[np.minimum(both, len(self.points) - 1)]
                at = np.where((both == number)[..., None], stored[k], known)
                new.append(stored[k] if shapes(at).min() > FLATTEST else straight)
                gone.append(own)
                made.append(both)
                parents.append(np.tile(self.parents[own], 2))
            self._replace(np.concatenate(gone), made, parents, new)
            left = np.array(later, dtype=np.int64)

    def _replace(self, gone: Any, made: list[Any], parents: list[Any], new: list[Floats]) -> None:
        """Replace tetrahedra ``gone`` by those of ``made``, of new points, in parts of ``parents``."""
        self.points = np.concatenate([self.points, np.array(new)])
        self.cells = np.concatenate([np.delete(self.cells, gone, axis=0), *made])
        self.parents = np.concatenate([np.delete(self.parents, gone), *parents])
        self.kept = np.concatenate([self.kept, np.ones(len(new), dtype=bool)])
        self.added += len(new)

    def pierce(self, place: Floats, size: float, more: bool) -> int:
        """The number of the vertex that is put where the surface is nearest to a place (3,), or stood there before.

        -1 where the place is so far inside, or ``more`` (nodes between the vertices) stand there, that its nearest node
        is meant. ``size`` [m]: of the mesh.
        """
        outer = self.outer()
        found, face, shares = _nearest(self.points, outer.faces, place)
        corners = outer.faces[face]
        sides = np.linalg.norm(self.points[corners] - self.points[np.roll(corners, -1)], axis=1)
        inside = (found - place) @ outer.across[face]
        middles = 0.5 * (self.points[corners] + self.points[np.roll(corners, -1)])
        if inside > INSIDE * sides.min() or (more and _away(middles, place).min() <= ROUNDING * size):
            return -1
        nearest = corners[np.argmin(_away(self.points[corners], found))]
        if _away(self.points[[nearest]], found)[0] <= ROUNDING * size:
            self.kept[nearest] = True
            return int(nearest)
        return self._put(outer, face, shares, found, place, size)

    def _put(self, outer: Outer, face: int, shares: Floats, found: Floats, place: Floats, size: float) -> int:
        """The vertex at the point ``found`` (3,) nearest to a place (3,), in the way that shapes tetrahedra best.

        ``shares`` (3,): its barycentric coordinates in an outer face.
        """
        corners = outer.faces[face]
        pairs = [np.sort(np.delete(corners, k)) for k in range(3)]
        which = [np.flatnonzero((outer.ends == pair).all(axis=1)) for pair in pairs]
        sharp = [bool(one.size == 0 or outer.sharp[one[0]]) for one in which]
        on = next((k for k in range(3) if sharp[k] and shares[k] < LEAST), None)
        if on is not None:
            a, b = self.points[pairs[on]]
            found = a + np.clip((found - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0) * (b - a)
            if self.surface.onto is not None and which[on].size:
                found = self.surface.onto(found[None], outer, which[on])[0]
        elif self.surface.onto_face is not None:
            found = _foot(place, found, outer.across[face], ROUNDING * size, self.surface.onto_face)
        cells, starts = around(self.cells, len(self.points))
        around_each = [cells[starts[k] : starts[k + 1]] for k in corners]
        best, best_vertex = 0.0, -1
        for k, vertex in enumerate(corners.tolist()):
            own = self.cells[around_each[k]]
            may = outer.free[vertex] if on is None else outer.along[vertex] and vertex in pairs[on]
            if may and not self.kept[vertex] and self.surface.real is None:
                shape = float(shapes(np.where((own == vertex)[..., None], found, self.points[own])).min())
                if shape > best and keeps_shape(self.points, own, vertex, found):
                    best, best_vertex = shape, vertex
        splits = [[int(vertex) for vertex in corners]] if on is None else []
        splits += [pairs[k].tolist() for k in range(3) if k == on or (on is None and not sharp[k])]
        number, chosen = len(self.points), None
        for split in splits:
            own = np.flatnonzero(np.isin(self.cells, split).sum(axis=1) == len(split))
            both = np.concatenate([np.where(self.cells[own] == end, number, self.cells[own]) for end in split])
            at = np.where((both == number)[..., None], found, self.points[np.minimum(both, number - 1)])
            if (shape := float(shapes(at).min())) > best:
                best, chosen = shape, (own, both, np.tile(self.parents[own], len(split)))
        if chosen is None and best_vertex < 0:
            best_vertex, found = int(corners[np.argmax(shares)]), self.points[corners[np.argmax(shares)]]
        if chosen is not None:
            own, both, parents = chosen
            self._replace(own, [both], [parents], [found])
            return number
        if (self.points[best_vertex] != found).any():
            self.points[best_vertex] = found
            self.moved += 1
        self.kept[best_vertex] = True
        return best_vertex


def _nearest(points: Floats, faces: Any, place: Floats) -> tuple[Floats, int, Floats]:
    """The place (3,) on faces (f, 3) that is nearest to another, its face, and its barycentric coordinates (3,)."""
    from trimesh import triangles

    on_triangles: Any = triangles
    corners = points[faces]
    found = on_triangles.closest_point(corners, np.broadcast_to(place, (len(faces), 3)))
    k = int(np.argmin(np.linalg.norm(found - place, axis=1)))
    shares = on_triangles.points_to_barycentric(corners[k : k + 1], found[k : k + 1])[0]
    return found[k], k, np.clip(shares, 0.0, 1.0)


def _away(points: Floats, place: Floats) -> Floats:
    """Distances (k,) of points (k, 3) from a place (3,)."""
    found: Floats = np.linalg.norm(points - place, axis=1)
    return found


def _foot(
    place: Floats, start: Floats, normal: Floats, enough: float, onto: Callable[[Floats, Floats], Floats]
) -> Floats:
    """The point (3,) of a surface nearest to a place (3,), from a point near it; ``onto`` as Surface.onto_face."""
    aside = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    aside /= np.linalg.norm(aside)
    ways = np.stack([np.zeros(3), aside, np.cross(normal, aside)])
    found, apart = start, APART * max(float(np.linalg.norm(place - start)), 1e3 * enough)
    for _ in range(STEPS):
        three = onto(found + apart * ways, np.tile(normal, (3, 1)))
        across = np.cross(three[1] - three[0], three[2] - three[0])
        across /= max(float(np.linalg.norm(across)), 1e-300)
        move = place - three[0] - ((place - three[0]) @ across) * across
        found = three[0] + move
        if np.linalg.norm(move) <= enough:
            break
    nearest: Floats = onto(found[None], normal[None])[0]
    return nearest
