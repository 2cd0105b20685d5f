"""Solids that move through a flow: numbers and terms by which kernels cut the cells again at each instant."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from sceneql.contacts.colliders import OFTEN, is_moving, shifted, surfaces
from sceneql.flows import layout
from sceneql.flows.obstacles import moving_layout as own
from sceneql.island.start import Start
from sceneql.kinds import Object
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.shapes.placement import Placed, inverse

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.flows.obstacles.obstructed import Passage
    from sceneql.flows.staggered import Faces
    from sceneql.frame import Floats
    from sceneql.kinds import Moment, Ref
    from sceneql.system import Assembly

GO = "sceneql.flows.obstacles.cut_anew_kernels:go"
GO_ON = "sceneql.flows.obstacles.cut_anew_kernels:go_on"
CELLS, MOMENTS = 0.25, 40
"""Cells that a solid passes in a step at most, since what it leaves or comes to has no order; intervals of the run in
which its speed is sampled."""
UNEVEN, BRIEF = 0.618034, 1e-4
"""How much further on in each interval than in that before its speed is sampled there, so that no beat of the solid is
missed; part of an interval that this takes."""
UNSOLVED = ("direct",)
"""Linear solvers of the pressure that are refused, since they would factor the matrix again in each step."""


def moving(refs: Sequence[Ref], assembly: Assembly) -> bool:
    """Whether any of the solids moves."""
    return any(is_moving(cast(Object, assembly.object(ref))) for ref in refs)


@dataclass(frozen=True, slots=True, eq=False)
class Known:
    """The constant data of a flow with moving solids; arrays are (faces,) unless stated."""

    passage: Passage
    """The faces of the box without solids."""
    given: Any
    """Whether the velocity is given by the boundary."""
    outside: Floats
    """Acceleration by the pressure outside."""
    base: int
    weights: int
    """Offsets of the accelerations without the script's force, and of the factor of this force; or -1."""
    edge_weights: Floats
    """(edges,) [m^3/s] viscous ties to the box's walls."""
    sinks: int
    solved: int
    """Offsets of the sinks and volumes of the components (system.Grid)."""
    density: float
    viscosity: float
    """Density [kg/m^3] and kinematic viscosity [m^2/s]."""
    held: int
    """Offset of the pressure equation's sinks for a linear solver chosen by name; or -1."""


class MovingSolids:
    """Solids in a flow, some of which move; their distances are those of the contacts' surfaces."""

    def __init__(self, refs: Sequence[Ref], model: Any, faces: Faces, assembly: Assembly) -> None:
        """Raises ScriptError for solids that change their shape, and for settings that moving solids do not allow."""
        self.faces, self.assembly, count = faces, assembly, len(refs)
        line = refs[0].span or assembly.line()
        if model.edges == "staircase":
            text, help = "solids that move cut the cells: a staircase would jump", "take `edges: cut_cell`"
            raise ScriptError([Diagnostic("invalid", text, line, help)])
        if model.pressure in UNSOLVED:
            text = f"solids that move change the equation of the pressure, which `{model.pressure}` would factor anew"
            raise ScriptError([Diagnostic("invalid", text, line, "take `pressure: auto` or `multigrid`")])
        named = [name for name in cast("Mapping[str, Any]", model.boundary) if name in {ref.name for ref in refs}]
        if named:
            text = f"beside solids that move the wall of '{named[0]}' has the velocity of its own motion"
            help = "leave it out of `boundary`, and give it a rotation by keys or a formula"
            raise ScriptError([Diagnostic("invalid", text, line, help)])
        self.solids = surfaces(refs, assembly, own.HEAD, often=np.inf)
        for ref in refs:
            if (turn := self._fastest(ref)) > 0.0:
                assembly.step_at_most(CELLS / turn)
        self.count = count
        cells = int(np.prod(faces.cells.shape))
        zeros = np.zeros(faces.count)
        self.whole = assembly.floats(np.zeros(cells))
        self.cells, self.rates = assembly.floats(np.zeros(cells)), assembly.floats(np.zeros(cells))
        self.scratch = [assembly.floats(zeros) for _ in range(3 + 3 + 2 + 2)]
        self.middles = assembly.floats(np.concatenate([np.arange(faces.count), *[zeros] * 3]))
        self.owners = assembly.floats(np.zeros(faces.count + cells))
        self.seeping = assembly.floats(np.zeros(2 * cells + 1))

    def _fastest(self, ref: Ref) -> float:
        """Most cells along all axes that a corner of a solid's box passes in a second, from samples in time.

        The larger of means over intervals and of speeds at instants, each of which misses motions of a kind.
        """
        kind: Any = self.assembly.object(ref)
        moment = cast("Moment", Start(self.assembly))
        if not is_moving(kind) or not 0.0 < self.assembly.end < np.inf:
            return 0.0
        if not isinstance(kind, Placed):
            return CELLS / OFTEN
        axes = self.faces.axes
        low, high = kind.extent(inverse(kind.local(moment)), moment)
        corners = np.array(list(product(*zip(low, high, strict=True), (1.0,)))).T
        step = self.assembly.end / MOMENTS
        number = np.arange(MOMENTS)
        long = step * (number[:, None] + [0.0, 1.0])  # what moves for a short time, between two keys
        short = step * (number + UNEVEN * number % 1.0)[:, None] + [0.0, BRIEF * step]  # what goes to and fro
        times = np.stack([long, short])
        moved: list[Any] = [shifted(kind, time, self.assembly) for time in times.ravel()]
        places = (np.array([one.local(moment) for one in moved]) @ corners)[:, :axes].reshape(*times.shape, axes, -1)
        cells = np.abs(places[:, :, 1] - places[:, :, 0]) / self.faces.cells.spacing[:axes, None]
        return float((cells.sum(axis=2).max(axis=2) / (times[:, :, 1] - times[:, :, 0])).max())

    def describe(self, ints: Any) -> None:
        """Write the entries on solids into the flow's integers."""
        ints[layout.OWNERS], ints[layout.SEEPING], ints[layout.LED] = self.owners, self.seeping, self.whole
        ints[layout.MIDDLES], ints[layout.CUT_FACES] = self.middles, self.faces.count

    def start(self, known: Known, x: Floats, flow: NDArray[int64]) -> None:
        """Cut the cells at the start, and add the terms that cut them again.

        ``x`` (faces,): the velocities, changed where solids stand. Raises ScriptError where the solids fill the box, or
        displace fluid in a closed box.
        """
        from sceneql.flows.obstacles.cut_anew_kernels import cut_anew, settle

        assembly, faces = self.assembly, self.faces
        spacing = faces.cells.spacing
        areas = np.array(faces.areas)
        fastest = 4.0 * known.viscosity * float((1.0 / spacing[: faces.axes] ** 2).sum())
        entry = float((2.0 * areas / spacing[: faces.axes]).sum())
        draw = sum(float(tie.max(initial=0.0)) for tie in known.passage.ties)
        numbers = [*faces.low, *spacing, known.density, fastest, entry, draw]
        ties = [assembly.floats(tie) for tie in known.passage.ties]
        uncut = [known.passage.areas, known.passage.volumes, known.given.astype(float), known.outside]
        levels, parts, depths, *rest = self.scratch
        centers = [self.middles + faces.count * k for k in (1, 2, 3)]
        head = [
            self.count, own.HEAD + len(self.solids), *(*ties, ties[0])[:3],
            *(assembly.floats(one) for one in uncut), known.base, known.weights, assembly.floats(known.edge_weights),
            known.sinks, known.solved, levels, parts, depths, *centers, *rest[:5], self.cells, self.whole,
            known.held, assembly.floats(numbers), rest[5], self.rates, rest[6],
        ]  # fmt: skip
        assert len(head) == own.HEAD
        ints = np.array([*head, *self.solids, *flow], dtype=np.int64)
        at_start = ints.copy()
        at_start[at_start[own.FLOW] + layout.AT] = 0
        now = assembly.numbers()
        room = cut_anew(now, at_start)
        settle(x, now, at_start)
        assembly.write(0, now)
        n = int(np.prod(faces.cells.shape))
        if not (now[self.whole : self.whole + n] > 0.0).any():
            text = "the solids fill the whole box: no cell is left to flow through"
            raise ScriptError([Diagnostic("no-cell", text, assembly.line(), "take smaller ones, or a larger `size`")])
        if not room:
            text = "a solid moves through a side of a closed box, and the flow cannot be compressed"
            help = "give a part of the boundary `outflow: {}`, or keep the solid inside"
            raise ScriptError([Diagnostic("no-way-out", text, assembly.line(), help)])
        assembly.term("internal", GO, ints)
        assembly.after_step(GO_ON, ints)

    def fractions(self) -> Floats:
        """The open fraction (cells,) of each cell at the start (obstacles.Solids.fractions)."""
        n = int(np.prod(self.faces.cells.shape))
        found: Floats = self.assembly.numbers(self.whole, self.whole + n)
        return found
