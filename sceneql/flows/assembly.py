"""Assembly of an incompressible flow on a staggered grid: state, numbers and terms of an island."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.flows import layout
from sceneql.flows.edges import BEGIN, component_at, edges_of, timed
from sceneql.flows.obstacles.moving_solids import Known, MovingSolids, moving
from sceneql.flows.obstacles.obstacles import Solids
from sceneql.flows.obstacles.obstructed import obstructed, whole
from sceneql.flows.obstacles.skin_velocities import SkinVelocities
from sceneql.flows.pressure import write_pressure
from sceneql.flows.staggered import Faces
from sceneql.flows.ways_out import must_have_ways_out
from sceneql.grids.at_points import at_points
from sceneql.grids.cell_program import over_cells, over_faces
from sceneql.grids.domain.boundary import shares
from sceneql.grids.medium import number_in
from sceneql.grids.multigrid.layout import SINK
from sceneql.kinds import Formula
from sceneql.quantities.derivative import components, differentiate
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.expression import TIME_SYMBOL, Number, Symbol
from sceneql.system import Cells, Flow, Grid

if TYPE_CHECKING:
    from sceneql.flows.flow_fields import Model
    from sceneql.flows.parts import Side
    from sceneql.flows.varying.fluids import Fluids
    from sceneql.frame import Floats
    from sceneql.grids.domain.cells import Cells as Ground
    from sceneql.system import Assembly

SCHEMES = {"upwind": layout.UPWIND, "central": layout.CENTRAL, "koren": layout.KOREN}
ACROSS = 1e-9
"""Normal component of a wall's velocity, relative to its largest component, that counts as rounding."""


def add_flow(name: str, model: Model, cells: Ground, assembly: Assembly) -> Flow:
    """Reserve one entry of y a face and add the flow's terms. Raises ScriptError for boundary parts that do not fit."""
    return _Builder(name, model, cells, assembly).build()


class _Builder:
    def __init__(self, name: str, model: Model, cells: Ground, assembly: Assembly) -> None:
        self.model, self.cells, self.assembly = model, cells, assembly
        solids = {ref.name for ref in (*model.around, *([model.domain] if model.domain is not None else []))}
        sides = {name: part for name, part in model.boundary.items() if name not in solids}
        shared, self.periodic = shares(sides, cells, assembly.line())
        self.faces = Faces(cells, self.periodic)
        self.parts: list[tuple[Side, Any]] = [(part, mine) for part, mine in shared if len(mine)]
        count = len(cells.boundary.cells)
        self.part_of = np.full(count, -1)
        for number, (_, mine) in enumerate(self.parts):
            self.part_of[mine] = number
        self.opened = np.zeros(count, dtype=bool)
        self.slip = np.zeros(count)
        self.pressure = np.zeros(count)
        for part, mine in self.parts:
            self.slip[mine] = part.slip
            if part.outflow is not None:
                self.opened[mine] = True
                self.pressure[mine] = part.outflow.pressure
        self.fluids: Fluids | None = None
        held, viscosity, laden = assembly.fluids(name), number_in(model.viscosity), assembly.laden(name)
        if held or laden or viscosity is None:
            from sceneql.flows.varying.fluids import Fluids

            self.fluids = Fluids(model, [density for density, _ in held], laden, self.faces, assembly)
        self.viscosity = 1.0 if viscosity is None or self.fluids is not None else viscosity / model.density
        staircase = model.edges == "staircase"
        self.solids: Solids | None = None
        self.moving: MovingSolids | None = None
        if moving(model.around, assembly):
            if model.domain is not None:
                text, help = "solids move through a flow in a box alone, not in a `domain`", "give the flow a `size`"
                raise ScriptError([Diagnostic("moves", text, model.domain.span or assembly.line(), help)])
            if self.fluids is not None:
                self.fluids.must_stand(True)
            self.moving = MovingSolids(model.around, model, self.faces, assembly)
        elif model.around or model.domain is not None:
            self.solids = Solids(model.around, self.faces, staircase, assembly, model.domain, model.boundary)

    def build(self) -> Flow:
        assembly, faces, cells = self.assembly, self.faces, self.cells
        for part, _ in self.parts:
            self._must_fit(part.velocity)
        self._must_slide()
        areas, volumes, given, pushes = self._faces()
        x = self._start(given)
        at = len(assembly.start())
        edges, edge_faces = edges_of(self, at)
        ints = np.zeros(layout.EDGE_FACES + len(edge_faces), dtype=np.int64)
        ints[layout.CELLS : layout.CELLS + 3] = cells.shape
        ints[layout.PERIODIC : layout.PERIODIC + 3] = self.periodic
        ints[layout.AXES], ints[layout.AT], ints[layout.FACES] = faces.axes, at, faces.count
        ints[layout.STARTS : layout.STARTS + faces.axes] = faces.starts
        uncut = passage = whole(faces, areas, volumes, self.viscosity)
        outside = pushes
        if self.solids is not None:
            skins = SkinVelocities(self.solids, self.model.boundary)
            passage = obstructed(self.solids, skins, passage, self.viscosity)
            if self.fluids is not None:
                self.fluids.must_stand(bool(passage.gains.any()) or bool(passage.walls.any()))
            areas, volumes = passage.areas, passage.volumes
            shut = areas == 0.0
            given = given | shut
            x[shut] = passage.walls[shut]
            pushes = pushes * passage.fills + passage.gains / volumes
            weights = assembly.numbers(edges[1], edges[1] + len(edge_faces))
            assembly.write(edges[1], weights * passage.edges[edge_faces])
        inflows = [part for part, _ in self.parts if part.inflow is not None]
        if inflows:
            names = [ref.name for ref in (self.solids.refs if self.solids is not None else ())]
            line = inflows[0].span or assembly.line()
            must_have_ways_out(faces, areas, self.opened, self._given_velocity, names, line)
        friction = np.where(given, 0.0, passage.friction)
        inverses = np.where(given, 0.0, 1.0 / volumes)
        ints[layout.OWNERS] = assembly.floats([] if self.solids is None else self.solids.owners())
        ints[layout.FILLS], ints[layout.FRICTION] = assembly.floats(passage.fills), assembly.floats(friction)
        cut, middles = (np.zeros(0), np.zeros((0, 3))) if self.solids is None else self.solids.middles()
        ints[layout.MIDDLES], ints[layout.CUT_FACES] = assembly.floats(np.vstack([cut, middles.T])), len(cut)
        ints[layout.GAINS] = assembly.floats(passage.gains)
        ints[layout.SEEPING] = -1 if passage.seeping is None else assembly.floats(passage.seeping)
        ints[layout.AREAS], ints[layout.INVERSES] = assembly.floats(areas), assembly.floats(inverses)
        ints[layout.SCALES] = assembly.floats(areas * inverses)
        ints[layout.PLAIN] = self.moving is None and self.solids is None and self.fluids is None
        ints[layout.MOVES] = self._moving(at)
        ints[layout.PUSHES], base, strengths = self._push(pushes, passage.fills)
        ints[layout.PUSHED] = self.moving is not None or base >= 0 or bool(pushes.any())
        ints[layout.GIVEN] = self.moving is not None or bool(given.any())
        viscous = [assembly.floats(tie) for tie in passage.ties]
        viscous = (viscous + viscous[:1])[:3]
        ints[layout.VISCOUS : layout.VISCOUS + 3] = viscous
        ints[layout.EDGES : layout.EDGES + 3] = (len(edge_faces), *edges[:2])
        ints[layout.EDGE_FIRST : layout.EDGE_FACES] = edges[2:]
        ints[layout.EDGE_FACES :] = edge_faces
        ints[layout.SCHEME], ints[layout.SKIP] = SCHEMES[self.model.advection], assembly.floats([0.0])
        moves, solver = self.moving is not None, self.model.pressure
        if self.fluids is not None:
            moves, solver = self.fluids.unequal, self.fluids.solver(solver)
        walled = self.moving is not None or self.solids is not None
        scales = areas * inverses
        plan, text = write_pressure(faces, self.opened, walled, areas, scales, solver, assembly, ints, moves)
        ints = np.concatenate([ints, plan])
        sinks, solved, grids = self._grids(at, given, volumes, friction, viscous, edges[1], edge_faces)
        fractions = None if self.solids is None else self.solids.fractions(areas)
        if self.moving is not None:
            self.moving.describe(ints)
            edge_weights = assembly.numbers(edges[1], edges[1] + len(edge_faces))
            held = int(plan[SINK]) if len(plan) else -1
            weighed = (base, strengths, edge_weights, sinks, solved)
            known = Known(uncut, given, outside, *weighed, self.model.density, self.viscosity, held)
            self.moving.start(known, x, ints)
            fractions = self.moving.fractions()
            text += ", cells cut anew at each instant"
        self._force(at, int(ints[layout.PUSHES]), base, strengths)
        varying: tuple[int, ...] = ()
        if self.fluids is None:
            assembly.term("close", "sceneql.flows.advection_kernels:advect", ints)
            assembly.term("close", "sceneql.flows.advection_kernels:rub", ints)
        else:
            held = int(plan[SINK]) if len(plan) else -1
            varying = self.fluids.add(ints, held, len(edge_faces), uncut, passage)
            text += self.fluids.text
        assembly.term("constrain", "sceneql.flows.projection_kernels:constrain", ints)
        assembly.state(self._projected(x, ints))
        flow = Flow(
            cells=Cells(cells.shape, self.periodic, np.zeros(len(cells.volumes), dtype=bool), 0, 0),
            components=grids,
            areas=faces.areas,
            spacing=tuple(cells.spacing.tolist()),
            low=tuple(cells.low.tolist()),
            ints=tuple(ints.tolist()),
            fractions=fractions,
            density=self.model.density,
            viscosity=number_in(self.model.viscosity) or 0.0,
            pressure=text,
            varying=varying,
        )
        assembly.flow(flow)
        return flow

    def _must_fit(self, formula: Formula | None) -> None:
        """Raise ScriptError for a velocity whose number of components is not that of the box's axes."""
        if formula is not None and formula.expr.type.shape != (self.faces.axes,):
            text = f"this velocity needs {self.faces.axes} components, one for each side of the box"
            raise ScriptError([Diagnostic("wrong-shape", text, formula.span)])

    def _must_slide(self) -> None:
        """Raise ScriptError for a wall whose velocity has a normal component at the start."""
        for part, by_axis in self._normal():
            for axis, mine in by_axis.items():
                if part.wall is None or part.velocity is None:
                    continue
                points = self.faces.points(axis)[mine - self.faces.starts[axis]]
                parts = [np.abs(component_at(part.velocity, k, points, 0.0)) for k in range(self.faces.axes)]
                if parts[axis].max() > ACROSS * max(one.max() for one in parts):
                    text = "a wall moves along itself: this velocity leads through it"
                    help = "let its component across the wall be 0, or give an `inflow`"
                    raise ScriptError([Diagnostic("invalid", text, part.velocity.span, help)])

    def _on_boundary(self, values: Any, kind: Any, default: Any = 0) -> Any:
        """An array (faces,) of values given for boundary faces; ``default`` for inner faces."""
        found = np.full(self.faces.count, default, dtype=kind)
        for axis in range(self.faces.axes):
            for high in range(0 if self.periodic[axis] else 2):
                found[self.faces.on_side(axis, high).ravel()] = values[self.faces.side(axis, high).ravel()]
        return found

    def _faces(self) -> tuple[Floats, Floats, Any, Floats]:
        """Arrays (faces,): area, volume of the control volume, whether the velocity is given, and the acceleration by a
        given pressure outside."""
        faces = self.faces
        areas = np.concatenate([np.full(np.prod(s), a) for s, a in zip(faces.shapes, faces.areas, strict=True)])
        volumes, signs = np.full(faces.count, faces.volume), np.zeros(faces.count)
        for axis in range(faces.axes):
            for high in range(0 if self.periodic[axis] else 2):
                mine = faces.on_side(axis, high).ravel()
                volumes[mine] *= 0.5
                signs[mine] = -1.0 if high else 1.0
        bounds = self._on_boundary(np.ones(len(self.opened), dtype=bool), bool)
        given = bounds & ~self._on_boundary(self.opened, bool)
        outside = self._on_boundary(self.pressure, float)
        return areas, volumes, given, signs * outside / self.model.density * areas / volumes

    def _given_velocity(self, time: float) -> Floats:
        """Normal velocities (faces,) of inflows on the boundary at a time [s]; 0 elsewhere."""
        faces = self.faces
        found = np.zeros(faces.count)
        for part, chosen in self._normal():
            for axis, mine in chosen.items():
                if part.inflow is None or part.velocity is None:
                    continue
                points = self._open_points(axis)[mine - faces.starts[axis]]
                found[mine] = component_at(part.velocity, axis, points, time)
        return found

    def _open_points(self, axis: int) -> Floats:
        """Centroids (m, 3) [m] of the open parts of a component's faces."""
        if self.solids is None or self.solids.staircase:
            return self.faces.points(axis)
        return self.solids.opened[axis].centers

    def _normal(self) -> list[tuple[Side, dict[int, Any]]]:
        """Each part of the boundary with the numbers of its faces, by axis."""
        number = self._on_boundary(self.part_of, int, -1)
        found = []
        for k, (part, _) in enumerate(self.parts):
            by_axis = {}
            for axis in range(self.faces.axes):
                mine = self.faces.index(axis).ravel()
                mine = mine[number[mine] == k]
                if len(mine):
                    by_axis[axis] = mine
            found.append((part, by_axis))
        return found

    def _start(self, given: Any) -> Floats:
        """Velocities (faces,) at the start, before the projection."""
        faces, said = self.faces, self.model.initial
        x = np.zeros(faces.count)
        for axis in range(faces.axes if said is not None else 0):
            assert said is not None
            mine = faces.index(axis).ravel()
            if said.velocity is not None:
                self._must_fit(said.velocity)
                x[mine] = component_at(said.velocity, axis, faces.points(axis), 0.0)
                continue
            assert said.stream_function is not None
            if faces.axes == 3:
                text = "a deep flow starts by a velocity, not by a stream function"
                raise ScriptError([Diagnostic("invalid", text, said.stream_function.span)])
            ends = [at_points(said.stream_function, faces.points(axis, (1 - axis, side))) for side in (0.5, -0.5)]
            x[mine] = (1 - 2 * axis) * (ends[0] - ends[1]) / self.cells.spacing[1 - axis]
        if said is not None and not np.isfinite(x).all():
            formula = said.velocity or said.stream_function
            text = "the flow at the start is not finite everywhere"
            raise ScriptError([Diagnostic("not-finite", text, None if formula is None else formula.span)])
        x[given] = self._given_velocity(0.0)[given]
        return x

    def _projected(self, x: Floats, ints: Any) -> Floats:
        """Velocities x (faces,) made divergence-free, in place. Raises ScriptError if iteration does not converge."""
        if not self.assembly.marched:
            return x
        from sceneql.flows.projection_kernels import project

        own = ints.copy()
        own[layout.AT] = 0
        if not project(x, layout.VELOCITY, self.assembly.numbers(), own):
            text = "the iterations for the pressure of the start do not end"
            raise ScriptError([Diagnostic("invalid", text, self.assembly.line())])
        return x

    def _moving(self, at: int) -> int:
        """Offset of time derivatives (faces,) of given velocities; terms write those of varying inflows."""
        assembly = self.assembly
        moves = assembly.floats(np.zeros(self.faces.count))
        varying = [
            (part, axis, mine)
            for part, by_axis in self._normal()
            if part.inflow is not None and part.velocity is not None and timed(part.velocity.expr)
            for axis, mine in by_axis.items()
        ]
        if varying:
            zeros = assembly.floats(np.zeros(self.faces.count))
            assembly.term("internal", BEGIN, (self.faces.count, zeros, moves))
        for part, axis, mine in varying:
            assert part.velocity is not None
            expr = components(part.velocity.expr)[axis]
            try:
                rates = [differentiate(expr, Symbol(name)) for name in ("t", TIME_SYMBOL)]
            except TypeError as error:
                text = "how fast this inflow changes is not known: it has an operation without a derivative"
                raise ScriptError([Diagnostic("invalid", text, part.velocity.span)]) from error
            points = assembly.floats(self._open_points(axis)[mine - self.faces.starts[axis]])
            ones = assembly.floats(np.ones(len(mine)))
            for rate in rates:
                if rate != Number(0.0):
                    kernel, ints = over_faces(assembly, rate, at, moves, ones, points, mine.tolist())
                    assembly.term("internal", kernel, ints)
        return moves

    def _push(self, pushes: Floats, fills: Floats) -> tuple[int, int, int]:
        """Offsets of arrays (faces,): accelerations by the pressure outside and the script's force; accelerations
        without this force; factor of the force. The last two are -1 without a force."""
        assembly, force = self.assembly, self.model.force
        pushing = assembly.floats(pushes)
        if force is None:
            return pushing, -1, -1
        self._must_fit(force)
        return pushing, assembly.floats(pushes), assembly.floats(fills / self.model.density)

    def _force(self, at: int, pushing: int, base: int, weights: int) -> None:
        """Add the terms that write the accelerations by the script's force."""
        assembly, faces, force = self.assembly, self.faces, self.model.force
        for axis in range(faces.axes if force is not None else 0):
            assert force is not None
            start, shape = faces.starts[axis], faces.shapes[axis]
            arrays = (pushing + start, base + start, weights + start)
            box = assembly.floats(faces.box(axis))
            sizes = (shape[2], shape[1], shape[0])
            kernel, ints = over_cells(assembly, components(force.expr)[axis], at + start, arrays, sizes, box)
            assembly.term("internal", kernel, ints)

    def _grids(
        self,
        at: int,
        given: Any,
        volumes: Floats,
        friction: Floats,
        viscous: Sequence[int],
        weights_at: int,
        edge_faces: Sequence[int],
    ) -> tuple[int, int, tuple[Grid, ...]]:
        """(offset of the viscous sinks, offset of the volumes of free faces, each velocity component as a Grid).

        A component is a field whose conductances are the viscous ties.
        """
        faces, assembly = self.faces, self.assembly
        sink = np.zeros(faces.count)
        weights = assembly.numbers(weights_at, weights_at + len(edge_faces))
        np.add.at(sink, np.array(edge_faces, dtype=np.int64), weights)
        sink += friction
        sinks, solved = assembly.floats(sink), assembly.floats(np.where(given, 0.0, volumes))
        found = []
        for axis in range(faces.axes):
            start, shape = faces.starts[axis], faces.shapes[axis]
            own = given[faces.index(axis).ravel()]
            cells = Cells((shape[2], shape[1], shape[0]), self.periodic, own, solved + start, 0)
            ties = (viscous[0] + start, viscous[1] + start, viscous[2] + start)
            found.append(Grid(cells, at + start, solved + start, sinks + start, ties, False, -1, True))
        return sinks, solved, tuple(found)
