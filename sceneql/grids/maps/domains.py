"""Surfaces on which a field is drawn: a 2D domain; sections of a 3D domain, or its surface, whole or cut open."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.grids.maps.kept import Kept
from sceneql.grids.maps.seen import level_of
from sceneql.grids.maps.sheets import Sheet, Side, flat_normals, joined, kept, lattice
from sceneql.shapes.placement import unit_vector
from sceneql.shapes.solid import triple

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.grids.maps.seen import Seen
    from sceneql.grids.medium import FieldLayout
    from sceneql.kinds import Moment, Ref

FINEST = 4
"""Most steps of a sheet within a cell."""
MOST = 25_000
"""Approximate largest number of parallelograms of a flat sheet."""
CREASE = 0.75
"""Cosine of 41 degrees: a larger angle between a facet's and the surface's normal marks a sharp edge."""

Plane = tuple[Any, Any]
"""A point (3,) and a unit normal (3,)."""
Numbers = tuple[tuple[tuple[float, ...], tuple[float, ...]], ...]
"""Point and normal of several planes, hashable."""


_sheets: Kept[Sheet] = Kept()


def sheet_of(field: Seen, moment: Moment, cut: Numbers, surface: bool) -> Sheet:
    """The sheet of a 2D domain; of a 3D one its surface, cut open by planes, or without ``surface`` their sections."""

    def make() -> Sheet:
        planes = [(np.array(through), unit_vector(normal)) for through, normal in cut]
        return _made(field.layout, level_of(field, moment), planes, surface)

    return _sheets.get(field.model, (field.layout.shape, cut, surface), make)


def _made(layout: FieldLayout, level: Any, planes: list[Plane], surface: bool) -> Sheet:
    if layout.shape[2] == 1:
        return flat(layout, level)
    sections = [section(layout, level, plane) for plane in planes]
    if not surface:
        return joined(sections)
    whole = outside(layout, level)
    return cut_open(whole, sections, planes) if planes else whole


def sides(layout: FieldLayout) -> Floats:
    """Lengths (3,) [m] of the grid's sides."""
    extent: Floats = np.array(layout.shape) * np.array(layout.spacing)
    return extent


def flat(layout: FieldLayout, level: Any) -> Sheet:
    """The sheet of a 2D domain at z = 0, facing +z, clipped at the domain's boundary."""
    width, height, _ = sides(layout)
    nx, ny, _ = layout.shape
    sheet = lattice((*layout.low[:2], 0.0), (width, 0.0, 0.0), (0.0, height, 0.0), _steps(nx, ny))
    return sheet if level is None else kept(sheet, level.values)


def _steps(nx: float, ny: float) -> tuple[int, int]:
    """Numbers of steps of a sheet over nx by ny cells: up to FINEST a cell, about MOST in all."""
    fine = min(FINEST, (MOST / (nx * ny)) ** 0.5)
    return max(1, round(nx * fine)), max(1, round(ny * fine))


def section(layout: FieldLayout, level: Any, plane: Plane) -> Sheet:
    """The section of a 3D domain by a plane, facing along the plane's normal."""
    through, normal = plane
    low, extent = np.array(layout.low), sides(layout)
    across = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    across /= np.linalg.norm(across)
    up = np.cross(normal, across)
    corners = low + np.array([[k & 1, k >> 1 & 1, k >> 2] for k in range(8)]) * extent - through
    s, t = corners @ across, corners @ up
    spacing = min(layout.spacing)
    steps = _steps(float(np.ptp(s)) / spacing, float(np.ptp(t)) / spacing)
    sheet = lattice(through + s.min() * across + t.min() * up, np.ptp(s) * across, np.ptp(t) * up, steps)
    room = 1e-12 * float(extent.max())
    for axis in np.eye(3):
        sheet = kept(sheet, _before((low - room, -axis)))
        sheet = kept(sheet, _before((low + extent + room, axis)))
    return sheet if level is None else kept(sheet, level.values)


def outside(layout: FieldLayout, level: Any) -> Sheet:
    """The surface of a 3D domain, facing outwards."""
    if level is None:
        return _box(layout)
    low = np.array(layout.low)
    return around(level, low, low + sides(layout), 0.5 * min(layout.spacing))


def around(level: Any, low: Floats, high: Floats, cell: float) -> Sheet:
    """The surface of a level set in the box low..high, from cells of side ``cell`` [m].

    By dual contouring, with sharp edges, where the level set is an object's field (TapeLevel), else by marching cubes.
    """
    if hasattr(level, "tape"):
        from sceneql.mesh.dual.sharp import polygonise_sharp

        found = polygonise_sharp(level.tape, triple(low), triple(high), cell)
        return creased(Sheet(found.vertices, found.triangles, found.normals))
    from sceneql.bodies.spring_look import vertex_normals
    from sceneql.grids.maps.iso import iso_sheet

    axes = [np.linspace(a, b, int(np.ceil((b - a) / cell)) + 1) for a, b in zip(low, high, strict=True)]
    z, y, x = np.meshgrid(axes[2], axes[1], axes[0], indexing="ij")
    values = level.values(np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)).reshape(x.shape)
    rough = iso_sheet((axes[0], axes[1], axes[2]), values)
    return creased(Sheet(rough.vertices, rough.triangles, vertex_normals(rough.vertices, rough.triangles)))


def skin(ref: Ref, layout: FieldLayout, moment: Moment) -> Sheet:
    """The surface of an object at a moment. Raises TypeError or ValueError for one without an inside, or a 2D one."""
    from sceneql.grids.domain.domain import inside

    level, low, high, flat = inside(ref, False, moment)
    if flat:
        raise ValueError(f"'{ref.name}' is flat: it has no surface")
    cell = 0.5 * min(*layout.spacing, float((high - low).max()) / 24)
    return around(level, low - 0.5 * cell, high + 0.5 * cell, cell)


def creased(sheet: Sheet) -> Sheet:
    """The sheet with separate vertices for each triangle's corners.

    A corner's normal is the surface's, or beside a sharp edge (CREASE) the facet's.
    """
    own = flat_normals(sheet)
    if sheet.normals is None or own.normals is None:
        return own
    smooth = sheet.normals[sheet.triangles].reshape(-1, 3)
    bent = (smooth * own.normals).sum(axis=1) < CREASE
    return Sheet(own.vertices, own.triangles, np.where(bent[:, None], own.normals, smooth))


def _box(layout: FieldLayout) -> Sheet:
    """The six faces of the grid's box, as one sheet."""
    low, extent = np.array(layout.low), sides(layout)
    faces = []
    for axis in range(3):
        one, other = (axis + 1) % 3, (axis + 2) % 3
        along, across = np.eye(3)[one] * extent, np.eye(3)[other] * extent
        steps = _steps(layout.shape[one], layout.shape[other])
        far = low + np.eye(3)[axis] * extent
        faces += [lattice(far, along, across, steps), lattice(low, across, along, steps[::-1])]
    return flat_normals(joined(faces))


def cut_open(whole: Sheet, sections: Sequence[Sheet], planes: Sequence[Plane]) -> Sheet:
    """A surface without the part that lies in front of all planes at once, closed by the planes' sections.

    ``sections``: the section by each plane.
    """
    parts, rest = [], whole
    for plane in planes:
        parts.append(kept(rest, _before(plane)))
        rest = kept(rest, _before((plane[0], -plane[1])))
    for k, sheet in enumerate(sections):
        for other, plane in enumerate(planes):
            if other != k:
                sheet = kept(sheet, _before((plane[0], -plane[1])))
        parts.append(flat_normals(sheet))
    return joined([part for part in parts if len(part.triangles)])


def _before(plane: Plane) -> Side:
    """A function from points (k, 3) to their signed distances (k,) [m] from a plane, positive in front."""
    through, normal = plane
    return lambda points: (points - through) @ normal
