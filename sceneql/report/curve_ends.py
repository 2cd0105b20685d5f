"""Additions to the curves of reports: labels at their ends, and bands of repeated measurements."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

GAP = 0.045
"""Least distance between two labels, as a fraction of a panel's height: a line of text."""


def label_ends(axes: Any) -> None:
    """Write the label of every line of a panel to the right of it, at the height of its end where there is room.

    A thin line leads from the end to a label that had to move; labels of lines without points stand below the others.
    To be called after all lines are drawn.
    """
    axes.autoscale_view()
    place = axes.transScale + axes.transLimits
    lines = [line for line in axes.get_lines() if not line.get_label().startswith("_")]
    ends = {line: _end(line) for line in lines}
    drawn = sorted((line for line in lines if ends[line]), key=lambda line: place.transform(ends[line])[1])
    lines = [*(line for line in lines if not ends[line]), *drawn]
    heights = spread([place.transform(ends[line])[1] if ends[line] else 0.0 for line in lines])
    for line, height in zip(lines, heights, strict=True):
        axes.annotate(
            line.get_label(),
            ends[line] or (1.0, height),
            (1.03, height),
            xycoords="data" if ends[line] else "axes fraction",
            textcoords="axes fraction",
            color=line.get_color(),
            fontsize=8,
            va="center",
            arrowprops={"arrowstyle": "-", "lw": 0.5, "alpha": 0.6, "color": line.get_color()} if ends[line] else None,
            annotation_clip=False,
        )


def _end(line: Any) -> tuple[float, float] | None:
    """The rightmost point of a line, the last of several; None without a finite one."""
    points = [(float(x), float(y)) for x, y in zip(*line.get_data(), strict=True)]
    drawn = [(x, y) for x, y in points if math.isfinite(x) and math.isfinite(y)]
    return max(reversed(drawn), key=lambda point: point[0], default=None)


def spread(heights: Sequence[float]) -> list[float]:
    """Ascending heights in a panel of height 1, moved apart as little as labels need; closer where there are many."""
    gap = min(GAP, 1.0 / max(len(heights), 1))
    moved = [min(max(height, 0.0), 1.0) for height in heights]
    for k in range(1, len(moved)):
        moved[k] = max(moved[k], moved[k - 1] + gap)
    for k in reversed(range(len(moved))):
        moved[k] = min(moved[k], 1.0 if k == len(moved) - 1 else moved[k + 1] - gap)
    return moved


def band(axes: Any, line: Any, median: Sequence[float]) -> None:
    """Shade from a line's points to the right, up to the median of repeats [s] or the edge of the panel.

    To be called after all lines are drawn: the scale is kept, so that a busy machine does not change it.
    """
    fastest, errors = line.get_data()
    if len(fastest):
        axes.autoscale(False)
        axes.fill_betweenx(errors, fastest, median, color=line.get_color(), alpha=0.2, lw=0)


def repeats(axes: Any, line: Any, median: Sequence[float]) -> None:
    """As `band` for points that form no curve: a bar from each."""
    fastest, errors = line.get_data()
    axes.autoscale(False)
    axes.hlines(errors, fastest, median, color=line.get_color(), alpha=0.4, lw=3)
