"""What a solver hands to the march: its compiled step, its step size control, and its needs of the island."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from sceneql.system.fields import Fields

if TYPE_CHECKING:
    from collections.abc import Callable

    from sceneql.frame import Floats


UNREAD = -2
"""`Method.last_stage` where the rate at a step's end is nowhere, and no one asks for it: neither dense output nor what
acts between steps."""


@dataclass(frozen=True, slots=True)
class Prepared:
    """The arrays that a step works with on one island."""

    settings: Any
    """Floats for the step, which it may change."""
    numbers: Any
    """Integers for the step, which it may change."""
    work: int
    """Floats of scratch, zero before the first step."""
    text: str = ""
    """How the method solves this island, for `explain`."""
    alone: Any = None
    """(n,) bool: entries whose errors are scaled by their own magnitude alone; None: none."""
    kept: int = 0
    """Number of floats at the start of the scratch that the method keeps when the Jacobian's pattern grows, together
    with its settings and numbers, except settings[0], the coefficient of its factored matrix; 0: the method starts
    anew."""
    scales: tuple[int, int] = (0, 0)
    """Offset and number of the error scales in the settings (largest magnitudes that entries have had); another method
    that takes over goes on with them."""
    last_stage: int | None = None
    """As in `Method`, where it depends on the island."""


@dataclass(frozen=True, slots=True)
class Method:
    """The compiled step and its data for any island; functions are ``"package.module:function"``."""

    step: str
    order: int
    dense: str | None = None
    """Dense output; None: the cubic Hermite interpolant of the step's ends."""
    settings: tuple[float, ...] = ()
    """Floats for the step (a tableau)."""
    numbers: tuple[int, ...] = ()
    """Integers for the step (its stages)."""
    work: int = 1
    """Scratch that the step needs, in arrays of the size of y."""
    last_stage: int = -1
    """Index of the array of ``work`` that holds the rate at the step's end (first same as last); -1: none does; or
    UNREAD."""
    extend: str | None = None
    """Function of the step's signature that adds the further stages of dense output to `work`; called once before a
    frame is read off a step. Where contacts are exact, it is not: `dense` is read after every step, and contacts change
    at its end, so the step computes these stages itself (see `Needs.prepare`)."""
    stability: tuple[float, ...] = ()
    """Coefficients of an explicit method's stability function, that of z^0 first."""
    settles: int = 1
    """Number of steps after which the errors that are removed from samples (``samples`` of Assembly.after_step) are
    removed from the solution itself, where nothing else acts between steps."""
    name: str = ""
    """The method's name in `explain`, where the march switches methods."""


@dataclass(frozen=True, slots=True)
class Control:
    """Step size control: a fixed length, or a tolerance."""

    first_step: float = 0.0
    """The fixed step [s], or the first of an adaptive method (0: choose)."""
    adaptive: bool = False
    tolerance: float = 0.0
    """Relative tolerance of an adaptive method."""
    absolute: float | tuple[float, ...] = 0.0
    """Absolute tolerance, one for all entries of y or one for each."""
    by_scale: bool = False
    """Whether an adaptive method scales errors by magnitudes instead of ``absolute``: by the largest that entries have
    had (stepping/error_scales_kernels.py), or on a grid by the largest value at the start."""
    largest_step: float = float("inf")
    """[s]"""
    self_controlled: bool = False
    """Whether an adaptive step writes the next length to try [s] to work[0], after acceptance or rejection; else the
    march controls the step by its error."""
    unsolved: str = ""
    """The message for a step of fixed length without a finite end; empty: the default, that the step is unstable."""
    halves: bool = False
    """Whether a step of fixed length that fails is first halved repeatedly."""


@dataclass(frozen=True, slots=True)
class Needs:
    """What a method asks of the island before the run; functions and classes are ``"package.module:name"``."""

    jacobian: bool = False
    """Whether the step calls the island's Jacobian (System.pattern)."""
    newton: bool = False
    """Whether linear/newton_kernels.py solves all its stages (Slopes.in_stages)."""
    at_rest: bool = False
    """Whether the method finds states of rest alone, where forces of damped terms also have their potentials."""
    prepare: str | None = None
    """Function ``(System, Stepper) -> Prepared``; replaces settings, numbers and work where these depend on the island,
    as the ordering of a factorization does."""
    linear: str = "auto"
    """The script's choice of linear solver, where `prepare` has several."""
    likely: str | None = None
    """Function of the System that returns the modules of kernels that `prepare` will need, to be compiled early; None:
    those of linear/stage.py."""
    beside: tuple[str, ...] = ()
    """Modules of kernels that `prepare` may need, compiled in the background and not waited for."""
    march: str | None = None
    """A subclass of march.March that replaces compiled steps."""


@dataclass(frozen=True, slots=True)
class Stepper:
    """A method as the march runs it."""

    method: Method
    control: Control = field(default_factory=Control)
    needs: Needs = field(default_factory=Needs)


@dataclass(frozen=True, slots=True)
class IslandFacts:
    """Facts of an island by which a solver chooses its methods (`Solver.choose`)."""

    entries: int = 0
    """Size of its state."""
    local_contacts: bool = False
    """Whether contacts resolve impacts within a step."""
    impacts: bool = False
    """Whether contacts of any kind, tears or births change its state between steps."""
    fields: Fields = field(default_factory=Fields)
    floats: Callable[[], Floats] | None = None
    """Returns the island's floats, into which the offsets of ``fields`` point."""
    orbits: bool = False
    """Whether it consists of masses on which only forces at a distance act (Force.at_a_distance)."""
    free: bool = False
    """Whether it consists of rigid bodies that nothing holds, touches or drives, under constant uniform forces."""
    apart: bool = False
    """Whether a barrier keeps surfaces apart; explicit steps would become ever shorter near it."""
    in_solids: int = 0
    """Number of velocity entries of elastic solids' nodes: their many couplings fill up the factors of the Jacobian."""
    solids_size: float = 1.0
    """Size [m] of the smallest of these solids at the start: the diagonal of its box."""
