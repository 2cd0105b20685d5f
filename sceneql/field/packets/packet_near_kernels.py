# mypy: ignore-errors
"""Selects the parts of skeletons that are near the segments of a bundle, in float32."""

from sceneql.compiled.kernels import inlined, lean
from sceneql.compiled.lanes_kernels import bits_below, load
from sceneql.field.packets import packet_density_kernels as density
from sceneql.field.packets import packet_rows as rows
from sceneql.field.packets.packet_density_kernels import C1, GROW, INFINITE, TINY, VECTOR
from sceneql.field.packets.packet_kernels import KEEP_SKELETON
from sceneql.field.skeleton import skeleton_parts_kernels as part


@inlined
def off_box(parts, k, x, y, z):
    """Squared distance of points from the box around part k."""
    gx = density.apart(x, x, parts[rows.LOW_X, k], parts[rows.LOW_X + 1, k])
    gy = density.apart(y, y, parts[rows.LOW_Y, k], parts[rows.LOW_Y + 1, k])
    gz = density.apart(z, z, parts[rows.LOW_Z, k], parts[rows.LOW_Z + 1, k])
    return gx * gx + gy * gy + gz * gz


@inlined
def lanes_within(off, far):
    """Bit mask of the lanes where ``off`` is at most far^2, NaN included."""
    return ~bits_below(far * far * GROW + TINY, off) & ((1 << VECTOR) - 1)


@inlined
def within_reach(parts, k, x, y, z, spare, first, stop):
    """(whether part k may have a density in one of the lanes first..stop-1, whose ``sizes`` are in ``spare``; whether
    it may on the segments through the middles of these lanes)."""
    found, middle = False, False
    for i in range(first // VECTOR * VECTOR, stop, VECTOR):
        off, far = off_box(parts, k, load(x, i), load(y, i), load(z, i)), parts[rows.FAR, k + 1]
        chosen = (1 << min(stop - i, VECTOR)) - (1 << max(first - i, 0))
        if lanes_within(off, far + load(spare, i)) & chosen != 0:
            found = True
            way = abs(load(x, C1 + i)) + abs(load(y, C1 + i)) + abs(load(z, C1 + i))
            middle = middle or lanes_within(off, far + way) & chosen != 0
    return found, middle


@inlined
def box_around(x, y, z, first, stop):
    """(bounding box of lanes first..stop-1, rounded to whole vectors; whether all of them are finite)."""
    ax, bx, ay, by, az, bz = INFINITE, -INFINITE, INFINITE, -INFINITE, INFINITE, -INFINITE
    known = True
    for i in range(first // VECTOR * VECTOR, stop, VECTOR):
        seen = density.looked_at(x, y, z, i)
        box, loose = seen[6], seen[8]
        known = known and bits_below(loose, INFINITE) == (1 << VECTOR) - 1
        ax, bx, ay, by = min(ax, box[0]), max(bx, box[1]), min(ay, box[2]), max(by, box[3])
        az, bz = min(az, box[4]), max(bz, box[5])
    return (ax, bx, ay, by, az, bz), known


@lean(KEEP_SKELETON, inner=True)
def keep_skeleton(start, end, x, y, z, spare, first, stop, singles, parts, kept, near_singles, near_parts):
    """Append the parts of the skeleton in rows start..end-1 that are near lanes first..stop-1; (rows kept, own).

    ``own`` is the number of parts near the middle segments of the lanes.
    """
    own = 0
    density.sizes(x, y, z, spare)
    box, known = box_around(x, y, z, first, stop)
    for begin in range(start, end, VECTOR):
        bits = density.near_box(singles, begin, end, box)
        for k in range(begin, min(begin + VECTOR, end), part.STRIDE):
            if parts[k + 1, part.SHAPE] == part.NODE or (known and (bits >> (k - begin)) & 1 == 0):
                continue
            found, middle = within_reach(singles, k, x, y, z, spare, first, stop)
            own += 1 if middle else 0
            if found:
                for j in range(rows.PART):
                    near_singles[j, kept] = singles[j, k]
                    near_singles[j, kept + 1] = singles[j, k + 1]
                for j in range(8):
                    near_parts[kept, j] = parts[k, j]
                    near_parts[kept + 1, j] = parts[k + 1, j]
                kept += part.STRIDE
    return kept, own
