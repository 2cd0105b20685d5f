"""A cache of results that are computed once from a field's model for all frames, since domains do not move."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import Any, Generic, TypeVar

T = TypeVar("T")


class Kept(Generic[T]):
    """The ``most`` results used last, by identity of the model and a key; models are referenced, so ids stay unique."""

    def __init__(self, most: int = 8) -> None:
        self._most = most
        self._found: OrderedDict[tuple[int, Hashable], tuple[Any, T]] = OrderedDict()

    def get(self, model: Any, key: Hashable, make: Callable[[], T]) -> T:
        """The cached result, else that of ``make``."""
        place = id(model), key
        if place not in self._found:
            self._found[place] = model, make()
            while len(self._found) > self._most:
                self._found.popitem(last=False)
        self._found.move_to_end(place)
        return self._found[place][1]
