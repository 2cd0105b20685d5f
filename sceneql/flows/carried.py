"""Fields advected by a solved flow in the same box, and their action on it (buoyancy)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.flows.edges import BEGIN, timed
from sceneql.flows.layout import AREAS, LED, SEEPING
from sceneql.flows.staggered import Faces
from sceneql.grids.at_points import at_points
from sceneql.grids.carrying import KERNELS as CARRY
from sceneql.grids.carrying import LIMITERS
from sceneql.grids.cell_program import over_faces
from sceneql.grids.domain.boundary import shares
from sceneql.grids.domain.domain import cells_of
from sceneql.quantities.derivative import components
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.expression import Link

if TYPE_CHECKING:
    from sceneql.flows.parts import Buoyancy
    from sceneql.frame import Floats
    from sceneql.grids.domain.cells import Cells
    from sceneql.grids.drift import Drift
    from sceneql.grids.medium import Boundary
    from sceneql.grids.spreading_medium import SpreadingMedium
    from sceneql.kinds import Value
    from sceneql.system import Assembly, Flow, Grid

THROUGH = "sceneql.flows.carrying_kernels:through"
PAST = "sceneql.flows.carrying_past_kernels"
EVEN_OUT = "sceneql.flows.carrying_kernels:even_out"
LIFT = "sceneql.flows.carrying_kernels:lift"
SAME = 1e-9
"""Difference of two boxes, in cells, that counts as rounding."""


def carry(model: SpreadingMedium, drift: Drift, fields: Sequence[tuple[Grid, Boundary]], assembly: Assembly) -> None:
    """Add the advection of a model's fields by the flow that its drift names.

    Inflow through the boundary brings in the field's `value` there, else 0. Raises ScriptError for a model that is no
    flow, or a flow on other cells.
    """
    assert drift.by is not None
    flow = assembly.flow_of(drift.by.name)
    if flow is None:
        if getattr(assembly.object(drift.by), "flows", False):
            return  # its own assembly has failed
        text = f"'{drift.by.name}' is no flow"
        raise ScriptError([Diagnostic("no-flow", text, drift.by.span, "name a model `flow`")])
    cells = cells_of(model, assembly)
    periodic = fields[0][0].cells.periodic
    _must_agree(cells.shape, cells.low, cells.spacing, periodic, flow, drift.by.name, drift.by.span)
    strength = assembly.floats([1.0])
    first = flow.components[0].at
    areas = [flow.ints[AREAS] + one.at - first for one in flow.components]
    opened = assembly.numbers(flow.ints[AREAS])
    faces = Faces(cells, periodic)
    n = len(cells.volumes)
    flows = [assembly.floats(np.zeros(n)) for _ in flow.areas]
    own_skin = model.domain is not None
    if own_skin:
        _must_be_closed(flow, faces, opened, assembly.object(drift.by), drift)
        areas = [assembly.floats(one) for one in _between(cells, faces, opened)]
    for grid, boundary in fields:
        mine, beside, sides = _boundary(flow, faces, own_skin)
        values = assembly.floats([]) if own_skin else _values(boundary, cells, mine, grid.at, assembly)
        brought, leaving = assembly.floats(np.zeros(n)), assembly.floats(np.zeros(n))
        known = assembly.floats(opened[beside - first]), values, len(mine)
        if flow.ints[LED] > 0:
            _past(grid, flow, areas, assembly)
        if flow.fractions is not None and not own_skin:
            _cut(grid, flow.fractions, faces, opened, drift, assembly)
        starts = [one.at for one in flow.components]
        ints = (
            *(*flows, flows[0])[:3], *(*areas, areas[0])[:3], brought, leaving, *known,
            *cells.boundary.cells[mine].tolist(), *beside.tolist(), *sides.tolist(),
            *cells.shape, *map(int, periodic), *(*starts, 0)[:3], len(starts),
        )  # fmt: skip
        assembly.term("internal", THROUGH, ints)
        if own_skin:
            assembly.term("internal", EVEN_OUT, (*(*flows, flows[0])[:3], leaving, *cells.shape))
        exchange = (brought, leaving, brought, leaving)
        assembly.term(
            "close",
            CARRY,
            (
                grid.at, *cells.shape, grid.volumes_at, grid.cells.insides_at, *(*flows, flows[0])[:3],
                *map(int, periodic), LIMITERS[drift.limiter], strength, *exchange, grid.at + n,
            ),
        )  # fmt: skip


def _past(grid: Grid, flow: Flow, areas: Sequence[int], assembly: Assembly) -> None:
    """Add the terms that cut a field's cells by moving solids as they cut the flow's."""
    n, numbers = int(np.prod(flow.cells.shape)), assembly.numbers()
    uncut = numbers[grid.cells.insides_at : grid.cells.insides_at + n]
    whole = [assembly.floats(numbers[at : at + n]) for at in grid.faces_at[: len(areas)]]
    pushed, left = flow.ints[SEEPING], flow.ints[LED]
    last = assembly.floats(uncut * numbers[left : left + n]), assembly.floats(numbers[pushed : pushed + n])
    area = assembly.floats(flow.areas)
    sizes = [area + axis for axis in range(len(areas))]
    ints = (
        grid.at, grid.cells.insides_at, grid.volumes_at, assembly.floats(uncut), left, pushed, *last, *grid.faces_at,
        *((*one, one[0])[:3] for one in (whole, areas, sizes)),
    )  # fmt: skip
    flat = [int(k) for one in ints for k in (one if isinstance(one, tuple) else (one,))]
    flat += [*flow.cells.shape, *map(int, flow.cells.periodic), len(areas)]
    assembly.term("internal", f"{PAST}:past", flat)
    assembly.term("close", f"{PAST}:keep", flat)
    assembly.after_step(f"{PAST}:go_past", flat)


def _cut(grid: Grid, fractions: Floats, faces: Faces, opened: Floats, drift: Drift, assembly: Assembly) -> None:
    """Cut a field's cells by standing solids as the flow's are cut. Raises ScriptError for a varying coefficient."""
    if grid.varying:
        text = "a field around solids has a coefficient that varies neither in time nor with the field"
        help = "write its `coefficient` by place alone, or let no solids stand in the flow"
        raise ScriptError([Diagnostic("invalid", text, drift.by.span if drift.by else None, help)])
    n, numbers = len(fractions), assembly.numbers()
    volumes = fractions * numbers[grid.cells.insides_at : grid.cells.insides_at + n]
    assembly.write(grid.cells.insides_at, volumes)
    assembly.write(grid.volumes_at, np.where(volumes > 0.0, volumes, 1.0))
    for axis in range(faces.axes):
        low = tuple(slice(0, m) for m in faces.cells.shape[::-1])
        part = opened[faces.index(axis)][low].ravel() / faces.areas[axis]
        ties = slice(grid.faces_at[axis], grid.faces_at[axis] + n)
        assembly.write(grid.faces_at[axis], numbers[ties] * part)


def _must_agree(shape: Any, low: Any, spacing: Any, periodic: Any, flow: Flow, name: str, span: Any) -> None:
    """Raise ScriptError where a field's cells or periodic axes differ from a flow's."""
    same = tuple(shape) == flow.cells.shape
    axes = len(flow.areas)
    if same:
        apart = np.abs(np.array(spacing) - flow.spacing)[:axes], np.abs(np.array(low) - flow.low)[:axes]
        same = all((one <= SAME * np.array(flow.spacing)[:axes]).all() for one in apart)
    if not same:
        text = f"the field has other cells than the flow '{name}'"
        sides = [side * count for side, count in zip(flow.spacing, flow.cells.shape, strict=True)][:axes]
        box = (" ".join(f"{x:.12g}" for x in one) for one in (sides, flow.low[:axes]))
        help = "give it the flow's `size: {} m`, `corner: {} m` and `cell`".format(*box)
        raise ScriptError([Diagnostic("other-domain", text, span, help)])
    if tuple(periodic)[:axes] != tuple(flow.cells.periodic)[:axes]:
        text = f"the field and the flow '{name}' are not periodic in the same directions"
        raise ScriptError([Diagnostic("other-domain", text, span, "let the boundary of both say `periodic`")])


def _must_be_closed(flow: Flow, faces: Faces, opened: Floats, carrier: Any, drift: Drift) -> None:
    """Raise ScriptError for a field with its own boundary in a flow with open sides or further solids."""
    first = flow.components[0].at
    _, beside, _ = _boundary(flow, faces, False)
    if carrier.around or (opened[beside - first] > 0.0).any():
        text = "this field ends at the skin of its domain, and the flow has ways through or solids besides"
        sides = " ".join(f"{side * count:.12g}" for side, count in zip(flow.spacing, flow.cells.shape, strict=True))
        help = f"give it a `size` in place of its `domain`: {sides} m, and the flow's `corner`"
        raise ScriptError([Diagnostic("other-domain", text, drift.by.span if drift.by else None, help)])


def _between(cells: Cells, faces: Faces, opened: Floats) -> list[Floats]:
    """For each component the open areas of faces, 0 next to cells outside the field's domain."""
    found = []
    filled = (cells.volumes > 0.0).reshape(cells.shape[::-1])
    for axis in range(faces.axes):
        area = opened[faces.index(axis)].copy()
        line, count = 2 - axis, cells.shape[axis]
        inner = tuple(slice(1, count) if k == line else slice(None) for k in range(3))
        low, high = filled.take(range(count - 1), axis=line), filled.take(range(1, count), axis=line)
        area[inner] *= low & high
        found.append(area.ravel())
    return found


def _boundary(flow: Flow, faces: Faces, own_skin: bool) -> tuple[Any, Any, Any]:
    """(numbers, entries in y, side 1 high or -1 low) of the boundary faces of sides that are not periodic.

    Empty for a field whose domain has a boundary of its own (``own_skin``).
    """
    mine, beside, sides = [], [], []
    at = flow.components[0].at
    for axis in range(faces.axes):
        for high in range(0 if faces.periodic[axis] or own_skin else 2):
            chosen = faces.side(axis, high).ravel()
            mine.append(chosen)
            beside.append(at + faces.on_side(axis, high).ravel())
            sides.append(np.full(len(chosen), 1 if high else -1))
    none = [np.zeros(0, dtype=np.int64)]
    return np.concatenate([*none, *mine]), np.concatenate([*none, *beside]), np.concatenate([*none, *sides])


def _values(boundary: Boundary, cells: Cells, mine: Any, at: int, assembly: Assembly) -> int:
    """Offset of the field's values (faces,) in inflowing fluid, for the boundary faces ``mine``."""
    place = np.full(len(cells.boundary.cells), -1)
    place[mine] = np.arange(len(mine))
    fixed, later = np.zeros(len(mine)), []
    for part, chosen in shares(boundary, cells, assembly.line())[0]:
        if part.value is None or not len(chosen):
            continue
        points = cells.boundary.points[chosen].copy()
        points[:, 2] *= not cells.flat
        if timed(part.value.expr) or "c" in {getattr(node, "name", "") for node in _nodes(part.value.expr)}:
            later.append((components(part.value.expr)[0], place[chosen], points))
        else:
            fixed[place[chosen]] = at_points(part.value, points)
    values = assembly.floats(fixed)
    if later:
        assembly.term("internal", BEGIN, (len(mine), assembly.floats(fixed), values))
    for expr, chosen, points in later:
        ones = assembly.floats(np.ones(len(chosen)))
        kernel, ints = over_faces(assembly, expr, at, values, ones, assembly.floats(points), chosen.tolist())
        assembly.term("internal", kernel, ints)
    return values


def _nodes(expr: Any) -> Any:
    from sceneql.quantities.expression import walk

    return walk(expr)


def field_in(by: Value, flow: Flow, name: str, assembly: Assembly) -> Grid:
    """The field that a value links to, on the cells of the flow of model ``name``. Raises ScriptError for any other."""
    link = by.expr
    assert isinstance(link, Link)
    grid = assembly.field_of(link)
    if grid is None:
        text = f"'{link.task}.{link.output}' is no field on a grid that is solved with the flow"
        raise ScriptError([Diagnostic("no-field", text, by.span, "name one of a `diffusion`")])
    box = assembly.numbers(grid.cells.box_at, grid.cells.box_at + 6)
    _must_agree(grid.cells.shape, box[:3], box[3:], grid.cells.periodic, flow, name, by.span)
    return grid


def add_buoyancy(buoyancy: Buoyancy, name: str, assembly: Assembly) -> None:
    """Add the buoyancy force of a field on a model's flow. Raises ScriptError for no field, or one on other cells."""
    flow = assembly.flow_of(name)
    if flow is None:
        return  # its own assembly has failed
    grid = field_in(buoyancy.by, flow, name, assembly)
    values = [assembly.value(one) for one in (buoyancy.expansion, buoyancy.reference, buoyancy.gravity)]
    assembly.term("force", LIFT, (grid.at, grid.cells.insides_at, *values, *flow.ints))
