"""An island's Jacobian as it is laid out: its pattern, and the section of integers that its kernel works by.

The section, at ints[4], all indices absolute: [values, entries, places_at, starts_at, masses_at, mass_triples, first
block of every group and the end of the last, ...]; a block is (first and last of its integers, first and last of its
entries in ``values``); at places_at the place of every entry among the values; at starts_at the starts of the rows; at
masses_at triples (velocity_at, inverse_at, count).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate
from typing import TYPE_CHECKING

import numpy as np

from sceneql.system import Pattern, Slopes

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

BY_DIFFERENCES = 400
"""Up to so many entries of y a Jacobian is found by differences where a term does not know its own."""
HEAD = 6
"""Integers of a section before its groups."""


def full(size: int) -> Pattern | None:
    """The pattern of a Jacobian by differences; None where there are too many entries."""
    if size > BY_DIFFERENCES:
        return None
    starts = np.arange(size + 1, dtype=np.int64) * size
    return Pattern(
        starts,
        np.tile(np.arange(size, dtype=np.int64), size),
        size * size + 3 * size,
        False,
        np.zeros(0, dtype=np.int64),
    )


def section(
    at: int,
    size: int,
    slopes: Sequence[tuple[Slopes, Sequence[int]]],
    masses: Sequence[tuple[int, int, int]],
) -> tuple[Pattern, tuple[str, ...], NDArray[int64]]:
    """The pattern of ``size`` rows, the kernels in order, and the section that is to stand ``at`` an index of ints.

    ``slopes`` with the integers of each; ``masses``: (velocity_at, inverse_at, count) of each model of masses.
    """
    by_kernel: dict[str, list[tuple[Slopes, Sequence[int]]]] = {}
    for one in slopes:
        by_kernel.setdefault(one[0].kernel, []).append(one)
    ordered = [one for group in by_kernel.values() for one in group]
    found, places = _pattern(size, [one for one, _ in ordered])
    count = len(found.columns)
    groups_at = at + HEAD
    blocks_at = groups_at + len(by_kernel) + 1
    places_at = blocks_at + 4 * len(ordered)
    starts_at = places_at + len(places)
    masses_at = starts_at + size + 1
    ints_at = list(accumulate((len(ints) for _, ints in ordered), initial=masses_at + 3 * len(masses)))
    entries_at = list(accumulate((len(one.rows) for one, _ in ordered), initial=count))
    parts = [
        [count, len(places), places_at, starts_at, masses_at, len(masses)],
        list(accumulate((4 * len(group) for group in by_kernel.values()), initial=blocks_at)),
        np.column_stack([ints_at[:-1], ints_at[1:], entries_at[:-1], entries_at[1:]]).ravel(),
        places,
        found.starts,
        np.ravel(masses),
        *(ints for _, ints in ordered),
    ]
    return found, tuple(by_kernel), np.concatenate([np.asarray(part, dtype=np.int64) for part in parts])


def _pattern(size: int, slopes: Sequence[Slopes]) -> tuple[Pattern, NDArray[int64]]:
    """The pattern, and for every entry of the slopes its place among the values."""
    diagonal = np.arange(size, dtype=np.int64)
    rows = np.concatenate([*(np.asarray(one.rows, dtype=np.int64) for one in slopes), diagonal])
    columns = np.concatenate([*(np.asarray(one.columns, dtype=np.int64) for one in slopes), diagonal])
    kept, places = np.unique(rows * size + columns, return_inverse=True)
    starts = np.searchsorted(kept, np.arange(size + 1, dtype=np.int64) * size)
    entries = len(rows) - size
    tallies = np.setdiff1d(diagonal, np.concatenate([rows[:entries], columns[:entries]]))
    found = Pattern(starts.astype(np.int64), kept % max(size, 1), len(kept) + entries, True, tallies)
    return found, places[:entries].astype(np.int64)
