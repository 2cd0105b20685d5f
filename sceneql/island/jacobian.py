"""The layout of an island's Jacobian: its sparsity pattern, and the section of integers that its kernel reads."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import accumulate
from typing import TYPE_CHECKING

import numpy as np

from sceneql.island import layout
from sceneql.island.rising import rising
from sceneql.system import Pattern, Slopes

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.system.assembly import Ints

    Numbers = NDArray[int64]
    Triples = Sequence[tuple[int, int, int]]

BY_DIFFERENCES = 400
"""Largest number of entries of y at which the Jacobian is found by differences where a term gives no derivatives."""
TILE = 20_000
"""Number of values in a thread's tile; fewer are not worth threads."""
_NONE = np.zeros(0, dtype=np.int64)


def full(size: int) -> Pattern | None:
    """The pattern of a dense Jacobian found by differences; None where there are more than BY_DIFFERENCES entries."""
    if size > BY_DIFFERENCES:
        return None
    rows, columns = np.divmod(np.arange(size * size, dtype=np.int64), max(size, 1))
    every = np.column_stack([rows, columns])
    known = np.ones(len(every), dtype=bool)
    return Pattern(_NONE.reshape(0, 2), every, known, size * size + 3 * size, False, _NONE)


def section(
    at: int,
    size: int,
    slopes: Sequence[tuple[Slopes, Ints]],
    masses: Triples,
    pairs: Triples,
    border: int = 0,
) -> tuple[Pattern, tuple[str, ...], Numbers]:
    """The pattern of ``size`` rows, the kernels in order, and the section of integers that begins at ints[at].

    A border of m unknowns adds 2 m rows and columns (Slopes.border), and scratch for a rate. ``slopes``: each with its
    integers; ``masses``: (velocity_at, inverse_at, count) of each model of masses, with inverse_at -1 where the inertia
    is a matrix, which multiplies no rows; ``pairs``: (position_at, velocity_at, count of entries).
    """
    by_kernel: dict[str, list[tuple[Slopes, Ints]]] = {}
    for one in slopes:
        by_kernel.setdefault("|".join(filter(None, (one[0].kernel, one[0].positive))), []).append(one)
    ordered = [one for group in by_kernel.values() for one in group]
    from sceneql.compiled.threads_kernels import threads, tile_address
    from sceneql.island.jacobian_kernels import block_tile, single_tile

    found, lists = _pattern(size + 2 * border, [one for one, _ in ordered], masses, pairs)
    if border:
        found = replace(found, room=found.room + size, tallies=found.tallies[found.tallies < size])
    count, blocks, singles = found.count, len(found.blocks), len(lists[2]) // 3 - 1
    kernels_at = at + layout.HEAD + len(by_kernel) + 1
    terms_at = kernels_at + layout.CALLS * len(by_kernel)
    starts = list(accumulate((len(part) for part in lists), initial=terms_at + 4 * len(ordered)))
    masses_at = starts.pop()
    ints_at = list(accumulate((len(ints) for _, ints in ordered), initial=masses_at + 3 * len(masses)))
    entries_at = list(accumulate((one.entries for one, _ in ordered), initial=count))
    parts = [
        [count, entries_at[-1] - count, blocks, 9 * blocks // TILE + 1, masses_at, len(masses), *starts[:2]],
        [singles, singles // TILE + 1, *starts[2:]],
        [*threads(), tile_address(block_tile), tile_address(single_tile), len(by_kernel), kernels_at, int(border > 0)],
        list(accumulate((4 * len(group) for group in by_kernel.values()), initial=terms_at)),
        [0] * (terms_at - kernels_at),
        np.column_stack([ints_at[:-1], ints_at[1:], entries_at[:-1], entries_at[1:]]).ravel(),
        *lists,
        np.ravel(masses),
        *(ints for _, ints in ordered),
    ]
    return found, tuple(by_kernel), np.concatenate([np.asarray(part, dtype=np.int64) for part in parts])


def _pattern(
    size: int, slopes: Sequence[Slopes], masses: Triples, pairs: Triples
) -> tuple[Pattern, tuple[Numbers, Numbers, Numbers, Numbers]]:
    """The pattern, and four lists of integers: the blocks' table and parts, then those of single values.

    The layout of the lists is that of layout.py; the table of single values includes its end.
    """
    top, inverse, in_masses = _masses_of(size, masses, pairs)
    first = list(accumulate((one.entries for one in slopes), initial=0))
    blocks, singles = ([one for one in zip(slopes, first, strict=False) if one[0].blocks == kind] for kind in (1, 0))
    (rows, columns, parts), (block_rows, block_columns, block_parts) = _joined(singles), _joined(blocks)
    tallies = np.ones(size, dtype=bool)
    for places in (rows, columns):
        tallies[places] = False
    for places in (block_rows, block_columns):
        tallies[(places[:, None] + np.arange(3)).ravel()] = False
    # The pattern always has the diagonal; values in rows of masses make blocks.
    diagonal = np.arange(size, dtype=np.int64)
    summed = np.repeat([True, False], [len(rows), size])
    rows, columns = np.concatenate([rows, diagonal]), np.concatenate([columns, diagonal])
    inside = in_masses[rows] & (top[columns] >= 0)
    block_keys = block_rows * size + block_columns
    inside_keys = top[rows[inside]] * size + top[columns[inside]]
    kept, starts, order = _distinct(block_keys, inside_keys)
    table = np.column_stack([starts[:-1], inverse[kept // max(size, 1)]]).ravel()

    target = np.empty(len(rows), dtype=np.int64)
    number = np.searchsorted(kept, inside_keys)
    own = 3 * (rows[inside] - top[rows[inside]]) + columns[inside] - top[columns[inside]]
    target[inside] = 9 * number + own
    keys = rows[~inside] * size + columns[~inside]
    others = rising(keys)
    target[~inside] = 9 * len(kept) + np.searchsorted(others, keys)
    more = np.arange(9 * len(kept), 9 * len(kept) + len(others))
    single, single_starts, single_order = _distinct(target[summed], more)
    in_blocks = 9 * len(kept)
    keys_of = np.concatenate([kept[single[single < in_blocks] // 9], others])
    single_table = np.column_stack([single, inverse[keys_of // max(size, 1)], single_starts[:-1]]).ravel()
    known = np.zeros(len(others), dtype=bool)
    known[target[summed & ~inside] - 9 * len(kept)] = True
    found = Pattern(
        np.column_stack(np.divmod(kept, max(size, 1))),
        np.column_stack(np.divmod(others, max(size, 1))),
        known,
        9 * len(kept) + len(others) + first[-1],
        True,
        np.flatnonzero(tallies),
    )
    end = [-1, -1, int(single_starts[-1])]
    lists = (np.append(table, starts[-1]), block_parts[order], np.append(single_table, end), parts[single_order])
    return found, lists


def _masses_of(size: int, masses: Triples, pairs: Triples) -> tuple[Numbers, Numbers, NDArray[np.bool_]]:
    """Three arrays (size,) over the entries of y, by which entries are grouped into masses.

    First entry of the mass's position or velocity, -1 for other entries; offset of the inverse mass for velocities,
    else -1; whether the entry is the velocity of a mass.
    """
    top, inverse = np.full(size, -1, dtype=np.int64), np.full(size, -1, dtype=np.int64)
    moving = np.zeros(size, dtype=bool)
    for velocity_at, inverse_at, count in masses:
        own = np.arange(count).repeat(3)
        moving[velocity_at : velocity_at + 3 * count] = True
        top[velocity_at : velocity_at + 3 * count] = velocity_at + 3 * own
        inverse[velocity_at : velocity_at + 3 * count] = inverse_at + own if inverse_at >= 0 else -1
    for position, velocity, count in pairs:
        if (top[velocity : velocity + count : 3] == np.arange(velocity, velocity + count, 3)).all() and count % 3 == 0:
            top[position : position + count] = position + 3 * np.arange(count // 3).repeat(3)
    return top, inverse, moving


def _joined(slopes: Sequence[tuple[Slopes, int]]) -> tuple[Numbers, Numbers, Numbers]:
    """Concatenated rows, columns and parts (layout.py) of slopes, each given with the index of its first entry."""
    rows, columns, parts = [_NONE], [_NONE], [_NONE]
    for one, at in slopes:
        size = 9 if one.blocks else 1
        own = np.arange(len(one.rows)) if one.shared is None else np.asarray(one.shared, dtype=np.int64)
        rows.append(np.asarray(one.rows, dtype=np.int64))
        columns.append(np.asarray(one.columns, dtype=np.int64))
        parts.append(np.where(own < 0, -1 - (at + size * (-1 - own)), at + size * own))
    return np.concatenate(rows), np.concatenate(columns), np.concatenate(parts)


def _distinct(keys: Numbers, more: Numbers) -> tuple[Numbers, Numbers, Numbers]:
    """Distinct keys of both arrays, ascending; starts (and end) of each one's run in sorted ``keys``; that order."""
    order = np.argsort(keys, kind="stable")
    ordered = keys[order]
    kept = rising(np.concatenate([ordered, more]))
    return kept, np.append(np.searchsorted(ordered, kept), len(keys)), order
