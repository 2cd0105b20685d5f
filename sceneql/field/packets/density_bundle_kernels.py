# mypy: ignore-errors
"""First roots along a whole bundle of rays of a density: see ``density_roots_kernels``."""

import numpy as np

from sceneql.compiled.kernels import inlined, lean
from sceneql.field.packets.point_blocks_kernels import keep_on_ray
from sceneql.field.packets.ray_rows import FOUND_HIGH, FOUND_LOW, FOUND_ROOT
from sceneql.field.roots.beam_kernels import (
    BEAM,
    DX,
    DY,
    DZ,
    FAR,
    INVERSE_SPEED,
    PX,
    PY,
    PZ,
    beam_around,
    beam_of_ray,
    beam_within,
    gather,
    keep_reaching,
    keep_reaching_skeleton,
)
from sceneql.field.roots.density_march_kernels import LANES
from sceneql.field.roots.density_roots_kernels import DENSITY_ROOTS, ROW_OF, THRESHOLD, search_packet
from sceneql.field.roots.density_slice_kernels import BEAM_ROW, OWN_ROW, SPARE
from sceneql.field.skeleton.density_polish_kernels import polish
from sceneql.field.tape.tape_ops import DENSITY

APART = 0.5
"""Cosine of the angle to the beam's axis below which rays of a bundle count as going apart."""
FIRST, LONGER = 0.06, 2.0
"""Of the pieces of such a ray: the share of its length that is the first, and how far the others end by the last."""
MANY = 96
"""Parts that reach into a bundle from which on rays that go apart are each searched among the few in its own reach."""


@inlined
def search_ray(
    room, i, far, blocks, parts, near, threshold, anywhere, table, state, order, rays, found, queue, met, doubted
):  # fmt: skip
    """``search_packet`` of gathered ray i alone, piece by piece, since most rays among many parts end early."""
    ids = order[4 * LANES :]
    listed = ids[rays.shape[1] :]
    own = room[OWN_ROW, :BEAM]
    spent, before, begin, end = 0, met + doubted, 0.0, far * FIRST
    x, y, z = room[PX, i], room[PY, i], room[PZ, i]
    dx, dy, dz = room[DX, i], room[DY, i], room[DZ, i]
    while begin < far and met + doubted == before:
        end = min(end, far)
        room[PX, i], room[PY, i], room[PZ, i] = x + begin * dx, y + begin * dy, z + begin * dz
        room[FAR, i] = end - begin
        kept = keep_on_ray(
            blocks, parts, room[PX, i], room[PY, i], room[PZ, i], dx, dy, dz, end - begin, near,
            listed,
        )  # fmt: skip
        if kept > 0:
            beam_of_ray(room, i, own)
            more, met, doubted = search_packet(
                room, i, i + 1, near, kept, threshold, anywhere, table, state, order, listed, ids, own, 0.0, found,
                queue, met, doubted,
            )  # fmt: skip
            spent += more
        if met + doubted > before:
            j, off = np.uint64(ids[i]), begin * room[INVERSE_SPEED, i]
            found[FOUND_LOW, j] += off
            found[FOUND_HIGH, j] += off
            found[FOUND_ROOT, j] += off
        begin, end = end, end * LONGER
    return spent, met, doubted


@inlined
def roots_apart(
    constants, parts, plan, rays, n, anywhere, found, queue, order, room, table, state, near, blocks
):  # fmt: skip
    """``density_roots`` of n gathered rays, each alone: of a hierarchy's parts a ray meets a few, all rays most."""
    threshold = constants[plan[THRESHOLD]]
    spent = met = doubted = 0
    for i in range(n):
        more, met, doubted = search_ray(
            room, i, room[FAR, i], blocks, parts, near, threshold, anywhere, table, state, order, rays, found, queue,
            met, doubted,
        )  # fmt: skip
        spent += more
    for i in range(0 if anywhere else met):
        j = np.uint64(queue[i])
        t = rays[6, j] + found[FOUND_ROOT, j]
        kept = keep_on_ray(
            blocks, parts, rays[0, j] + t * rays[3, j], rays[1, j] + t * rays[4, j], rays[2, j] + t * rays[5, j],
            rays[3, j], rays[4, j], rays[5, j], 0.0, near, order,
        )  # fmt: skip
        polish(near, kept, threshold, rays, queue[i:], 1, room, found)
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
    n = gather(rays, count, groups, room, ids)
    if n == 0:
        return 0, 0, 0
    beam = room[BEAM_ROW, :BEAM]
    lowest = beam_around(room, n, beam, room[SPARE:])
    if code[k, 0] == DENSITY:
        kept = keep_reaching(parts, code[k, 1], code[k, 2], beam, near)
    else:
        kept = keep_reaching_skeleton(parts, code[k, 1], code[k, 2], beam, near)
    spent = met = doubted = 0
    apart = code[k, 0] != DENSITY and kept > MANY and lowest <= APART
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
        polish(near, kept, constants[plan[THRESHOLD]], rays, queue, met, room, found)
    return spent, met + doubted, kept
