"""Mesh of a model's domain, which is a box or the inside of an object of the script. Imports numpy."""

from __future__ import annotations

from dataclasses import replace
from itertools import permutations
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from sceneql.bodies.elements.element import elements
from sceneql.bodies.elements.filled import filled
from sceneql.bodies.filling.tetrahedra import edges
from sceneql.failure import LimitRefused
from sceneql.galerkin.field_mesh import FieldMesh
from sceneql.galerkin.plane_mesh import TooCoarse, flat_mesh, outlined
from sceneql.galerkin.plane_quality import outer_sides
from sceneql.galerkin.simplex import Simplex
from sceneql.grids.domain.cells import SIDES, counts, periodic_axes
from sceneql.grids.domain.domain import inside
from sceneql.island.memory import bounded
from sceneql.island.start import Start
from sceneql.kinds import Exceeds
from sceneql.quantities.diagnostic import Diagnostic, ScriptError

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.grids.medium import Boundary, Medium
    from sceneql.kinds import Moment
    from sceneql.system import Assembly

DEGREES = {"p1": 1, "p2": 2}
"""Polynomial degree of elements, by name."""
BYTES = {(2, 1): 600, (2, 2): 2500, (3, 1): 1500, (3, 2): 9000}
"""Memory per element [bytes] by dimension and degree, with its share of an implicit solver's matrix."""
ON = 1e-9
"""Distance from a side of the box, relative to its length, within which a point lies on it."""


def mesh_of(model: Medium, degree: int, boundary: Boundary, assembly: Assembly) -> FieldMesh:
    """Mesh of a model's domain. Raises ScriptError for a domain without a mesh, LimitRefused for too many elements."""
    try:
        if model.size is not None:
            return _box(model, degree, boundary)
        return _object(model, degree, assembly)
    except Exceeds as error:
        raise LimitRefused(str(error), assembly.line(), "take a larger `cell`") from None


def _object(model: Medium, degree: int, assembly: Assembly) -> FieldMesh:
    ref = model.domain
    assert ref is not None
    try:
        level, low, high, flat = inside(ref, model.flat, cast("Moment", Start(assembly)))
    except (TypeError, ValueError) as error:
        message = f"'{ref.name}' cannot be a domain: {error}"
        raise ScriptError([Diagnostic("no-domain", message, ref.span)]) from error
    element = Simplex(2 if flat else 3, degree)
    if flat:
        count = 2.31 * float(np.prod(((high - low)[:2]) / model.cell))
        bounded(count, "triangles", BYTES[2, degree])
        try:
            found = outlined(low, high, model.cell, level, element)
        except TooCoarse as error:
            message = f"'{ref.name}' cannot be cut into triangles of {model.cell:g} m: {error}"
            raise ScriptError([Diagnostic("no-mesh", message, ref.span, "take a smaller `cell`")]) from None
        if found is None:
            message = f"no triangle of {model.cell:g} m lies inside '{ref.name}'"
            raise ScriptError([Diagnostic("no-mesh", message, ref.span, "take a smaller `cell`")])
        return found
    try:
        made = filled(ref, model.cell, elements()[f"p{degree}"], {}, assembly)
    except ScriptError as error:
        told = [replace(one, help=one.help or "the spacing is that of `cell`") for one in error.diagnostics]
        raise ScriptError(told) from None
    four = made.cells[:, :4].astype(np.int64)
    own = _outer(four)
    names = getattr(level, "names", (ref.name,))
    cells = made.cells.astype(np.int64)
    return FieldMesh(element, made.points, cells, cells, len(made.points), own, np.zeros(len(own), int), names)


def _outer(four: Any) -> Any:
    """(f, 2): tetrahedron and opposite corner of each face that belongs to one tetrahedron alone."""
    corners = np.sort(four[:, [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]]], axis=2).reshape(-1, 3)
    size = int(four.max()) + 1
    _, first, count = np.unique((corners @ (size, 1, 0)) * size + corners[:, 2], return_index=True, return_counts=True)
    alone = np.sort(first[count == 1])
    return np.stack(np.divmod(alone, 4), axis=1)


def _box(model: Medium, degree: int, boundary: Boundary) -> FieldMesh:
    assert model.size is not None
    sides = np.array(model.size)
    shape = counts(model.size, model.cell)
    element = Simplex(len(sides), degree)
    bounded((2.0 if len(sides) == 2 else 6.0) * float(np.prod(shape)), "elements", BYTES[len(sides), degree])
    low = np.array(model.corner or (0.0,) * len(sides))
    made = _flat_box if len(sides) == 2 else _deep_box
    mesh = made(shape, low, sides, element)
    middles = mesh.points[mesh.cells[mesh.faces[:, 0][:, None], _corners(element)[mesh.faces[:, 1]]]].mean(axis=1)
    share = (middles - low) / sides
    pieces = np.argmin(np.stack([share, 1.0 - share], axis=2).reshape(len(middles), -1), axis=1)
    names = SIDES[: 2 * len(sides)]
    return _joined(mesh, pieces, names, periodic_axes(boundary), low, sides)


def _corners(element: Simplex) -> Any:
    return np.array(element.sides)


def _joined(
    mesh: FieldMesh, pieces: Any, names: tuple[str, ...], axes: set[int], low: Floats, sides: Floats
) -> FieldMesh:
    """Mesh of a box with ``pieces``, ``names``, and one unknown for opposite nodes of periodic sides."""
    if not axes:
        return replace(mesh, pieces=pieces, names=names)
    share = (mesh.points - low) / sides
    for axis in axes:
        share[:, axis] = np.where(share[:, axis] > 1.0 - ON, 0.0, share[:, axis])
    _, number = np.unique(np.round(share, 9) + 0.0, axis=0, return_inverse=True)
    number = number.ravel()
    inner = ~np.isin(pieces // 2, sorted(axes))
    return replace(
        mesh,
        unknowns=number[mesh.cells],
        count=int(number.max()) + 1,
        faces=mesh.faces[inner],
        pieces=pieces[inner],
        names=names,
    )


def _flat_box(shape: tuple[int, ...], low: Floats, sides: Floats, element: Simplex) -> FieldMesh:
    """Mesh with two triangles per cell; the diagonal's direction alternates from cell to cell."""
    nx, ny = shape[:2]
    j, i = (index.ravel() for index in np.indices((ny + 1, nx + 1)))
    points = low + np.stack([i / nx, j / ny], axis=1) * sides
    j, i = (index.ravel() for index in np.indices((ny, nx)))
    a = i + (nx + 1) * j
    b, c, d = a + 1, a + nx + 2, a + nx + 1
    even = ((i + j) % 2 == 0)[:, None]
    first = np.where(even, np.stack([a, b, c], axis=1), np.stack([a, b, d], axis=1))
    second = np.where(even, np.stack([a, c, d], axis=1), np.stack([b, c, d], axis=1))
    triangles = np.concatenate([first, second])
    own, _ = outer_sides(triangles)
    return flat_mesh(points, triangles, element, np.zeros(len(own), int), ())


def _deep_box(shape: tuple[int, ...], low: Floats, sides: Floats, element: Simplex) -> FieldMesh:
    """Mesh with six tetrahedra per cell (Kuhn 1960)."""
    nx, ny, nz = shape
    k, j, i = (index.ravel() for index in np.indices((nz + 1, ny + 1, nx + 1)))
    points = low + np.stack([i / nx, j / ny, k / nz], axis=1) * sides
    strides = np.array([1, nx + 1, (nx + 1) * (ny + 1)])
    k, j, i = (index.ravel() for index in np.indices((nz, ny, nx)))
    first = np.stack([i, j, k], axis=1) @ strides
    found = []
    for order in permutations(range(3)):
        odd = order in ((0, 2, 1), (1, 0, 2), (2, 1, 0))
        path = np.cumsum([0, *strides[list(order)]])
        found.append(first[:, None] + (path[[0, 2, 1, 3]] if odd else path))
    cells = four = np.concatenate(found)
    if element.degree == 2:
        ends, which = edges(four)
        points = np.concatenate([points, 0.5 * (points[ends[:, 0]] + points[ends[:, 1]])])
        cells = np.concatenate([four, len(points) - len(ends) + which], axis=1)
    own = _outer(four)
    return FieldMesh(element, points, cells, cells, len(points), own, np.zeros(len(own), int), ())
