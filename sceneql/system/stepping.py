"""What a solver hands to the march: its compiled step, its step size control, and its needs of the island."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from sceneql.system.fields import Fields

if TYPE_CHECKING:
    from collections.abc import Callable

    from sceneql.frame import Floats


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
    """(n,) bool: entries whose errors are measured by their own sizes; None: none are."""
    kept: int = 0
    """Floats at the start of the scratch with which the method goes on where the island's Jacobian has more places;
    then its settings and numbers too, but the first setting, its factored matrix's coefficient; 0: it starts anew."""
    scales: tuple[int, int] = (0, 0)
    """Where in the settings the sizes begin that entries have had, and how many; another method goes on with them."""


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
    """Arrays of the size of y that the step needs as scratch."""
    last_stage: int = -1
    """Index of the array of ``work`` with the rate at the step's end (first same as last); -1: none."""
    extend: str | None = None
    """Function of the step's signature that adds the further stages of dense output to `work`; called once before a
    frame is read off a step. Where contacts are exact, `dense` is read after every step without this call, so the step
    computes these stages itself (see `Needs.prepare`)."""
    stability: tuple[float, ...] = ()
    """Coefficients of an explicit method's stability function, that of z^0 first."""
    name: str = ""
    """Its name in `explain`, where the march switches methods."""


@dataclass(frozen=True, slots=True)
class Control:
    """Step size control: a fixed length, or a tolerance."""

    first_step: float = 0.0
    """The fixed step [s], or the first of an adaptive method (0: choose)."""
    adaptive: bool = False
    tolerance: float = 0.0
    """Relative tolerance of an adaptive method."""
    absolute: float | tuple[float, ...] = 0.0
    """Absolute tolerance, of all entries of y or one for each."""
    by_scale: bool = False
    """Whether an adaptive method measures errors by scales in place of ``absolute``: by the sizes that entries have
    had (stepping/error_scales_kernels.py), or on a grid by the largest value at the start."""
    largest_step: float = float("inf")
    """[s]"""
    self_controlled: bool = False
    """Whether an adaptive step writes the next length to try [s] to work[0], after acceptance or rejection; else the
    march controls the step by its error."""
    unsolved: str = ""
    """The message where a step of fixed length has no finite end; empty: that the step is unstable."""
    halves: bool = False
    """Whether such a step is first halved repeatedly."""


@dataclass(frozen=True, slots=True)
class Needs:
    """What a method asks of the island before the run; functions and classes are ``"package.module:name"``."""

    jacobian: bool = False
    """Whether the step calls the island's Jacobian (System.pattern)."""
    newton: bool = False
    """Whether linear/newton_kernels.py solves all its stages (Slopes.in_stages)."""
    at_rest: bool = False
    """Whether it is for states of rest alone, where forces that are damped have their potentials, too."""
    prepare: str | None = None
    """Called with (System, Stepper) -> Prepared, which replaces settings, numbers and work where these depend on the
    island, as the ordering of a factorization does."""
    linear: str = "auto"
    """The script's choice of linear solver, where `prepare` has several."""
    likely: str | None = None
    """Called with the System: modules of kernels that `prepare` will need, to be compiled early; None: those of
    linear/stage.py."""
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
    """The island's floats, which the offsets of fields are into."""
    orbits: bool = False
    """Whether it is masses that nothing but forces at a distance moves (Force.at_a_distance)."""
    apart: bool = False
    """Whether a barrier keeps surfaces apart, towards which explicit steps would creep."""
    in_solids: int = 0
    """Velocities of the nodes of elastic solids: each is tied to so many others that factors fill up."""
