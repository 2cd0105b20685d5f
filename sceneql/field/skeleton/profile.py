"""Falloff kernels K(d/R) of a skeleton's parts: values, inverse function and slope. Imports numpy."""

from __future__ import annotations

from functools import cache, lru_cache
from typing import TYPE_CHECKING

import numpy as np

from sceneql.field.skeleton.skeleton import Skeleton
from sceneql.field.tape.builder import TapeBuilder

if TYPE_CHECKING:
    from sceneql.frame import Floats, Tape

FEW = 8
"""Most different densities of a call whose distances are cached."""


@cache
def _unit(kernel: int) -> Tape:
    """The tape of the density about one point at the origin, of radius 1 and weight 1."""
    build = TapeBuilder()
    one = Skeleton(np.zeros((1, 3, 3)), np.ones((1, 2)), np.ones(1), np.zeros(1), kernel)
    return build.finish(build.skeleton(one, build.x, build.y, build.z))


def profile(kernel: int, r: Floats) -> Floats:
    """Values K(r) (n,) of a kernel at r = d/R (n,)."""
    from sceneql.field.tape.tape_solid import field_values

    return field_values(_unit(kernel), np.stack([r, 0.0 * r, 0.0 * r], axis=1))


def farthest(kernel: int, density: Floats) -> Floats:
    """Inverse of a kernel by bisection: r = d/R (n,) at which it falls to densities (n,) > 0; 0 for densities >= 1."""
    densities, where = np.unique(density, return_inverse=True)
    found = np.array(_few(kernel, tuple(densities.tolist()))) if len(densities) <= FEW else _bisected(kernel, densities)
    return found[where]


@lru_cache(maxsize=256)
def _few(kernel: int, densities: tuple[float, ...]) -> tuple[float, ...]:
    """Cached results of ``farthest`` for a few densities, which are often the same in the next frame."""
    found: tuple[float, ...] = tuple(_bisected(kernel, np.array(densities)).tolist())
    return found


def _bisected(kernel: int, densities: Floats) -> Floats:
    low, high = np.zeros(len(densities)), np.ones(len(densities))
    for _ in range(54):
        middle = 0.5 * (low + high)
        above = profile(kernel, middle) > densities
        low, high = np.where(above, middle, low), np.where(above, high, middle)
    found: Floats = np.where(densities < 1.0, high, 0.0)
    return found


@lru_cache(maxsize=256)
def steepness(kernel: int, density: float) -> float:
    """Slope -dK/dr, r = d/R, at the r where a kernel has a given density; by a central difference."""
    r = farthest(kernel, np.array([density]))
    step = 1e-6 * min(r[0], 1.0 - r[0])
    return float((profile(kernel, r - step) - profile(kernel, r + step))[0] / (2.0 * step))
