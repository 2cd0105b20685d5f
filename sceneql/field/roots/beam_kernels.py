# mypy: ignore-errors
"""Beams: capsules around pieces of neighboring rays, and the parts of a density field that reach into one.

The rays of a bundle that have a length stand in ``wide`` (WIDE, n): start (3), unit direction (3), length [m], t per
meter, and the ray's place in its beam. After the last ray copies of it fill the row up: see ``padded``.
"""

import numpy as np

from sceneql.compiled.kernels import inlined
from sceneql.field.enclose.extent_kernels import extent
from sceneql.field.roots.ray_order_kernels import put_together
from sceneql.field.skeleton import skeleton_parts_kernels as part

PX, PY, PZ, DX, DY, DZ, FAR, INVERSE_SPEED, BEHIND, STRETCH, OFF = range(11)
"""Rows of rays; BEHIND: place of the ray's start along the axis of its beam; STRETCH: length of the ray per unit along
the axis; OFF: offset of the start from the axis (3 rows)."""
WIDE = 13
ORIGIN, WAY, RADIUS_OF, LOW, HIGH, SPREAD = 0, 3, 6, 7, 8, 9
BEAM = 10
"""Of a beam: a point and the unit direction of its axis, radius, where it begins and ends along the axis, and the share
of the radius that is due to the divergence of the rays."""
RUN = 4
"""Columns that ``gather_whole`` copies at once: as many rays become neighbors in the rows."""
PADDED = 32
"""The number of rays is filled up to a multiple of this."""
HAIR = 1.0e-9
UNIT = 1.0e-15
"""Squared lengths within this of 1 count as 1."""
DEEP = 1.0
"""Depth of a slice, relative to the mean chord of the parts in the beam."""


@inlined
def gather_whole(rays, count, groups, wide, ids):
    """Copy all rays into ``wide``, one row at a time, by groups of RUN columns."""
    for row in range(8):
        source, target = rays[row], wide[row]
        k = np.uint64(0)
        for g in range(0, groups, RUN):
            for first in range(g, count, groups):
                j = np.uint64(first)
                one, two = source[j], source[j + np.uint64(1)]  # all loads before the first store: vector moves
                three, four = source[j + np.uint64(2)], source[j + np.uint64(3)]
                target[k], target[k + np.uint64(1)] = one, two
                target[k + np.uint64(2)], target[k + np.uint64(3)] = three, four
                k += np.uint64(RUN)
    k = 0
    for g in range(0, groups, RUN):
        for first in range(g, count, groups):
            for c in range(RUN):
                ids[np.uint64(k + c)] = first + c
            k += RUN


@inlined
def gather_some(rays, count, groups, together, wide, ids, counts):
    """Copy the rays that have a length into ``wide``, column by column, or as ``put_together`` puts them."""
    begin, end = rays[6], rays[7]
    n = 0
    for g in range(groups):
        for j in range(g, count, groups):
            ids[n] = j
            n += 1 if begin[np.uint64(j)] < end[np.uint64(j)] else 0
    if together:
        put_together(rays, count, n, wide[:3], counts, ids, wide[3])
    for row in range(8):
        source, target = rays[row], wide[row]
        for i in range(n):
            target[i] = source[np.uint64(ids[i])]


@inlined
def padded(n):
    """Number of columns for n rays, copies of the last ray included: loops over whole vectors have no remainder."""
    return (n + PADDED - 1) // PADDED * PADDED


@inlined
def gather(rays, count, groups, together, wide, ids, counts):
    """Copy the rays that have a length into ``wide``, so that neighbors in ``rays`` are neighbors there, or those that
    ``put_together`` finds, with working memory ``counts``; returns their number."""
    begin, end = rays[6], rays[7]
    n = np.int32(0)
    for j in range(count):
        n += np.int32(1) if begin[j] < end[j] else np.int32(0)
    if n == count and groups % RUN == 0 and count % groups == 0 and not together:
        gather_whole(rays, count, groups, wide, ids)
    else:
        gather_some(rays, count, groups, together, wide, ids, counts)
    given = n
    n = padded(n)
    for row in range(8):
        line = wide[row]
        for i in range(given, n):
            line[i] = line[given - 1]
    t0, t1, dx, dy, dz = wide[FAR], wide[INVERSE_SPEED], wide[DX], wide[DY], wide[DZ]
    for axis in range(3):
        place, way = wide[PX + axis], wide[DX + axis]
        for i in range(n):
            place[i] += t0[i] * way[i]
    long = np.int64(0)
    for i in range(n):
        off = dx[i] * dx[i] + dy[i] * dy[i] + dz[i] * dz[i] - 1.0
        long += np.int64(0) if abs(off) < UNIT else np.int64(1)
    if long == 0:
        for i in range(n):
            t0[i] = t1[i] - t0[i]
            t1[i] = 1.0
        return given
    for i in range(n):
        speed = np.sqrt(dx[i] * dx[i] + dy[i] * dy[i] + dz[i] * dz[i])
        far = (t1[i] - t0[i]) * speed
        inverse = 1.0 / speed
        dx[i], dy[i], dz[i] = dx[i] * inverse, dy[i] * inverse, dz[i] * inverse
        t0[i] = far
        t1[i] = inverse
    return given


@inlined
def beam_around(wide, count, beam, spare):
    """Make the beam around the first ``count`` rays, and set their BEHIND, STRETCH and OFF.

    Returns the least cosine between a ray and the axis. ``spare`` (5, n) is working memory.
    """
    last = count - 1
    for axis in range(3):
        p, d = wide[PX + axis], wide[DX + axis]
        beam[ORIGIN + axis] = 0.5 * (p[0] + p[last])
        beam[WAY + axis] = d[0] + d[last]
    length = np.sqrt(beam[3] * beam[3] + beam[4] * beam[4] + beam[5] * beam[5])
    for axis in range(3):
        beam[WAY + axis] = beam[WAY + axis] / length if length > HAIR else 1.0 * (axis == 0)
    ox, oy, oz, ax, ay, az = beam[0], beam[1], beam[2], beam[3], beam[4], beam[5]
    n = padded(count)
    px, py, pz, vx, vy, vz = wide[PX], wide[PY], wide[PZ], wide[DX], wide[DY], wide[DZ]
    fars, behinds, stretches = wide[FAR], wide[BEHIND], wide[STRETCH]
    off_x, off_y, off_z = wide[OFF], wide[OFF + 1], wide[OFF + 2]
    off2, spread2, lows, highs, cosines = spare[0], spare[1], spare[2], spare[3], spare[4]
    for i in range(n):
        ex, ey, ez = px[i] - ox, py[i] - oy, pz[i] - oz
        behind = ex * ax + ey * ay + ez * az
        along = vx[i] * ax + vy[i] * ay + vz[i] * az
        behinds[i] = behind
        cosines[i] = along
        ex, ey, ez = ex - behind * ax, ey - behind * ay, ez - behind * az
        off_x[i], off_y[i], off_z[i] = ex, ey, ez
        off2[i] = ex * ex + ey * ey + ez * ez
    for i in range(n):
        along, behind, far = cosines[i], behinds[i], fars[i]
        dx, dy, dz = vx[i] - along * ax, vy[i] - along * ay, vz[i] - along * az
        end = behind + along * far
        spread2[i] = dx * dx + dy * dy + dz * dz
        stretches[i] = 1.0 / along
        lows[i] = behind if behind < end else end
        highs[i] = behind if behind > end else end
    _, most = extent(spread2, n)
    _, far = extent(fars, n)
    low, _ = extent(lows, n)
    _, high = extent(highs, n)
    _, off = extent(off2, n)
    least, _ = extent(cosines, n)
    spread = np.sqrt(most) * far
    hair = HAIR * (abs(ox) + abs(oy) + abs(oz) + abs(low) + abs(high))
    beam[SPREAD] = spread + hair
    beam[RADIUS_OF] = np.sqrt(off) + beam[SPREAD]
    beam[LOW] = low - hair
    beam[HIGH] = high + hair
    return least


@inlined
def beam_within(wide, first, stop, beam, spare, own):
    """Make ``own``, the beam around rays first..stop-1 of a beam, with the same direction of its axis."""
    last = stop - first - 1
    n = padded(stop - first)
    stop = first + n
    off_x, off_y, off_z = wide[OFF, first:stop], wide[OFF + 1, first:stop], wide[OFF + 2, first:stop]
    cx, cy, cz = 0.5 * (off_x[0] + off_x[last]), 0.5 * (off_y[0] + off_y[last]), 0.5 * (off_z[0] + off_z[last])
    off2 = spare[0]
    for i in range(n):
        ex, ey, ez = off_x[i] - cx, off_y[i] - cy, off_z[i] - cz
        off2[i] = ex * ex + ey * ey + ez * ez
    for j in range(BEAM):
        own[j] = beam[j]
    own[0] += cx
    own[1] += cy
    own[2] += cz
    _, off = extent(off2, n)
    own[RADIUS_OF] = np.sqrt(off) + beam[SPREAD]


@inlined
def beam_of_ray(wide, i, beam):
    """Make the beam around ray i alone, and set its BEHIND and STRETCH."""
    size = wide[FAR, i]
    for axis in range(3):
        beam[ORIGIN + axis], beam[WAY + axis] = wide[PX + axis, i], wide[DX + axis, i]
        size += abs(wide[PX + axis, i])
    wide[BEHIND, i], wide[STRETCH, i] = 0.0, 1.0
    beam[RADIUS_OF] = beam[SPREAD] = HAIR * size
    beam[LOW], beam[HIGH] = -HAIR * size, wide[FAR, i] + HAIR * size


@inlined
def reached(beam, x, y, z, radius):
    """(enter, leave, half2): where a ball of a radius about a point overlaps a beam, along its axis (enter > leave:
    nowhere), and radius^2 less the squared distance of the point from the beam."""
    ex, ey, ez = x - beam[0], y - beam[1], z - beam[2]
    along = ex * beam[3] + ey * beam[4] + ez * beam[5]
    ex, ey, ez = ex - along * beam[3], ey - along * beam[4], ez - along * beam[5]
    away2, far = ex * ex + ey * ey + ez * ez, radius + beam[RADIUS_OF]
    if away2 >= far * far:
        return np.inf, -np.inf, 0.0
    off = min(max(np.sqrt(away2) - beam[RADIUS_OF], 0.0), radius)
    half2 = radius * radius - off * off
    half = np.sqrt(half2)
    return max(along - half, beam[LOW]), min(along + half, beam[HIGH]), half2


@inlined
def keep_reaching(parts, rows, start, stop, beam, near):
    """Copy the points of rows start..stop-1, or of the ``rows`` that are listed there, that reach into a beam to
    ``near`` (p, 8); returns their number."""
    kept = 0
    for k in range(start, stop):
        i = np.uint64(rows[np.uint64(k)] if len(rows) > 0 else k)
        enter, leave, _ = reached(beam, parts[i, 0], parts[i, 1], parts[i, 2], parts[i, part.RADIUS])
        if enter <= leave:
            for j in range(8):
                near[kept, j] = parts[i, j]
            kept += 1
    return kept


@inlined
def list_parts(near, kept, beam, spans, order):
    """List the parts that reach into a beam in ``order``, and for each in ``spans`` where it enters and leaves along
    the axis and its largest density in the beam; returns their number."""
    m = 0
    for k in range(kept):
        radius = near[k, 6]
        enter, leave, half2 = reached(beam, near[k, 0], near[k, 1], near[k, 2], radius)
        if enter <= leave:
            u = half2 / (radius * radius)
            spans[0, m], spans[1, m], spans[2, m] = enter, leave, max(near[k, 7], 0.0) * u * u * u
            order[m] = k
            m += 1
    return m


@inlined
def next_slice(spans, m, begin):
    """(start, end) of the next slice, start at the first part from ``begin`` on (inf: none); the last has end = inf."""
    start = np.inf
    last = -np.inf
    chords = 0.0
    left = 0
    for i in range(m):
        enter, leave = spans[0, i], spans[1, i]
        if leave > begin:
            start = min(start, max(enter, begin))
            last = max(last, enter)
            chords += leave - enter
            left += 1
    end = start + DEEP * chords / max(left, 1)
    return start, end if last > end else np.inf
