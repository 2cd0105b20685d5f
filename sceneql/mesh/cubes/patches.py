"""Triangulations of a cube's closed curves that have no chord in a face, since the neighboring cube might have it too.

Each edge of the mesh then belongs to exactly two triangles: a segment on a face to one of each cube, a chord to two of
one cube. A curve without such a triangulation gets an inner vertex in its middle.
"""

from __future__ import annotations

import math
from functools import cache
from itertools import product

from sceneql.mesh.cubes.cube import EDGES, FACES_OF, Loop

Triangle = tuple[int, int, int]
INFINITY = math.inf


@cache
def middle(edge: int) -> tuple[float, float, float]:
    """Middle of an edge of the unit cube."""
    first, second = EDGES[edge]
    x, y, z = (0.5 * ((first >> axis & 1) + (second >> axis & 1)) for axis in range(3))
    return x, y, z


def chord(first: int, second: int) -> float:
    """Length of a chord between the middles of two edges; infinite if it lies in a face."""
    if FACES_OF[first] & FACES_OF[second]:
        return INFINITY
    return math.dist(middle(first), middle(second))


def filled(loop: Loop) -> list[Triangle] | None:
    """The triangulation of a curve with the least total length of chords; None if each has a chord in a face."""

    @cache
    def best(i: int, j: int) -> tuple[float, tuple[Triangle, ...]]:
        """Best triangulation of the polygon loop[i..j], without the length of its side from j to i."""
        if j == i + 1:
            return 0.0, ()
        choices = []
        for k in range(i + 1, j):
            left, right = best(i, k), best(k, j)
            cost = left[0] + right[0]
            cost += chord(loop[i], loop[k]) if k > i + 1 else 0.0
            cost += chord(loop[k], loop[j]) if k < j - 1 else 0.0
            choices.append((cost, (*left[1], (loop[i], loop[k], loop[j]), *right[1])))
        return min(choices)

    cost, triangles = best(0, len(loop) - 1)
    return list(triangles) if cost < INFINITY else None


def fan(polygon: Loop, center: int) -> list[Triangle]:
    """Triangles from a center vertex to the sides of a polygon."""
    return [(polygon[k - 1], polygon[k], center) for k in range(len(polygon))]


def band(first: Loop, second: Loop) -> tuple[Loop, Loop]:
    """Two polygons that form a tube between two curves, cut open along two chords that lie in no face.

    The two chords minimize the sum of their lengths and of how unevenly they halve the curves.
    """
    n, m = len(first), len(second)
    bridges = [(i, j) for i, j in product(range(n), range(m)) if chord(first[i], second[j]) < INFINITY]

    def cost(one: tuple[int, int], other: tuple[int, int]) -> float:
        uneven = abs(2 * ((other[0] - one[0]) % n) - n) / n + abs(2 * ((one[1] - other[1]) % m) - m) / m
        return uneven + chord(first[one[0]], second[one[1]]) + chord(first[other[0]], second[other[1]])

    pairs = [(cost(p, q), p, q) for p, q in product(bridges, bridges) if p[0] != q[0] and p[1] != q[1]]
    _, (i, j), (k, l) = min(pairs)
    return (*arc(first, i, k), *arc(second, l, j)), (*arc(first, k, i), *arc(second, j, l))


def arc(loop: Loop, start: int, stop: int) -> Loop:
    """The part of a curve from one index to another, both included."""
    return tuple(loop[(start + k) % len(loop)] for k in range((stop - start) % len(loop) + 1))
