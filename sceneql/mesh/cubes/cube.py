"""The cube of marching cubes: corners, edges, faces, and the curves in which a surface cuts its faces.

Corner c lies at (c & 1, c >> 1 & 1, c >> 2). Edge 4 a + k is parallel to axis a; the bits of k are its place along the
axes a + 1 and a + 2 (modulo 3). Face 2 a + s is the side s of axis a.
"""

from __future__ import annotations

from functools import cache

Loop = tuple[int, ...]
Segment = tuple[int, int]


def corner(axis: int, along: int, k: int) -> int:
    """The corner at ``along`` on an axis, and at the bits of k on the other two."""
    return along << axis | (k & 1) << (axis + 1) % 3 | (k >> 1) << (axis + 2) % 3


EDGES = [(corner(axis, 0, k), corner(axis, 1, k)) for axis in range(3) for k in range(4)]
"""The two corners of each edge, the lower one along its axis first."""
EDGE_OF = {frozenset(ends): edge for edge, ends in enumerate(EDGES)}
FACES = [
    [corner(axis, side, k) for k in ((0, 1, 3, 2) if side else (0, 2, 3, 1))] for axis in range(3) for side in (0, 1)
]
"""Corners of each face, counterclockwise seen from outside the cube."""
FACES_OF = [{f for f, face in enumerate(FACES) if set(ends) <= set(face)} for ends in EDGES]


def inside(config: int, at: int) -> bool:
    """Whether a corner is inside; ``config`` has one bit a corner."""
    return bool(config >> at & 1)


@cache
def ambiguous(config: int) -> tuple[int, ...]:
    """Faces whose corners alternate: two opposite ones inside, two outside."""

    def alternates(face: list[int]) -> bool:
        signs = [inside(config, at) for at in face]
        return signs[0] == signs[2] != signs[1] == signs[3]

    return tuple(f for f, face in enumerate(FACES) if alternates(face))


def segments(config: int, face: int, joined: bool) -> list[Segment]:
    """Curves on a face as pairs of edges, with the inside to the left as seen from outside the cube.

    On an ambiguous face they separate the two inside corners, or with ``joined`` the two outside ones.
    """
    corners = FACES[face]
    enter: list[Segment] = []  # (place on the face's border, edge)
    leave: list[Segment] = []
    for k in range(4):
        here, there = corners[k], corners[(k + 1) % 4]
        if inside(config, here) != inside(config, there):
            (enter if inside(config, there) else leave).append((k, EDGE_OF[frozenset((here, there))]))
    found = []
    for k, edge in enter:
        order = sorted(leave, key=lambda other: (other[0] - k) % 4)
        if order:
            found.append((edge, order[-1 if joined else 0][1]))
    return found


def loops(config: int, joined: frozenset[int]) -> list[Loop]:
    """Closed curves, as lists of edges, counterclockwise seen from outside the solid."""
    after = dict(pair for face in range(6) for pair in segments(config, face, face in joined))
    found = []
    while after:
        start, edge = after.popitem()
        loop = [start]
        while edge != start:
            loop.append(edge)
            edge = after.pop(edge)
        found.append(tuple(loop))
    return sorted(found)


def regions(config: int, joined: frozenset[int]) -> list[int]:
    """For each corner the number of its region: corners connected on the cube's faces."""
    label = list(range(8))

    def merge(first: int, second: int) -> None:
        old, new = label[first], label[second]
        label[:] = [new if number == old else number for number in label]

    for first, second in EDGES:
        if inside(config, first) == inside(config, second):
            merge(first, second)
    for face in ambiguous(config):
        corners = FACES[face]
        first = 0 if inside(config, corners[0]) == (face in joined) else 1
        merge(corners[first], corners[first + 2])
    return label
