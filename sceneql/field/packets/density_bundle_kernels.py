# mypy: ignore-errors
"""First roots along a whole bundle of rays of a density: see ``density_roots_kernels``."""

from sceneql.compiled.kernels import lean
from sceneql.field.roots.beam_kernels import BEAM, beam_around, gather, keep_reaching, keep_reaching_skeleton
from sceneql.field.roots.density_march_kernels import LANES
from sceneql.field.roots.density_roots_kernels import DENSITY_ROOTS, ROW_OF, THRESHOLD, search_packet
from sceneql.field.roots.density_slice_kernels import BEAM_ROW, SPARE
from sceneql.field.skeleton.density_polish_kernels import polish
from sceneql.field.tape.tape_ops import DENSITY


@lean(DENSITY_ROOTS, inner=True)
def density_roots(
    code, constants, parts, plan, rays, count, groups, anywhere, found, queue, order, room, table, state, short, near
):  # fmt: skip
    """First roots of a bundle: (segments examined, rays that may hit, in ``queue``); see ``packet_roots_kernels``.

    ``short`` becomes the tape with only the parts that reach into the bundle, copied to ``near``, as a DENSITY.
    """
    k = plan[ROW_OF]
    for row in range(code.shape[0]):
        for j in range(4):
            short[row, j] = code[row, j]
    ids = order[4 * LANES :]
    listed = ids[rays.shape[1] :]
    n = gather(rays, count, groups, room, ids)
    if n == 0:
        return 0, 0
    beam = room[BEAM_ROW, :BEAM]
    lowest = beam_around(room, n, beam, room[SPARE:])
    if code[k, 0] == DENSITY:
        kept = keep_reaching(parts, code[k, 1], code[k, 2], beam, near)
    else:
        kept = keep_reaching_skeleton(parts, code[k, 1], code[k, 2], beam, near)
    short[k, 0], short[k, 1], short[k, 2] = DENSITY, 0, kept
    spent = met = doubted = 0
    if kept > 0:
        for first in range(0, n, LANES):
            more, met, doubted = search_packet(
                room, first, min(first + LANES, n), near, kept, constants[plan[THRESHOLD]], anywhere, table, state,
                order, listed, ids, beam, lowest, found, queue, met, doubted,
            )  # fmt: skip
            spent += more
    last = len(queue) - 1
    for k in range(doubted):
        queue[met + k], queue[last - k] = queue[last - k], queue[met + k]
    if not anywhere:
        polish(near, kept, constants[plan[THRESHOLD]], rays, queue, met, room, found)
    return spent, met + doubted
