"""Labels beside things: on the wanted side, or the nearest free place, with a leader line if far away."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from sceneql.pictures.anchors import Box

if TYPE_CHECKING:
    from sceneql.pictures.lettering import Letterer

Thing = tuple[float, float, float, float]
"""Left, top, right, bottom of a labelled thing [pixels]; a point has no extent."""
Way = tuple[float, float]
"""Direction (right, down), of any length but 0."""

UP: Way = (0.0, -1.0)
DOWN: Way = (0.0, 1.0)
STEP, FARTHEST = 0.25, 6.0
"""Step and largest distance of a label's moves away from obstacles, in heights of letters."""
AWAY = 0.6
"""Distance of a label beyond which it gets a leader line, in heights of letters."""


def stand(
    thing: Thing,
    way: Way,
    block: tuple[int, int],
    picture: tuple[int, int],
    gap: float,
    em: int,
    taken: Sequence[Thing] = (),
    spared: Sequence[Thing] = (),
) -> Box:
    """Box of a label (width, height) outside a thing, on the side that ``way`` points to, inside the picture.

    If possible it meets none of the boxes ``taken``, and none of those ``spared``: it moves farther the same way
    first, then to the other sides. ``gap`` [pixels]: distance from the thing; ``em`` [pixels]: height of letters.
    """
    boxes = list(dict.fromkeys(_tries(thing, way, block, picture, gap, em)))
    for others in ((*taken, *spared), taken):
        for box in boxes:
            if not any(meet(box, other) for other in others) and not _covers(box, thing):
                return box
    return boxes[0]


def _tries(
    thing: Thing, way: Way, block: tuple[int, int], picture: tuple[int, int], gap: float, em: int
) -> Iterator[Box]:
    """Boxes to try, in order."""
    x, y = way
    for one in ((x, y), (-y, x), (y, -x), (-x, -y)):
        for k in range(math.ceil(FARTHEST / STEP)):
            left, top = _outside(thing, one, block, gap + k * STEP * em)
            left = round(max(0, min(picture[0] - block[0] - 1, left)))  # which need not be finite
            top = round(max(0, min(picture[1] - block[1] - 1, top)))
            yield left, top, left + block[0], top + block[1]


def _outside(thing: Thing, way: Way, block: tuple[int, int], gap: float) -> tuple[float, float]:
    """Left and top of a block outside a thing by a gap, with the direction ``way`` between their centers [pixels]."""
    length = math.hypot(*way)
    x, y = way[0] / length, way[1] / length
    half = 0.5 * (thing[2] - thing[0] + block[0]) + gap * abs(x), 0.5 * (thing[3] - thing[1] + block[1]) + gap * abs(y)
    far = min(reach / abs(part) for part, reach in zip((x, y), half, strict=True) if part)
    center = 0.5 * (thing[0] + thing[2]) + far * x, 0.5 * (thing[1] + thing[3]) + far * y
    return center[0] - 0.5 * block[0], center[1] - 0.5 * block[1]


def meet(one: Sequence[float], other: Sequence[float]) -> bool:
    """Whether the interiors of two boxes intersect."""
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]


def _covers(box: Box, thing: Thing) -> bool:
    """Whether a box overlaps a thing by more than a pixel, which is rounding."""
    return meet((box[0] + 1, box[1] + 1, box[2] - 1, box[3] - 1), thing)


def lead(letters: Letterer, thing: Thing, box: Box) -> None:
    """Draw a leader line from a thing to its label, if the label is farther than AWAY."""
    x = min(max(0.5 * (box[0] + box[2]), thing[0]), thing[2])
    y = min(max(0.5 * (box[1] + box[3]), thing[1]), thing[3])
    to = min(max(x, box[0]), box[2]), min(max(y, box[1]), box[3])
    if math.hypot(to[0] - x, to[1] - y) > AWAY * letters.em:
        wide = max(1, round(letters.em / 12))
        letters.draw.line((x, y, *to), letters.look.paper, 3 * wide)
        letters.draw.line((x, y, *to), letters.look.ink, wide)
