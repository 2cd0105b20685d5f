# mypy: ignore-errors
"""Directional albedo of GGX: the part of uniform light that a rough surface scatters once, tabulated at import."""

import numpy as np

from renderers.tracing.scene_kernels import part

NODES = 16
"""Nodes along each axis of the table, evenly in roughness and in the square root of the cosine."""


def _reflected(roughness, nv, across=24, around=16):
    """(n, 2) shares of light by Schlick's Fresnel terms (1 - (1 - vh)^5) and (1 - vh)^5, towards cosines nv (n,).

    By the midpoint rule over the distribution of visible normals (Heitz 2018, Sampling the GGX Distribution of Visible
    Normals), where the weight of a direction is its masking and shadowing, height-correlated, over its masking alone.
    """
    alpha = roughness * roughness
    rest, phi = np.meshgrid((np.arange(across) + 0.5) / across, (np.arange(around) + 0.5) * np.pi / around)
    share, u = 2.0 * rest, 1.0 - rest * rest  # dense where normals lean most
    v = np.stack([np.sqrt(1.0 - nv * nv), nv])[..., None, None]
    stretched = np.stack([alpha * v[0], v[1]])
    sine, cosine = stretched / np.sqrt((stretched**2).sum(axis=0))
    # A point of the disk that the hemisphere of normals shows to the viewer; y is across the plane of incidence.
    x, y = np.sqrt(u) * np.cos(phi), np.sqrt(u) * np.sin(phi)
    x = 0.5 * (1.0 - cosine) * np.sqrt(1.0 - y * y) + 0.5 * (1.0 + cosine) * x
    z = np.sqrt(np.maximum(1.0 - x * x - y * y, 0.0))
    h = np.stack([alpha * (z * sine - x * cosine), alpha * y + 0.0 * x, np.maximum(z * cosine + x * sine, 1e-9)])
    h /= np.sqrt((h**2).sum(axis=0))
    vh = v[0] * h[0] + v[1] * h[2]
    nl = np.maximum(2.0 * vh * h[2] - v[1], 0.0)
    masked = [np.sqrt(alpha * alpha / np.maximum(c * c, 1e-18) + 1.0 - alpha * alpha) for c in (v[1], nl)]
    weight = np.where(nl > 0.0, share * (1.0 + masked[0]) / (masked[0] + masked[1]), 0.0)
    grazing = np.clip(1.0 - vh, 0.0, 1.0) ** 5
    return np.stack([(weight * (1.0 - grazing)).mean(axis=(1, 2)), (weight * grazing).mean(axis=(1, 2))], axis=-1)


_x = np.arange(NODES) / (NODES - 1.0)
REFLECTED = np.array([_reflected(roughness, np.maximum(_x * _x, 1e-4)) for roughness in _x]).round(5)
"""(NODES, NODES, 2) by roughness and by the square root of the cosine. Rounded: the same on every processor."""


@part
def mean_reflectance(roughness, nv):
    """(scale, bias): a rough surface scatters F0 scale + F90 bias of uniform light once."""
    a, b = min(max(roughness, 0.0), 1.0) * (NODES - 1), np.sqrt(min(max(nv, 0.0), 1.0)) * (NODES - 1)
    i, j = min(int(a), NODES - 2), min(int(b), NODES - 2)
    a, b = a - i, b - j
    scale = (1.0 - b) * REFLECTED[i, j, 0] + b * REFLECTED[i, j + 1, 0]
    bias = (1.0 - b) * REFLECTED[i, j, 1] + b * REFLECTED[i, j + 1, 1]
    scale += a * ((1.0 - b) * REFLECTED[i + 1, j, 0] + b * REFLECTED[i + 1, j + 1, 0] - scale)
    bias += a * ((1.0 - b) * REFLECTED[i + 1, j, 1] + b * REFLECTED[i + 1, j + 1, 1] - bias)
    return scale, bias
