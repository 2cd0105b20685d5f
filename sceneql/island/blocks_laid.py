"""The blocks of an island (the integers of each term and contact), and their layout in the array that kernels read."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import accumulate
from typing import TYPE_CHECKING

import numpy as np

from sceneql.island import layout

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.quantities.span import Span
    from sceneql.system import Slopes
    from sceneql.system.assembly import Ints


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """The kernels and integers of one term or contact."""

    kernels: tuple[str, ...]
    ints: Ints
    """(k,) int64; may be long where it holds tables of plans or elements."""
    pairs: int = 0
    slopes: Slopes | Callable[[], Slopes | None] | None = None
    part: str = ""
    span: Span | None = None
    model: str | None = None
    """The model that a force acts on."""
    energy: str | None = None
    """The kernel of the term's potential energy, as in Assembly.term."""
    damped: bool = False
    stiff: bool = False
    help: str = ""
    """The advice in the failure message of impacts that accumulate without end (Assembly.contact)."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "ints", np.array(self.ints, dtype=np.int64))


def grouped(blocks: list[Block], laid: list[Block]) -> list[tuple[tuple[str, ...], int]]:
    """Distinct kernels in order of first use, each with its number of blocks.

    Appends the blocks in that order to ``laid``.
    """
    by_kernels: dict[tuple[str, ...], list[Block]] = {}
    for block in blocks:
        by_kernels.setdefault(block.kernels, []).append(block)
    for group in by_kernels.values():
        laid.extend(group)
    return [(kernels, len(group)) for kernels, group in by_kernels.items()]


def lay_out(
    triples: list[tuple[int, int, int]],
    frees: list[tuple[int, int]],
    tied: bool,
    blocks: list[Block],
    stages: list[list[int]],
    pairs: list[int],
) -> NDArray[int64]:
    """The island's array of integers, as layout.py describes.

    ``stages``: the number of blocks of each group, stage by stage.
    """
    first_blocks = list(accumulate((count for stage in stages for count in stage), initial=1))
    first_groups = list(accumulate((len(stage) for stage in stages), initial=0))
    calls_at = layout.GROUPS_AT + len(first_blocks)
    triples_at = calls_at + layout.CALLS * first_groups[-1]
    frees_at = triples_at + layout.TRIPLE * len(triples)
    table_at = frees_at + 2 * len(frees)
    ranges_at = table_at + len(blocks) + 1
    table = list(accumulate((len(block.ints) for block in blocks), initial=ranges_at + len(pairs) + 1))
    parts = [
        [triples_at, len(triples), frees_at, len(frees), int(tied), table_at, ranges_at, table[-1]],
        [*first_groups, calls_at],
        [table_at + block for block in first_blocks],
        [0] * (triples_at - calls_at),
        [number for triple in triples for number in triple],
        [number for free in frees for number in free],
        table,
        list(accumulate(pairs, initial=0)),
        *(block.ints for block in blocks),
    ]
    return np.concatenate([np.asarray(part, dtype=np.int64) for part in parts])
