"""Least and largest of fields with a blend: fillets of a given width where surfaces meet.

The blend of values f_i of width k is the least, over all weights w_i >= 0 of sum 1, of sum w_i f_i less
k/2 (1 - sum w_i^2): a minimum that is smoothed on the simplex (Nesterov 2005, section 4.1). Of two values it is the
quadratic smooth minimum min(a, b) - max(k - |a - b|, 0)^2 / (4 k) (Quilez, "Smooth minimum"). It is C1, symmetric in
the values, and equal to their minimum where no other value is within k of the minimum.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import reduce
from typing import TYPE_CHECKING

from sceneql.shapes.solid import less

if TYPE_CHECKING:
    from sceneql.kinds import FieldBuilder


def bulge(count: int, width: float) -> float:
    """Greatest depth of the blend of ``count`` values below their minimum: that where all are equal."""
    return 0.5 * width * (1.0 - 1.0 / count)


def least(build: FieldBuilder, values: Sequence[int], width: float) -> int:
    """Register of the blend of some values; of their minimum where the width is 0."""
    if width == 0.0 or len(values) == 1:
        return reduce(lambda a, b: build.op("min", a, b), values)
    return _of_two(build, values[0], values[1], width) if len(values) == 2 else _of_many(build, values, width)


def largest(build: FieldBuilder, values: Sequence[int], width: float) -> int:
    """Register of the blend of some values from above; of their maximum where the width is 0."""
    if width == 0.0:
        return reduce(lambda a, b: build.op("max", a, b), values)
    return build.op("neg", least(build, [build.op("neg", value) for value in values], width))


def _of_two(build: FieldBuilder, a: int, b: int, width: float) -> int:
    apart = build.op("abs", build.op("sub", a, b))
    share = build.op("max", build.op("sub", build.constant(width), apart), build.constant(0.0))
    below = build.op("mul", build.op("square", share), build.constant(0.25 / width))
    return build.op("sub", build.op("min", a, b), below)


def _of_many(build: FieldBuilder, values: Sequence[int], width: float) -> int:
    """Register of the blend of three or more values: f - k/2 + t - sum max(t - g_i, 0)^2 / (2 k).

    f is the minimum of the values, g_i = f_i - f are their gaps, and the level t solves sum max(t - g_i, 0) = k. With
    the gaps sorted, t is the minimum over j of (k + g_1 + ... + g_j) / j (Held, Wolfe & Crowder 1974, on projections
    to the simplex). Gaps above k have no effect.
    """
    first = reduce(lambda a, b: build.op("min", a, b), values)
    most = build.constant(width)
    gaps = [build.op("min", build.op("sub", value, first), most) for value in values]
    for low, high in comparators(len(gaps)):
        a, b = gaps[low], gaps[high]
        gaps[low], gaps[high] = build.op("min", a, b), build.op("max", a, b)
    total = level = most
    for count, gap in enumerate(gaps[1:], 2):
        total = build.op("add", total, gap)
        level = build.op("min", level, build.op("mul", total, build.constant(1.0 / count)))
    squares = build.op("square", level)  # of the first gap, which is 0
    for gap in gaps[1:]:
        share = build.op("max", build.op("sub", level, gap), build.constant(0.0))
        squares = build.op("add", squares, build.op("square", share))
    below = build.op("sub", build.op("mul", squares, build.constant(0.5 / width)), less(build, level, 0.5 * width))
    # The bound is reached only where all values are equal; it keeps interval enclosures of the blend narrow.
    return build.op("sub", first, build.op("min", below, build.constant(bulge(len(values), width))))


def comparators(count: int) -> Iterator[tuple[int, int]]:
    """Comparators (i, j), i < j, of a sorting network for ``count`` values, in the order of their execution.

    Merge exchange (Batcher 1968; Knuth, The Art of Computer Programming 3, 5.2.2, algorithm M).
    """
    most = 1 << max((count - 1).bit_length() - 1, 0)
    p = most
    while p > 0:
        q, r, d = most, 0, p
        while True:
            yield from ((i, i + d) for i in range(count - d) if i & p == r)
            if q == p:
                break
            q, r, d = q // 2, p, q - p
        p //= 2
