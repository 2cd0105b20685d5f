# mypy: ignore-errors
"""Python's garbage collector stands still while numba compiles. This leaves numba itself as it is."""

import gc
from collections.abc import Iterator
from contextlib import contextmanager

MANY, VERY_MANY = 20_000, 3_000_000
"""Objects that a compilation makes, a load from the cache does not; and how many of them memory has room for."""
out_of_sight: list[int] = []


@contextmanager
def collecting_later() -> Iterator[None]:
    """Leave the garbage collector off: a compilation makes millions of objects that live on, looked over in vain.

    Afterwards they are kept out of its sight too, or it would look them over at once, until there are very many.
    """
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            made = gc.get_count()[0]
            if made > MANY:
                out_of_sight.append(made)
                if sum(out_of_sight) > VERY_MANY:
                    out_of_sight.clear()
                    gc.unfreeze()
                    gc.collect()
                gc.freeze()
            gc.enable()
