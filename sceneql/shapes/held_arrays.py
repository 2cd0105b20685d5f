"""A cache of results computed from arrays that never change (frame.is_held), kept as long as the arrays live."""

from __future__ import annotations

import weakref
from collections.abc import Callable, Hashable, Sequence
from typing import Any, Generic, TypeVar

from sceneql.frame import is_held

T = TypeVar("T")


class OfHeld(Generic[T]):
    """The last result for each group of arrays; it is dropped with any of them.

    Arrays are known by identity (weak references), not by their numbers or address, so that no other array can be
    mistaken for one. A result must not refer to the arrays, or they would never be freed.
    """

    def __init__(self) -> None:
        self._made: dict[tuple[int, ...], tuple[list[weakref.ref[Any]], Hashable, T]] = {}

    def __len__(self) -> int:
        return len(self._made)

    def get(self, arrays: Sequence[Any], key: Hashable, make: Callable[[], T]) -> T:
        """The result for these arrays (None: no array) and an equal key, else a new one; kept where all are held."""
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
