"""An island as arrays: what its assembly lays out, and the march works on."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from sceneql.island.breakpoint_table import BreakpointTable

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.quantities.span import Span
    from sceneql.system import Grid, Pattern


@dataclass(frozen=True, slots=True)
class Structure:
    """The kernels of an island by name, each once for each stage. Nothing of the script's text or numbers."""

    terms: tuple[str, ...]
    exact: tuple[tuple[str, str], ...]
    """(gap, impact)."""
    local: tuple[str, ...]
    after: tuple[str, ...]
    """What acts at the end of steps."""
    varying: bool
    """Whether values vary in time."""
    slopes: tuple[str, ...] | None = None
    """The kernels of the Jacobian; None: it is not asked for, or found by differences."""


@dataclass(frozen=True, slots=True)
class Origin:
    """Where entries of the state come from."""

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
    """Offsets, then the integers of every block (layout.py says how they lie)."""
    pairs: int
    """Contact pairs of exact contacts."""
    partner: NDArray[int64]
    """(n,) for a position its velocity's index, else -1."""
    ranges: tuple[tuple[int, int, str, tuple[Span | None, ...]], ...]
    largest_step: float = float("inf")
    """[s], of steps that a tolerance chooses."""
    stops: BreakpointTable = field(default_factory=BreakpointTable)
    """Where such steps end."""
    pattern: Pattern | None = None
    """Of its Jacobian; None: not asked for, or too large to be found by differences."""
    grid: Grid | None = None
    """Of an island that is one field on a grid."""
    unsloped: str = ""
    """The part that gives no slopes, where one gives none."""
    grids: tuple[Grid, ...] = ()
    """Of all its fields."""
    masses: tuple[tuple[int, int, int], ...] = ()
    """Of each model of masses: where in y their velocities start, where in floats their inverse masses, how many."""
    terms: tuple[Origin, ...] = ()
    """Where the terms of the rate come from, in the order in which they act."""

    def origin(self, index: int) -> Origin:
        """Part and line of an entry of y."""
        for first, last, part, spans in self.ranges:
            if first <= index < last:
                return Origin(part, spans[(index - first) * len(spans) // (last - first)])
        return Origin("island", None)
