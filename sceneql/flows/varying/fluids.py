"""A flow of several fluids, or of varying viscosity: the numbers and terms of its kernels (fluid_layout.py)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.flows import layout
from sceneql.flows.parts import of_field
from sceneql.flows.varying import fluid_layout as own
from sceneql.flows.varying.thickness import by_formula, measure
from sceneql.grids.medium import number_in
from sceneql.quantities.diagnostic import Diagnostic, ScriptError

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.flows.flow_fields import Model
    from sceneql.flows.obstacles.obstructed import Passage
    from sceneql.flows.staggered import Faces
    from sceneql.system import Assembly, Flow, Membrane

FLOW_IN, DRIVE = "sceneql.flows.varying.mass_flow_kernels:flow_in", "sceneql.flows.varying.mass_flow_kernels:drive"
FIXED = ("fast_transform", "direct")
"""Linear solvers of the pressure that require constant coefficients, so equal densities."""


class Fluids:
    """The additional data of a flow of several fluids; skins register the fluids they enclose by `fill`."""

    def __init__(self, model: Model, densities: Sequence[float], laden: bool, faces: Faces, assembly: Assembly) -> None:
        """``densities`` [kg/m^3] of the fluids inside skins; ``laden``: whether immersed masses add to the inertia."""
        self.model, self.count, self.faces, self.assembly = model, len(densities), faces, assembly
        self.laden = laden
        self.unequal = laden or any(density != model.density for density in densities)

    @property
    def text(self) -> str:
        """Text for `explain`."""
        return (f", of {1 + self.count} fluids" if self.count else "") + (", laden with masses" if self.laden else "")

    def solver(self, named: str) -> str:
        """Name of the linear solver of the pressure. Raises ScriptError for one that needs constant coefficients."""
        if not self.unequal:
            return named
        if named in FIXED:
            what = "skins hold fluids of other densities" if self.count else "masses in it weigh other than its fluid"
            text = f"{what}: the equation of the pressure changes, and not by `{named}`"
            raise ScriptError([Diagnostic("invalid", text, self.assembly.line(), "take `pressure: auto`")])
        return "multigrid" if named == "auto" else named

    def must_stand(self, moving: bool) -> None:
        """Raise ScriptError where solids in the flow, or their walls, move (``moving``)."""
        if moving:
            what = "masses in it add to its inertia" if self.laden else "its viscosity varies"
            what = "skins in it hold other fluids" if self.count else what
            text = f"walls of solids in the flow move, and {what}"
            help = "let the solids stand, or let the flow have one density and viscosity"
            raise ScriptError([Diagnostic("invalid", text, self.assembly.line(), help)])

    def add(self, flow: NDArray[int64], held: int, edges: int, open_: Passage, left: Passage) -> tuple[int, ...]:
        """Add the terms; returns the integers of all kernels (fluid_layout).

        ``flow``: the flow's integers; ``held``: fluid_layout.HELD; ``edges``: number of edges at walls; ``open_``: the
        faces without solids; ``left``: the faces cut by solids, the same object without any.
        """
        assembly, faces = self.assembly, self.faces
        cells, flat = faces.cells, faces.axes == 2
        n = int(np.prod(cells.shape))
        halves = n * (4 if flat else 8)
        sizes: list[int] = []
        starts: list[int] = []
        for a, b in ((0, 1),) if flat else ((0, 1), (0, 2), (1, 2)):
            starts.append(sum(sizes))
            sizes.append(int(np.prod([m + (k in (a, b) and not faces.periodic[k]) for k, m in enumerate(cells.shape)])))
        ints = np.zeros(own.HEAD, dtype=np.int64)

        def zeros(count: int) -> int:
            return assembly.floats(np.zeros(count))

        ints[own.FLOW], ints[own.BASE], ints[own.HELD], ints[own.UNEQUAL] = own.HEAD, -1, held, self.unequal
        box = [*faces.low, *cells.spacing]
        ints[own.OWN] = assembly.floats([self.model.density, number_in(self.model.viscosity) or 0.0, *box])
        if number_in(self.model.viscosity) is None:
            ints[own.BASE] = by_formula(self.model.viscosity, int(flow[layout.AT]), faces, assembly)
        ints[own.TABLE] = assembly.floats([0.0, float(zeros(own.ROW * self.count))])
        for place in (own.DENSITY, own.MEAN, own.FLUIDITY, own.PART, own.COVER):
            ints[place] = zeros(halves)
        ints[own.MASSES], ints[own.LEFT] = zeros(2 * faces.count), -1
        for place in (own.MOMENTUM, own.MASS):
            ints[place] = zeros(faces.count)
        if left is not open_:
            ties = [one / np.where(all_ > 0.0, all_, 1.0) for one, all_ in zip(left.ties, open_.ties, strict=True)]
            ints[own.LEFT] = assembly.floats(np.concatenate([left.volumes / open_.volumes, *ties]))
            ints[own.DRAGS] = zeros(faces.count)
        ints[own.NORMAL], ints[own.SHEAR], ints[own.WALLS] = zeros(n), zeros(sum(sizes)), zeros(edges)
        ints[own.SHEARS : own.SHEARS + len(starts)] = starts
        ints[own.WEIGHT], ints[own.MODE], ints[own.FASTEST] = zeros(3), zeros(1), zeros(1)
        if not flat:
            from sceneql.flows.varying.deep_parts_kernels import ROOM

            ints[own.CLIPPED] = zeros(ROOM)
        ints[own.LINES] = zeros(4 * (2 * cells.shape[0] + 1))
        ints[own.ANEW] = self.laden or ints[own.BASE] >= 0
        found = (*ints.tolist(), *flow.tolist())
        if not of_field(self.model.viscosity):  # else `thicken` adds it, after the field is evaluated
            measure(found, flat, assembly)
        assembly.term("close", FLOW_IN, found)
        assembly.term("close", DRIVE, found)
        return found


def fill(
    flow: Flow, skin: Membrane, triangles: Any, fluid: tuple[float, float], tension: float, assembly: Assembly
) -> None:
    """Register the fluid inside a skin: (density [kg/m^3], viscosity [Pa s]).

    ``triangles`` (m, 3): of a skin in a 3D flow; ``tension``: Membrane.largest_tension [N/m].
    """
    ints = flow.varying
    density, viscosity = fluid
    count, rows = (int(one) for one in assembly.numbers(ints[own.TABLE], ints[own.TABLE] + 2))
    corners = assembly.floats(np.ravel(triangles)) if len(triangles) else 0
    known = assembly.floats(np.full(3 * skin.count, np.nan))
    row = [skin.count, skin.position_at, len(triangles), corners, density, viscosity, known]
    assembly.write(rows + own.ROW * count, np.array(row, dtype=float))
    assembly.write(ints[own.TABLE], np.array([count + 1.0]))
    cell = min(flow.spacing[: len(flow.areas)])
    turn = (tension / (0.5 * (density + flow.density) * cell**3)) ** 0.5
    fastest = ints[own.FASTEST]
    assembly.write(fastest, np.array([max(turn, *assembly.numbers(fastest, fastest + 1))]))
