"""Glowing spheres too small for samples of the light from around, summed up as swarms."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from renderers.tracing import layout
from sceneql.frame import Points, Shape

if TYPE_CHECKING:
    from sceneql.frame import Floats

ACROSS = 4
"""Least number of cells along the longest side of what glows."""


def swarms_of(shapes: Iterable[Shape]) -> Floats:
    """(n, SWARM) of all glowing spheres, by the cells of a grid that stands still in the world."""
    glowing = [s for s in shapes if isinstance(s, Points) and s.soft is None and any(s.surface.emission)]
    glowing = [s for s in glowing if len(s.centers)]
    if not glowing:
        return np.empty((0, layout.SWARM))
    places = np.concatenate([s.centers for s in glowing])
    power = np.concatenate([np.pi * s.radii[:, None] ** 2 * np.array([s.surface.emission]) for s in glowing])
    extent = float(np.ptp(places, axis=0).max())
    cell = 2.0 ** math.ceil(math.log2(max(extent / ACROSS, 1e-9)))
    _, own = np.unique(np.floor(places / cell), axis=0, return_inverse=True)
    own = own.ravel()
    weight = power.sum(axis=1)
    total = np.maximum(np.bincount(own, weight), 1e-300)

    def mean(values: Floats) -> Floats:
        return np.stack([np.bincount(own, weight * row) / total for row in values.T], axis=1)

    middle = mean(places)
    apart = mean(((places - middle[own]) ** 2).sum(axis=1)[:, None])
    light = np.stack([np.bincount(own, row) for row in power.T], axis=1)
    return np.concatenate([middle, apart, light], axis=1)
