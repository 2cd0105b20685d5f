# mypy: ignore-errors
"""Impacts and rest of bodies within a step, compiled when the first body touches a surface.

The body's path in the step is the cubic Hermite curve of its ends; after an impact it flies on with the step's mean
acceleration, which loses the solver's order. So where few bodies have impacts, the march is asked to end the step right
after the first impact and to continue from there; and so wherever a tie breaks, for one cut serves all ties that break
at that instant. An approach slower than the speed that the acceleration into the surface gives in two steps is no
impact: the body rests (resting_kernels), and slides for the rest of the step.
"""

import math

from numba import types

import sceneql.system.channels as channels
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.contacts import layout
from sceneql.contacts.body_path_kernels import MOVED, NEVER, moving, place, set_out
from sceneql.contacts.impact_kernels import bounce, count_hit, scale_of
from sceneql.contacts.meet_kernels import earliest, seen
from sceneql.contacts.pair_kernels import ANSWER, BRAKE, is_flat
from sceneql.contacts.resting_kernels import come_to_rest, keep, lies
from sceneql.contacts.shape_kernels import clear, surface, velocity
from sceneql.contacts.slide_kernels import fly_on, slide, start_with
from sceneql.system.signatures_kernels import A, F, I, N

brake = lazy("sceneql.contacts.friction_kernels:brake", BRAKE)

MOST_IMPACTS = 8
"""Most impacts of a body in one step; after these it is only kept outside."""
FEW = 8
"""Bodies with an impact in a step above which the step is not cut."""
TOUCHING = 1e-9
"""Depth, relative to the coordinates (or to a meter), up to which a body touches a surface."""
AFTER_IMPACT = 1e-4
"""Where a cut step ends, in parts of the step after the impact."""


@lean(types.boolean(F, F, N, A, A, A, I), inner=True)
def hits(s, whole, j, path, mean, floats, ints):
    """Whether the contact at s with object j is an impact, not the beginning of rest."""
    at = layout.HEAD + layout.OBJECT * j
    x, y, z = seen(path, s, floats, ints, at)
    vx, vy, vz = moving(path, s)
    ux, uy, uz = velocity(floats, ints, at, x, y, z)
    _, nx, ny, nz = surface(floats, ints, at, x, y, z)
    press = min(0.0, mean[0] * nx + mean[1] * ny + mean[2] * nz)
    return (vx - ux) * nx + (vy - uy) * ny + (vz - uz) * nz < 2.0 * press * whole


@lean_inlined
def fly(k, t1, whole, reach, path, mean, floats, ints):
    """Change the path by its impacts; the energy per mass that they dissipate [J/kg]. ``whole``: length of a step."""
    length = path[12]
    lost = 0.0
    for _ in range(MOST_IMPACTS):
        s, j = earliest(k, reach, path, floats, ints)
        if s == NEVER:
            break
        at = layout.HEAD + layout.OBJECT * j
        px, py, pz = place(path, s)
        vx, vy, vz = moving(path, s)
        qx, qy, qz = seen(path, s, floats, ints, at)
        d, nx, ny, nz = surface(floats, ints, at, qx, qy, qz)
        # Move it onto the surface: roots have rounding errors, and a body may start slightly inside.
        d = min(0.0, d - reach)
        ux, uy, uz = velocity(floats, ints, at, qx, qy, qz)
        rx, ry, rz = vx - ux, vy - uy, vz - uz
        vn = rx * nx + ry * ny + rz * nz
        press = min(0.0, mean[0] * nx + mean[1] * ny + mean[2] * nz)
        t = t1 - path[12] * (1.0 - s)
        impact = hits(s, whole, j, path, mean, floats, ints)
        path[12] *= 1.0 - s
        path[0], path[1], path[2] = px - d * nx, py - d * ny, pz - d * nz
        path[3], path[4], path[5] = vx, vy, vz
        if -d > TOUCHING * scale_of(px, py, pz):  # another mass has pushed it in: the acceleration does work on that
            lost -= d * (mean[0] * nx + mean[1] * ny + mean[2] * nz)
        if impact:
            rx, ry, rz = bounce(rx, ry, rz, nx, ny, nz, floats[ints[layout.RESTITUTION]], floats[ints[layout.FRICTION]])
            lost += start_with(path, rx + ux, ry + uy, rz + uz)
            count_hit(floats, ints[layout.TALLY], t, -vn)
            fly_on(path, mean[0], mean[1], mean[2], path[12])
        else:
            rx, ry, rz = rx - vn * nx, ry - vn * ny, rz - vn * nz
            lost += start_with(path, rx + ux, ry + uy, rz + uz)
            lost += slide(path, mean, nx, ny, nz, ux, uy, uz, press, floats[ints[layout.FRICTION]])
            memory = ints[layout.PAIRS] + layout.PAIR * (k * ints[layout.OBJECTS] + j)
            rx, ry, rz = path[9] - ux, path[10] - uy, path[11] - uz
            come_to_rest(t, memory, rx, ry, rz, nx, ny, nz, floats, ints)
            if floats[memory] == layout.SLIDES and floats[ints[layout.FRICTION]] > 0.0:
                floats[memory] = layout.CREEPS
        if path[12] <= 1e-14 * length:
            break
    return lost


@lean_inlined
def push_out(reach, path, mean, floats, ints):
    """Move the path's end out of all objects; the kinetic and potential energy per mass that this takes [J/kg]."""
    work = 0.0
    before = path[9] ** 2 + path[10] ** 2 + path[11] ** 2
    for _ in range(3):
        apart = True
        for j in range(ints[layout.OBJECTS]):
            at = layout.HEAD + layout.OBJECT * j
            if clear(floats, ints, at, path[6], path[7], path[8], reach):
                continue
            d, nx, ny, nz = surface(floats, ints, at, path[6], path[7], path[8])
            d -= reach
            if d >= 0.0:
                continue
            apart = False
            work -= d * (mean[0] * nx + mean[1] * ny + mean[2] * nz)
            path[6], path[7], path[8] = path[6] - d * nx, path[7] - d * ny, path[8] - d * nz
            ux, uy, uz = velocity(floats, ints, at, path[6], path[7], path[8])
            vn = (path[9] - ux) * nx + (path[10] - uy) * ny + (path[11] - uz) * nz
            if vn < 0.0:
                path[9], path[10], path[11] = path[9] - vn * nx, path[10] - vn * ny, path[11] - vn * nz
        if apart:
            break
    return work + 0.5 * (before - path[9] ** 2 - path[10] ** 2 - path[11] ** 2)


@lean_inlined
def keep_all(t, k, h, y0, y, path, mean, floats, ints):
    """Friction of creeping pairs and `keep` for all pairs of body k; then path and mean acceleration as `set_out`.

    What `keep` corrects, at the end of a step that may be short, is no speed of the flight and no acceleration: it
    moves both ends of the path.
    """
    at, to = ints[layout.POSITION] + 3 * k, ints[layout.VELOCITY] + 3 * k
    for c in range(6):
        mean[MOVED + c] = 0.0
    for j in range(ints[layout.OBJECTS]):
        if floats[ints[layout.FRICTION]] > 0.0:
            brake(t, k, j, h, y0, y, floats, ints)
        for c in range(3):
            mean[MOVED + c] -= y[at + c]
            mean[MOVED + 3 + c] -= y[to + c]
        keep(t, k, j, y, floats, ints)
        for c in range(3):
            mean[MOVED + c] += y[at + c]
            mean[MOVED + 3 + c] += y[to + c]
    set_out(k, h, y0, y, path, mean, ints)
    for c in range(3):
        path[c] += mean[MOVED + c]
        path[3 + c] += mean[MOVED + 3 + c]
        mean[c] -= mean[MOVED + 3 + c] / h


@lean_inlined
def slack(memory, floats, ints):
    """Margin [m/s^2] of static friction over the pull along the surface; NaN where the pair does not stick."""
    if floats[memory] != layout.STICKS or floats[ints[layout.FRICTION]] == 0.0:
        return math.nan
    return floats[ints[layout.FRICTION]] * floats[memory + layout.LOAD] - floats[memory + layout.PULL]


@lean_inlined
def crossing(before, after):
    """Part of a step after which a number linear from ``before`` to ``after`` is negative; 1 where it is not (NaN)."""
    if before > 0.0 and after < 0.0:
        return before / (before - after)
    return 1.0


@lean_inlined
def torn_off(k, floats, ints):
    """Part of a step after which the first tie of body k pulls, or exceeds static friction; 1 where none does."""
    first = 1.0
    for j in range(ints[layout.OBJECTS]):
        memory = ints[layout.PAIRS] + layout.PAIR * (k * ints[layout.OBJECTS] + j)
        if floats[memory] != layout.FREE and not math.isnan(floats[memory + layout.EARLIER]):
            first = min(first, crossing(floats[memory + layout.EARLIER], -floats[memory + layout.PRESS]))
            first = min(first, crossing(floats[memory + layout.SLACK], slack(memory, floats, ints)))
    return first


@lean_inlined
def let_go(k, floats, ints):
    """Break the ties of body k that pull or exceed static friction; store the loads of the others."""
    for j in range(ints[layout.OBJECTS]):
        memory = ints[layout.PAIRS] + layout.PAIR * (k * ints[layout.OBJECTS] + j)
        if floats[memory] == layout.FREE:
            continue
        left = slack(memory, floats, ints)
        floats[memory + layout.SLACK] = left
        if floats[memory + layout.PRESS] > 0.0:
            floats[memory] = layout.FREE
        elif left < 0.0:
            floats[memory] = layout.SLIDES
        if floats[memory] != layout.CREEPS:
            floats[memory + layout.EARLIER] = floats[memory + layout.LOAD]


@lean(ANSWER, inner=True)
def cut(t0, t1, y0, y1, found, path, mean, floats, ints):
    """The time at which to end the step: after its first impact, where few of the bodies with found[k] = 1 have one,
    or after the first tie breaks: these are few, or mostly break at one instant."""
    h = t1 - t0
    memory = ints[layout.LAST]
    ties = floats[channels.STAGE] == channels.BETWEEN
    impact = torn = 1.0
    count = 0
    for k in range(ints[layout.BODIES]):
        if found[k] == 0.0:
            continue
        if ties:
            torn = min(torn, torn_off(k, floats, ints))
        if count > FEW:
            continue
        reach = floats[ints[layout.RADIUS] + k] + floats[ints[layout.THICKNESS]]
        set_out(k, h, y0, y1, path, mean, ints)
        s, j = earliest(k, reach, path, floats, ints)
        if s != NEVER and hits(s, floats[memory + layout.WHOLE], j, path, mean, floats, ints):
            impact = min(impact, s)
            count += 1
            if count > FEW and not ties:
                return
    first = min(torn, impact) if count <= FEW else torn
    end = first * h + AFTER_IMPACT * floats[memory + layout.WHOLE]
    if first < 1.0 and end < h * (1.0 - AFTER_IMPACT) and t0 + end < floats[channels.STEP_END]:
        floats[channels.STEP_END] = t0 + end
        floats[memory + layout.CUTS] += 1.0


@lean(ANSWER, inner=True)
def back_off_found(t0, t1, y0, y1, found, path, mean, floats, ints):
    """Resolve impacts and rest of the bodies with found[k] = 1 in y1, and list those that rest."""
    h = t1 - t0
    resting = 0
    ties = floats[channels.STAGE] == channels.BETWEEN
    flat = is_flat(ints) and not ties
    level, nx, ny, nz = surface(floats, ints, layout.HEAD, 0.0, 0.0, 0.0)
    for k in range(ints[layout.BODIES]):
        if found[k] == 0.0:
            continue
        if flat and lies(k, level, nx, ny, nz, y1, floats, ints):
            floats[ints[layout.LAST] + layout.LIST + resting] = k
            resting += 1
            continue
        reach = floats[ints[layout.RADIUS] + k] + floats[ints[layout.THICKNESS]]
        if ties:
            let_go(k, floats, ints)
        keep_all(t1, k, h, y0, y1, path, mean, floats, ints)
        pair = ints[layout.PAIRS] + layout.PAIR * k
        if ints[layout.OBJECTS] == 1 and floats[pair] != layout.FREE and floats[pair + layout.PRESS] < 0.0:
            # It rests on the only object.
            floats[ints[layout.LAST] + layout.LIST + resting] = k
            resting += 1
            continue
        at, to = ints[layout.POSITION] + 3 * k, ints[layout.VELOCITY] + 3 * k
        lost = fly(k, t1, max(h, floats[ints[layout.LAST] + layout.WHOLE]), reach, path, mean, floats, ints)
        lost += push_out(reach, path, mean, floats, ints)
        y1[ints[layout.WORK]] += floats[ints[layout.MASS] + k] * lost
        for c in range(3):
            y1[at + c], y1[to + c] = path[6 + c], path[9 + c]
        rests = False
        for j in range(ints[layout.OBJECTS]):
            rests = rests or floats[ints[layout.PAIRS] + layout.PAIR * (k * ints[layout.OBJECTS] + j)] != layout.FREE
        if rests:
            floats[ints[layout.LAST] + layout.LIST + resting] = k
            resting += 1
    floats[ints[layout.LAST] + layout.RESTING] = resting
    if resting > 0:
        floats[channels.HOLDS] = 1.0
