"""What words reserve of an island: entries of its state with their values at the start, and numbers."""

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
"""Arrays of the state's size that a run keeps: states and rates at a step's ends, and the stages of a solver."""


@dataclass
class Reserved:
    """The state at the start and the numbers, each with the word that reserved it."""

    went_on: Mapping[str, ModelState] = field(init=False, default_factory=dict)
    """By contact that has given way (Assembly.gives_way) its state at that instant, from which the island goes on."""
    before_contacts: int = field(init=False, default=0)
    """How many numbers there are of models, forces and ties."""
    gives_way: bool = field(init=False, default=False)
    """Whether a contact has another way for what is left, where its events have none."""
    by_tolerance: bool = field(init=False, default=False)
    """Whether the solver is explicit, and a tolerance chooses its steps."""
    _starts: list[Floats] = field(init=False, default_factory=list)
    _size: int = field(init=False, default=0)
    _bodies: int = field(init=False, default=0)
    _ranges: list[tuple[int, int, str, tuple[Span | None, ...]]] = field(init=False, default_factory=list)
    _names: list[tuple[int, int, Callable[[int], str]]] = field(init=False, default_factory=list)
    _pairs: list[tuple[int, int, int]] = field(init=False, default_factory=list)
    _numbers: list[Floats] = field(init=False, default_factory=lambda: [np.zeros(channels.HEAD)])
    _stored: int = field(init=False, default=channels.HEAD)
    _rests: list[tuple[int, Floats]] = field(init=False, default_factory=list)
    _matrices: dict[int, Any] = field(init=False, default_factory=dict)
    """Inertia that is a matrix, by the offset of the velocities, and other capacities, by that of the entries."""
    _capacities: list[int] = field(init=False, default_factory=list)
    _word: tuple[str, Span | None, str | None] = field(init=False, default=("island", None, None))

    @contextmanager
    def word(self, name: str, span: Span | None, model: str | None = None) -> Iterator[None]:
        """Mark what is added inside the context as the part ``name``'s (a force's on ``model``)."""
        before = self._word
        self._word = (name, span, model)
        try:
            yield
        finally:
            self._word = before

    def capacity(self, at: int, matrix: Any) -> None:
        """Say that rates of entries are solved for by a matrix (system.Assembly)."""
        self._matrices[at] = matrix
        self._capacities.append(at)

    @property
    def on_elements(self) -> int:
        """Unknowns with such rates, where there are no others."""
        if len(self._ranges) != len(self._capacities):
            return 0
        return sum(self._matrices[at].shape[0] for at in self._capacities)

    def begin_contacts(self) -> None:
        """Say that all that comes now belongs to contacts."""
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
        """Let entries start elsewhere than at rest (system.Assembly)."""
        y = self.start()
        self._rests.append((at, y[at : at + len(values)].copy()))
        y[at : at + len(values)] = values
        self._starts = [y]

    def room(self, entries: float, span: Span | None) -> None:
        """Raise LimitRefused where a state of so many entries exceeds memory; call it before making large arrays."""
        memory = 8.0 * entries * VECTORS
        if memory > LARGEST_MEMORY:
            raise LimitRefused(
                f"a state of {entries:.3g} numbers needs about {memory / 2**30:.3g} GiB; at most "
                f"{LARGEST_MEMORY / 2**30:.0f} GiB are allowed",
                span,
                "use fewer masses or a coarser lattice",
            )

    def pair(self, position_at: int, velocity_at: int, count: int) -> None:
        """Say which entries are velocities of which (system.Assembly)."""
        self._pairs.append((position_at, velocity_at, count))
        self._bodies += count // 3

    def floats(self, values: Any) -> int:
        """Store numbers; the offset of the first."""
        numbers = np.array(values, dtype=np.float64).ravel()
        first = self._stored
        self._numbers.append(numbers)
        self._stored += len(numbers)
        return first

    def write(self, at: int, values: Any) -> None:
        """Replace numbers (system.Assembly)."""
        numbers = self.numbers()
        numbers[at : at + len(values)] = values
        self._numbers = [numbers]

    def line(self) -> Span | None:
        """The place in the script of the word that is being assembled."""
        return self._word[1]

    def start(self) -> Floats:
        """The state reserved so far, at the start of the run."""
        return np.concatenate(self._starts) if self._starts else np.zeros(0)

    def numbers(self) -> Floats:
        """The floats stored so far."""
        if len(self._numbers) > 1:  # many words ask, each after it has stored a few
            self._numbers = [np.concatenate(self._numbers)]
        return self._numbers[0].copy()
