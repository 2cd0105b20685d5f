"""An island under construction: words reserve state, store numbers and add terms; `finish` lays it out as arrays.

The module knows no word. The result is a `System`: the state at the start, the arrays of floats and integers, and a
`Structure`, which alone decides which code is compiled.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import accumulate
from typing import TYPE_CHECKING, Any

import numpy as np

import sceneql.system.channels as channels
from sceneql.island.blocks_laid import Block, grouped, lay_out
from sceneql.island.breakpoint_table import Breakpoint, BreakpointTable
from sceneql.island.breakpoints import Breakpoints
from sceneql.island.inputs import Inputs, WithoutSlopes
from sceneql.island.jacobian import BY_DIFFERENCES, full, section
from sceneql.island.offered import Offered
from sceneql.island.system import Origin, Structure, System
from sceneql.island.value_slopes import Layout, own_slopes, value_slopes
from sceneql.kinds import Object, Ref, Value
from sceneql.quantities.diagnostic import Diagnostics, ScriptError
from sceneql.quantities.expression import Expr, Link
from sceneql.system import Fields, Place

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.island.inputs import Word
    from sceneql.island.setting import Setting
    from sceneql.system import Bodies, Flow, Mode, Slopes, Stage, Tied
    from sceneql.system.assembly import Ints

STAGES: tuple[Stage, ...] = ("velocity", "internal", "force", "tie", "close", "constrain")
TIED = 150
"""Largest number of entries of y at which a Jacobian with ties is found by differences, which are as fast."""


@dataclass
class IslandAssembly(Offered):
    """The Assembly (system/assembly.py) of one island.

    ``places`` returns the indices into y of a solved model's output (None: it is computed); it may be set until
    `finish`.
    """

    setting: Setting
    whole: int = 0
    """Number of bodies of the whole island, where this is the assembly of a block of it; else 0."""
    places: Callable[[Link], NDArray[int64] | None] = lambda link: None
    points: Callable[[Link], tuple[Bodies, int, tuple[float, float, float]] | None] = lambda link: None
    """Resolves a link to a position: its masses, index of one, point on it (Model.point); set as ``places``."""
    ties: list[Tied] = field(default_factory=list)
    """The island's ties, for the term that solves for all their forces."""
    tie_ints: tuple[int, ...] = ()
    driven: bool = False
    contact_why: str = ""
    changes: list[tuple[int, int]] = field(default_factory=list)
    """(offset, count) of floats that change as bodies come and go."""
    _alike: list[tuple[int, int]] = field(default_factory=list)
    _masses: list[tuple[int, int, int]] = field(default_factory=list)
    _terms: dict[Stage, list[Block]] = field(default_factory=lambda: {stage: [] for stage in STAGES})
    _exact: list[Block] = field(default_factory=list)
    _local: list[Block] = field(default_factory=list)
    _after: list[Block] = field(default_factory=list)
    _settling: list[Block] = field(default_factory=list)
    _free: list[Block] = field(default_factory=list)
    _frees: list[tuple[int, int]] = field(default_factory=list)
    _tied: list[Block] = field(default_factory=list)
    _limits: list[Block] = field(default_factory=list)
    _growing: list[Callable[[Floats], bool]] = field(default_factory=list)
    _varying: list[tuple[int, Value, Word]] = field(default_factory=list)
    _largest_step: float = float("inf")
    _stops: set[Breakpoint] = field(default_factory=set)
    _apart: bool = True
    _unsloped: str = ""
    _remembered: dict[tuple[str, str | None], tuple[int, ...]] = field(default_factory=dict)

    def value(self, value: Value) -> int:
        """Store a value, a varying one to be evaluated at stage times; the offset of its first float."""
        if value.constant:
            return self.floats(self.initial(value))
        shape = value.expr.type.shape
        # An output of a solved model may have no place in y yet.
        later = None not in shape and self._inputs().reads_state(value.expr)
        first = self.floats(np.zeros([k or 0 for k in shape]) if later else self.initial(value))
        self._varying.append((first, value, (self._word[0], self._word[2])))
        return first

    def initial(self, value: Value) -> Any:
        """The value at the start of the run: float or float64 array."""
        return self._inputs().at_start(value)

    def term(
        self,
        stage: Stage,
        kernel: str,
        ints: Ints,
        jacobian: Slopes | Callable[[], Slopes | None] | None = None,
        apart: bool = False,
        energy: str | None = None,
        damped: bool = False,
        stiff: bool = False,
    ) -> None:
        """Add a term to the rate."""
        self._apart = self._apart and apart
        self._terms[stage].append(Block((kernel,), ints, 0, jacobian, *self._word, energy, damped, stiff))

    def tied_drift(self, kernel: str, ints: Ints) -> None:
        """Add a correction of drifts by ties (system.Assembly)."""
        self._tied.append(Block((kernel,), ints))

    def limit(self, kernel: str, ints: Ints) -> None:
        """Add a limit on changes of the state (system.Assembly)."""
        self._apart = False
        self._limits.append(Block((kernel,), ints))

    def grows(self, grow: Callable[[Floats], bool]) -> None:
        """Let the slopes' pattern grow (system.Assembly)."""
        self._growing.append(grow)

    def alike(self, at: int, count: int) -> None:
        """Declare entries with a common error scale (system.Assembly)."""
        self._alike.append((at, count))

    def inertia(self, velocity_at: int, inverse_at: int, count: int, matrix: Any = None) -> None:
        """Declare which rows of the Jacobian are multiplied by inverse masses (system.Assembly)."""
        self._masses.append((velocity_at, inverse_at, count))
        if matrix is not None:
            self._matrices[velocity_at] = matrix

    def contact(
        self, mode: Mode, kernels: Sequence[str], ints: Ints, pairs: int, apart: bool = False, help: str = ""
    ) -> None:
        """Add contacts."""
        self._apart = self._apart and apart and mode == "local"
        block = Block(tuple(kernels), ints, pairs, None, *self._word, help=help)
        (self._exact if mode == "exact" else self._local).append(block)

    def after_step(self, kernel: str, ints: Ints, apart: bool = False, samples: bool = False) -> None:
        """Add a kernel for the end of each step (system.Assembly)."""
        self._apart = self._apart and apart
        (self._settling if samples else self._after).append(Block((kernel,), ints))

    def free_motion(self, kernel: str, ints: Ints, at: int, count: int) -> None:
        """Add a force-free motion (system.Assembly)."""
        self._free.append(Block((kernel,), ints))
        self._frees.append((at, count))

    def fluids(self, flow: str) -> tuple[tuple[float, float], ...]:
        """Density and viscosity of the other fluids in a flow (system.Assembly)."""
        return self.setting.fluids(flow)

    def carrier(self, model: str) -> Flow | None:
        """The flow that carries a model (system.Assembly)."""
        name = self.setting.carrier(model)
        return None if name is None else self._flows.get(name)

    def laden(self, flow: str) -> bool:
        """Whether masses change a flow's inertia (system.Assembly)."""
        return self.setting.laden(flow)

    @property
    def on_grids(self) -> Fields:
        """The fields and the flow of the island, and whether it consists of these alone."""
        still, flow = not self.changed_between_steps, next(iter(self._flows.values()), None)
        alone = still and not self._pairs and 0 < len(self._ranges) == len(self._grids) + len(self._flows)
        stiff = tuple((one.kernels[0], one.ints) for stage in STAGES for one in self._terms[stage] if one.stiff)
        return Fields(tuple(self._grids), flow, alone, self.on_elements if still else 0, stiff)

    @property
    def changed_between_steps(self) -> bool:
        """Whether contacts, or kernels that act after steps, change the state."""
        return bool(self._exact or self._local or self._after)

    @property
    def moved_by_forces_alone(self) -> bool:
        """Whether it consists of masses without springs, pins or contacts, and nothing changes it between steps."""
        others = self._terms["internal"] or self._terms["constrain"] or self.changed_between_steps
        paired = 2 * sum(n for *_, n in self._pairs) + len(self._masses)
        return bool(self._masses) and paired == self._size and not others

    @property
    def moves_freely(self) -> bool:
        """Whether it has a free motion, beside which nothing but constant forces act, if any."""
        others = self._varying or any(self._terms[stage] for stage in STAGES if stage not in ("force", "close"))
        return bool(self._free) and not (others or self._tied or self.changed_between_steps)

    def object(self, ref: Ref) -> Object:
        """The kind of an object of the script."""
        return self.setting.object(ref)

    def holder(self, ref: Ref) -> tuple[str, Object] | None:
        """The group that an object is a member of, and its kind."""
        return self.setting.holder(ref)

    def formula(self, link: Link) -> Expr | None:
        """A linked output as an expression of time; None for one of a model that is solved."""
        return self.setting.formula(link)

    @property
    def end(self) -> float:
        """End of the run [s]."""
        return self.setting.end

    def step_at_most(self, seconds: float) -> None:
        """Bound the steps that a tolerance chooses (system.Assembly)."""
        self._largest_step = min(self._largest_step, seconds)

    def stop_at(self, time: float) -> None:
        """Let steps that a tolerance chooses end at an instant (system.Assembly)."""
        self._stops.add((time, 0.0))

    def stop_at_breakpoints(self, expr: Expr) -> None:
        """Let adaptive steps end at the breakpoints of a formula (system.Assembly)."""
        if not self.whole:  # blocks have fixed steps
            self.breakpoints.follow(expr, expr.span or self.line())

    @cached_property
    def breakpoints(self) -> Breakpoints:
        """The breakpoints of values and formulas in the run."""
        return Breakpoints(self.setting.formula, self.setting.end)

    def place(self, link: Link) -> Place | None:
        """Where a force acts (system.Assembly)."""
        found = self.points(link)
        if found is None:
            return None
        bodies, body, arm = found
        return Place(bodies, body, -1 if bodies.turning is None or not any(arm) else self.floats(arm))

    def tie(self, tied: Tied) -> None:
        """Hold two bodies to conditions (system.Assembly)."""
        self.ties.append(tied)

    def tied(self, model: str) -> bool:
        """Whether ties hold a body of a model (system.Assembly)."""
        movers = (mover for tie in self.ties for mover in tie.movers)
        return any(isinstance(mover, Place) and mover.bodies.model == model for mover in movers)

    def ints_of(self, kernel: str) -> tuple[int, ...]:
        """The integers of a term (system.Assembly)."""
        terms = [term for some in self._terms.values() for term in some if kernel in term.kernels]
        return tuple(np.asarray(terms[0].ints).tolist()) if terms else ()

    def body_count(self) -> int:
        """Number of bodies of the island so far; in a block, of the whole island."""
        return max(self._bodies, self.whole)

    def changing(self, at: int, count: int) -> None:
        """Say that floats change as bodies come and go (system.Assembly)."""
        self.changes.append((at, count))

    def remember(self, *ints: int) -> None:
        """Keep integers for the word's outputs (ModelState.ints)."""
        name, _, model = self._word
        self._remembered[name, model] = self._remembered.get((name, model), ()) + ints

    def remembered(self, name: str, model: str | None = None) -> tuple[int, ...]:
        """The integers that a word has stored by `remember`; those of a force: for one model."""
        return self._remembered.get((name, model), ())

    @property
    def apart(self) -> bool:
        """Whether bodies do not interact: all terms and contacts are ``apart``, and no value reads the state."""
        return self._apart and not self._inputs().reading(self._varying)

    @property
    def contact_mode(self) -> str:
        """The modes of its contacts ("exact", "local", "barrier", joined by "and"), or "none"."""
        kinds = (("exact", self._exact), ("local", self._local), ("barrier", self._limits))
        return " and ".join(mode for mode, blocks in kinds if blocks) or "none"

    def finish(self, jacobian: bool = False, newton: bool = False) -> System:
        """The island as arrays; ``jacobian``: with its Jacobian; ``newton``: as Newton's method alone needs it.

        Raises ScriptError for values without a program.
        """
        y = self.start()
        slopes = self._slopes(newton) if jacobian else None
        inputs = self._inputs()
        blocks = [Block((), self._program(inputs))]
        groups: list[tuple[tuple[str, ...], int]] = []
        for stage in STAGES:
            groups += grouped(self._terms[stage], blocks)
        first_exact = len(blocks)
        exact, events = grouped(self._exact, blocks), blocks[first_exact:]  # of what was just grouped
        pairs = [block.pairs for block in events]
        local = grouped(self._local, blocks)
        between = (self._after, self._settling, self._free, self._tied, self._limits)
        after, settling, free, tied, limits = (grouped(some, blocks) for some in between)
        counts = [[n for _, n in stage] for stage in (groups, exact, local, after, settling, free, tied, limits)]
        ints = lay_out(self._pairs, self._frees, bool(tied), blocks, counts, pairs)
        found, derived, border = full(len(y)) if jacobian else None, None, 0
        if slopes is not None:
            masses = [(at, -1 if at in self._matrices else inverse_at, n) for at, inverse_at, n in self._masses]
            border = max((one.border for one, _ in slopes), default=0)
            found, derived, more = section(len(ints), len(y), slopes, masses, self._pairs, border)
            ints = np.concatenate([ints, more])
        names = [tuple(kernels[0] for kernels, _ in some) for some in (local, after, settling, free, tied, limits)]
        structure = Structure(
            terms=tuple(kernels[0] for kernels, _ in groups),
            exact=tuple((kernels[0], kernels[1]) for kernels, _ in exact),
            local=names[0],
            after=names[1],
            settling=names[2],
            free=names[3],
            tied=names[4],
            limits=names[5],
            varying=bool(self._varying),
            slopes=derived,
            energies=self._energies(groups, blocks[1:first_exact]) if slopes is not None else None,
        )
        partner = np.full(len(y), -1, dtype=np.int64)
        for position, velocity, count in self._pairs:
            partner[position : position + count] = np.arange(velocity, velocity + count)
        floats = np.concatenate([*self._numbers, np.zeros(0 if found is None else len(channels.ARRAYS) * len(y))])
        if slopes is not None and (self._local or self._limits):
            floats[channels.STAGE] = channels.OUTSIDE if newton else channels.BETWEEN
        else:
            self._share(floats)

        def grown(floats: Floats) -> System | None:
            more = [grow(floats) for grow in self._growing]
            return self.finish(jacobian, newton) if any(more) else None

        return System(
            structure=structure,
            grown=grown,
            y=y,
            floats=floats,
            ints=ints,
            pairs=sum(pairs),
            partner=partner,
            ranges=tuple(self._ranges),
            names=tuple(self._names),
            largest_step=self._largest_step,
            stops=BreakpointTable.of(self._stops | self.breakpoints.stops),
            pattern=found,
            fields=self.on_grids,
            unsloped=self._unsloped,
            grids=tuple(self.fields.values()),
            masses=tuple(self._masses),
            inertia=tuple(self._matrices.items()),
            border=border,
            alike=tuple(self._alike),
            following=tuple(self._following),
            rests=tuple(self._rests),
            terms=tuple(Origin(block.part, block.span) for block in blocks[1:first_exact]),
            events=tuple((block.pairs, Origin(block.part, block.span), block.help) for block in events),
            gives_way=self.gives_way,
            damped=any(block.damped for block in blocks[1:first_exact]),
            stiff=self.on_grids.stiff,
        )

    def _energies(self, groups: list[tuple[tuple[str, ...], int]], terms: list[Block]) -> tuple[str, ...] | None:
        """The energy kernel of each group of terms; None where a term has no potential or a value reads the state."""
        energies = [block.energy for block in terms]
        if None in energies or self._inputs().reading(self._varying):
            return None
        ends = accumulate(count for _, count in groups)
        return tuple(energies[end - 1] or "" for end in ends)

    def _program(self, inputs: Inputs) -> list[int]:
        """The program that evaluates all varying values. Raises ScriptError."""
        program: list[int] = []
        found = Diagnostics()
        for first, value, _ in self._varying:
            with self.word("values", value.span):
                self.stop_at_breakpoints(value.expr)
            try:
                program += inputs.program(value, first)
            except ScriptError as error:
                found.extend(error.diagnostics)
        found.raise_errors()
        return program

    def _slopes(self, newton: bool) -> list[tuple[Slopes, Ints]] | None:
        """The slopes of all terms with their integers; None where some are unknown or differences are as fast."""
        inputs = self._inputs()
        layout = Layout(self._size, self._ranges, self._pairs, self._masses, [*self._grids, *self.fields.values()])
        try:
            found = own_slopes(self._terms, newton or self._size > BY_DIFFERENCES)
            found += value_slopes(inputs.reading(self._varying), self._terms, [one for one, _ in found], layout, inputs)
        except (WithoutSlopes, ScriptError) as error:  # `_program` reports the latter with all other errors
            self._unsloped = str(error)
            return None
        if self._size <= TIED and any(one.border for one, _ in found):
            return None
        return [one for one in found if len(one[0].rows)]

    def _inputs(self) -> Inputs:
        return Inputs(self.setting.formula, self.places, self.start, self.floats)
