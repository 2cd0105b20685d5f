# mypy: ignore-errors
"""First roots along a whole bundle of rays of a density: see ``density_roots_kernels``."""

import numpy as np

from sceneql.compiled.kernels import inlined, lean
from sceneql.field.packets.lone_ray_kernels import MOST_POINTS, place_points, search_piece
from sceneql.field.packets.lone_ray_kernels import polish as polish_lone
from sceneql.field.packets.point_blocks_kernels import list_in_beam, list_on_ray
from sceneql.field.packets.ray_rows import FOUND_HIGH, FOUND_LOW, FOUND_ROOT, FOUND_STATUS
from sceneql.field.roots.beam_kernels import (
    BEAM,
    DX,
    DY,
    DZ,
    FAR,
    HIGH,
    INVERSE_SPEED,
    LOW,
    PX,
    PY,
    PZ,
    RADIUS_OF,
    beam_around,
    beam_of_ray,
    beam_within,
    gather,
    keep_reaching,
)
from sceneql.field.roots.density_march_kernels import LANES
from sceneql.field.roots.density_roots_kernels import DENSITY_ROOTS, ROW_OF, THRESHOLD, search_packet
from sceneql.field.roots.density_slice_kernels import BEAM_ROW, OWN_ROW, SPARE
from sceneql.field.skeleton.density_polish_kernels import polish
from sceneql.field.tape.tape_ops import DENSITY, HIT, MISS, UNDECIDED

APART = 0.5
"""Cosine of the angle to the beam's axis below which rays of a bundle count as going apart."""
FIRST, LONGER = 0.12, 2.0
"""Of the pieces of such a ray: the share of its length that is the first, and how far the others end by the last."""
MANY = 96
"""Parts that reach into a bundle from which on rays that go apart are each searched among the few in its own reach."""
CROWD = 256
"""Rows of parts from which on it pays to sort a bundle's rays."""


@inlined
def search_many(
    room, i, begin, end, rays, parts, near, kept, threshold, anywhere, table, state, order, listed, ids, found, queue,
    met, doubted,
):  # fmt: skip
    """``search_packet`` of a piece of gathered ray i alone, among more points than have room in lanes."""
    hits, own = met, room[OWN_ROW, :BEAM]
    for k in range(kept):
        for j in range(8):
            near[k, j] = parts[listed[k], j]
    before = room[PX, i], room[PY, i], room[PZ, i], room[FAR, i]
    for axis in range(3):
        room[PX + axis, i] += begin * room[DX + axis, i]
    room[FAR, i] = end - begin
    beam_of_ray(room, i, own)
    spent, met, doubted = search_packet(
        room, i, i + 1, near, kept, threshold, anywhere, table, state, order, listed, ids, own, 0.0, found, queue, met,
        doubted,
    )  # fmt: skip
    room[PX, i], room[PY, i], room[PZ, i], room[FAR, i] = before
    j, off = np.uint64(ids[i]), begin * room[INVERSE_SPEED, i]
    found[FOUND_LOW, j] += off
    found[FOUND_HIGH, j] += off
    found[FOUND_ROOT, j] += off
    if met > hits and not anywhere:  # in the memory of the first ray, which is searched already
        polish(near, kept, threshold, rays, queue[hits:], 1, room, listed, found)
    return spent, met, doubted


@inlined
def search_ray(
    room, i, rays, blocks, parts, near, threshold, anywhere, table, state, order, listed, ids, found, queue, met,
    doubted,
):  # fmt: skip
    """Search gathered ray i alone, piece by piece, since most rays among many parts end early."""
    far, unit, j = room[FAR, i], room[INVERSE_SPEED, i], np.uint64(ids[i])
    x, y, z, dx, dy, dz = room[PX, i], room[PY, i], room[PZ, i], room[DX, i], room[DY, i], room[DZ, i]
    spent, before, begin, end = 0, met + doubted, 0.0, far * FIRST
    while begin < far and met + doubted == before:
        end = min(end, far)
        px, py, pz = x + begin * dx, y + begin * dy, z + begin * dz
        kept = list_on_ray(blocks, 0, px, py, pz, dx, dy, dz, end - begin, listed)
        if kept > MOST_POINTS:
            more, met, doubted = search_many(
                room, i, begin, end, rays, parts, near, kept, threshold, anywhere, table, state, order, listed, ids,
                found, queue, met, doubted,
            )  # fmt: skip
            spent += more
        elif kept > 0:
            n, sums = place_points(parts, listed, kept, px, py, pz, dx, dy, dz, threshold, table)
            outcome, low, high, at, more = search_piece(table, sums, n, end - begin, threshold, anywhere)
            spent += more
            if outcome != MISS:
                root = float(at)
                if outcome == HIT and not anywhere:
                    root, settled = polish_lone(
                        parts, listed, n, threshold, px, py, pz, dx, dy, dz, root, float(low), float(high), far
                    )
                    outcome = HIT if settled and begin + root < far else UNDECIDED
                found[FOUND_STATUS, j] = outcome
                found[FOUND_LOW, j], found[FOUND_HIGH, j] = (begin + low) * unit, (begin + high) * unit
                found[FOUND_ROOT, j] = (begin + root) * unit
                if outcome == HIT:
                    queue[met] = ids[i]
                    met += 1
                else:
                    queue[len(queue) - 1 - doubted] = ids[i]
                    doubted += 1
        begin, end = end, end * LONGER
    return spent, met, doubted


@inlined
def roots_apart(
    constants, parts, plan, rays, n, anywhere, found, queue, order, room, table, state, near, blocks
):  # fmt: skip
    """``density_roots`` of n gathered rays, each alone: of a hierarchy's parts a ray meets a few, all rays most."""
    ids = order[4 * LANES :]
    listed = ids[rays.shape[1] :]
    threshold = constants[plan[THRESHOLD]]
    spent = met = doubted = 0
    for i in range(n):
        more, met, doubted = search_ray(
            room, i, rays, blocks, parts, near, threshold, anywhere, table, state, order, listed, ids, found, queue,
            met, doubted,
        )  # fmt: skip
        spent += more
    return spent, met, doubted


@lean(DENSITY_ROOTS, inner=True)
def density_roots(
    code, constants, parts, plan, rays, count, groups, anywhere, found, queue, order, room, table, state, short, near,
    blocks,
):  # fmt: skip
    """First roots of a bundle: (segments examined, rays that may hit, in ``queue``, parts among which they were
    searched); see ``packet_roots_kernels``.

    ``short`` becomes the tape with only the parts that reach into the bundle, copied to ``near``, as a DENSITY. Where
    rays go apart there is no such tape, and their number is -1; then ``blocks`` are those of the points.
    """
    k = plan[ROW_OF]
    for row in range(code.shape[0]):
        for j in range(4):
            short[row, j] = code[row, j]
    ids = order[4 * LANES :]
    listed = ids[rays.shape[1] :]
    many = code[k, 2] - code[k, 1] > CROWD
    n = gather(rays, count, groups, anywhere and many, room, ids, order)
    if n == 0:
        return 0, 0, 0
    beam = room[BEAM_ROW, :BEAM]
    lowest = beam_around(room, n, beam, room[SPARE:])
    most = MANY if lowest <= APART else max(MANY, 2 * n)
    if code[k, 0] == DENSITY:
        kept = keep_reaching(parts, listed[:0], code[k, 1], code[k, 2], beam, near)
    else:
        # The beam's axis begins at LOW.
        low = beam[LOW]
        px, py, pz = beam[0] + low * beam[3], beam[1] + low * beam[4], beam[2] + low * beam[5]
        some = list_in_beam(
            blocks, 0, px, py, pz, beam[3], beam[4], beam[5], beam[HIGH] - low, beam[RADIUS_OF], listed
        )  # fmt: skip
        kept = keep_reaching(parts, listed, 0, some, beam, near)
    spent = met = doubted = 0
    apart = code[k, 0] != DENSITY and kept > most
    if apart:
        kept = -1
        spent, met, doubted = roots_apart(
            constants, parts, plan, rays, n, anywhere, found, queue, order, room, table, state, near, blocks
        )  # fmt: skip
    else:
        short[k, 0], short[k, 1], short[k, 2] = DENSITY, 0, kept
    own = room[OWN_ROW, :BEAM]
    for first in range(0, n if kept > 0 else 0, LANES):
        stop = min(first + LANES, n)
        beam_within(room, first, stop, beam, room[SPARE:], own)
        more, met, doubted = search_packet(
            room, first, stop, near, kept, constants[plan[THRESHOLD]], anywhere, table, state, order, listed, ids, own,
            lowest, found, queue, met, doubted,
        )  # fmt: skip
        spent += more
    last = len(queue) - 1
    for k in range(doubted):
        queue[met + k], queue[last - k] = queue[last - k], queue[met + k]
    if not (anywhere or apart):
        polish(near, kept, constants[plan[THRESHOLD]], rays, queue, met, room, listed, found)
    return spent, met + doubted, kept
