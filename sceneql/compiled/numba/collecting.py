# mypy: ignore-errors
"""Python's garbage collector is off while numba compiles. This replaces no part of numba."""

import gc
from collections.abc import Iterator
from contextlib import contextmanager

MANY, VERY_MANY = 20_000, 3_000_000
"""Objects made by a compilation but not by a load from the cache; and frozen objects that memory has room for."""
out_of_sight: list[int] = []


@contextmanager
def collecting_later() -> Iterator[None]:
    """Leave the garbage collector off: a compilation makes millions of objects that live on, traversed in vain.

    Afterwards these are frozen, or the collector would traverse them at once; when they are too many, it collects all.
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
