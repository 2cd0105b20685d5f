"""Triangles inside an outline: isosurface stuffing in the plane, on a lattice of equilateral triangles.

The planar form of Labelle & Shewchuk 2007 (Isosurface stuffing): if the outline cuts a side of the lattice near one of
its ends, that end moves to the cut; triangles that the outline still crosses are cut. Imports numpy.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from sceneql.frame import Floats, Ints

NEAR = 0.4
"""Distance of a cut from an end, relative to the side, within which the end moves to the cut."""
OUT, ON, IN = 0, 1, 2
ROOTS, SLOW = 80, 12
"""Largest number of root-finding steps, and number of steps after which every second one bisects."""
TOUCHING = 1e-9
"""Distance of the lattice from points on the outline, relative to the spacing."""

Values = Callable[["Floats"], "Floats"]
"""Level: values (k,) at points (k, 2) [m], negative inside."""


@dataclass(frozen=True, slots=True, eq=False)
class Triangles:
    """Triangle mesh in the plane."""

    points: Floats
    """(n, 2) [m]: vertices."""
    triangles: Ints
    """(t, 3): indices of vertices, counterclockwise."""


def stuffed(low: Floats, high: Floats, spacing: float, values: Values) -> Triangles:
    """Triangles with sides of ``spacing`` [m] inside a level in a box; none if no lattice point lies inside."""
    rise = 0.5 * 3.0**0.5 * spacing
    counts = np.ceil((high - low) / (spacing, rise)).astype(np.int64) + 4
    middle = 0.5 * (low + high)
    j, i = (index.ravel() for index in np.indices((counts[1], counts[0])))
    points = np.stack([(i + 0.5 * (j % 2)) * spacing, j * rise], axis=1)
    points += middle - 0.5 * (counts - 1) * (spacing, rise)
    triangles = _lattice(counts)
    inside = values(points) < 0.0
    triangles = triangles[inside[triangles].any(axis=1)]
    used, triangles = np.unique(triangles, return_inverse=True)
    points, state, triangles = points[used], np.where(inside[used], IN, OUT), triangles.reshape(-1, 3)
    ends = sides_of(triangles)[0]
    ends = ends[state[ends[:, 0]] != state[ends[:, 1]]]
    ends = np.where((state[ends[:, 0]] == IN)[:, None], ends, ends[:, ::-1])
    share = crossing(values, points[ends[:, 0]], points[ends[:, 1]])
    surface = points[ends[:, 0]] + share[:, None] * (points[ends[:, 1]] - points[ends[:, 0]])
    vertex, away = ends.T.ravel(), np.concatenate([share, 1.0 - share])
    close = np.flatnonzero(away < NEAR)
    order = close[np.argsort(-away[close], kind="stable")]
    points[vertex[order]] = surface[order % max(len(ends), 1)]  # the last assignment stays: the nearest cut
    state[vertex[order]] = ON
    return _cut(points, state, triangles, ends, surface)


def crossing(values: Values, inner: Floats, outer: Floats, within: float = 4e-16) -> Floats:
    """Fractions (k,) at which segments from points inside to points outside, (k, 2) each, cross the outline.

    Regula falsi with the Illinois rule (Dowell & Jarratt 1971) to the tolerance ``within``, with bisection if slow.
    """
    low, high = np.zeros(len(inner)), np.ones(len(inner))
    below, above = values(inner), values(outer)
    share, side = np.full(len(inner), np.inf), np.zeros(len(inner))
    for step in range(ROOTS if len(inner) else 0):
        rise = above - below
        last = share
        share = np.where(rise > 0.0, low - below * (high - low) / np.where(rise > 0.0, rise, 1.0), 0.5 * (low + high))
        if step > SLOW and step % 2:
            share = 0.5 * (low + high)
        share = np.clip(share, low, high)
        if np.minimum(np.abs(share - last), high - low).max() < within:
            break
        found = values(inner + share[:, None] * (outer - inner))
        held = found < 0.0
        low, high = np.where(held, share, low), np.where(held, high, share)
        again = np.where(held, 1.0, -1.0) == side
        below = np.where(held, found, np.where(again, 0.5 * below, below))
        above = np.where(held, np.where(again, 0.5 * above, above), found)
        side = np.where(held, 1.0, -1.0)
    return share


def sides_of(triangles: Any) -> tuple[Any, Any]:
    """Sides (s, 2), each once, lower end first; and (t, 3): the side opposite to each corner."""
    ends = np.sort(triangles[:, [[1, 2], [2, 0], [0, 1]]].astype(np.int64), axis=2).reshape(-1, 2)
    size = int(ends.max(initial=0)) + 1
    keys, which = np.unique(ends @ (size, 1), return_inverse=True)
    return np.stack(np.divmod(keys, size), axis=1), which.reshape(-1, 3)


def _lattice(counts: Any) -> Any:
    """Triangles (t, 3) of a lattice of points, x fastest, whose odd rows are shifted by half a side."""
    nx, ny = counts.tolist()
    j, i = (index.ravel() for index in np.indices((ny - 1, nx - 1)))
    a = i + nx * j
    b, c, d = a + 1, a + nx, a + nx + 1
    even = (j % 2 == 0)[:, None]
    first = np.where(even, np.stack([a, b, c], axis=1), np.stack([a, d, c], axis=1))
    second = np.where(even, np.stack([b, d, c], axis=1), np.stack([a, b, d], axis=1))
    return np.concatenate([first, second])


def _cut(points: Floats, state: Any, triangles: Any, ends: Any, surface: Floats) -> Triangles:
    """Triangles cut to their parts inside; ``surface`` (k, 2): points at which sides ``ends`` (k, 2) cross."""
    size = len(points)
    order = np.argsort(ends @ (size, 1))
    keys = (ends @ (size, 1))[order]
    points = np.concatenate([points, surface[order]])

    def meet(inner: Any, outer: Any) -> Any:
        """Vertices at which sides leave: the outer end if it is ON, else the crossing."""
        return np.where(state[outer] == ON, outer, size + np.searchsorted(keys, inner * size + outer))

    states = state[triangles]
    inner, outer = (states == IN).sum(axis=1), (states == OUT).sum(axis=1)
    pieces = [triangles[(outer == 0) & (inner > 0)]]
    lone = _turned(triangles, states == IN)[(inner == 1) & (outer > 0)]
    a, b, c = lone.T
    pieces.append(np.stack([a, meet(a, b), meet(a, c)], axis=1))
    o, a, b = _turned(triangles, states == OUT)[(inner == 2) & (outer == 1)].T
    from_a, from_b = meet(a, o), meet(b, o)
    first = np.linalg.norm(points[a] - points[from_b], axis=1) < np.linalg.norm(points[b] - points[from_a], axis=1)
    pieces.append(np.stack([a, b, np.where(first, from_b, from_a)], axis=1))
    pieces.append(np.stack([np.where(first, a, b), from_b, from_a], axis=1))
    found = np.concatenate(pieces)
    used, found = np.unique(found, return_inverse=True)
    return Triangles(points[used], found.reshape(-1, 3).astype(np.int32))


def _turned(triangles: Any, lone: Any) -> Any:
    """Triangles (t, 3) rotated so that the first marked corner comes first."""
    first = np.argmax(lone, axis=1)
    return np.take_along_axis(triangles, (first[:, None] + np.arange(3)) % 3, axis=1)
