# mypy: ignore-errors
"""Light of small spheres that glow: summed up, not left to the samples of light from around.

Few of these would meet a small sphere, and other ones in the next frame. Of a sphere samples tell the share ``met``,
and sums the rest; both go by its size and distance alone, so that none is counted twice and nothing jumps.
"""

import numpy as np
from numba import types

from renderers.tracing import layout
from renderers.tracing.light.light_kernels import smoothstep
from renderers.tracing.light.sampling_kernels import SKY_COUNT
from renderers.tracing.scene_kernels import SCENE, SCRATCH, part
from renderers.tracing.solids.intersect_kernels import walk
from sceneql.compiled.kernels import kernel

_f, _i = types.float64, types.int64
FEW, MANY = 4.0, 16.0
"""Samples of a whole net that meet a sphere up to which they tell nothing of it, and from which on they tell all."""
NEARLY, ROUGHLY = 0.3, 0.5
"""Reach of a node of the tree, by its distance, up to which its spheres are summed up as one: for light on what the
camera sees, and on what lights that. Irradiance is harmonic in the place of its source (as gravity: Barnes and Hut
1986), so that the error is of the node's third axis beside the others."""
NEAREST = 0.16
"""Square of the distance from a node up to which its spheres count as if they may be met, by that of its middle."""
BARELY = 1e-6
"""Part of its length by which a ray to a sphere ends before it."""


@part
def met_share(radius, d2):
    """Share of the light of a sphere, at the square of a distance, that samples tell."""
    return smoothstep(FEW, MANY, SKY_COUNT * radius * radius / d2) if d2 > 0.0 else 1.0


@part
def met(scene, item, x, y, z):
    """Share of the light of an item that a sample from a place tells: 1 but for small spheres."""
    at = layout.ITEMS + 4 * item
    if scene.ints[layout.EMBERS] == 0 or scene.ints[at + layout.KIND] != layout.ROUND:
        return 1.0
    u, k = scene.reals, scene.ints[at + layout.REALS_AT]
    if u[k + 3] != 0.0 or u[k + 4] != 0.0 or u[k + 5] != 0.0:
        return 1.0
    return met_share(u[k + 6], (u[k] - x) ** 2 + (u[k + 1] - y) ** 2 + (u[k + 2] - z) ** 2)


@kernel(types.Tuple((_f, _f, _f, _f, _i, _f))(SCENE, *(_f,) * 7, _i, _f, _f), _nrt=False)
def sum_up(scene, x, y, z, nx, ny, nz, far, k, total, until):
    """Irradiance (3) of a surface by all spheres, over pi and without shadows, and the sum of that.

    The sum goes on from node k of the tree and ``total``, and stops at the node where it would exceed ``until``; it
    says which that is, -1 if there is none, and at which share of the node's light.
    """
    u = scene.reals
    r, g, b = 0.0, 0.0, 0.0
    first = int(scene.ints[layout.EMBERS_AT])
    end = first + layout.EMBER * (2 * int(scene.ints[layout.EMBERS]) - 1)
    k = first + layout.EMBER * k
    while k < end:
        dx, dy, dz = u[k] - x, u[k + 1] - y, u[k + 2] - z
        height = dx * nx + dy * ny + dz * nz
        reach = u[k + 3]
        behind = k + layout.EMBER * (2 * int(u[k + 8]) - 1)
        if height <= -reach:
            k = behind
            continue
        d2 = dx * dx + dy * dy + dz * dz
        single = u[k + 8] == 1.0
        share = 1.0
        if single:
            share = 1.0 - met_share(u[k + 4], d2)
        elif reach * reach > far * far * d2 or SKY_COUNT * u[k + 4] * u[k + 4] > FEW * NEAREST * d2:
            k += layout.EMBER
            continue
        if height > 0.0 and share > 0.0:
            share *= height / (np.pi * d2 * np.sqrt(d2))
            more = share * (u[k + 5] + u[k + 6] + u[k + 7])
            if total + more > until:
                return r, g, b, total, (k - first) // layout.EMBER, (until - total) / more
            r, g, b = r + share * u[k + 5], g + share * u[k + 6], b + share * u[k + 7]
            total += more
        k = behind
    return r, g, b, total, -1, 0.0


@kernel(_f(SCENE, SCRATCH, _f, _f, _f, _i, _f), _nrt=False)
def ember_seen(scene, scratch, x, y, z, k, rest):
    """Seen share of the sphere at a share of a node's light, from a place a little off a surface."""
    u = scene.reals
    k = int(scene.ints[layout.EMBERS_AT]) + layout.EMBER * k
    while u[k + 8] > 1.0:
        left = k + layout.EMBER
        right = k + 2 * layout.EMBER * ((int(u[k + 8]) + 1) // 2)
        share = (u[left + 5] + u[left + 6] + u[left + 7]) / (u[k + 5] + u[k + 6] + u[k + 7])
        if rest < share:
            rest, k = rest / share, left
        else:
            rest, k = (rest - share) / (1.0 - share), right
    dx, dy, dz = u[k] - x, u[k + 1] - y, u[k + 2] - z
    d = np.sqrt(dx * dx + dy * dy + dz * dz)
    length = (1.0 - BARELY) * (d - u[k + 3])
    if not length > 0.0:
        return 1.0
    _, _, light = walk(scene, scratch, x, y, z, dx / d, dy / d, dz / d, 0.0, length, True)
    return light
