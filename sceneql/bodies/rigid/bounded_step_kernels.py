# mypy: ignore-errors
"""Stops, motors and dry friction of ties on an island whose bodies touch nothing: the step's velocities at its end."""

import numpy as np

import sceneql.system.channels as channels
from sceneql.bodies.rigid.drive_kernels import EFFORT_AT
from sceneql.bodies.rigid.groups_kernels import MASS, solve_groups
from sceneql.bodies.rigid.moved_bodies_kernels import (
    DRIVES,
    ROW_BODIES_AT,
    ROWS,
    move_all,
    place_all,
)
from sceneql.bodies.rigid.ties.tied_rows_kernels import begin_ties, drive_of, first_stop, write_ties
from sceneql.bodies.rigid.ties.tied_step_kernels import again, end_ties, strike, tell_work, tied_to
from sceneql.bodies.rigid.velocity_step_kernels import BODY_INTS, gather
from sceneql.compiled.kernels import kernel
from sceneql.linear.cones.cone_layout_kernels import ROW
from sceneql.system.signatures_kernels import BACK_OFF

BODIES, BODIES_AT, OWN_AT, OWN, HEAD = range(5)
"""Integers: the number of bodies; where their integers and those of their ties (tied_rows_kernels) begin, and how many
these are."""

MOST = 6
"""Most solutions of a step."""


@kernel(BACK_OFF, inner=True)
def back_off(t0, t1, y0, rate0, y1, floats, ints):
    """Resolve the stops, motors and friction of the step in y1."""
    own = ints[ints[OWN_AT] : ints[OWN_AT] + ints[OWN]]
    h, every, bodies_at = t1 - t0, ints[BODIES], ints[BODIES_AT]
    if floats[channels.STEP_END] > 0.0:
        part = first_stop(h, y0, y1, floats, own)
        if part < 1.0:
            floats[channels.STEP_END] = min(floats[channels.STEP_END], t0 + part * h)
        return
    masses, motions, before = np.empty(MASS * every), np.empty(6 * every), np.empty(6 * every)
    rows, sides = np.zeros(ROW * own[ROWS]), own[own[ROW_BODIES_AT] : own[ROW_BODIES_AT] + 2 * own[ROWS]]
    who, where = np.empty(0, dtype=np.int64), np.empty(0)
    begin_ties(h, y0, y1, floats, own)
    for k in range(every):
        gather(y0, y0, y1, floats, ints, bodies_at + BODY_INTS * k, masses, MASS * k, motions, before, 6 * k)
    strike(y1, floats, masses, ints, own, bodies_at, motions, before)
    write_ties(h, y0, y1, floats, own, rows)
    free, found, touched, some, loose = y1.copy(), motions.copy(), np.zeros(every, dtype=np.int64), False, 0
    for number in range(MOST):
        loose = solve_groups(every, every, who, where, 0, masses, motions, found, 0.0, rows, sides)
        touched[:] = 0
        some = tied_to(touched, floats, own, rows)
        if not some:
            break
        place_all(h, y0, y1, free, floats, ints, bodies_at, every, own, touched, found, motions)
        if number == MOST - 1 or not again(h, y0, y1, free, floats, own, rows):
            break
    for k in range(own[DRIVES] if loose > 0 else 0):
        floats[own[drive_of(own, k) + EFFORT_AT] + 1] += 1.0
    move_all(y0, y1, free, floats, ints, bodies_at, every, own, touched, masses, found, before)
    tell_work(floats, own, rows, found, before)
    end_ties(h, y0, floats, own, rows, who, where, 0, every, some)
