"""The entries of an island's state with their initial values, and the numbers, as words reserve them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

import sceneql.system.channels as channels
from sceneql.failure import LimitRefused
from sceneql.island.memory import LARGEST_MEMORY

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.quantities.span import Span
    from sceneql.system import ModelState

VECTORS = 12
"""Number of arrays of the state's size that a run keeps: states and rates at a step's ends, and a solver's stages."""


@dataclass
class Reserved:
    """The state at the start and the numbers, with the word that reserved each."""

    went_on: Mapping[str, ModelState] = field(init=False, default_factory=dict)
    """The state, by contact, at the instant at which the contact gave way (Assembly.gives_way)."""
    before_contacts: int = field(init=False, default=0)
    """Number of floats stored by models, forces and ties, before those of contacts."""
    gives_way: bool = field(init=False, default=False)
    """Whether a contact can go on in another mode where it finds no solution (Assembly.gives_way)."""
    by_tolerance: bool = field(init=False, default=False)
    """Whether the solver is explicit with adaptive steps."""
    marched: bool = field(init=False, default=True)
    """Whether it is to be marched (Assembly.marched)."""
    _starts: list[Floats] = field(init=False, default_factory=list)
    _size: int = field(init=False, default=0)
    _bodies: int = field(init=False, default=0)
    _ranges: list[tuple[int, int, str, tuple[Span | None, ...]]] = field(init=False, default_factory=list)
    _names: list[tuple[int, int, Callable[[int], str]]] = field(init=False, default_factory=list)
    _pairs: list[tuple[int, int, int]] = field(init=False, default_factory=list)
    _numbers: list[Floats] = field(init=False, default_factory=lambda: [np.zeros(channels.HEAD)])
    _stored: int = field(init=False, default=channels.HEAD)
    _room: Floats = field(init=False, default_factory=lambda: np.zeros(0))
    _scratch: dict[int, int] = field(init=False, default_factory=dict)
    """Offsets of what `scratch` returns, by size."""
    _rests: list[tuple[int, Floats]] = field(init=False, default_factory=list)
    _matrices: dict[int, Any] = field(init=False, default_factory=dict)
    """Mass matrices by the offset of the velocities, and matrices of `capacity` by that of their entries."""
    _capacities: list[int] = field(init=False, default_factory=list)
    _word: tuple[str, Span | None, str | None] = field(init=False, default=("island", None, None))

    @contextmanager
    def word(self, name: str, span: Span | None, model: str | None = None) -> Iterator[None]:
        """Context manager: what is added inside belongs to the part ``name`` (for a force: as it acts on ``model``)."""
        before = self._word
        self._word = (name, span, model)
        try:
            yield
        finally:
            self._word = before

    def capacity(self, at: int, matrix: Any) -> None:
        """Declare a matrix by which rates are solved for (system.Assembly)."""
        self._matrices[at] = matrix
        self._capacities.append(at)

    @property
    def on_elements(self) -> int:
        """Number of entries with a `capacity` matrix, where the state has no others; else 0."""
        if len(self._ranges) != len(self._capacities):
            return 0
        return sum(self._matrices[at].shape[0] for at in self._capacities)

    def begin_contacts(self) -> None:
        """Mark the beginning of contacts: all floats stored from now on are theirs."""
        self.before_contacts = self._stored

    def state(
        self, initial: Any, spans: Sequence[Span | None] | None = None, named: Callable[[int], str] | None = None
    ) -> int:
        """Reserve entries of y (system.Assembly). Raises LimitRefused when the run would need too much memory."""
        start = np.array(initial, dtype=np.float64).ravel()
        name, span, _ = self._word
        self.room(self._size + len(start), span)
        first = self._size
        self._starts.append(start)
        self._size += len(start)
        self._ranges.append((first, self._size, name, tuple(spans) if spans else (span,)))
        if named is not None:
            self._names.append((first, len(start), named))
        return first

    def displaced(self, at: int, values: Any) -> None:
        """Set initial values other than those at rest (system.Assembly)."""
        y = self.start()
        self._rests.append((at, y[at : at + len(values)].copy()))
        y[at : at + len(values)] = values
        self._starts = [y]

    def room(self, entries: float, span: Span | None) -> None:
        """Raise LimitRefused where a state of that many entries needs too much memory.

        Call it before making large arrays.
        """
        memory = 8.0 * entries * VECTORS
        if memory > LARGEST_MEMORY:
            raise LimitRefused(
                f"a state of {entries:.3g} numbers needs about {memory / 2**30:.3g} GiB; at most "
                f"{LARGEST_MEMORY / 2**30:.0f} GiB are allowed",
                span,
                "use fewer masses or a coarser lattice",
            )

    def pair(self, position_at: int, velocity_at: int, count: int) -> None:
        """Declare pairs of positions and velocities (system.Assembly)."""
        self._pairs.append((position_at, velocity_at, count))
        self._bodies += count // 3

    def floats(self, values: Any) -> int:
        """Store numbers; returns the offset of the first."""
        numbers = np.array(values, dtype=np.float64).ravel()
        first = self._stored
        self._numbers.append(numbers)
        self._stored += len(numbers)
        return first

    def scratch(self, size: int) -> int:
        """Floats that every word may overwrite (system.Assembly)."""
        if size not in self._scratch:
            self._scratch[size] = self.floats(np.zeros(size))
        return self._scratch[size]

    def write(self, at: int, values: Any) -> None:
        """Overwrite stored numbers (system.Assembly)."""
        numbers = self._joined()
        if not numbers.flags.writeable:  # it belongs to an island that is laid out already
            numbers = numbers.copy()
        numbers[at : at + len(values)] = values
        self._numbers = [numbers]

    def start_at(self, at: int, values: Any) -> None:
        """Overwrite entries of the state at the start (system.Assembly)."""
        start = self.start()
        start[at : at + len(values)] = values
        self._starts = [start]

    def line(self) -> Span | None:
        """The place in the script of the word that is being assembled."""
        return self._word[1]

    def start(self) -> Floats:
        """The state reserved so far, at the start of the run."""
        return np.concatenate(self._starts) if self._starts else np.zeros(0)

    def numbers(self, first: int = 0, last: int | None = None) -> Floats:
        """The floats stored so far, or those from ``first`` to before ``last``: a copy."""
        return self._joined()[first:last].copy()

    def _share(self, floats: Floats) -> None:
        """Keep the floats of an island that is laid out, without a copy: each march writes to its own."""
        self._numbers = [floats[: self._stored]]
        self._numbers[0].flags.writeable = False
        self._room = np.zeros(0)

    def _joined(self) -> Floats:
        """The floats stored so far, in one array with room for more: many words ask, each after storing a few."""
        joined, *later = self._numbers
        if not later:
            return joined
        if len(self._room) < self._stored or joined.base is not self._room:
            self._room = np.empty(self._stored + self._stored // 2)
            self._room[: len(joined)] = joined
        np.concatenate(later, out=self._room[len(joined) : self._stored])
        self._numbers = [self._room[: self._stored]]
        return self._numbers[0]
