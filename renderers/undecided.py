"""undecided: picture of the pixels that the certified search could not decide."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any, ClassVar

from sceneql.kinds import FixedScalar, Renderer, field


class Undecided(Renderer):
    """Draws in orange the pixels where a root of an implicit surface was proved neither to be there nor not to be.

    What else is seen is gray, lighter where it faces the viewer; black is where nothing is. Rays go through the
    centers of pixels. Data: not developed.
    """

    data: ClassVar[bool] = True

    tolerance: FixedScalar = field("As of `trace`.", "1e-9", above=0, at_most=1e-3)

    def kernels(self, traced: Collection[str]) -> tuple[str, ...]:
        """Kernel modules of the tracer."""
        from renderers.tracing.certified import certified

        return certified("renderers.tracing.normals") if traced else ("renderers.tracing.normals",)

    def draw(self, frame: Any) -> Any:
        """Picture of a frame: (h, w, 3) in 0..1, and the number of undecided pixels."""
        from renderers.tracing.normals import draw_undecided

        return draw_undecided(frame, self.tolerance)
