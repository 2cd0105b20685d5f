# mypy: ignore-errors
"""Impacts of rigid bodies by generalized reflections, and the contacts that are kept after them.

All contacts that approach are reflected together, until none approaches (Smith, Kaufman, Vouga, Tamstorf & Grinspun
2012): with the impulses of Coulomb's law and Newton's restitution on these alone. What is left of infinitely many
bounces ends at once where they are low (crowd_kernels).
"""

import math

import numpy as np
from numba import types

import sceneql.system.channels as channels
from sceneql.compiled.kernels import kernel, lean, lean_inlined
from sceneql.contacts import layout
from sceneql.contacts.distance.manifold_kernels import MOST as MOST_CORNERS
from sceneql.contacts.distance.manifold_kernels import NAME
from sceneql.contacts.distance.manifold_kernels import POINT as CORNER
from sceneql.contacts.impact_kernels import count_hit
from sceneql.contacts.rigid_exact.contact_kernels import (
    BIAS,
    KIND,
    OWN_A,
    PAIR,
    PUSHES,
    RECORD,
    ROWS,
    SHAPE_A,
    SHAPE_B,
    SPEED,
    pace,
    three,
)
from sceneql.contacts.rigid_exact.crowd_kernels import ENDLESS, TIRED, count_event, level, lowest
from sceneql.contacts.rigid_exact.energy_made_kernels import begin_account, made_energy
from sceneql.contacts.rigid_exact.exact_law_kernels import BILATERAL, UNILATERAL
from sceneql.contacts.rigid_exact.exact_law_kernels import NORMAL as CONE
from sceneql.contacts.rigid_exact.exact_rows_kernels import (
    A_SECOND,
    AGAIN,
    AT_CONTACT,
    BEFOREHAND,
    BEGUN,
    BOUNDED,
    DRIVES,
    ENDURANCE,
    FRICTION_AT,
    IMPACTS,
    KEPT,
    KEPT_AT,
    KINDS_AT,
    LATEST,
    LOOSE,
    MEMORY_AT,
    MOST,
    MOVERS,
    PAIRS,
    PASSED,
    RECORDS_AT,
    RESTITUTION_AT,
    STARTED,
    TALLY_AT,
    TIE_ROWS,
    UNIT,
    UNITS_AT,
    WATCHED,
    WORK,
    count_energy,
    energy,
    follow_all,
    kick,
    look,
    marked_at,
    mover_at,
    pull_at,
    right_at,
    solution_at,
    spots,
    write_rows,
)
from sceneql.contacts.rigid_exact.exact_solve_kernels import solve_rows
from sceneql.contacts.rigid_exact.extra_rows_kernels import write_more
from sceneql.contacts.rigid_exact.features_kernels import size_at
from sceneql.contacts.rigid_exact.find_kernels import begin, find, start_step
from sceneql.contacts.rigid_exact.rim_kernels import any_rim, exchange_all
from sceneql.contacts.rigid_exact.stop_kernels import REBOUND, STOP
from sceneql.contacts.rigid_exact.true_gap_kernels import DRIFT, unseen
from sceneql.system.signatures_kernels import IMPACT, A, F, I, N

APPROACHES = 1e-13
"""Speed of approach, in parts of the speeds that it is a sum of, that counts."""
PARTS, STILL = 1e-9, 1e-12
"""Speed away from each other, in the same parts and [m/s], from which a contact is not kept."""
MOST_ROUNDS = 200
"""Reflections at one instant, after which all contacts end their approach together, without restitution."""


@lean(F(A, A, I))
def energies(y, floats, ints):
    """Kinetic energy of all."""
    total = 0.0
    for m in range(ints[MOVERS]):
        total += energy(y, floats, ints, m)
    return total


@lean_inlined
def rebound(floats, ints, rec):
    """The restitution of a contact; that of a stop is its tie's."""
    if floats[rec + KIND] == STOP:
        return floats[int(floats[rec + OWN_A]) + REBOUND]
    return floats[ints[RESTITUTION_AT]]


@lean(types.Tuple((N, types.boolean))(F, A, A, I, F, F))
def reflect(t, y, floats, ints, restitution, friction):
    """Impulses on the contacts that are marked, so that none of them approaches; rows that were solved for, and
    whether to rounding.

    ``restitution``: the part that is had of each one's own. With one below 0, and no friction, none of them goes apart,
    either.
    """
    n = write_rows(floats, ints, IMPACTS, friction)
    if friction == floats[ints[FRICTION_AT]] and restitution >= 0.0:
        n = write_more(floats, ints, n, IMPACTS)
    right = right_at(ints)
    for i in range(ints[TIE_ROWS], n):
        kind = ints[ints[KINDS_AT] + i]
        if (kind == UNILATERAL or kind == CONE) and floats[right + i] < 0.0:
            rec = ints[RECORDS_AT] + RECORD * int(floats[ints[UNITS_AT] + UNIT * i + AT_CONTACT])
            floats[right + i] *= 1.0 + max(0.0, restitution) * rebound(floats, ints, rec)
        elif kind == UNILATERAL and restitution < 0.0:
            ints[ints[KINDS_AT] + i] = BILATERAL
    solved = solve_rows(floats, ints, n, friction, restitution >= 0.0)
    kick(y, floats, ints, n)
    look(t, y, floats, ints)
    follow_all(floats, ints)
    return n, solved


@lean(N(A, I))
def mark_approaching(floats, ints):
    """Mark the contacts that approach, of circles that lie flat the points that do so fastest; how many."""
    count = 0
    if any_rim(floats, ints):
        exchange_all(floats, ints, 0, False)
    for k in range(int(floats[ints[MEMORY_AT] + KEPT])):
        rec = ints[RECORDS_AT] + RECORD * k
        a, b = mover_at(ints, int(floats[rec + SHAPE_A])), mover_at(ints, int(floats[rec + SHAPE_B]))
        near = floats[rec + SPEED] < -APPROACHES * (STILL + pace(floats, rec, a, b))
        ints[marked_at(ints) + k] = 1 if near else 0
        count += near
    return count


@lean(F(A, I, N))
def weight(floats, ints, m):
    """Size of the acceleration of a mover by all forces but those of contacts."""
    x, y, z = three(floats, pull_at(ints, m))
    return math.sqrt(x * x + y * y + z * z)


@lean(types.boolean(A, I))
def tired(floats, ints):
    """Whether what approaches has had so many impacts that there is no restitution left."""
    for k in range(int(floats[ints[MEMORY_AT] + KEPT])):
        rec = ints[RECORDS_AT] + RECORD * k
        if floats[rec + SPEED] < 0.0 and level(floats, ints, int(floats[rec + PAIR])) > TIRED:
            return True
    return False


@lean(types.boolean(F, A, A, I))
def strike(t, y, floats, ints):
    """End the approach of all kept contacts; whether there was one. They, the ties and the movers are of this state."""
    memory, marked = ints[MEMORY_AT], marked_at(ints)
    friction, most = floats[ints[FRICTION_AT]], 0.0
    for k in range(int(floats[memory + KEPT])):
        most = max(most, rebound(floats, ints, ints[RECORDS_AT] + RECORD * k))
    restitution = 1.0 if most > 0.0 else 0.0  # the part that is had of each one's own
    # (Without friction nothing ends what bounces with a restitution of 1.)
    if (most < 1.0 or friction > 0.0) and tired(floats, ints):
        restitution = 0.0
    if any_rim(floats, ints):
        exchange_all(floats, ints, 0, False)
    count = int(floats[memory + KEPT])
    fastest = 0.0
    for k in range(count):
        fastest = max(fastest, -floats[ints[RECORDS_AT] + RECORD * k + SPEED])
    if count == 0:
        return False
    if mark_approaching(floats, ints) > 0:
        count_hit(floats, ints[TALLY_AT], t, fastest)
    count_energy(y, floats, ints, 1.0)
    rounds, solved = 0, True
    while restitution > 0.0 and solved and rounds < MOST_ROUNDS and mark_approaching(floats, ints) > 0:
        before, part = energies(y, floats, ints), restitution
        n, solved = reflect(t, y, floats, ints, part, friction)
        # Restitution and friction of several contacts may make energy: then less of the restitution.
        while friction > 0.0 and part > 0.0 and energies(y, floats, ints) > before * (1.0 + 1e-12):
            for i in range(n):
                floats[solution_at(ints) + i] *= -1.0
            kick(y, floats, ints, n)
            look(t, y, floats, ints)
            follow_all(floats, ints)
            mark_approaching(floats, ints)
            part = 0.5 * part if part * most > 0.05 else 0.0
            n, solved = reflect(t, y, floats, ints, part, friction)
        rounds += 1
    # What approaches still, or would bounce lower than it is seen, stays together.
    count, caught, later = int(floats[memory + KEPT]), 0, 0.0
    for k in range(count):
        rec = ints[RECORDS_AT] + RECORD * k
        a, b = int(floats[rec + SHAPE_A]), int(floats[rec + SHAPE_B])
        ma, mb = mover_at(ints, a), mover_at(ints, b)
        pull, speed = floats[rec + BIAS], floats[rec + SPEED]
        for side in range(2):
            for c in range(6):
                pull += floats[rec + ROWS + 6 * side + c] * floats[pull_at(ints, b if side == 1 else a) + c]
        # What holds the lower body is not known here: it may fall as fast as the upper one, and not draw away.
        pull = max(-pull, weight(floats, ints, a), weight(floats, ints, b))
        own = restitution * rebound(floats, ints, rec)
        low = speed * speed < 2.0 * pull * lowest(floats, ints, int(floats[rec + PAIR])) * size_at(floats, ints, rec)
        near = speed <= STILL + PARTS * pace(floats, rec, ma, mb)
        stays = near or (low and own < 1.0)
        ints[marked + k] = 1 if stays else 0
        if stays and ((low and not near) or speed < 0.0 or own == 0.0):
            caught += 1
        if low and speed > 0.0 and own < 1.0:
            later = max(later, 2.0 * speed / (pull * (1.0 - own)))
    if caught > 0:
        _, solved = reflect(t, y, floats, ints, 0.0, friction)
        if not solved:
            # Friction as it was found nearly; what approaches still is stopped without.
            floats[memory + LOOSE] += 1.0
            reflect(t, y, floats, ints, 0.0, 0.0)
        reflect(t, y, floats, ints, -1.0, 0.0)
        rounds = 0
        while rounds < MOST_ROUNDS and any_rim(floats, ints) and exchange_all(floats, ints, 0, False):
            mark_approaching(floats, ints)
            reflect(t, y, floats, ints, 0.0, friction)
            rounds += 1
        if math.isnan(floats[ints[TALLY_AT] + layout.REST_TIME]):
            floats[ints[TALLY_AT] + layout.REST_TIME] = t + later
    count_energy(y, floats, ints, -1.0)
    return True


@lean(types.void(F, A, I, types.boolean))
def keep(t, floats, ints, old):
    """Keep the contacts that do not part; ``old``: of pairs alone that kept some before."""
    memory, kept = ints[MEMORY_AT], 0
    h = t - floats[memory + BEGUN] if old else 0.0
    for k in range(int(floats[memory + KEPT])):
        rec, to = ints[RECORDS_AT] + RECORD * k, ints[RECORDS_AT] + RECORD * kept
        a, b = mover_at(ints, int(floats[rec + SHAPE_A])), mover_at(ints, int(floats[rec + SHAPE_B]))
        parts = DRIFT if old and floats[rec + PUSHES] > 0.0 else PARTS
        pull = weight(floats, ints, int(floats[rec + SHAPE_A])) + weight(floats, ints, int(floats[rec + SHAPE_B]))
        # (What rests at no pace at all has the rounding of what forces do in a step.)
        if abs(floats[rec + SPEED]) > STILL + parts * pace(floats, rec, a, b) + PARTS * h * pull:
            continue
        if old and floats[ints[KEPT_AT] + int(floats[rec + PAIR])] == 0.0:
            continue
        for c in range(RECORD if to != rec else 0):
            floats[to + c] = floats[rec + c]
        kept += 1
    floats[memory + KEPT] = kept


@kernel(IMPACT, inner=True)
def impact(t, y, pair, floats, ints):
    """Strike the contacts of this instant; for pair -1, at the end of a step, find anew those that are kept."""
    memory = ints[MEMORY_AT]
    if pair < 0 and floats[memory + STARTED] > 0.0:
        if made_energy(t, y, floats, ints):
            floats[channels.CHANGED] = channels.MADE
            return
        if unseen(t, y, floats, ints, False):
            floats[channels.CHANGED] = channels.UNSEEN
            return
    points, names = np.zeros(MOST_CORNERS * CORNER), np.zeros(MOST_CORNERS * NAME, dtype=np.int64)
    if pair >= 0:
        again = floats[memory + AGAIN] + 1.0 if t == floats[memory + LATEST] else 0.0
        floats[memory + LATEST], floats[memory + AGAIN], floats[memory + PASSED] = t, again, 0.0
        of = pair
        if pair >= spots(ints) + WATCHED * ints[MOST]:
            of = ints[PAIRS] + pair - spots(ints) - WATCHED * ints[MOST]
        elif pair >= spots(ints):
            of = int(floats[ints[RECORDS_AT] + RECORD * ((pair - spots(ints)) // WATCHED) + PAIR])
        look(t, y, floats, ints)
        count_event(t, floats, ints, of)
        if again > ENDURANCE or level(floats, ints, of) > ENDLESS:
            floats[channels.CHANGED] = channels.NO_WAY_ON
        find(t, y, floats, ints, points, names, False)
        strike(t, y, floats, ints)
        keep(t, floats, ints, False)
        begin(t, y, floats, ints, False)
    elif floats[memory + STARTED] == 0.0:
        floats[memory + STARTED] = 1.0
        unseen(t, y, floats, ints, True)
        find(t, y, floats, ints, points, names, False)
        keep(t, floats, ints, False)
        begin(t, y, floats, ints, False)
        floats[channels.CHANGED] = 1.0
    elif ints[DRIVES] > 0 and floats[channels.CHANGED] == channels.DUE and floats[memory + PASSED] == 0.0:
        # All is found anew at the impact; where that is another contact's, a step later.
        floats[memory + PASSED] = 1.0
    elif floats[memory + KEPT] > 0.0 or ints[DRIVES] > 0:
        floats[memory + AGAIN] = floats[memory + PASSED] = 0.0
        before = floats[memory + KEPT]
        same = find(t, y, floats, ints, points, names, True)
        keep(t, floats, ints, True)
        begin(t, y, floats, ints, same and floats[memory + KEPT] == before)
        floats[channels.CHANGED] = 1.0
    if floats[memory + BOUNDED] > 0.0 and floats[memory + WORK] > BEFOREHAND + A_SECOND * t:
        floats[channels.CHANGED] = channels.COSTLY
    start_step(t, y, floats, ints)
    begin_account(y, floats, ints)
