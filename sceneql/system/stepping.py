"""What a solver hands to the march: its compiled step, how that is controlled, and what it needs of the island."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    from sceneql.frame import Floats
    from sceneql.system.fields import Grid


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
class Method:
    """The compiled step and what belongs to it whatever the island; functions are ``"package.module:function"``."""

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
    """Array of ``work`` that after a step holds the rate at its end (first same as last); -1: none does."""
    extend: str | None = None
    """Function of the step's signature, for what `dense` needs beyond the step (more stages, into `work`):
    called once before a frame is read off a step. Where contacts are exact, `dense` is read after every step without
    it, so the step does that itself (see `Needs.prepare`)."""
    stability: tuple[float, ...] = ()
    """Of an explicit method: coefficients of its stability function, that of z^0 first."""
    name: str = ""
    """What `explain` calls it, where the march goes from one method to another."""


@dataclass(frozen=True, slots=True)
class Control:
    """How long steps are: a given length, or a tolerance."""

    first_step: float = 0.0
    """The fixed step [s], or the first of an adaptive method (0: choose)."""
    adaptive: bool = False
    tolerance: float = 0.0
    """Relative tolerance of an adaptive method."""
    absolute: float | tuple[float, ...] = 0.0
    """Absolute tolerance, or one of each entry of y."""
    by_scale: bool = False
    """Whether an adaptive method that knows scales measures errors by these, not by ``absolute``: by how large entries
    have been (stepping/error_scales_kernels.py), or on a grid by the largest value at the start."""
    largest_step: float = float("inf")
    """[s]"""
    self_controlled: bool = False
    """Whether an adaptive step leaves in work[0] the length [s] to try next, after acceptance or rejection; else
    the march controls by the error."""
    unsolved: str = ""
    """What it means where a step of a given length has no finite end; else that the step is unstable."""
    halves: bool = False
    """Whether such a step is halved first, and halved again."""


@dataclass(frozen=True, slots=True)
class Needs:
    """What a method asks of the island before the run; functions and classes are ``"package.module:name"``."""

    jacobian: bool = False
    """Whether the step calls the island's Jacobian (System.pattern)."""
    newton: bool = False
    """Whether all its stages are solved by linear/newton_kernels.py (Slopes.in_stages)."""
    prepare: str | None = None
    """Called with (System, Stepper) -> Prepared in place of settings, numbers and work: for what depends on the
    island, such as the ordering of a factorization."""
    linear: str = "auto"
    """How linear systems are solved, where `prepare` can make them be solved in several ways."""
    likely: str | None = None
    """Called with the System: modules of kernels that `prepare` will ask for, to be compiled early; None: those of
    linear/stage.py."""
    beside: tuple[str, ...] = ()
    """Modules of kernels that `prepare` may ask for, compiled beside but not waited for."""
    march: str | None = None
    """A march.March of its own, in place of compiled steps."""


@dataclass(frozen=True, slots=True)
class Stepper:
    """A method as the march runs it."""

    method: Method
    control: Control = field(default_factory=Control)
    needs: Needs = field(default_factory=Needs)


@dataclass(frozen=True, slots=True)
class IslandFacts:
    """What a solver may know of an island when it chooses its methods (`Solver.choose`)."""

    entries: int = 0
    """Of its state."""
    local_contacts: bool = False
    """Whether contacts back masses off within a step."""
    grid: Grid | None = None
    """Of an island that is one field on a grid and nothing else."""
    floats: Callable[[], Floats] | None = None
    """The island's floats, which the grid's offsets are into."""
