"""Marching cubes on values at a grid's nodes, with the trilinear interpolant's topology (on tapes: mesh.cubes)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.grids.maps.iso_kernels import variants
from sceneql.grids.maps.sheets import Sheet
from sceneql.mesh.cubes.cases import CENTERS, cases

if TYPE_CHECKING:
    from sceneql.frame import Floats, Ints


def iso_sheet(axes: tuple[Floats, Floats, Floats], values: Floats) -> Sheet:
    """The surface between negative values and the others, facing the latter; without normals.

    ``axes``: positions [m] of the nodes along x, y, z; ``values`` (nz, ny, nx). Where the interpolant has a saddle in a
    cube, inner vertices are placed at the means of the vertices around them (Lorensen & Cline 1987; Chernyaev 1995).
    """
    table = cases()
    negative = values < 0.0
    config = np.zeros(tuple(n - 1 for n in values.shape), dtype=np.int32)
    corners = [(slice(c >> 2, -1 + (c >> 2) or None), slice(c >> 1 & 1, -1 + (c >> 1 & 1) or None),
                slice(c & 1, -1 + (c & 1) or None)) for c in range(8)]  # fmt: skip
    for c, where in enumerate(corners):
        config |= negative[where].astype(np.int32) << c
    cubes = np.argwhere((config > 0) & (config < 255))
    k, j, i = cubes.T
    config = config[k, j, i]
    around = np.stack([values[k + (c >> 2), j + (c >> 1 & 1), i + (c & 1)] for c in range(8)], axis=1)
    variant = np.empty(len(cubes), dtype=np.int32)
    variants(around, config, table.first, table.faces, table.tunnel, variant)
    places, numbers = _on_edges(axes, values, negative)
    edges = np.stack([_edge(numbers, cubes, edge) for edge in range(CENTERS)], axis=1)
    own_at = len(places) + np.concatenate([[0], np.cumsum(table.centers[variant])])
    owners = np.repeat(np.arange(len(cubes)), table.centers[variant])
    rings = table.around[variant[owners], np.arange(len(owners)) - (own_at[owners] - len(places))]
    members = np.take_along_axis(edges[owners], np.maximum(rings, 0), axis=1)
    weights = (rings >= 0)[..., None]
    middles = (places[members] * weights).sum(axis=1) / np.maximum(weights.sum(axis=1), 1)
    count = table.start[variant + 1] - table.start[variant]
    which = np.repeat(np.arange(len(cubes)), count)
    rows = np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count) + table.start[variant][which]
    corner = table.triangles[rows]
    on_edge = np.take_along_axis(edges[which], np.minimum(corner, CENTERS - 1), axis=1)
    triangles = np.where(corner < CENTERS, on_edge, own_at[which][:, None] + corner - CENTERS)
    return Sheet(np.concatenate([places, middles]), triangles.astype(np.int32))


def _on_edges(axes: tuple[Floats, Floats, Floats], values: Floats, negative: Any) -> tuple[Floats, list[Ints]]:
    """Crossings (n, 3) [m] of grid edges, and for each axis the number of each edge's vertex, -1 for none."""
    places: list[Floats] = []
    numbers = []
    total = 0
    for axis in range(3):
        low, high = [slice(None)] * 3, [slice(None)] * 3
        low[2 - axis], high[2 - axis] = slice(None, -1), slice(1, None)
        crossed = negative[tuple(low)] != negative[tuple(high)]
        at = np.argwhere(crossed)
        a, b = values[tuple(low)][crossed], values[tuple(high)][crossed]
        place = np.stack([axes[0][at[:, 2]], axes[1][at[:, 1]], axes[2][at[:, 0]]], axis=1)
        nodes, index = axes[axis], at[:, 2 - axis]
        place[:, axis] += a / (a - b) * (nodes[index + 1] - nodes[index])
        number = np.full(crossed.shape, -1, dtype=np.int32)
        number[crossed] = total + np.arange(len(at))
        total += len(at)
        places.append(place)
        numbers.append(number)
    return np.concatenate(places), numbers


def _edge(numbers: list[Ints], cubes: Any, edge: int) -> Ints:
    """Number (m,) of the vertex on an edge (mesh.cubes.cube) of each cube (m, 3), whose columns are z, y, x."""
    axis = edge >> 2
    shift = np.zeros(3, dtype=np.int64)
    shift[2 - (axis + 1) % 3], shift[2 - (axis + 2) % 3] = edge & 1, edge >> 1 & 1
    found: Ints = numbers[axis][tuple((cubes + shift).T)]
    return found
