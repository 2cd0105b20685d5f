"""The addresses of the tracer's large functions; see scene_kernels.Scene."""

from __future__ import annotations

from functools import cache
from typing import Any

from renderers.tracing.gather_kernels import gather
from renderers.tracing.intersect_kernels import walk
from renderers.tracing.scene_kernels import GATHER, LOOK_AROUND, NORMAL_AT, SHADE, WALK
from renderers.tracing.shade_kernels import shade
from renderers.tracing.surface_kernels import normal_at
from renderers.tracing.visibility_kernels import look_around
from sceneql.kernels import address


@cache
def addresses() -> tuple[Any, ...]:
    """Scene.walk, normal, look, shade and gather."""
    functions = (walk, normal_at, look_around, shade, gather)
    return tuple(map(address, functions, (WALK, NORMAL_AT, LOOK_AROUND, SHADE, GATHER)))
