"""An island as arrays, laid out by its assembly for the march."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from sceneql.island.breakpoint_table import BreakpointTable
from sceneql.system.channels import ARRAYS
from sceneql.system.fields import Fields

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.quantities.span import Span
    from sceneql.system import Grid, Pattern


@dataclass(frozen=True, slots=True)
class Structure:
    """The names of an island's kernels, each once for each stage; it holds no text or numbers of the script."""

    terms: tuple[str, ...]
    exact: tuple[tuple[str, str], ...]
    """(gap, impact) of each."""
    local: tuple[str, ...]
    after: tuple[str, ...]
    """Kernels that act at the end of steps (Assembly.after_step)."""
    settling: tuple[str, ...]
    """Those that also act on interpolated states (``samples`` of Assembly.after_step)."""
    free: tuple[str, ...]
    """Force-free motions (Assembly.free_motion)."""
    tied: tuple[str, ...]
    """Corrections of drifts by ties (Assembly.tied_drift)."""
    varying: bool
    """Whether any value varies in time."""
    limits: tuple[str, ...] = ()
    """Limits on changes of the state (Assembly.limit)."""
    slopes: tuple[str, ...] | None = None
    """The slopes kernels of the Jacobian; "kernel|positive" where positive slopes have a kernel of their own. None:
    there is no Jacobian, or it is found by differences."""
    energies: tuple[str, ...] | None = None
    """The energy kernel of each of ``terms``, empty where the term moves nothing; None: the island has no potential, or
    no slopes."""


@dataclass(frozen=True, slots=True)
class Origin:
    """The part and line of the script that entries of the state come from."""

    part: str
    span: Span | None


@dataclass(frozen=True, slots=True, eq=False)
class System:
    """An island as arrays."""

    structure: Structure
    y: Floats
    """(n,) the state at the start."""
    floats: Floats
    ints: NDArray[int64]
    """Offsets, then the integers of every block (layout.py)."""
    grown: Callable[[Floats], System | None]
    """Lays the island out again with a larger Jacobian pattern (Assembly.grows), given its present floats; None: the
    pattern has not grown."""
    pairs: int
    """Number of pairs of exact contacts."""
    partner: NDArray[int64]
    """(n,) for a position entry of y the index of its velocity, else -1."""
    ranges: tuple[tuple[int, int, str, tuple[Span | None, ...]], ...]
    largest_step: float = float("inf")
    """Largest adaptive step [s]."""
    stops: BreakpointTable = field(default_factory=BreakpointTable)
    """Breakpoints, where adaptive steps end."""
    pattern: Pattern | None = None
    """Sparsity pattern of its Jacobian; None: there is none, or it is too large for differences."""
    fields: Fields = field(default_factory=Fields)
    unsloped: str = ""
    """Name of the first part without slopes; empty where all parts have them."""
    grids: tuple[Grid, ...] = ()
    """The grids of all its fields."""
    masses: tuple[tuple[int, int, int], ...] = ()
    """For each model of masses: offset of velocities in y, offset of inverse masses in floats, number of masses."""
    inertia: tuple[tuple[int, Any], ...] = ()
    """(offset in y, sparse matrix): mass matrices of velocities (Assembly.inertia), and matrices by which other rates
    are solved for (Assembly.capacity)."""
    border: int = 0
    """Unknowns that border the linear systems of implicit stages (Slopes.border)."""
    alike: tuple[tuple[int, int], ...] = ()
    """(offset, count) of further entries of y with a common error scale (Assembly.alike)."""
    following: tuple[tuple[int, int], ...] = ()
    """(offset, count) of entries of y that are functions of others (Assembly.follows)."""
    rests: tuple[tuple[int, Floats], ...] = ()
    """(offset, values at rest) of entries of y that start elsewhere (Assembly.displaced)."""
    terms: tuple[Origin, ...] = ()
    """The origins of the terms of the rate, in the order in which they act."""
    events: tuple[tuple[int, Origin, str], ...] = ()
    """For each exact contact: the number of its pairs, its origin, and its advice where impacts accumulate without
    end."""
    gives_way: bool = False
    """Whether a contact can go on in another mode then (Assembly.gives_way)."""
    damped: bool = False
    """Whether forces also depend on velocities; the energies are then those of the forces at zero velocities."""

    stiff: tuple[tuple[str, Any], ...] = ()
    """(kernel, integers) of terms that additive methods may march implicitly (``stiff`` of Assembly.term)."""
    names: tuple[tuple[int, int, Callable[[int], str]], ...] = ()
    """(offset, count, name of an entry by its number) of entries that have names of their own."""

    def after(self, floats: Floats) -> Floats:
        """The floats with which this system continues from ``floats`` of the same island before its pattern grew."""
        import numpy as np

        arrays = len(ARRAYS) * len(self.y)
        kept = len(floats) - arrays
        return np.concatenate([floats[:kept], self.floats[kept : len(self.floats) - arrays], floats[kept:]])

    def name(self, index: int) -> str:
        """The own name of an entry of y, as that of an `equations` state; empty where it has none."""
        for first, count, name in self.names:
            if first <= index < first + count:
                return name(index - first)
        return ""

    def origin(self, index: int) -> Origin:
        """The part and line of the script that an entry of y comes from."""
        for first, last, part, spans in self.ranges:
            if first <= index < last:
                return Origin(part, spans[(index - first) * len(spans) // (last - first)])
        return Origin("island", None)
