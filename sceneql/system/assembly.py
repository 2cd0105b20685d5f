"""The island under construction, as models, forces and contacts see it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, Protocol

from sceneql.system.terms import Slopes, Stage

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from sceneql.kinds.values import Ref, Value
    from sceneql.kinds.word import Kind
    from sceneql.quantities.expression import Expr, Link
    from sceneql.quantities.span import Span
    from sceneql.system.fields import Grid

Mode = Literal["exact", "local"]
"""Of contacts: located events and impulses, or masses that back off within a step."""


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
        """Store a value of the script, a varying one to be evaluated at stage times; the offset of its first float.

        It is read by terms and contacts of the word that is being assembled: where it depends on the state, what these
        terms do by it is part of the Jacobian (system.Slopes).
        """

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

    def contact(self, mode: Mode, kernels: Sequence[str], ints: Sequence[int], pairs: int, apart: bool = False) -> None:
        """Add contacts: kernels (gap, impact) with the number of pairs for `exact`, (settle,) for `local`.

        ``apart``: as of a term, for local ones.
        """

    def after_step(self, kernel: str, ints: Sequence[int], apart: bool = False) -> None:
        """Add what happens at the end of each accepted step: springs that tear, particles that are born.

        ``kernel`` is ``"package.module:function"``; it returns whether it has changed anything. ``apart``: as of a
        term.
        """

    def grid(self, grid: Grid) -> None:
        """Say that the entries of the state from grid.at on are a field, for solvers that know grids.

        What else a model has in the state (tallies) must depend on the field alone, and nothing on it.
        """

    def offer(self, output: str, grid: Grid) -> None:
        """Say where a field of the model that is being assembled lies: its inflow follows its cells in the state."""

    def field_of(self, link: Link) -> Grid | None:
        """Where the field lies that a link is of; None where it is of none of this island."""

    def object(self, ref: Ref) -> Kind:
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
