"""The addresses of the tracer's large functions; see scene_kernels.Scene."""

from __future__ import annotations

from functools import cache
from typing import Any

from renderers.tracing.gather_kernels import gather
from renderers.tracing.implicit_kernels import crossing
from renderers.tracing.intersect_kernels import walk
from renderers.tracing.scene_kernels import CROSSING, FUNCTIONS
from renderers.tracing.shade_kernels import shade
from renderers.tracing.surface_kernels import normal_at
from renderers.tracing.visibility_kernels import look_around
from sceneql.kernels import address


@cache
def addresses() -> tuple[Any, ...]:
    """Scene.crossing to Scene.gather."""
    functions = (crossing, walk, normal_at, look_around, shade, gather)
    return tuple(map(address, functions, FUNCTIONS))


@cache
def marching() -> Any:
    """What may stand for Scene.crossing: fixed samples, nothing proved."""
    from renderers.tracing.march_kernels import sampled

    return address(sampled, CROSSING)


@cache
def certifying() -> Any:
    """What may stand for Scene.crossing: certified intervals alone."""
    from renderers.tracing.certain_kernels import certain

    return address(certain, CROSSING)
