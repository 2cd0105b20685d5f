"""Certified roots of implicit objects: how exact they are, and the modules that find them."""

from __future__ import annotations

TOLERANCE = 1e-9
"""Of roots of implicit objects, relative to the searched piece of a ray, where nothing is said: that of packets."""


def certified(module: str) -> tuple[str, ...]:
    """A module of the tracer and what finds implicit objects by certified roots, in an order for `compile_beside`."""
    return (
        "sceneql.field.enclose.enclosure_kernels",
        module,
        "renderers.tracing.solids.occupancy_kernels",
        "renderers.tracing.solids.implicit",
        "renderers.tracing.solids.implicit_kernels",
    )
