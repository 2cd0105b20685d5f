# mypy: ignore-errors
"""Soft boxes as polished surfaces mirror them: rectangles of the sky, blurred where rays or surfaces spread."""

from renderers.tracing import layout
from renderers.tracing.light.light_kernels import smoothstep
from renderers.tracing.scene_kernels import part

SHARPEST = 0.02
"""Least half width of an edge, as the tangent of an angle: cloth before a lamp has no hard edge."""


@part
def covered(at, half, blur):
    """Share of an interval of 2 ``blur`` about ``at`` that is within ``half`` of 0, with soft ends."""
    return smoothstep(-blur, blur, half - at) + smoothstep(-blur, blur, half + at) - 1.0


@part
def soft_boxes(scene, dx, dy, dz, blur):
    """Radiance (3) of all soft boxes in a direction (unit), over a cone of half width ``blur`` (a tangent)."""
    u = scene.reals
    blur = max(blur, SHARPEST)
    r, g, b = 0.0, 0.0, 0.0
    first = layout.LIGHTS + layout.LIGHT * int(scene.ints[layout.LIGHT_COUNT])
    for box in range(int(scene.ints[layout.BOX_COUNT])):
        k = first + layout.BOX * box
        toward = dx * u[k] + dy * u[k + 1] + dz * u[k + 2]
        if toward <= 0.0:
            continue
        across = (dx * u[k + 3] + dy * u[k + 4] + dz * u[k + 5]) / toward
        up = (dx * u[k + 6] + dy * u[k + 7] + dz * u[k + 8]) / toward
        if abs(across) < u[k + 9] + blur and abs(up) < u[k + 10] + blur:
            share = covered(across, u[k + 9], blur) * covered(up, u[k + 10], blur)
            r, g, b = r + share * u[k + 11], g + share * u[k + 12], b + share * u[k + 13]
    return r, g, b
