"""march: the ray tracer with implicit surfaces sampled at fixed places of each ray."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

from sceneql.kinds import Renderer, field


class March(Renderer):
    """Draws as `trace` does, but finds implicit surfaces as most programs do: by samples and bisection.

    A field is asked at fixed places along the ray through an object's box, and where its sign changes from one to the
    next, the root between is found by bisection. Nothing is proved: what is thinner than the way between two samples
    has holes or is not there at all, and what is touched without a change of sign is never seen. It is here to show
    that, and for `sceneql bench` to measure.
    """

    samples: int = field("Places on a ray at which a field is sampled.", 64, at_least=1, at_most=100000)

    def kernels(self, traced: Collection[str]) -> tuple[str, ...]:
        """Kernel modules of the tracer."""
        own = "renderers.tracing.draw"
        also = ("renderers.tracing.solids.implicit", "renderers.tracing.solids.fixed_samples_kernels")
        return (own, *also) if traced else (own,)

    def draw(self, frame: Any) -> Any:
        """Picture of a frame: linear (h, w, 3), with no undecided pixels."""
        from renderers.tracing.draw import draw

        return draw(frame, march=self.samples)
