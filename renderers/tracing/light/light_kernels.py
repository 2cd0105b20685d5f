# mypy: ignore-errors
"""Sky and reflectance in closed form."""

import numpy as np

from renderers.tracing import layout
from renderers.tracing.scene_kernels import part


@part
def sky_radiance(sky, y):
    """Radiance (3) of the sky in a direction of height y = sin(elevation): linear in y to zenith or ground."""
    at = 0 if y >= 0.0 else 6
    w = abs(y)
    return sky[3] + w * (sky[at] - sky[3]), sky[4] + w * (sky[at + 1] - sky[4]), sky[5] + w * (sky[at + 2] - sky[5])


@part
def backdrop(sky, y):
    """Radiance (3) that a camera sees in a direction of height y."""
    if sky[layout.HAS_VISIBLE] == 0.0:
        return sky_radiance(sky, y)
    w = 0.0
    if y < 0.0:
        ratio = sky[layout.FADE] / y
        w = np.exp(-ratio * ratio)
    u = layout.BELOW
    return sky[9] + w * (sky[u] - sky[9]), sky[10] + w * (sky[u + 1] - sky[10]), sky[11] + w * (sky[u + 2] - sky[11])


@part
def sky_ambient(sky, ny):
    """Irradiance / pi (3) of the unobstructed sky on a surface whose normal has height ny.

    In closed form: the integral of max(a.w, 0) max(b.w, 0) over all directions w, for unit a and b at an angle
    theta, is 2/3 (sin theta + (pi - theta) cos theta).
    """
    c = min(max(ny, -1.0), 1.0)
    theta = np.arccos(c)
    s = np.sqrt(1.0 - c * c)
    up = (2.0 / (3.0 * np.pi)) * (s + (np.pi - theta) * c)
    down = (2.0 / (3.0 * np.pi)) * (s - theta * c)
    return (
        sky[3] + up * (sky[0] - sky[3]) + down * (sky[6] - sky[3]),
        sky[4] + up * (sky[1] - sky[4]) + down * (sky[7] - sky[4]),
        sky[5] + up * (sky[2] - sky[5]) + down * (sky[8] - sky[5]),
    )


@part
def highlight(nl, nv, nh, width):
    """GGX distribution times masking over 4 nl nv, without Fresnel (Walter et al. 2007; Heitz 2014, eq. 99)."""
    a2 = width * width
    d = nh * nh * (a2 - 1.0) + 1.0
    shadowing = nl * np.sqrt(a2 + (1.0 - a2) * nv * nv) + nv * np.sqrt(a2 + (1.0 - a2) * nl * nl)
    return a2 / (np.pi * d * d) * 0.5 / shadowing


@part
def schlick(f0, f90, cosine):
    """Fresnel's reflectance by Schlick's approximation (1994)."""
    m = 1.0 - cosine
    return f0 + (f90 - f0) * m * m * m * m * m


@part
def dielectric(cosine, ratio):
    """Fresnel's reflectance of a clear surface, unpolarized; ``ratio`` of indices, before over behind. 1: total."""
    sine2 = ratio * ratio * (1.0 - cosine * cosine)
    if sine2 >= 1.0:
        return 1.0
    behind = np.sqrt(1.0 - sine2)
    across = (ratio * cosine - behind) / (ratio * cosine + behind)
    along = (cosine - ratio * behind) / (cosine + ratio * behind)
    return 0.5 * (across * across + along * along)


@part
def smoothstep(low, high, x):
    """0 below low, 1 above high, smooth between."""
    t = min(max((x - low) / (high - low), 0.0), 1.0)
    return t * t * (3.0 - 2.0 * t)


@part
def sharpness(roughness):
    """Share of the reflection that is traced as in a mirror; the rest is the sky, blurred."""
    return 1.0 - smoothstep(0.05, 0.4, roughness)


@part
def polish(roughness):
    """Share of a lamp's reflection that is its image, as in a mirror; the rest is a highlight."""
    return 1.0 - smoothstep(0.0, 0.1, roughness)
