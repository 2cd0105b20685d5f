# mypy: ignore-errors
"""Lists the rays of a bundle in an order in which those of a packet lie close together across their way.

Rays to a light begin where neighboring pixels see surfaces, which may be far apart across the way to the light.
"""

import numpy as np

from sceneql.compiled.kernels import inlined
from sceneql.field.enclose.extent_kernels import extent
from sceneql.field.roots.density_march_kernels import LANES

BUCKETS = 64


@inlined
def lay_across(rays, count, ray, across):
    """Write the starts of all rays, without what is along one ray, into the rows of ``across`` (3, n)."""
    j = np.uint64(ray)
    ax, ay, az = rays[3, j], rays[4, j], rays[5, j]
    per = 1.0 / (ax * ax + ay * ay + az * az)
    x, y, z, dx, dy, dz, begin = rays[0], rays[1], rays[2], rays[3], rays[4], rays[5], rays[6]
    u, v, w = across[0], across[1], across[2]
    for i in range(count):
        px, py, pz = x[i] + begin[i] * dx[i], y[i] + begin[i] * dy[i], z[i] + begin[i] * dz[i]
        along = (px * ax + py * ay + pz * az) * per
        u[i], v[i], w[i] = px - along * ax, py - along * ay, pz - along * az


@inlined
def sort_across(across, start, stop, counts, ids, spare):
    """Sort the rays ``ids[start:stop]`` by the coordinate in which they differ most; those in a bucket stay in order.

    ``counts`` (BUCKETS,) and ``spare`` are working memory.
    """
    n, widest, least, axis = stop - start, -1.0, 0.0, 0
    for k in range(3):
        own = across[k]
        for i in range(n):
            spare[i] = own[np.uint64(ids[start + i])]
        low, high = extent(spare, n)
        if high - low > widest:
            widest, least, axis = high - low, low, k
    own, per = across[axis], (BUCKETS - 1) / widest if widest > 0.0 else 0.0
    for b in range(BUCKETS):
        counts[b] = 0
    for i in range(start, stop):
        counts[np.uint64((own[np.uint64(ids[i])] - least) * per)] += 1
    before = 0
    for b in range(BUCKETS):
        before, counts[b] = before + counts[b], before
    for i in range(start, stop):
        b = np.uint64((own[np.uint64(ids[i])] - least) * per)
        spare[np.uint64(counts[b])] = ids[i]
        counts[b] += 1
    for i in range(n):
        ids[start + i] = int(spare[i])


@inlined
def put_together(rays, count, n, across, counts, ids, spare):
    """Sort the n listed rays of ``count`` in halves across their way, and these in halves again, of whole packets."""
    if n <= LANES:
        return
    lay_across(rays, count, ids[0], across)
    half = (n // 2 + LANES - 1) // LANES * LANES
    sort_across(across, 0, n, counts, ids, spare)
    if half > LANES:
        sort_across(across, 0, half, counts, ids, spare)
    if n - half > LANES:
        sort_across(across, half, n, counts, ids, spare)
