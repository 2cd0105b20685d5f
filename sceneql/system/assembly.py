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
        """Reserve len(initial) entries of y with these initial values; returns the offset of the first.

        ``spans``, one an entry or one for all, say which line of the script an entry comes from; ``named`` gives the
        name of each, for messages.
        """

    def displaced(self, at: int, values: Any) -> None:
        """Set initial values of y[at : at + len(values)]; the values reserved before are kept as those at rest."""

    def pair(self, position_at: int, velocity_at: int, count: int) -> None:
        """Declare y[velocity_at + k], k < count, as the derivative of y[position_at + k], for methods that use it."""

    def floats(self, values: Any) -> int:
        """Store numbers in the floats; returns the offset of the first."""

    def scratch(self, size: int) -> int:
        """Offset of so many floats that kernels of every word may overwrite, and none finds again in its next call."""

    def write(self, at: int, values: Any) -> None:
        """Overwrite floats[at : at + len(values)], which were stored before."""

    def start_at(self, at: int, values: Any) -> None:
        """Overwrite y[at : at + len(values)] at the start, which was reserved before."""

    def value(self, value: Value) -> int:
        """Store a value of the script in the floats; returns its offset.

        A varying value is evaluated at every stage time. Only terms and contacts of the word that is being assembled
        read it. Where it depends on the state, the derivatives of these terms through it are part of the Jacobian
        (system.Slopes).
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
        stiff: bool = False,
    ) -> None:
        """Add a term to the rate; ``kernel`` is ``"package.module:function"``.

        ``jacobian``: the term's derivatives, or a function that returns them if a solver needs them; None: unknown, and
        the whole Jacobian of the island is then found by finite differences. ``apart``: the term's force on a body
        depends on that body and the time alone, so that a large island may be solved in blocks of its bodies.

        ``energy``: ``"package.module:function"``, ``(t, y, floats, ints) -> float``, with the term's integers: the
        potential energy [J] of its force, called after the rate has been evaluated at the same t. Empty: the term adds
        no force to what moves. None: its force has no potential. Where every term of an island has one of the former,
        Newton's method uses the total potential energy in its line search. ``damped``: the force also depends on
        velocities, and ``energy`` is its potential at zero velocities. ``stiff``: an additive method may march what
        it does implicitly, by its integers (System.stiff).
        """

    def limit(self, kernel: str, ints: Ints) -> None:
        """Add a kernel that limits changes of the state, so that no surface passes through another.

        ``kernel`` is ``"package.module:function"``, ``(t, y, changed, floats, ints) -> float``: the largest fraction of
        the straight line from y to ``changed`` without interpenetration, 1 for all of it. Newton's method calls it for
        each update, from states where surfaces are apart. Other methods call it for the whole step: an adaptive step is
        then shortened, a step of given length fails.
        """

    def grows(self, grow: Callable[[Any], bool]) -> None:
        """Declare that the sparsity pattern of a term's slopes may grow in a run, as more surfaces come near."""

    def tied_drift(self, kernel: str, ints: Ints) -> None:
        """Add a kernel that corrects a splitting's drift so that it ends where the constraints of ties hold (RATTLE).

        ``kernel(functions, h, y0, kicked, y1, floats, all_ints, ints)``: ``kicked`` has the positions of y0 and the
        momenta at the start of the drift; y1 is the state after drifting from ``kicked`` over h. The kernel rewrites
        both. ``all_ints``: the island's integers; ``ints``: the kernel's own.
        """

    def alike(self, at: int, count: int) -> None:
        """Declare that y[at : at + count] have one magnitude: methods with a tolerance scale all their errors alike."""

    def inertia(self, velocity_at: int, inverse_at: int, count: int, matrix: Any = None) -> None:
        """Declare that a close term scales rate[velocity_at + 3k : +3], and so its slopes, by floats[inverse_at + k].

        ``matrix``: a consistent mass matrix with which the close term solves instead (bodies/consistent.py), scipy
        sparse, symmetric positive definite, (3 count, 3 count) [kg]; floats[inverse_at + k] are then inverse lumped
        masses, for contacts. Entries that are held have a row and a column of zeros.
        """

    def capacity(self, at: int, matrix: Any) -> None:
        """Declare that the rates r of y[at : at + n] solve matrix r = b, in a close term; slopes are derivatives of b.

        ``matrix``: scipy sparse, symmetric and positive definite, (n, n).
        """

    def contact(
        self, mode: Mode, kernels: Sequence[str], ints: Ints, pairs: int, apart: bool = False, help: str = ""
    ) -> None:
        """Add contacts: kernels (gap, impact) with the number of pairs for `exact`, (back_off,) for `local`.

        ``apart``: as for a term; for local contacts only. ``help``: the advice, told at the contact's line, of a run
        that ends because impacts of the pairs accumulate without end.
        """

    def after_step(self, kernel: str, ints: Ints, apart: bool = False, samples: bool = False) -> None:
        """Add a kernel that acts at the end of each accepted step: springs that tear, particles that are born.

        ``kernel`` is ``"package.module:function"``; it returns whether it changed anything. ``apart``: as for a term.
        ``samples``: the kernel removes accumulated errors, such as the drift of a quaternion's length. It then also
        acts after impacts and on every state that is interpolated within a step, with both times equal, and returns
        whether the rate at the end of the step must be evaluated anew.
        """

    def free_motion(self, kernel: str, ints: Ints, at: int, count: int) -> None:
        """Add the exact force-free motion of y[at : at + count], which splittings use as their drift.

        ``kernel(h, y, floats, ints)`` changes these entries alone, by velocities and momenta in y. Entries named by
        `pair` need no kernel: x += h v.
        """

    def grid(self, grid: Grid) -> None:
        """Declare the entries of the state from grid.at on as a field, for solvers that know grids.

        Other entries of the model (tallies) must depend on the field alone, and nothing may depend on them.
        """

    def flow(self, flow: Flow) -> None:
        """Declare entries of the state as an incompressible flow, the only one of the island."""

    def flow_of(self, model: str | None = None) -> Flow | None:
        """The flow of a model, or by default the only one; None where this island has none."""

    def fluids(self, flow: str) -> tuple[tuple[float, float], ...]:
        """Density [kg/m^3] and viscosity [Pa s] of each other fluid that skins in a flow enclose (Model.fluid)."""

    def carrier(self, model: str) -> Flow | None:
        """The flow that carries a model by a force (Interaction.carrier); None where none does."""

    def laden(self, flow: str) -> bool:
        """Whether masses carried by a flow add to its inertia or reduce it (Model.burdens)."""

    def follows(self, at: int, count: int) -> None:
        """Declare y[at : at + count] as functions or integrals of other entries: their errors are not measured."""

    def membrane(self, membrane: Membrane) -> None:
        """Declare entries of the state as the vertices of a skin that a flow carries."""

    def membrane_of(self, model: str) -> Membrane | None:
        """The skin of a model; None where it has none."""

    def offer(self, output: str, grid: Grid) -> None:
        """Name a field output of the model that is being assembled.

        In y the cells of ``grid`` are followed by its inflow tally.
        """

    def field_of(self, link: Link) -> Grid | None:
        """The grid of the field that a link reads; None where this island has no such field."""

    def object(self, ref: Ref) -> Kind:
        """The kind of an object of the script."""

    def holder(self, ref: Ref) -> tuple[str, Kind] | None:
        """The group that an object of the script is a member of, and its kind; None where it is in none."""

    def changing(self, at: int, count: int) -> None:
        """Declare that bodies appear and vanish, and floats[at : at + count] change with them, alike in every block."""

    def remember(self, *ints: int) -> None:
        """Keep integers for the word's outputs (ModelState.ints): a force's for each model, a contact's for all."""

    def formula(self, link: Link) -> Expr | None:
        """A linked output as an expression of time; None for one of a model that is solved."""

    @property
    def end(self) -> float:
        """End of the run [s]."""

    def step_at_most(self, seconds: float) -> None:
        """Bound the adaptive step [s], where the error estimate cannot see what happens."""

    def stop_at(self, time: float) -> None:
        """Add a breakpoint [s]: adaptive steps end there."""

    def stop_at_breakpoints(self, expr: Expr) -> None:
        """Add the breakpoints of a formula of time: adaptive steps end there.

        (`value` adds those of its values itself.)
        """

    def start(self) -> Any:
        """The state reserved so far (n,), at the start of the run."""

    def numbers(self, first: int = 0, last: int | None = None) -> Any:
        """The floats stored so far, or those from ``first`` to before ``last``: a copy.

        Values that vary in time are as at the start.
        """

    def line(self) -> Span | None:
        """The place in the script of the word that is being assembled."""

    def places(self, link: Link) -> Any:
        """Indices into y of a model's output, in an array of its shape; None where the output is computed."""

    def place(self, link: Link) -> Place | None:
        """The mass, or the point of a rigid body, whose position a link reads; None where it is not in this island."""

    def tie(self, tied: Tied) -> None:
        """Add constraints between two bodies; their forces are solved for together with those of all other ties."""

    ties: list[Tied]
    """The ties of the island so far."""
    tie_ints: tuple[int, ...]
    """The integers of the term that solves for all constraint forces (bodies/rigid/ties/tie_kernels.py); empty before
    it is added."""
    driven: bool
    """Whether a contact's step already solves for the stops, motors and friction of ties."""
    went_on: Mapping[str, ModelState]
    """The state, by contact, at the instant at which the contact gave way and from which the island goes on; empty at
    the start."""
    gives_way: bool
    """Whether a contact of mode `exact` can go on in another mode where it finds no solution or takes too much work:
    the island is then assembled anew and goes on from that instant."""
    by_tolerance: bool
    """Whether the solver is explicit with adaptive steps."""
    marched: bool
    """Whether the island is to be marched; else `check` asks for errors alone, and numbers that do not tell any may be
    left as they are."""
    overlaps: list[Any]
    """What measures in a run how deep rigid bodies are in one another (contacts/distance/depths.py)."""
    contact_why: str
    """Why contacts of rigid bodies have their mode, or, without contacts, stops, motors and friction: for `explain`."""

    def tied(self, model: str) -> bool:
        """Whether ties hold a body or mass of a model."""

    def ints_of(self, kernel: str) -> tuple[int, ...]:
        """The integers of the first term with a kernel; empty where there is none."""

    def body_count(self) -> int:
        """Number of bodies of the island (contacts choose their mode by it)."""
