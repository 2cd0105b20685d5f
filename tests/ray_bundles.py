"""Bundles of rays that pass near each other, and their roots beside those of the certified routine."""

import numpy as np
import pytest

from sceneql.field.packets import ray_rows
from sceneql.field.packets.packet_roots_kernels import GROUP
from sceneql.field.packets.packets import Memory
from sceneql.field.tape.own_coordinates import in_own_coordinates
from sceneql.field.tape.tape_ops import (
    HIT,
    INSIDE,
    UNDECIDED,
)
from sceneql.field.tape.tape_solid import cast


def bundle(origin, direction, generator, count, spread):
    """Rays near one another."""
    return origin + spread * generator.uniform(-1, 1, (count, 3)), direction + spread * generator.uniform(
        -1, 1, (count, 3)
    )


def cast_together(tape, origins, directions, t0, t1, anywhere=False, cut=()):
    """(status, t), each (n,): as ``tape_solid.cast``, of neighboring rays, in bundles of 256.

    Rays are clipped by the rows ``cut`` of the tape before: see Memory.
    """
    size = min(256, len(t0))
    tape, matrix = (tape, np.eye(3, 4)) if len(cut) > 0 else in_own_coordinates(tape)
    origins, directions = origins @ matrix[:, :3].T + matrix[:, 3], directions @ matrix[:, :3].T
    memory = Memory(tape, size, cut)
    status, t = np.empty(len(t0), dtype=np.int64), np.empty(len(t0))
    for start in range(0, len(t0), size):
        stop = min(start + size, len(t0))
        n = stop - start
        # Neighbors go into columns of GROUP rows.
        columns = -(-n // GROUP)
        ray = start + np.argsort(np.arange(n) // GROUP + columns * (np.arange(n) % GROUP), kind="stable")
        memory.rays[:3, :n], memory.rays[3:6, :n] = origins[ray].T, directions[ray].T
        memory.rays[6, :n], memory.rays[7, :n] = t0[ray], t1[ray]
        memory.settle(n, anywhere)
        status[ray] = memory.found[ray_rows.FOUND_STATUS, :n]
        t[ray] = memory.found[ray_rows.FOUND_ROOT, :n]
    return status, t


def agree_with_the_certified(tape, origins, directions, t0, t1, within, cut=()):
    """First places, and whether there is any, as the certified routine has them, wherever both decide."""
    status, t = cast_together(tape, origins, directions, t0, t1, cut=cut)
    exact, places = cast(tape, origins, directions, t0, t1)
    told = (status != UNDECIDED) & (exact != UNDECIDED)
    assert told.mean() > 0.9
    met, truly = np.isin(status, [HIT, INSIDE]), np.isin(exact, [HIT, INSIDE])
    assert (met == truly)[told].all()
    assert t[met & told] == pytest.approx(places[met & told], abs=within)
    blocked, _ = cast_together(tape, origins, directions, t0, t1, anywhere=True, cut=cut)
    told &= blocked != UNDECIDED
    assert (np.isin(blocked, [HIT, INSIDE]) == truly)[told].all()
