"""The ray tracer behind the words `trace` and `normals`: packing, intersection, light, filtering, edges."""

TOLERANCE = 1e-9
"""Of roots of implicit objects, relative to the searched piece of a ray, where nothing is said: that of packets."""


def certified(module: str) -> tuple[str, ...]:
    """A module of the tracer and what finds implicit objects by certified roots, in an order for `compile_ahead`."""
    return (
        "sceneql.field.enclosure_kernels",
        module,
        "renderers.tracing.occupancy_kernels",
        "renderers.tracing.implicit",
        "renderers.tracing.implicit_kernels",
    )
