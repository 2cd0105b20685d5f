"""What is made of arrays that never change (frame.is_held), for as long as these live."""

from __future__ import annotations

import weakref
from collections.abc import Callable, Hashable, Sequence
from typing import Any, Generic, TypeVar

from sceneql.frame import is_held

T = TypeVar("T")


class OfHeld(Generic[T]):
    """Results by the arrays that they are made of: of each group of arrays the last one, let go with any of them.

    An array is known by itself (weakly), not by its numbers or its place in memory, so that no other can be taken for
    it. What is made must not hold the arrays themselves, or they would never go.
    """

    def __init__(self) -> None:
        self._made: dict[tuple[int, ...], tuple[list[weakref.ref[Any]], Hashable, T]] = {}

    def __len__(self) -> int:
        return len(self._made)

    def get(self, arrays: Sequence[Any], key: Hashable, make: Callable[[], T]) -> T:
        """What was made of the arrays (None: there is none) with an equal key, or is now; kept where all are held."""
        there = [array for array in arrays if array is not None]
        if not all(map(is_held, there)):
            return make()
        place = tuple(map(id, arrays))
        if place in self._made:
            known, before, made = self._made[place]
            if before == key and all(one() is array for one, array in zip(known, there, strict=True)):
                return made
        made = make()
        self._made[place] = [weakref.ref(array, lambda _: self._made.pop(place, None)) for array in there], key, made
        return made
