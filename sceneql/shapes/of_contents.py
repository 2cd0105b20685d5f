"""Results computed from arrays that are known by their numbers, so that equal arrays are not worked on twice."""

from __future__ import annotations

from collections.abc import Callable
from hashlib import blake2b
from typing import TYPE_CHECKING, Any, Generic, TypeVar

if TYPE_CHECKING:
    from numpy.typing import NDArray

T = TypeVar("T")


class OfContents(Generic[T]):
    """The last few results. A run ahead of the film asks for what the film's own run asks for again."""

    def __init__(self, most: int = 2) -> None:
        self._most = most
        self._made: dict[bytes, T] = {}

    def get(self, arrays: tuple[NDArray[Any], ...], make: Callable[[], T]) -> T:
        """The result for these arrays' shapes, types and numbers, else a new one."""
        import numpy as np

        digest = blake2b(digest_size=32)
        for array in arrays:
            digest.update(f"{array.shape} {array.dtype}".encode())
            digest.update(np.ascontiguousarray(array).data)
        key = digest.digest()
        if key not in self._made:
            made = make()
            for old in [*self._made][: max(0, len(self._made) + 1 - self._most)]:
                del self._made[old]
            self._made[key] = made
        return self._made[key]
