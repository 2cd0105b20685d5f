"""What a solver hands to the march: its compiled step, and how it is controlled."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


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
