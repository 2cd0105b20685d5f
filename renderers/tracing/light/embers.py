"""Spheres that glow, sorted into a tree by which many far ones are summed up as one."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from renderers.tracing import layout
from renderers.tracing.light.visibility_kernels import SHOWN
from sceneql.frame import PointLight, Points, Shape

if TYPE_CHECKING:
    from sceneql.frame import Floats, LightSource


def embers_of(shapes: Iterable[Shape], lights: Iterable[LightSource]) -> Floats:
    """(2 n - 1, EMBER) of the n spheres that glow, but for those that show a lamp; (0, EMBER) if there are none.

    Nodes of a binary tree stand in depth-first order, halves of as many spheres as can be.
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
    """Rows of the tree, level by level; a level halves its parts across their longest side."""
    count = len(places)
    rows = np.empty((max(2 * count - 1, 0), layout.EMBER))
    order = np.arange(count)
    starts, stops, at = (np.array([k] if count else [], dtype=np.int64) for k in (0, count, 0))
    while len(starts):
        own = np.repeat(np.arange(len(starts)), stops - starts)
        firsts = np.concatenate([[0], np.cumsum(stops - starts)])[:-1]
        items = order[np.concatenate([np.arange(a, b) for a, b in zip(starts, stops, strict=True)])]
        weight = intensity[items].sum(axis=1)
        total = np.add.reduceat(weight, firsts)
        middle = np.add.reduceat(weight[:, None] * places[items], firsts) / total[:, None]
        reach = np.linalg.norm(places[items] - middle[own], axis=1) + radii[items]
        rows[at, :3], rows[at, 3] = middle, np.maximum.reduceat(reach, firsts)
        rows[at, 4], rows[at, 5:8] = np.maximum.reduceat(radii[items], firsts), np.add.reduceat(intensity[items], firsts)
        rows[at, 8] = stops - starts
        sides = np.maximum.reduceat(places[items], firsts) - np.minimum.reduceat(places[items], firsts)
        along = places[items, sides.argmax(axis=1)[own]]
        order[np.concatenate([np.arange(a, b) for a, b in zip(starts, stops, strict=True)])] = items[
            np.lexsort((along, own))
        ]
        more = stops - starts > 1
        starts, stops, at = starts[more], stops[more], at[more]
        half = (stops - starts + 1) // 2
        starts, stops, at = (
            np.stack(pair, axis=1).ravel()
            for pair in ((starts, starts + half), (starts + half, stops), (at + 1, at + 2 * half))
        )
    return rows
