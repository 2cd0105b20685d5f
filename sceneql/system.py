"""The system contract: what models, forces and contacts hand to an island, and what a solver sees of it.

An island is a set of models that are solved together. Its state is one vector ``y``; its rate dy/dt = f(t, y) is the
sum of *terms*: compiled kernels of one signature, each called with its own integers and with the island's one array
of floats. All numbers of the script are inputs in that array (so a changed number compiles nothing); values that vary
in time are evaluated into it at every stage time before the terms run.

Kernel signatures (numba; the types are in system_kernels.py), all ``-> None`` unless said:

    term(t, y, rate, floats, ints)          adds its part to rate (n,). Forces add newtons to the velocity entries
    gap(t, y, gaps, floats, ints)           writes signed distances [m] of its contact pairs, > 0 apart (exact mode)
    impact(t, y, pair, floats, ints)        changes y by the impulse of that pair (exact mode)
    settle(t0, t1, y0, rate0, y1, floats, ints)   backs each mass off to its own impact within the step (local mode);
                                            where floats[1] > 0 it only lowers that to when the step should end
    step(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints) -> error   one step of a solver: writes
                                            y1; the error is scaled by the tolerance (accept when <= 1), 0 for fixed
                                            steps
    dense(theta, h, y0, rate0, y1, rate1, work, settings, numbers, out)   the solution inside the step, 0 <= theta <= 1

    slopes(t, y, entries, floats, ints)     adds the derivatives of one term (see Slopes)
    jacobian(functions, t, y, values, floats, ints)   the derivative of the island's rate (see Pattern)

A step gets what it may call as addresses: ``rate = rate_at(functions[AT_RATE])`` and, of a Stepper with ``jacobian``,
``jacobian = jacobian_at(functions[AT_JACOBIAN])`` (compiled/pointers_kernels.py); pass `functions` on to jacobian.
It may be called again from the same start with another h (a rejected step; the search for an event), and `dense`
belongs to the latest call. After an event y0 is not the y1 of the step before.

Stages: the terms run in the order `internal` (a model's own), `force`, `close` (a model turns newtons into
accelerations by its inverse masses and writes dx/dt = v), `constrain` (a resting contact removes what pushes in).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy import bool_, int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.kinds import Object, Ref, Value
    from sceneql.quantities.expression import Expr, Link
    from sceneql.quantities.span import Span

Stage = Literal["internal", "force", "close", "constrain"]
Mode = Literal["exact", "local"]


@dataclass(frozen=True, slots=True)
class Bodies:
    """Point masses in an island's state, as offsets: body k has position y[position_at + 3k : +3] [m]."""

    model: str
    count: int
    position_at: int
    velocity_at: int
    """y[velocity_at + 3k : +3] [m/s]."""
    work_at: int
    """y[work_at]: energy [J] that drag, damping and impacts have taken out so far."""
    mass_at: int
    """floats[mass_at + k] [kg]."""
    inverse_at: int
    """floats[inverse_at + k]: 1/mass; 0 for a fixed body."""
    radius_at: int
    """floats[radius_at + k]: collision radius [m]."""
    period: float = float("inf")
    """No oscillation of the springs between them is faster at the start [s]; infinite without springs."""
    tied: Any = None
    """(m, 2) int: the bodies at the ends of these springs; None without."""


@dataclass(frozen=True, slots=True, eq=False)
class Slopes:
    """The derivatives of one term's addition to the rate: where they stand, and the kernel that computes them.

    The kernel has the signature of a term, ``(t, y, entries, floats, ints)``, and adds to entries[i] (its own slice
    (k,), zero before) the derivative of what the term adds to rate[rows[i]] with respect to y[columns[i]]: for forces
    newtons per meter and per m/s, since the island multiplies by inverse masses and adds dx/dt = v. Places may repeat
    (their entries are summed) and stay the same for the run; rows of the energy taken out (Bodies.work_at) are left
    out. It stands in a kernel file of its own, which explicit solvers then never load.

    While floats[2] is above 0, Newton's method asks for what serves it best. The force itself, where slopes contain it,
    is then to be that which the latest change foresaw: floats[-2n : -n] is the state whose slopes that came from,
    floats[-n:] the state after it. Far from a solution floats[2] is finite, and systems are to be positive definite: a
    kernel that can leaves out what pushes masses away, such as the part of a spring's compression across it, as far as
    it exceeds floats[2] [1/s^2] times the mass.
    """

    kernel: str
    """``"package.module:function"``."""
    rows: Any
    """(k,) int; empty where nothing that the term adds depends on y."""
    columns: Any
    """(k,) int."""
    ints: Any = None
    """The kernel's integers; None: those of the term."""
    shared: Any = None
    """(k,) int, where several places have the same entry: which one each place adds, e, or takes away, -1 - e."""

    blocks: bool = False
    """Places and entries are blocks of 3x3, of which ``rows`` and ``columns`` give the first row and column; the nine
    numbers of an entry follow one another, row by row. Thrice as quick, where masses act on masses."""

    in_stages: bool = False
    """They are known where the term acts in another way than it does for explicit methods. Within stages of Newton's
    method (Stepper.newton) floats[3] is the coefficient a [s] of y = base + a f(t, y), whose base is floats[-3n : -2n];
    floats[4] counts the stages. It is -1 between those, -2 throughout for other methods that ask for slopes (of small
    islands they are found by differences), and 0 for those that ask for none."""

    @property
    def entries(self) -> int:
        """Length of the kernel's slice."""
        count = len(self.rows)
        if self.shared is not None:
            count = int(max(self.shared.max(), -1 - self.shared.min(), -1)) + 1 if len(self.shared) else 0
        return 9 * count if self.blocks else count


@dataclass(frozen=True, slots=True, eq=False)
class Pattern:
    """Where an island's Jacobian may differ from zero, all of the diagonal included: no place twice.

    Its values are first those of the blocks, nine for each, row by row, then the others one by one.
    """

    blocks: NDArray[int64]
    """(b, 2) first row and first column of the blocks of 3x3, rising: rows of velocities of masses."""
    others: NDArray[int64]
    """(s, 2) row and column of each value outside blocks, rising."""
    known: NDArray[bool_]
    """(s,) which of those come from slopes; the rest are zeros on the diagonal."""
    room: int
    """Length of the array ``values`` that the jacobian is called with: the values first, then scratch of its own."""
    exact: bool
    """False: by differences of the rate, the pattern is full."""
    tallies: NDArray[int64]
    """Entries of y that have no slopes at all, such as the energy taken out: nothing depends on them, and what they
    depend on is left out."""

    @property
    def count(self) -> int:
        """Number of values."""
        return 9 * len(self.blocks) + len(self.others)

    @property
    def rows(self) -> NDArray[int64]:
        """(count,) of each value."""
        import numpy as np

        own = (self.blocks[:, :1] + np.array([0, 0, 0, 1, 1, 1, 2, 2, 2])).ravel()
        return np.concatenate([own, self.others[:, 0]])

    @property
    def columns(self) -> NDArray[int64]:
        """(count,) of each value."""
        import numpy as np

        own = (self.blocks[:, 1:] + np.array([0, 1, 2, 0, 1, 2, 0, 1, 2])).ravel()
        return np.concatenate([own, self.others[:, 1]])


@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """An island that is one field on a regular grid, V dc/dt = sum over faces of g (neighbor - c) - sink c + fed.

    Cell (i, j, k) is y[at + i + nx (j + ny k)]; all offsets are into the island's floats, one number a cell. A face's
    conductance g stands with the cell on its high side, at the first cell of a row that between its last and its first
    (0 where the field is not periodic). Cells outside the domain have V = 1 and nothing else.
    """

    shape: tuple[int, int, int]
    at: int
    volumes_at: int
    sink_at: int
    faces_at: tuple[int, int, int]
    """Along x, y, z; that along z is not read where nz is 1."""
    periodic: tuple[bool, bool, bool]
    varying: bool
    """Whether g and sink depend on time or on the field: the rate leaves them in the floats."""
    fed_at: int
    """What is fed, where it does not vary; else -1."""
    outside: Any
    """(cells,) bool: not part of the domain."""
    insides_at: int
    """Volumes, 0 outside."""
    box_at: int
    """Low corner and sides of a cell, six numbers [m]."""
    carried: bool
    """Whether a drift acts on it."""
    keeps: tuple[float, float] = (-math.inf, math.inf)
    """Values that it stays between by the maximum principle."""


class Assembly(Protocol):
    """The island under construction, as words see it."""

    def state(self, initial: Any, spans: Sequence[Span | None] | None = None) -> int:
        """Reserve len(initial) entries of y with these values at the start; the offset of the first.

        ``spans``, one an entry or one for all, say which line of the script an entry comes from.
        """

    def pair(self, position_at: int, velocity_at: int, count: int) -> None:
        """Say that y[velocity_at + k] is the velocity of y[position_at + k] (for methods that use it)."""

    def floats(self, values: Any) -> int:
        """Store numbers; the offset of the first."""

    def value(self, value: Value) -> int:
        """Store a value of the script, a varying one to be evaluated at stage times; the offset of its first float."""

    def initial(self, value: Value) -> Any:
        """The value at the start of the run: float or float64 array."""

    def term(
        self,
        stage: Stage,
        kernel: str,
        ints: Sequence[int],
        jacobian: Slopes | Callable[[], Slopes | None] | None = None,
        apart: bool = False,
    ) -> None:
        """Add a term to the rate; ``kernel`` is ``"package.module:function"``.

        ``jacobian``: its derivatives, or what gives them if a solver asks; None: unknown, then the island uses
        differences of the whole rate. ``apart``: what it does to a body depends on that body and the time alone, so
        that a large island may be solved in blocks of its bodies.
        """

    def inertia(self, velocity_at: int, inverse_at: int, count: int) -> None:
        """Say that a close term multiplies rate[velocity_at + 3k : +3] by floats[inverse_at + k]: slopes likewise."""

    def contact(
        self,
        mode: Mode,
        kernels: Sequence[str],
        ints: Sequence[int],
        pairs: int,
        apart: bool = False,
    ) -> None:
        """Add contacts: kernels (gap, impact) with the number of pairs for `exact`, (settle,) for `local`.

        ``apart``: as of a term, for local ones.
        """

    def grid(self, grid: Grid) -> None:
        """Say that the entries of the state from grid.at on are a field, for solvers that know grids.

        What else a model has in the state (tallies) must depend on the field alone, and nothing on it.
        """

    def offer(self, output: str, grid: Grid) -> None:
        """Say where a field of the model that is being assembled lies: its inflow follows its cells in the state."""

    def field_of(self, link: Link) -> Grid | None:
        """Where the field lies that a link is of; None where it is of none of this island."""

    def object(self, ref: Ref) -> Object:
        """The kind of an object of the script."""

    def changing(self, at: int, count: int) -> None:
        """Say that bodies come and go, and that floats[at:] change as they do, alike in every block of bodies."""

    def remember(self, *ints: int) -> None:
        """Keep integers for the word's own reading: ModelState.ints (a force: for each model; a contact: of all)."""

    def formula(self, link: Link) -> Expr | None:
        """A linked output as an expression of time; None for one of a model that is solved."""

    def step_at_most(self, seconds: float) -> None:
        """Say that steps of a length chosen by a tolerance must not be longer: something happens that it cannot see."""

    def stop_at(self, time: float) -> None:
        """Say that something happens at an instant [s]: such steps end there."""

    def stop_at_breakpoints(self, expr: Expr) -> None:
        """Say that a formula is read: such steps end where the time switches it. (So they do for each `value`.)"""

    def start(self) -> Any:
        """The state reserved so far (n,), at the start of the run."""

    def numbers(self) -> Any:
        """The floats stored so far; of values that vary in time, those at the start."""

    def line(self) -> Span | None:
        """Where in the script the word stands that is being assembled."""

    def places(self, link: Link) -> Any:
        """Where in y the output of a model of the island stands, as indices of its shape; None where it is computed."""

    def body_count(self) -> int:
        """Number of bodies of the island (contacts choose their mode by it)."""


@dataclass(frozen=True, slots=True)
class ModelState:
    """A model's view of its island at an instant."""

    t: float
    y: Floats
    """(n,) the whole island."""
    rate: Floats
    """(n,) dy/dt."""
    floats: Floats
    bodies: Bodies | None
    ints: tuple[int, ...]
    """What the word asked to be remembered (`Assembly.remember`)."""
    potential: float = 0.0
    """Potential energy [J] of the model in the forces that act on it."""


@dataclass(frozen=True, slots=True)
class Prepared:
    """What a step works with on one island."""

    settings: Any
    """Floats for the step, which it may change."""
    numbers: Any
    """Integers for the step, which it may change."""
    work: int
    """Floats of scratch, zero before the first step."""
    text: str = ""
    """How it works there, for `explain`."""


@dataclass(frozen=True, slots=True)
class Stepper:
    """A solver as the run sees it."""

    step: str
    """``"package.module:function"`` of the compiled step."""
    dense: str | None
    """Compiled dense output; None: the cubic Hermite interpolant of the step's ends."""
    order: int
    settings: tuple[float, ...] = ()
    """Floats for the step (a tableau)."""
    numbers: tuple[int, ...] = ()
    """Integers for the step (its stages)."""
    work: int = 1
    """Arrays of the size of y that the step needs as scratch."""
    first_step: float = 0.0
    """The fixed step [s], or the first of an adaptive method (0: choose)."""
    adaptive: bool = False
    tolerance: float = 0.0
    """Relative tolerance of an adaptive method."""
    absolute: float | tuple[float, ...] = 0.0
    """Absolute tolerance, or one of each entry of y."""
    largest_step: float = float("inf")
    jacobian: bool = False
    """Whether the step calls the island's Jacobian (System.pattern)."""
    newton: bool = False
    """Whether all its stages are solved by linear/newton_kernels.py (Slopes.in_stages)."""
    prepare: str | None = None
    """``"package.module:function"``, called with (System, Stepper) -> Prepared in place of settings, numbers and work:
    for what depends on the island, such as the ordering of a factorization."""
    likely: str | None = None
    """``"package.module:function"``, called with the System: modules of kernels that `prepare` will ask for, to be
    compiled early; None: those of linear/stage.py."""
    controls: bool = False
    """Whether an adaptive step leaves in work[0] the length [s] to try next, after acceptance or rejection; else
    the march controls by the error."""
    name: str = ""
    """Its word, where another one may take its place."""
    stability: tuple[float, ...] = ()
    """Of an explicit method: coefficients of its stability function, that of z^0 first."""
    stiff: Stepper | None = None
    """What takes its place where the steps are held by stability."""
    last_stage: int = -1
    """Array of ``work`` that after a step holds the rate at its end (first same as last); -1: none does."""
    unsolved: str = ""
    """What it means where a step of a given length has no finite end; else that the step is unstable."""
    halves: bool = False
    """Whether such a step is halved first, and halved again."""
    extend: str | None = None
    """Compiled function of the step's signature, for what `dense` needs beyond the step (more stages, into `work`):
    called once before a frame is read off a step. Where contacts are exact, `dense` is read after every step without
    it, so the step does that itself (see `prepare`)."""
    on_grid: Stepper | None = None
    """What takes its place on an island that is one field on a grid (System.grid)."""
    otherwise: Stepper | None = None
    """What takes its place from the first step of a given length on that it finds no solution of."""
    by_scale: bool = False
    """Whether the absolute tolerance, on a grid, counts in units of the largest value at the start, and the errors of
    radau and rodas5p in units of how large entries are (stepping/error_scales_kernels.py)."""
    march: str | None = None
    """``"package.module:class"``, a march.March of its own, in place of compiled steps."""
    linear: str = "auto"
    """How its linear systems are solved on a grid (grids/prepare_stages.py)."""
