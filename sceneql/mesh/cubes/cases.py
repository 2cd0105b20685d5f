"""The cases of marching cubes: how a trilinear interpolant's zero surface can meet a cube; by rule, packed into arrays.

A variant is a configuration of the corners' signs, a decision for each ambiguous face (Nielson & Hamann 1991), and
perhaps a tunnel: a tube between two of the curves on the faces, through which two regions are connected inside
(Chernyaev 1995). Every curve without a tube is filled by a disk.
"""

from __future__ import annotations

from functools import cache
from itertools import combinations
from typing import TYPE_CHECKING, NamedTuple

from sceneql.mesh.cubes.cube import EDGES, FACES, Loop, ambiguous, inside, loops, regions
from sceneql.mesh.cubes.patches import Triangle, band, fan, filled

if TYPE_CHECKING:
    from sceneql.frame import Ints

CENTERS = 12
"""From this number on a vertex of a triangle is not on an edge, but one of the cube's inner vertices."""


class Cases(NamedTuple):
    """The table as arrays of int32 (a tuple, so that kernels take it whole)."""

    first: Ints
    """(256,) first variant of a configuration, to which the bits of its faces' decisions are added."""
    faces: Ints
    """(256, 6, 4) corners of its ambiguous faces in turn, the first and third inside; -1 after the last face, -2 first
    where no face is ambiguous, but two regions may be connected inside."""
    tunnel: Ints
    """(v, 8, 8) the variant in which two corners' regions are connected inside; -1 where they are one already."""
    start: Ints
    """(v + 1,) where the triangles of a variant begin."""
    triangles: Ints
    """(t, 3) edges, or CENTERS plus the number of an inner vertex."""
    centers: Ints
    """(v,) number of inner vertices."""
    around: Ints
    """(v, 2, 12) edges around each inner vertex; -1 after the last."""
    config: Ints
    """(v,) configuration of a variant."""
    curves: Ints
    """(v, 4, 12) edges along each curve on the cube's faces, counterclockwise seen from outside; -1 after the last."""


class Variant(NamedTuple):
    """A variant: triangles, the polygons around its inner vertices, its configuration and its curves on the faces."""

    triangles: list[Triangle]
    polygons: list[Loop]
    config: int
    curves: list[Loop]


def variant(config: int, curves: list[Loop], tube: tuple[Loop, Loop] | None) -> Variant:
    """The variant with a disk in every curve, but a tube between two of them."""
    triangles: list[Triangle] = []
    polygons: list[Loop] = list(band(*tube)) if tube else []
    for curve in curves:
        if tube is None or curve not in tube:
            found = filled(curve)
            if found is None:
                polygons.append(curve)
            else:
                triangles += found
    for k, polygon in enumerate(polygons):
        triangles += fan(polygon, CENTERS + k)
    return Variant(triangles, polygons, config, curves)


def sides(config: int, curve: Loop, label: list[int]) -> dict[bool, int]:
    """The regions on the two sides of a curve: inside (True) and outside."""
    return {inside(config, at): label[at] for at in EDGES[curve[0]]}


def decisions(config: int) -> list[frozenset[int]]:
    """Sets of ambiguous faces with joined inside corners, in the order of the numbers whose bits they are."""
    faces = ambiguous(config)
    return [frozenset(f for k, f in enumerate(faces) if bits >> k & 1) for bits in range(1 << len(faces))]


@cache
def cases() -> Cases:
    """The table, built once."""
    import numpy as np

    variants: list[Variant] = []
    first = np.zeros(256, dtype=np.int32)
    faces = np.full((256, 6, 4), -1, dtype=np.int32)
    tubes: list[tuple[int, int, list[tuple[int, int]]]] = []
    for config in range(256):
        first[config] = len(variants)
        for k, face in enumerate(ambiguous(config)):
            corners = FACES[face]
            turn = 0 if inside(config, corners[0]) else 1
            faces[config, k] = corners[turn:] + corners[:turn]
        drawn = [(loops(config, joined), regions(config, joined)) for joined in decisions(config)]
        variants += [variant(config, curves, None) for curves, _ in drawn]
        for bits, (curves, label) in enumerate(drawn):
            for one, other in combinations(curves, 2):
                beside = sides(config, one, label), sides(config, other, label)
                for sign in (False, True):
                    if beside[0][not sign] == beside[1][not sign]:
                        pair = [
                            (a, b)
                            for a in range(8)
                            for b in range(8)
                            if {label[a], label[b]} == {beside[0][sign], beside[1][sign]} and label[a] != label[b]
                        ]
                        tubes.append((first[config] + bits, len(variants), pair))
                        variants.append(variant(config, curves, (one, other)))
        if not ambiguous(config) and any(len(curves) > 1 for curves, _ in drawn):
            faces[config, 0, 0] = -2
    return packed(first, faces, tubes, variants)


def packed(
    first: Ints, faces: Ints, tubes: list[tuple[int, int, list[tuple[int, int]]]], variants: list[Variant]
) -> Cases:
    """The table from a list of variants."""
    import numpy as np

    tunnel = np.full((len(variants), 8, 8), -1, dtype=np.int32)
    for plain, piped, pair in tubes:
        for a, b in pair:
            tunnel[plain, a, b] = piped
    around = np.full((len(variants), 2, 12), -1, dtype=np.int32)
    curves = np.full((len(variants), 4, 12), -1, dtype=np.int32)
    for v, found in enumerate(variants):
        for k, polygon in enumerate(found.polygons):
            around[v, k, : len(polygon)] = polygon
        for k, curve in enumerate(found.curves):
            curves[v, k, : len(curve)] = curve
    counts = [len(found.triangles) for found in variants]
    return Cases(
        first=first,
        faces=faces,
        tunnel=tunnel,
        start=np.cumsum([0, *counts], dtype=np.int32),
        triangles=np.array([triangle for found in variants for triangle in found.triangles], dtype=np.int32),
        centers=np.array([len(found.polygons) for found in variants], dtype=np.int32),
        around=around,
        config=np.array([found.config for found in variants], dtype=np.int32),
        curves=curves,
    )
