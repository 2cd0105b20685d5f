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
    """The kernels of an island by name, each once for each stage, without text or numbers of the script."""

    terms: tuple[str, ...]
    exact: tuple[tuple[str, str], ...]
    """(gap, impact)."""
    local: tuple[str, ...]
    after: tuple[str, ...]
    """Kernels that act at the end of steps."""
    settling: tuple[str, ...]
    """Those that act on samples, too."""
    free: tuple[str, ...]
    """Free motions."""
    tied: tuple[str, ...]
    """What lets drifts end where ties hold."""
    varying: bool
    """Whether values vary in time."""
    limits: tuple[str, ...] = ()
    """What keeps surfaces apart (Assembly.limit)."""
    slopes: tuple[str, ...] | None = None
    """The kernels of the Jacobian, of positive slopes too where those are others ("kernel|positive"); None: there is
    none, or it is found by differences."""
    energies: tuple[str, ...] | None = None
    """For each of ``terms`` the kernel of its energy, empty where it moves nothing; None: the island has no potential,
    or no slopes."""


@dataclass(frozen=True, slots=True)
class Origin:
    """The part and lines of the script that entries of the state come from."""

    part: str
    span: Span | None


@dataclass(frozen=True, slots=True, eq=False)
class System:
    """An island as arrays."""

    structure: Structure
    y: Floats
    """(n,) the start."""
    floats: Floats
    ints: NDArray[int64]
    """Offsets, then the integers of every block (layout.py)."""
    grown: Callable[[Floats], System | None]
    """Lays the island out again with more places for slopes (Assembly.grows), from its present floats; None: there are
    no more."""
    pairs: int
    """Number of pairs of exact contacts."""
    partner: NDArray[int64]
    """(n,) for a position its velocity's index, else -1."""
    ranges: tuple[tuple[int, int, str, tuple[Span | None, ...]], ...]
    largest_step: float = float("inf")
    """Largest adaptive step [s]."""
    stops: BreakpointTable = field(default_factory=BreakpointTable)
    """Breakpoints, where adaptive steps end."""
    pattern: Pattern | None = None
    """Sparsity pattern of its Jacobian; None: there is none, or it is too large to be found by differences."""
    fields: Fields = field(default_factory=Fields)
    unsloped: str = ""
    """Name of the first part without slopes; empty where all have them."""
    grids: tuple[Grid, ...] = ()
    """The grids of all its fields."""
    masses: tuple[tuple[int, int, int], ...] = ()
    """For each model of masses: offset of velocities in y, offset of inverse masses in floats, number of masses."""
    inertia: tuple[tuple[int, Any], ...] = ()
    """Offset and sparse matrix of velocities whose inertia is one (Assembly.inertia), and of other entries whose rates
    are solved for by one (Assembly.capacity)."""
    border: int = 0
    """Unknowns that border the linear systems of implicit stages (Slopes.border)."""
    alike: tuple[tuple[int, int], ...] = ()
    """Offset and number of further entries of y that are of one size."""
    following: tuple[tuple[int, int], ...] = ()
    """Offset and number of entries of y that are functions of others (Assembly.follows)."""
    rests: tuple[tuple[int, Floats], ...] = ()
    """Offset and values at rest of entries of y that start elsewhere."""
    terms: tuple[Origin, ...] = ()
    """The origins of the terms of the rate, in the order in which they act."""
    events: tuple[tuple[int, Origin, str], ...] = ()
    """Of each exact contact the number of its pairs, its origin, and what is said where they have no end."""
    gives_way: bool = False
    """Whether a word of such contacts has another way for what is left then."""
    damped: bool = False
    """Whether forces depend on velocities besides: then the energies are those of forces at rest."""

    names: tuple[tuple[int, int, Callable[[int], str]], ...] = ()
    """Offset, count and names by number of entries that have names of their own."""

    def after(self, floats: Floats) -> Floats:
        """The floats with which it goes on from those of the same island before it had more places for slopes."""
        import numpy as np

        arrays = len(ARRAYS) * len(self.y)
        kept = len(floats) - arrays
        return np.concatenate([floats[:kept], self.floats[kept : len(self.floats) - arrays], floats[kept:]])

    def name(self, index: int) -> str:
        """The name of an entry of y, as a state of equations has one; else empty."""
        for first, count, name in self.names:
            if first <= index < first + count:
                return name(index - first)
        return ""

    def origin(self, index: int) -> Origin:
        """Part and line of the script of an entry of y."""
        for first, last, part, spans in self.ranges:
            if first <= index < last:
                return Origin(part, spans[(index - first) * len(spans) // (last - first)])
        return Origin("island", None)
