"""The command ``mesh``: an object of a scene to a file of triangles, and an account of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from sceneql import pipeline
from sceneql.failure import Unsuitable, failing_as
from sceneql.kinds import Object
from sceneql.quantities.diagnostic import suggestion

if TYPE_CHECKING:
    from pathlib import Path

    from sceneql.frame import Implicit, Tape
    from sceneql.graph import SimulationGraph
    from sceneql.mesh.bounded import Corner
    from sceneql.mesh.polygons import Polygons
    from sceneql.mesh.unresolved import Unresolved
    from sceneql.simulation.run import Instant

CELLS = 128
"""Cells along the longest side of an object's box, where nothing is said."""


@dataclass(frozen=True, slots=True)
class Account:
    """What was written."""

    file: Path
    vertices: int
    triangles: int
    cell: float
    """[m]"""
    euler: int
    volume: float
    """[m^3]"""
    area: float
    """[m^2]"""
    boundary_edges: int
    unresolved: int
    """Cells without a change of sign, whether or not something smaller than they hides in them."""
    unresolved_volume: float
    """[m^3]"""

    def text(self) -> str:
        """As lines."""
        lines = [
            f"made {self.file}",
            f"{self.triangles} triangles, {self.vertices} vertices, cells of {self.cell:.4g} m",
            f"Euler characteristic {self.euler}, volume {self.volume:.8g} m^3, area {self.area:.8g} m^2",
        ]
        if self.boundary_edges:
            lines.append(f"{self.boundary_edges} edges of one triangle: the mesh is open")
        if self.unresolved:
            cells = "1 cell" if self.unresolved == 1 else f"{self.unresolved} cells"
            lines.append(
                f"{cells} unresolved, {self.unresolved_volume:.3g} m^3 in all: without a change of sign at the corners,"
                " but not proved empty or full; a smaller --cell resolves more"
            )
        return "\n".join(lines)


def mesh(
    graph: SimulationGraph, name: str, output: Path, *, cell: float | None = None, tolerance: float | None = None,
    time: float = 0.0, sharp: bool = False,
) -> Account:  # fmt: skip
    """Polygonise an object at an instant [s] by cells [m], or by cells that keep within a distance [m] of the surface.

    With ``sharp``, its edges and corners are kept. Raises RunFailure, OSError, and Unsuitable for what has no inside,
    is empty or unbounded, or needs too many cells.
    """
    from sceneql.mesh.files import format_of, write
    from sceneql.mesh.measures import area, edge_counts, euler_characteristic, volume
    from sceneql.mesh.refine import refined
    from sceneql.mesh.tolerance import polygonise_within

    format_of(output)
    if not 0.0 <= time <= graph.settings.clock.end:
        raise Unsuitable(f"the scene ends at {graph.settings.clock.end:g} s, so there is nothing at {time:g} s")
    solid = _solid(graph, name, next(pipeline.simulate(graph, [time])))
    size = max(high - low for low, high in zip(solid.low, solid.high, strict=True))
    if cell is None:
        cell = size / CELLS
    box = solid.tape, solid.low, solid.high
    method = _kept_sharp if sharp else refined
    try:
        if tolerance is not None:
            _, cell = polygonise_within(*box, tolerance, cell, lambda *cells: method(*cells)[0])
        polygons, hidden = method(*box, cell)
    except ValueError as error:
        raise Unsuitable(f"{name} cannot be polygonised: {error}") from error
    if not len(polygons.triangles):
        raise Unsuitable(f"{name} has no surface in cells of {cell:g} m")
    write(output, polygons)
    vertices, triangles = polygons.vertices, polygons.triangles
    return Account(
        file=output,
        vertices=len(vertices),
        triangles=len(triangles),
        cell=cell,
        euler=euler_characteristic(triangles),
        volume=volume(vertices, triangles),
        area=area(vertices, triangles),
        boundary_edges=edge_counts(triangles)[1],
        unresolved=hidden.cells,
        unresolved_volume=hidden.volume,
    )


def _kept_sharp(tape: Tape, low: Corner, high: Corner, cell: float) -> tuple[Polygons, Unresolved]:
    """As ``refined``, but with edges and corners kept."""
    from sceneql.mesh.sharp import polygonise_sharp
    from sceneql.mesh.unresolved import unresolved

    return polygonise_sharp(tape, low, high, cell), unresolved(tape, low, high, cell)


def _solid(graph: SimulationGraph, name: str, moment: Instant) -> Implicit:
    """An object's field in its box in the world. Raises RunFailure, and Unsuitable where there is none."""
    from sceneql.simulation.solid import traced

    task = graph.tasks.get(name)
    if task is None or not isinstance(task.kind, Object):
        objects = [other for other, found in graph.tasks.items() if isinstance(found.kind, Object)]
        hint = suggestion(name, objects)
        raise Unsuitable(f"no object is named '{name}'" + (f": {hint}" if hint else ""))
    with failing_as(name, moment.time, task.span):
        found = list(traced(task.kind, name, moment.place(name), moment))
    if not found:
        raise Unsuitable(f"{name} is empty at {moment.time:g} s")
    return found[0]
