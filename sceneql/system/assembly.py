"""The island under construction, as models, forces and contacts see it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, Protocol

from sceneql.system.terms import Slopes, Stage

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.kinds.values import Ref, Value
    from sceneql.kinds.word import Kind
    from sceneql.quantities.expression import Expr, Link
    from sceneql.quantities.span import Span
    from sceneql.system.fields import Flow, Grid, Membrane
    from sceneql.system.state import ModelState, Place
    from sceneql.system.ties import Tied

    Ints = Sequence[int] | NDArray[int64]

Mode = Literal["exact", "local"]
"""How contacts act: by events located in time and impulses (exact), or by impacts resolved within a step (local)."""


class Assembly(Protocol):
    """The island under construction, as words see it."""

    def state(
        self, initial: Any, spans: Sequence[Span | None] | None = None, named: Callable[[int], str] | None = None
    ) -> int:
        """Reserve len(initial) entries of y with these values at the start; the offset of the first.

        ``spans``, one an entry or one for all, say which line of the script an entry comes from; ``named`` gives the
        name of each, for messages.
        """

    def displaced(self, at: int, values: Any) -> None:
        """Let entries of y start with other values than they were reserved with, which are those of rest."""

    def pair(self, position_at: int, velocity_at: int, count: int) -> None:
        """Say that y[velocity_at + k] is the velocity of y[position_at + k] (for methods that use it)."""

    def floats(self, values: Any) -> int:
        """Store numbers; the offset of the first."""

    def write(self, at: int, values: Any) -> None:
        """Replace numbers that are stored from an offset on."""

    def value(self, value: Value) -> int:
        """Store a value of the script, a varying one to be evaluated at stage times; the offset of its first float.

        Terms and contacts of the word that is being assembled read it. Where it depends on the state, the derivatives
        of these terms through it are part of the Jacobian (system.Slopes).
        """

    def initial(self, value: Value) -> Any:
        """The value at the start of the run: float or float64 array."""

    def term(
        self,
        stage: Stage,
        kernel: str,
        ints: Ints,
        jacobian: Slopes | Callable[[], Slopes | None] | None = None,
        apart: bool = False,
        energy: str | None = None,
        damped: bool = False,
    ) -> None:
        """Add a term to the rate; ``kernel`` is ``"package.module:function"``.

        ``jacobian``: its derivatives, or a function that gives them if a solver needs them; None: unknown, then the
        island takes differences of the whole rate. ``apart``: its force on a body depends on that body and the time
        alone, so that a large island may be solved in blocks of its bodies.

        ``energy``: ``"package.module:function"``, ``(t, y, floats, ints) -> float``, with the term's integers: the
        potential energy [J] of its force, called where the rate has been evaluated at this t; empty: of a term that
        adds no force to what moves; None: there is none. Newton's method searches along its updates for less of the sum
        where all terms of an island tell theirs. ``damped``: the force depends on velocities besides, and has this
        potential where they are 0.
        """

    def limit(self, kernel: str, ints: Ints) -> None:
        """Add what keeps surfaces apart: the largest part of a change of the state that lets none pass another.

        ``kernel`` is ``"package.module:function"``, ``(t, y, changed, floats, ints) -> float``, 1 where the whole way
        in a line from y to ``changed`` is free. Newton's method asks it of each update, from states where surfaces are
        apart; other methods of their whole step, which a tolerance then shortens, and which fails where its length is
        given.
        """

    def grows(self, grow: Callable[[Any], bool]) -> None:
        """Say that the places of slopes may become more during a run, as what comes near depends on one another.

        A slopes kernel that misses a place sets floats[channels.GROWS]. The march then calls ``grow`` with the floats;
        it returns whether the slopes of its term, given by a function, have more places now. None are taken away.
        """

    def tied_drift(self, kernel: str, ints: Ints) -> None:
        """Add what changes the momenta before a splitting's drift, so that it ends where ties hold (RATTLE).

        ``kernel(functions, h, y0, kicked, y1, floats, all_ints, ints)``: y1 is the state that has drifted over h from
        ``kicked``, whose places are those of y0; it writes both anew. ``all_ints`` are the island's.
        """

    def alike(self, at: int, count: int) -> None:
        """Say that y[at : at + count] are of one size: methods with a tolerance measure their errors by one scale."""

    def inertia(self, velocity_at: int, inverse_at: int, count: int, matrix: Any = None) -> None:
        """Say that a close term scales rate[velocity_at + 3k : +3], and so its slopes, by floats[inverse_at + k].

        ``matrix``: the close term solves with it instead (bodies/consistent.py), a scipy sparse symmetric positive
        definite matrix (3 count, 3 count) [kg]; floats[inverse_at + k] then are of lumped masses, for contacts. Entries
        that are held have a row and a column of zeros.
        """

    def capacity(self, at: int, matrix: Any) -> None:
        """Say that a close term solves with a matrix for the rates of y[at : at + n]: slopes are of what it solves for.

        ``matrix``: scipy sparse, symmetric and positive definite, (n, n).
        """

    def contact(
        self, mode: Mode, kernels: Sequence[str], ints: Ints, pairs: int, apart: bool = False, help: str = ""
    ) -> None:
        """Add contacts: kernels (gap, impact) with the number of pairs for `exact`, (back_off,) for `local`.

        ``apart``: as for a term; for local contacts only. ``help``: the advice of a run that ends because events of
        the pairs have no end, which is then told at the contact's line.
        """

    def after_step(self, kernel: str, ints: Ints, apart: bool = False, samples: bool = False) -> None:
        """Add a kernel that acts at the end of each accepted step: springs that tear, particles that are born.

        ``kernel`` is ``"package.module:function"``; it returns whether it changed anything. ``apart``: as for a term.
        ``samples``: it takes away what errors have added, as the length of quaternions, and so acts after impacts and
        on every state that is read off a step, too, with both times equal; what it returns is whether the rate at the
        end of the step is to be evaluated anew.
        """

    def free_motion(self, kernel: str, ints: Ints, at: int, count: int) -> None:
        """Add the exact motion without forces of y[at : at + count], which splittings use as their drift.

        ``kernel(h, y, floats, ints)`` changes these entries alone, from those of velocities and momenta. Of entries
        named by `pair` it need not be told: x += h v.
        """

    def grid(self, grid: Grid) -> None:
        """Say that the entries of the state from grid.at on are a field, for solvers that know grids.

        Other entries of the model (tallies) must depend on the field alone, and nothing may depend on them.
        """

    def flow(self, flow: Flow) -> None:
        """Say that entries of the state are an incompressible flow, the only one of the island."""

    def flow_of(self, model: str | None = None) -> Flow | None:
        """The flow of a model, or by default the only one; None where this island has none."""

    def fluids(self, flow: str) -> tuple[tuple[float, float], ...]:
        """Density and viscosity of each other fluid that skins in a flow hold (Model.fluid)."""

    def carrier(self, model: str) -> Flow | None:
        """The flow that carries a model by a force (Interaction.carrier); None where none does."""

    def laden(self, flow: str) -> bool:
        """Whether masses that a flow carries add to its inertia, or take some away (Model.burdens)."""

    def follows(self, at: int, count: int) -> None:
        """Say that entries of y follow from others, written by a term or summed up: their errors are not measured."""

    def membrane(self, membrane: Membrane) -> None:
        """Say that entries of the state are a skin that a flow carries."""

    def membrane_of(self, model: str) -> Membrane | None:
        """The skin of a model; None where it has none."""

    def offer(self, output: str, grid: Grid) -> None:
        """Name a field output of the model that is being assembled; its tally of inflow follows its cells in y."""

    def field_of(self, link: Link) -> Grid | None:
        """The grid of the field that a link reads; None where this island has no such field."""

    def object(self, ref: Ref) -> Kind:
        """The kind of an object of the script."""

    def holder(self, ref: Ref) -> tuple[str, Kind] | None:
        """The group that an object of the script is a member of, and its kind; None where it is in none."""

    def changing(self, at: int, count: int) -> None:
        """Say that bodies come and go, and that floats[at : at + count] change with them, alike in every block."""

    def remember(self, *ints: int) -> None:
        """Keep integers for the word's outputs: ModelState.ints (a force's for each model; a contact's for all)."""

    def formula(self, link: Link) -> Expr | None:
        """A linked output as an expression of time; None for one of a model that is solved."""

    def step_at_most(self, seconds: float) -> None:
        """Bound the adaptive step [s], where something happens that the error estimate cannot see."""

    def stop_at(self, time: float) -> None:
        """Add a breakpoint [s]: adaptive steps end there."""

    def stop_at_breakpoints(self, expr: Expr) -> None:
        """Add the breakpoints of a formula of time: adaptive steps end there. (Those of each `value` are added.)"""

    def start(self) -> Any:
        """The state reserved so far (n,), at the start of the run."""

    def numbers(self) -> Any:
        """The floats stored so far, with values that vary in time as they are at the start."""

    def line(self) -> Span | None:
        """The place in the script of the word that is being assembled."""

    def places(self, link: Link) -> Any:
        """Indices into y of a model's output, in an array of its shape; None where the output is computed."""

    def place(self, link: Link) -> Place | None:
        """The mass, or the place on a body, whose position a link is; None where it is none of this island's."""

    def tie(self, tied: Tied) -> None:
        """Hold two bodies to conditions; their forces are found together with those of all other ties."""

    ties: list[Tied]
    """What ties hold."""
    tie_ints: tuple[int, ...]
    """The integers of the term that finds all ties' forces (bodies/rigid/tie_kernels.py), once it is there."""
    driven: bool
    """Whether a step lets stops, motors and friction of ties act already."""
    went_on: Mapping[str, ModelState]
    """By contact that has given way its state at that instant, from which the island goes on; empty at the start."""
    gives_way: bool
    """Whether a contact of mode `exact` has another way for what is left, where it finds none or takes too much work:
    the island is then assembled anew, and goes on from there."""
    by_tolerance: bool
    """Whether the solver is explicit, and a tolerance chooses its steps."""
    contact_why: str
    """Why contacts of rigid bodies have their mode, for `explain`."""

    def tied(self, model: str) -> bool:
        """Whether ties hold a body or mass of a model."""

    def ints_of(self, kernel: str) -> tuple[int, ...]:
        """The integers of the first term with a kernel; empty where there is none."""

    def body_count(self) -> int:
        """Number of bodies of the island (contacts choose their mode by it)."""
