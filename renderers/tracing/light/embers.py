"""Glowing spheres in a tree, by which a far group of them counts as one light."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from renderers.tracing import layout
from renderers.tracing.light.lights_kernels import SHOWN
from sceneql.frame import PointLight, Points, Shape

if TYPE_CHECKING:
    from sceneql.frame import Floats, LightSource


def embers_of(shapes: Iterable[Shape], lights: Iterable[LightSource]) -> Floats:
    """Tree (2 n - 1, EMBER) of the n glowing spheres, except those that display a lamp; (0, EMBER) without any.

    Rows are the nodes of a balanced binary tree in depth-first order.
    """
    glowing = [s for s in shapes if isinstance(s, Points) and s.soft is None and any(s.surface.emission)]
    places = np.concatenate([np.empty((0, 3)), *(s.centers for s in glowing)])
    radii = np.concatenate([np.empty(0), *(s.radii for s in glowing)])
    light = np.concatenate([np.empty((0, 3)), *(np.tile(s.surface.emission, (len(s.centers), 1)) for s in glowing)])
    own = np.isfinite(places).all(axis=1) & (radii > 0.0)
    for lamp in lights:
        if isinstance(lamp, PointLight):
            reach = np.linalg.norm(places - np.array(lamp.position), axis=1) + radii
            own &= reach >= (1.0 + SHOWN) * lamp.radius
    return _tree(places[own], radii[own], np.pi * radii[own, None] ** 2 * light[own])


def _tree(places: Floats, radii: Floats, intensity: Floats) -> Floats:
    """Rows of the tree, built level by level; each level halves the groups across their longest side."""
    count = len(places)
    rows = np.empty((max(2 * count - 1, 0), layout.EMBER))
    sizes, at = np.full(min(count, 1), count), np.zeros(min(count, 1), dtype=np.int64)
    while len(sizes):
        firsts, own = np.cumsum(sizes) - sizes, np.repeat(np.arange(len(sizes)), sizes)
        weight = intensity.sum(axis=1)
        middle = np.add.reduceat(weight[:, None] * places, firsts) / np.add.reduceat(weight, firsts)[:, None]
        reach = np.linalg.norm(places - middle[own], axis=1) + radii
        rows[at, :3], rows[at, 3] = middle, np.maximum.reduceat(reach, firsts)
        rows[at, 4] = np.maximum.reduceat(radii, firsts)
        rows[at, 5:8], rows[at, 8] = np.add.reduceat(intensity, firsts), sizes
        low, high = np.minimum.reduceat(places, firsts), np.maximum.reduceat(places, firsts)
        axis, side = (high - low).argmax(axis=1), np.maximum((high - low).max(axis=1), 1e-300)
        along = (places[np.arange(len(own)), axis[own]] - low[np.arange(len(low)), axis][own]) / side[own]
        more = sizes > 1
        order = np.argsort(own + 0.5 * along, kind="stable")[more[own]]
        places, radii, intensity = places[order], radii[order], intensity[order]
        sizes, at = sizes[more], at[more]
        half = (sizes + 1) // 2
        sizes, at = (np.stack(pair, axis=1).ravel() for pair in ((half, sizes - half), (at + 1, at + 2 * half)))
    return rows
