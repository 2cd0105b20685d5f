"""normals: surface normals as colors."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any, ClassVar, Literal

from sceneql.kinds import Renderer, field


class Normals(Renderer):
    """Draws world normals n as colors (n + 1)/2: right is red, up green, towards +z blue; black where nothing is.

    Data: not developed. Normals face the viewer.
    """

    data: ClassVar[bool] = True

    samples: Literal[1, 2, 4, 8, 16, 32, 64] = field("Rays in a pixel; 1 keeps every normal's length.", 1)

    def kernels(self, traced: Collection[str]) -> tuple[str, ...]:
        """Kernel modules of the tracer."""
        from renderers.tracing.certified import certified

        return certified("renderers.tracing.normals") if traced else ("renderers.tracing.normals",)

    def draw(self, frame: Any) -> Any:
        """Picture of a frame: (h, w, 3) in 0..1, and the number of undecided pixels."""
        from renderers.tracing.normals import draw_normals

        return draw_normals(frame, self.samples)
