"""Edges of a staggered grid on the sides of the box, where walls impose tangential velocities."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from sceneql.grids.at_points import at_points
from sceneql.grids.cell_program import over_faces
from sceneql.kinds import Formula
from sceneql.quantities.derivative import components
from sceneql.quantities.expression import TIME_SYMBOL, Expr, Link, Symbol, walk

if TYPE_CHECKING:
    from sceneql.flows.parts import Side
    from sceneql.flows.staggered import Faces
    from sceneql.frame import Floats
    from sceneql.system import Assembly

BEGIN = "sceneql.grids.diffusion_kernels:begin"


class Sides(Protocol):
    """The part of a flow under construction that ``edges_of`` reads."""

    faces: Faces
    assembly: Assembly
    viscosity: float
    """Kinematic viscosity [m^2/s]."""
    parts: list[tuple[Side, Any]]
    part_of: Any
    """The number of each boundary face's part in ``parts``; -1 for none."""
    slip: Any
    """Slip length [m] of each boundary face."""


def edges_of(builder: Sides, at: int) -> tuple[tuple[int, ...], list[int]]:
    """Store the edges' velocities and viscous weights.

    ((offset of velocities, offset of weights, first edge of each side as of EDGE_FIRST), faces beside the edges).
    """
    faces, assembly, spacing = builder.faces, builder.assembly, builder.faces.cells.spacing
    firsts, sides = [-1] * 18, []
    count = 0
    for component in range(faces.axes):
        for axis in range(faces.axes):
            for high in range(0 if builder.faces.periodic[axis] or axis == component else 2):
                edges = faces.edges(component, axis, high)
                firsts[6 * component + 2 * axis + high] = count
                sides.append((component, axis, high, edges, count))
                count += len(edges.faces)
    values, weights = np.zeros(count), np.zeros(count)
    later: list[tuple[Expr, Any, Floats, Floats]] = []
    for component, axis, high, edges, first in sides:
        mine = slice(first, first + len(edges.faces))
        width = builder.faces.own_widths(component).take(-1 if high else 0, axis=2 - axis).ravel()
        area = builder.viscosity * width * faces.volume / spacing[axis]
        each = [area / (builder.slip[one] + 0.5 * spacing[axis]) for one in edges.both]
        weights[mine] = 0.5 * (each[0] + each[1])
        for number, (part, _) in enumerate(builder.parts):
            if part.velocity is None:
                continue
            share = sum(
                np.where(builder.part_of[one] == number, 0.5 * w, 0.0) for one, w in zip(edges.both, each, strict=True)
            )
            share = np.where(weights[mine] > 0.0, share / np.where(weights[mine] > 0.0, weights[mine], 1.0), 0.0)
            chosen = np.flatnonzero(share > 0.0)
            if not len(chosen):
                continue
            points, expr = edges.points[chosen], components(part.velocity.expr)[component]
            if timed(expr):
                later.append((expr, first + chosen, share[chosen], points))
            else:
                values[first + chosen] += share[chosen] * component_at(part.velocity, component, points, 0.0)
    values_at, weights_at = assembly.floats(values), assembly.floats(weights)
    if later:
        assembly.term("internal", BEGIN, (count, assembly.floats(values), values_at))
    for expr, chosen, share, points in later:
        known = assembly.floats(share), assembly.floats(points)
        kernel, ints = over_faces(assembly, expr, at, values_at, *known, chosen.tolist())
        assembly.term("internal", kernel, ints)
    beside = [face for *_, edges, _ in sides for face in edges.faces.tolist()]
    return (values_at, weights_at, *firsts), beside


def timed(expr: Expr) -> bool:
    """Whether a formula depends on time or on other parts."""
    names = ("t", TIME_SYMBOL)
    return any(isinstance(node, Link) or (isinstance(node, Symbol) and node.name in names) for node in walk(expr))


def component_at(formula: Formula, axis: int, points: Floats, time: float) -> Floats:
    """A component (k,) of a velocity formula at points (k, 3) [m] and a time [s]."""
    one = Formula(components(formula.expr)[axis], formula.span)
    return at_points(one, points, t=time, **{TIME_SYMBOL: time})
