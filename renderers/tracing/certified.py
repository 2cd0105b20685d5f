"""Defaults of the tracer, and the kernel modules that find certified roots of implicit objects."""

from __future__ import annotations

TOLERANCE = 1e-9
"""Default tolerance of roots of implicit objects, relative to the searched piece of a ray: that of packets."""
BOUNCES = 256
"""Most surfaces beside the lit one that light from around is followed to."""


def certified(module: str) -> tuple[str, ...]:
    """A module of the tracer and the modules of certified roots, in an order for `compile_beside`."""
    return (
        "sceneql.field.enclose.enclosure_kernels",
        module,
        "renderers.tracing.solids.implicit",
        "renderers.tracing.solids.implicit_kernels",
    )
