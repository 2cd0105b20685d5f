"""Slopes of terms with respect to the state: their own, and through values that they read (an attractor's place).

By the chain rule d rate/dy = (partial d term/dy) + (d term/d value) (d value/dy). Terms give the first part
(system.Slopes). In the second, d value/dy is exact, from the value's formula (Inputs.slopes), and d term/d value is a
finite difference of the term's own kernel with respect to the few floats of the value. So words need no code of their
own for it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.island.inputs import WithoutSlopes
from sceneql.system import Slopes

if TYPE_CHECKING:
    from numpy import bool_, int64
    from numpy.typing import NDArray

    from sceneql.island.blocks_laid import Block
    from sceneql.island.inputs import Inputs, Stored, ValueSlopes, Word
    from sceneql.system import Grid, Stage
    from sceneql.system.assembly import Ints

    Numbers = NDArray[int64]

KERNEL = "sceneql.island.value_slopes_kernels:by_values"


@dataclass(frozen=True, slots=True)
class Layout:
    """The owners of the entries of y, by model, mass and field."""

    size: int
    ranges: Sequence[tuple[int, int, str, Any]]
    """(first entry, end, part, lines of the script)."""
    pairs: Sequence[tuple[int, int, int]]
    """(positions at, velocities at, entries)."""
    inertia: Sequence[tuple[int, int, int]]
    """(velocities at, inverse masses at, masses) of each model of masses."""
    fields: Sequence[Grid]

    @property
    def masses(self) -> list[tuple[int, int]]:
        """(first, end) of the velocities of each model of masses."""
        return [(at, at + 3 * count) for at, _, count in self.inertia]

    @property
    def cells(self) -> list[tuple[int, int]]:
        """(first, end) of each field."""
        return [(grid.at, grid.at + math.prod(grid.cells.shape)) for grid in self.fields]

    def has_masses(self, word: Word) -> bool:
        """Whether a word is a model of masses."""
        own = [(first, end) for first, end, part, _ in self.ranges if part == word[0]]
        return any(first <= at < end for first, end in own for at, _ in self.masses)

    def rows(self, word: Word) -> Numbers:
        """(k,) entries of the rate that a word's terms may add to, without tallies such as the dissipated energy.

        These are velocities for a model of masses and for forces on it, and all entries for other models.
        """
        acted = word[0] if word[1] is None else word[1]
        ranges = [(first, end) for first, end, part, _ in self.ranges if part == acted] or [(0, self.size)]
        inside = [own for own in self.masses if any(first <= own[0] < end for first, end in ranges)]
        return np.concatenate([np.arange(first, end) for first, end in inside or ranges])

    def sums(self) -> NDArray[bool_]:
        """(size,) bool: tallies, the entries of models of masses or fields that belong to no mass and no cell.

        Their rows have no slopes.
        """
        found = np.zeros(self.size, dtype=bool)
        for first, end, *_ in self.ranges:
            found[first:end] = any(first <= at < end for at, _ in (*self.masses, *self.cells))
        for position, velocity, count in self.pairs:
            found[position : position + count] = found[velocity : velocity + count] = False
        for first, end in self.cells:
            found[first:end] = False
        return found


def own_slopes(terms: Mapping[Stage, Sequence[Block]], in_stages: bool) -> list[tuple[Slopes, Ints]]:
    """The terms' own slopes, with their integers; ``in_stages``: including those that hold in stages alone (`Slopes`).

    Raises WithoutSlopes.
    """
    found = []
    for block in (block for stage in terms for block in terms[stage]):
        slopes = block.slopes() if callable(block.slopes) else block.slopes
        if slopes is None or (slopes.in_stages and not in_stages):
            raise WithoutSlopes(block.part)
        found.append((slopes, block.ints if slopes.ints is None else slopes.ints))
    return found


def value_slopes(
    reading: Sequence[Stored],
    terms: Mapping[Stage, Sequence[Block]],
    known: Sequence[Slopes],
    layout: Layout,
    inputs: Inputs,
) -> list[tuple[Slopes, Ints]]:
    """The slopes of terms through values, with their integers; ``known``: the terms' own slopes.

    Raises WithoutSlopes. Derivatives of contact constraints through values are left out.
    """
    if not reading:
        return []
    slopes = {first: inputs.slopes(value) for first, value, _ in reading}
    used = np.zeros(layout.size, dtype=bool)
    for one in known:
        for places in (one.rows, one.columns):
            first_of = np.asarray(places, dtype=np.int64)[:, None]
            entries = (first_of + np.arange(3 if one.blocks else 1)).ravel()
            used[entries[entries < layout.size]] = True
    read = [place for one in slopes.values() for readings in one.readings for place, _ in readings]
    if layout.sums()[read].any():
        raise WithoutSlopes("a value that reads a sum over the state")
    used[read] = True
    found = []
    for word in dict.fromkeys(word for _, _, word in reading):
        # The close term of masses is left out: the Jacobian multiplies by inverse masses itself.
        stages = [
            stage for stage in terms if stage != "constrain" and not (stage == "close" and layout.has_masses(word))
        ]
        acting = [one for stage in stages for one in terms[stage] if (one.part, one.model) == word]
        rows = layout.rows(word)
        if acting:
            values = [(first, slopes[first]) for first, _, reader in reading if reader == word]
            found.append(_slopes(rows[used[rows]], acting, values))
    return found


def _slopes(rows: Numbers, acting: Sequence[Block], values: Sequence[tuple[int, ValueSlopes]]) -> tuple[Slopes, Ints]:
    """The slopes of one word's terms through values, with the integers of value_slopes_kernels.by_values."""
    from sceneql.compiled.generated import load
    from sceneql.compiled.numbered_kernels import number_of
    from sceneql.island.value_slopes_kernels import END
    from sceneql.system.signatures_kernels import TERM

    floats = [(first + k, readings) for first, one in values for k, readings in enumerate(one.readings)]
    columns = sorted({place for _, readings in floats for place, _ in readings})
    program = [number for _, one in values for number in one.program]
    values_at = END + len(program)
    readings_at = values_at + 3 * len(floats)
    ends = list(accumulate((2 * len(readings) for _, readings in floats), initial=readings_at))
    terms_at = ends[-1]
    rows_at = terms_at + 3 * len(acting)
    columns_at = rows_at + len(rows)
    starts = list(accumulate((len(one.ints) for one in acting), initial=columns_at + len(columns)))
    kernels = [getattr(load(module), name) for module, _, name in (one.kernels[0].partition(":") for one in acting)]
    parts: list[Sequence[int] | Numbers] = [
        (len(floats), len(acting), len(rows), len(columns), values_at, readings_at, terms_at, rows_at, columns_at),
        program,
        *((at, ends[k], ends[k + 1]) for k, (at, _) in enumerate(floats)),
        *((columns.index(place), slope) for _, readings in floats for place, slope in readings),
        *((number_of(kernel, TERM), starts[k], starts[k + 1]) for k, kernel in enumerate(kernels)),
        rows,
        columns,
        *(one.ints for one in acting),
    ]
    ints = np.concatenate([np.asarray(part, dtype=np.int64) for part in parts])
    return Slopes(KERNEL, np.tile(rows, len(columns)), np.repeat(columns, len(rows))), ints
