"""caption: words in a picture."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Literal

from sceneql.kinds import FixedScalar, Moment, Overlay, Position, field

if TYPE_CHECKING:
    from numpy import uint8
    from numpy.typing import NDArray

    from sceneql.frame import View

Place = Literal["top left", "top", "top right", "bottom left", "bottom", "bottom right"]


class Caption(Overlay):
    """A line of text at an edge of the picture, or over a point of the scene, which it follows."""

    text: str = field("What it says.")
    place: Place = field("Where it stands in the picture.", "top left")
    at: Position | None = field("The point that it stands over, in place of that.", None)
    size: FixedScalar = field("Height of its letters in parts of the picture's.", "0.045", above=0, at_most=0.3)
    panel: FixedScalar = field("Opacity of the panel that it stands on.", "0.7", at_least=0, at_most=1)

    def draw(
        self,
        pixels: NDArray[uint8],
        view: View,
        moment: Moment,
        develop: Callable[[Any], NDArray[uint8]],
    ) -> None:
        """Draw the line; nothing where its point lies behind the camera."""
        from sceneql.simulation.lettering import Letterer

        letters = Letterer(pixels, self.size)
        wide, high = letters.extent(self.text)
        room = round(0.4 * letters.em)
        if self.at is None:
            rows = {"t": 2 * room, "b": letters.height - high - 4 * room}
            top = rows[self.place[0]]
            left = 2 * room if "left" in self.place else letters.width - wide - 4 * room
            if self.place in ("top", "bottom"):
                left = (letters.width - wide) // 2 - room
        else:
            seen = projected(moment.at(self.at), view)
            if seen is None:
                return
            left, top = round(seen[0] - 0.5 * wide) - room, round(seen[1] - high) - 2 * room
        letters.panel((left, top, left + wide + 2 * room, top + high + 2 * room), self.panel)
        letters.text((left + room, top + room + 0.5 * high), self.text)
        letters.done()


def projected(point: Any, view: View) -> tuple[float, float] | None:
    """Where a point (3,) is seen [pixels], from the top left; None behind the camera."""
    import numpy as np

    x, y, z = view.axes @ (np.asarray(point, dtype=float) - np.array(view.origin))
    if z >= 0 and not view.orthographic:
        return None
    scale = 0.5 * view.size[1] / view.half_height / (1.0 if view.orthographic else -z)
    return 0.5 * view.size[0] + scale * x, 0.5 * view.size[1] - scale * y
