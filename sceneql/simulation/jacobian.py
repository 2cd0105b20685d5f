"""An island's Jacobian as it is laid out: its pattern, and the section of integers that its kernel works by.

The section, at ints[4], all indices absolute: [values, entries, sums_at, starts_at, masses_at, mass_triples, parts_at,
tiles, the numbers of threads_kernels.threads, the addresses of the tiles' kernels (slopes_kernels), first block of
every group and the end of the last, ...]; a block is (first and last of its integers, first and last of its entries in
``values``); at sums_at where the parts of each value start among those at parts_at, which are entries, k or, to be
taken away, -1 - k; at starts_at the starts of the rows; at masses_at triples (velocity_at, inverse_at, count).
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
HEAD = 12
"""Integers of a section before its groups."""
TILE = 20_000
"""Values that a thread sums at a time; fewer are not worth threads."""


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
    from sceneql.simulation.slopes_kernels import scale_tile, sum_tile
    from sceneql.simulation.threads_kernels import threads, tile_address

    found, sums, parts_of = _pattern(size, [one for one, _ in ordered])
    count = len(found.columns)
    groups_at = at + HEAD
    blocks_at = groups_at + len(by_kernel) + 1
    sums_at = blocks_at + 4 * len(ordered)
    parts_at = sums_at + len(sums)
    starts_at = parts_at + len(parts_of)
    masses_at = starts_at + size + 1
    ints_at = list(accumulate((len(ints) for _, ints in ordered), initial=masses_at + 3 * len(masses)))
    entries_at = list(accumulate((one.entries for one, _ in ordered), initial=count))
    shared = (*threads(), tile_address(sum_tile), tile_address(scale_tile))
    parts = [
        [count, entries_at[-1] - count, sums_at, starts_at, masses_at, len(masses)],
        [parts_at, count // TILE + 1, *shared],
        list(accumulate((4 * len(group) for group in by_kernel.values()), initial=blocks_at)),
        np.column_stack([ints_at[:-1], ints_at[1:], entries_at[:-1], entries_at[1:]]).ravel(),
        sums,
        parts_of,
        found.starts,
        np.ravel(masses),
        *(ints for _, ints in ordered),
    ]
    return found, tuple(by_kernel), np.concatenate([np.asarray(part, dtype=np.int64) for part in parts])


def _pattern(size: int, slopes: Sequence[Slopes]) -> tuple[Pattern, NDArray[int64], NDArray[int64]]:
    """The pattern; where the parts of each value start; and the parts, entries in their order or -1 less those."""
    diagonal = np.arange(size, dtype=np.int64)
    rows = np.concatenate([*(np.asarray(one.rows, dtype=np.int64) for one in slopes), diagonal])
    columns = np.concatenate([*(np.asarray(one.columns, dtype=np.int64) for one in slopes), diagonal])
    first = np.concatenate([[0], np.cumsum([one.entries for one in slopes])]).astype(np.int64)
    parts = [np.zeros(0, dtype=np.int64)]
    for one, at in zip(slopes, first.tolist(), strict=False):
        own = np.arange(len(one.rows)) if one.shared is None else np.asarray(one.shared, dtype=np.int64)
        parts.append(np.where(own < 0, own - at, own + at))
    keys = rows * size + columns
    # The diagonal comes last, and so after the entries of its places.
    order = np.argsort(keys, kind="stable")
    keys = keys[order]
    new = np.flatnonzero(np.diff(keys, prepend=-1))
    kept = keys[new]
    summed = order < len(rows) - size
    sums = np.append(0, np.cumsum(summed))[np.append(new, len(keys))]
    starts = np.searchsorted(kept, diagonal * size)
    entries = len(rows) - size
    alone = np.ones(size, dtype=bool)
    alone[rows[:entries]] = alone[columns[:entries]] = False
    tallies = np.flatnonzero(alone)
    starts = np.append(starts, len(kept)).astype(np.int64)
    found = Pattern(starts, kept % max(size, 1), len(kept) + int(first[-1]), True, tallies)
    return found, sums.astype(np.int64), np.concatenate(parts)[order[summed]]
