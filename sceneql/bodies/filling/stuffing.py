"""Tetrahedral meshes of objects by isosurface stuffing on a body-centred cubic lattice. Imports numpy.

Labelle & Shewchuk, Isosurface stuffing: fast tetrahedral meshes with good dihedral angles (2007). Lattice points are
the corners and centers of cubes; the centers on both sides of a face and an edge of the face make a tetrahedron (Fuchs
1998). Where an edge crosses the surface near one of its ends, the end moves to the crossing; tetrahedra that the
surface still crosses are cut.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.bodies.filling.tetrahedra import edges

if TYPE_CHECKING:
    from numpy import bool_, int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Ints

NEAR = (0.41189, 0.24999)
"""The end of a short (a long) edge moves to a crossing within this share of the edge's length (their table 1). Dihedral
angles were then 17 to 150 degrees in smooth objects, 10 to 160 degrees in all objects tried."""
TOUCHING = 1e-7
"""Distance in spacings within which a lattice point lies on a side of the box. It is then tested as far inside, so that
rounding does not decide whether a flat side of the object gets the lattice points on it."""
OUT, ON, IN = 0, 1, 2


@dataclass(frozen=True, slots=True, eq=False)
class Stuffing:
    """A tetrahedral mesh."""

    points: Floats
    """(n, 3) [m]."""
    tetrahedra: Ints
    """(t, 4) corners, in the order that makes volumes positive."""
    whole: NDArray[bool_]
    """(t,) whether it is a tetrahedron of the lattice, not cut and with no corner moved."""


def lattice_counts(low: Floats, high: Floats, spacing: float) -> Floats:
    """Number (3,) of cubes' corners along each side of a box low..high, the outermost ones outside the box."""
    counts: Floats = np.floor(np.maximum(high - low, 0.0) / spacing + TOUCHING) + 3
    return counts


def stuffed(
    low: Floats,
    high: Floats,
    spacing: float,
    holds: Callable[[Floats], NDArray[bool_]],
    crossing: Callable[[Floats, Floats], Floats],
) -> Stuffing:
    """Tetrahedra that fill an object in the box low..high, with cubes of side ``spacing`` [m].

    No tetrahedra where no lattice point is inside. ``holds``: which of places (n, 3) lie inside; ``crossing``: the
    parameters (n,) in 0..1 at which segments from places inside to places outside, each (n, 3), leave the object.
    """
    counts = lattice_counts(low, high, spacing).astype(np.int64)
    start = 0.5 * (low + high) - 0.5 * spacing * (counts - 1)
    corners = _grid(counts)
    places = np.concatenate([start + spacing * corners, start + spacing * (_grid(counts - 1) + 0.5)])
    asked = _within(places, low, high, TOUCHING * spacing)
    inside = holds(asked)
    tetrahedra = _lattice(counts, inside)
    odd = np.concatenate([corners.sum(axis=1), _grid(counts - 1).sum(axis=1)]) % 2
    used, tetrahedra = _compact(tetrahedra)
    middle = used >= len(corners)
    points, state = places[used], np.where(inside[used], IN, OUT)
    ends, _ = edges(tetrahedra)
    long = middle[ends[:, 0]] == middle[ends[:, 1]]
    cut = state[ends[:, 0]] != state[ends[:, 1]]
    ends, long = ends[cut], long[cut]
    ends = np.where((state[ends[:, 0]] == IN)[:, None], ends, ends[:, ::-1])
    share = crossing(asked[used][ends[:, 0]], points[ends[:, 1]])
    touches = (asked != places).any(axis=1)[used][ends[:, 0]]
    share = np.where(touches & (share < 10.0 * TOUCHING), 0.0, share)
    surface = points[ends[:, 0]] + share[:, None] * (points[ends[:, 1]] - points[ends[:, 0]])
    points, state = _moved(points, state, ends, share, surface, np.where(long, NEAR[1], NEAR[0]))
    return _cut(points, state, tetrahedra, ends, surface, 2 * middle + odd[used])


def _grid(counts: NDArray[int64]) -> NDArray[int64]:
    """Integer coordinates (n, 3) of a grid, z fastest."""
    return np.stack(np.meshgrid(*(np.arange(c) for c in counts), indexing="ij"), axis=-1).reshape(-1, 3)


def _within(places: Floats, low: Floats, high: Floats, near: float) -> Floats:
    """Places (n, 3), with those within ``near`` of a side of the box moved to that distance inside it."""
    found: Floats = np.where(np.abs(places - low) < near, low + near, places)
    return np.where(np.abs(found - high) < near, high - near, found)


def _lattice(counts: NDArray[int64], inside: NDArray[bool_]) -> Ints:
    """The lattice's tetrahedra (t, 4) with a corner inside; points are numbered cubes' corners first, then centers."""
    corner = np.arange(np.prod(counts)).reshape(counts)
    middle = corner.size + np.arange(np.prod(counts - 1)).reshape(counts - 1)
    found = []
    for axis in range(3):
        lower = np.moveaxis(middle, axis, 0)[:-1]
        upper = np.moveaxis(middle, axis, 0)[1:]
        face = np.moveaxis(corner, axis, 0)[1:-1]
        # Counterclockwise seen from the upper center: after moveaxis the axes are right-handed except for y.
        ring = [face[:, :-1, :-1], face[:, 1:, :-1], face[:, 1:, 1:], face[:, :-1, 1:]]
        ring = ring[::-1] if axis == 1 else ring
        for k in range(4):
            four = np.stack([lower, ring[k], ring[(k + 1) % 4], upper], axis=-1).reshape(-1, 4)
            found.append(four[inside[four].any(axis=1)])
    return np.concatenate(found)


def _compact(tetrahedra: Any) -> tuple[NDArray[int64], Any]:
    """Numbers of the points in use, and the tetrahedra renumbered to these."""
    used, which = np.unique(tetrahedra, return_inverse=True)
    return used.astype(np.int64), which.reshape(-1, 4)


def _moved(
    points: Floats, state: Ints, ends: NDArray[int64], share: Floats, surface: Floats, near: Floats
) -> tuple[Floats, Ints]:
    """Snap points to the nearest crossing within reach (NEAR); they are then ON the surface."""
    vertex = np.concatenate([ends[:, 0], ends[:, 1]])
    away = np.concatenate([share, 1.0 - share])
    close = np.flatnonzero(away < np.concatenate([near, near]))
    length = np.linalg.norm(points[ends[:, 0]] - points[ends[:, 1]], axis=1)
    order = close[np.argsort(-(away * np.concatenate([length, length]))[close], kind="stable")]
    points, state = points.copy(), state.copy()
    points[vertex[order]] = surface[order % len(ends)]  # of several crossings the last assignment, the nearest, remains
    state[vertex[order]] = ON
    return points, state


def _cut(
    points: Floats, state: Ints, tetrahedra: Ints, ends: NDArray[int64], surface: Floats, kind: NDArray[int64]
) -> Stuffing:
    """The parts of the tetrahedra inside the object, again cut into tetrahedra.

    ``kind`` (n,): 2 for cubes' centers, plus 1 for points whose integer coordinates have an odd sum.
    """
    size = len(points)
    keys = ends @ (size, 1)
    order = np.argsort(keys)
    keys = keys[order]
    points = np.concatenate([points, surface[order]])

    def meet(inner: Ints, outer: Ints) -> Ints:
        """Points at which edges from inner to outer points cross the surface; an outer point ON it is its own."""
        found: Ints = np.where(state[outer] == ON, outer, size + np.searchsorted(keys, inner * size + outer))
        return found

    # Corners sorted: inside, on the surface, outside. Where the permutation is odd, two of one state are swapped.
    states = state[tetrahedra]
    by = np.argsort(-states, axis=1, kind="stable")
    inner, outer = (states == IN).sum(axis=1), (states == OUT).sum(axis=1)
    fours = np.take_along_axis(tetrahedra, by, axis=1)
    fours = np.where(inner[:, None] == 1, _swapped(fours, _odd(by), 2, 3), _swapped(fours, _odd(by), 0, 1))
    kept = (outer == 0) & (inner > 0)
    pieces = [fours[kept]]
    a, *others = fours[(inner == 1) & (outer > 0)].T
    pieces.append(np.stack([a, *(meet(a, other) for other in others)], axis=1))
    a, b, z, o = fours[(inner == 2) & (outer == 1)].T
    to_a, to_b, from_a = meet(a, o), meet(b, o), _first(kind, a, b, o)[:, None]
    pieces.append(np.where(from_a, np.stack([a, b, z, to_b], axis=1), np.stack([a, b, z, to_a], axis=1)))
    pieces.append(np.where(from_a, np.stack([a, to_b, z, to_a], axis=1), np.stack([to_a, b, z, to_b], axis=1)))
    a, b, c, o = fours[(inner == 3) & (outer == 1)].T
    top, bottom = np.stack([a, b, c], axis=1), np.stack([meet(x, o) for x in (a, b, c)], axis=1)
    pieces += _prism(top, bottom, np.stack([_first(kind, x, y, o) for x, y in ((a, b), (a, c), (b, c))], axis=1))
    a, b, o, p = fours[(inner == 2) & (outer == 2)].T
    top, bottom = np.stack([a, meet(a, o), meet(a, p)], axis=1), np.stack([b, meet(b, o), meet(b, p)], axis=1)
    first, second = _first(kind, a, b, o), _first(kind, a, b, p)
    # On the surface the shorter diagonal, unless the diagonals of the other two quads determine it.
    shorter = _apart(points, top[:, 1], bottom[:, 2]) < _apart(points, top[:, 2], bottom[:, 1])
    pieces += _prism(top, bottom, np.stack([first, second, np.where(first == second, shorter, ~first)], axis=1))
    used, tetrahedra = _compact(np.concatenate(pieces))
    whole = np.zeros(len(tetrahedra), dtype=bool)
    whole[: len(pieces[0])] = (inner == 4)[kept]
    return Stuffing(points[used], tetrahedra.astype(np.int32), whole)


def _swapped(fours: Ints, where: NDArray[bool_], i: int, j: int) -> Ints:
    """Tetrahedra (t, 4), with corners i and j swapped where the mask is true."""
    order = np.arange(4)
    order[[i, j]] = j, i
    swapped: Ints = np.where(where[:, None], fours[:, order], fours)
    return swapped


def _apart(points: Floats, a: Ints, b: Ints) -> Floats:
    away: Floats = np.linalg.norm(points[a] - points[b], axis=1)
    return away


def _odd(order: Any) -> NDArray[bool_]:
    """(n,) whether permutations (n, k) are odd."""
    first, second = np.triu_indices(order.shape[1], 1)
    odd: NDArray[bool_] = (order[:, first] > order[:, second]).sum(axis=1) % 2 == 1
    return odd


def _first(kind: NDArray[int64], a: Ints, b: Ints, out: Ints) -> NDArray[bool_]:
    """Whether the quad that remains of a face with a, b inside and ``out`` outside is halved from a, else from b.

    The rule depends on the face alone, so both its tetrahedra agree. If a and b are both cubes' corners or both
    centers: from the one whose coordinates have an even sum. Else from the one that is not of the kind of ``out``.
    """
    alike = kind[a] // 2 == kind[b] // 2
    chosen: NDArray[bool_] = np.where(alike, kind[a] % 2 == 0, kind[a] // 2 != kind[out] // 2)
    return chosen


def _prism(top: Ints, bottom: Ints, wins: NDArray[bool_]) -> list[Ints]:
    """Three tetrahedra of each prism between triangles ``top`` and ``bottom`` (n, 3).

    ``wins`` (n, 3): for each of the quads over the sides 01, 02 and 12, whether its diagonal begins at the side's first
    top corner, else at the second.
    """
    one, two, three = wins.T.astype(np.int64)
    order = np.argsort(np.stack([2 - one - two, 1 + one - three, two + three], axis=1), axis=1)
    odd = _odd(order)
    p, q, r = np.take_along_axis(top, order, axis=1).T
    u, v, w = np.take_along_axis(bottom, order, axis=1).T
    return [_swapped(np.stack(four, axis=1), odd, 2, 3) for four in ((p, q, r, w), (p, q, w, v), (p, u, v, w))]
