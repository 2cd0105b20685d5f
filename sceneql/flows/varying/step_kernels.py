# mypy: ignore-errors
"""A step of a flow of several fluids: skins move, mass takes momentum along, viscosity is implicit; projections.

Order 1: skins move with the flow, forces act where they are then, and viscosity by implicit Euler (Chorin 1968). Order
2: a step of half the length so far gives velocities and forces in the middle, by which the whole one goes (midpoint;
Peskin 2002, Acta Numerica 11, 479-517), viscosity by the trapezoid and the second backward formula (TR-BDF2; Bank et
al. 1985, IEEE Trans. Electron Devices 32, 1992-2007), the pressure by increments. What skins and velocities do to each
other is Verlet's method then: it swings without growing up to two over the angular velocity.

``settings``: start and end of the latest step, 1 where there is one, the tolerance (0: none), then the size that each
block of the state has had. ``numbers``: [order, number of blocks, where the integers of fluid_layout.py begin], then
[offset in y, count] of each block, whose errors are measured together.
"""

import math

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.pointers_kernels import AT_RATE, AT_SETTLE, rate_at, settle_at
from sceneql.flows.layout import AT, CELLS, FACES, INVERSES, PRESSURE, SKIP, VELOCITY
from sceneql.flows.projection_kernels import less_gradient, project
from sceneql.flows.varying import fluid_layout as own
from sceneql.flows.varying.carried_kernels import bring, hand_over, rub
from sceneql.flows.varying.stress_kernels import WITH_WALLS, spacing, stress
from sceneql.system.signatures_kernels import STEP

ORDER, BLOCKS, VARYING_AT, HEAD = range(4)
START, END, KNOWN, TOLERANCE, SIZES = range(5)
STILL = 1e-6
"""A velocity that crosses such a part of a cell in a step is as good as none: rounding moves what is at rest."""
MOST = 0.98
"""Largest part of its mass that a cell may lose in a step."""
LOST = 0.75
"""The same where a tolerance chooses steps."""
SWING = 1.0
"""Longest step, times the angular velocity of the fastest waves of skins, where a tolerance chooses steps."""


@lean_inlined
def along(y0, rate, h, y1, at, faces):
    """All entries but velocities of the flow, after h."""
    for k in range(y0.size):
        if k < at or k >= at + faces:
            y1[k] = y0[k] + h * rate[k]


@lean_inlined
def given(u, u0, rate, h, inverses):
    """Velocities that are given."""
    for f in range(u.size):
        if inverses[f] == 0.0:
            u[f] = u0[f] + h * rate[f]


@lean_inlined
def failed(y1, one, mode, floats):
    """What a step without an end says."""
    floats[one[SKIP]], floats[mode] = 0.0, own.WHOLE
    y1[one[AT]] = math.nan
    return math.inf


@lean_inlined
def emptied(lost, y0, y1, settings, one, mode, floats):
    """What a step says in which a cell would lose more than all of its mass: by how much it is too long."""
    if settings[TOLERANCE] == 0.0 or not lost < math.inf:
        return failed(y1, one, mode, floats)
    floats[one[SKIP]], floats[mode] = 0.0, own.WHOLE
    for k in range(y0.size):
        y1[k] = y0[k]
    return (lost / LOST) ** 3


@lean(STEP, inner=True)
def step(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints):
    """y1 after a step of length h; what it errs by in parts of the tolerance."""
    n = y0.size
    var = numbers[numbers[VARYING_AT] :]
    one = var[var[own.FLOW] :]
    at, faces = one[AT], one[FACES]
    cells = one[CELLS] * one[CELLS + 1] * one[CELLS + 2]
    rate1, rate_a, rate_b, half = work[:n], work[n : 2 * n], work[2 * n : 3 * n], work[3 * n : 4 * n]
    room = work[4 * n :]
    first, second, newtons = room[:faces], room[faces : 2 * faces], room[2 * faces : 3 * faces]
    masses = room[3 * faces :]
    had, wanted = masses[2 * faces : 3 * faces], masses[3 * faces : 4 * faces]
    r, z, p = masses[4 * faces : 5 * faces], masses[5 * faces : 6 * faces], masses[6 * faces : 7 * faces]
    q, entries = masses[7 * faces : 8 * faces], masses[8 * faces : 9 * faces]
    pressure = masses[9 * faces : 9 * faces + 2 * cells]
    before = masses[:faces]
    found = floats[one[PRESSURE] : one[PRESSURE] + cells]
    inverses = floats[one[INVERSES] : one[INVERSES] + faces]
    now = floats[var[own.MASSES] : var[own.MASSES] + faces]
    rate, settle = rate_at(functions[AT_RATE]), settle_at(functions[AT_SETTLE])
    u0, u = y0[at : at + faces], y1[at : at + faces]
    mode = var[own.MODE]
    order = numbers[ORDER]
    if settings[KNOWN] == 1.0 and t == settings[END]:
        for c in range(cells):
            pressure[c] = pressure[cells + c]
        for f in range(faces):
            before[f] = masses[faces + f]
    elif settings[KNOWN] == 0.0 or t != settings[START]:  # after a change from outside, or at the start
        rate(t, y0, rate_a, floats, ints)
        for c in range(cells):
            pressure[c] = found[c]
        for f in range(faces):
            before[f] = now[f]
    settings[START], settings[END], settings[KNOWN] = t, t + h, 1.0
    floats[one[SKIP]], floats[mode] = 1.0, own.MOTION
    rate(t, y0, rate_a, floats, ints)
    part = h if order == 1 else 0.5 * h
    lost = bring(u0, before, u, part, had, floats, var)
    if not lost < MOST:
        return emptied(lost, y0, y1, settings, one, mode, floats)
    if order == 2:
        stress(u0, first, WITH_WALLS, floats, var)
    along(y0, rate_a, part, y1, at, faces)
    if order == 1:  # skins keep their volume now, so that the masses are those of the end
        settle(t, t + h, y0, rate0, y1, floats, ints)
    for f in range(faces):
        half[at + f], u[f] = u[f], u0[f]
    floats[mode] = own.FORCES
    rate(t + part, y1, rate_b, floats, ints)
    for f in range(faces):
        u[f] = half[at + f]
        newtons[f] = now[f] * rate_b[at + f]
    hand_over(u, had, z, floats, var)
    for f in range(faces):
        u[f] += part * rate_b[at + f]
    given(u, u0, rate_b[at : at + faces], part, inverses)
    if order == 2:
        less_gradient(y1, pressure, part, floats, one)
    for f in range(faces):
        wanted[f] = now[f] * u[f]
        if order == 2:
            wanted[f] += 0.25 * h * first[f]
    solved = rub(part if order == 1 else 0.25 * h, wanted, u, r, z, p, q, entries, floats, var)
    if not (solved and project(y1, VELOCITY, floats, one)):
        return failed(y1, one, mode, floats)
    if order == 2:
        latest = pressure[cells : 2 * cells]
        for c in range(cells):
            latest[c] = pressure[c] + found[c] / part
        for k in range(n):
            half[k] = y1[k]
        stress(u, second, WITH_WALLS, floats, var)
        floats[mode] = own.MOTION
        rate(t + part, half, rate_b, floats, ints)
        lost = bring(u0, before, u, h, had, floats, var)
        if not lost < MOST:
            return emptied(lost, y0, y1, settings, one, mode, floats)
        along(y0, rate_b, h, y1, at, faces)
        settle(t, t + h, y0, rate0, y1, floats, ints)
        for f in range(faces):
            wanted[f], u[f] = u[f], half[at + f]
        rate(t + h, y1, rate1, floats, ints)
        for f in range(faces):
            u[f] = wanted[f]
        hand_over(u, had, z, floats, var)
        for f in range(faces):
            u[f] += h * newtons[f] / now[f]
        given(u, u0, rate_b[at : at + faces], h, inverses)
        less_gradient(y1, latest, h, floats, one)
        for f in range(faces):
            wanted[f] = now[f] * u[f] + h / 3.0 * (first[f] + second[f])
        solved = rub(h / 3.0, wanted, u, r, z, p, q, entries, floats, var)
        if not (solved and project(y1, VELOCITY, floats, one)):
            return failed(y1, one, mode, floats)
        for c in range(cells):
            latest[c] += found[c] / h
    for f in range(faces):
        masses[faces + f] = now[f]
    floats[mode] = own.MOTION
    rate(t + h, y1, rate1, floats, ints)
    for f in range(faces):
        k = at + f
        rate1[k] = (u[f] - u0[f]) / h if order == 1 else (3.0 * u[f] - 4.0 * half[k] + u0[f]) / h
    floats[one[SKIP]], floats[mode] = 0.0, own.WHOLE
    if settings[TOLERANCE] == 0.0:
        return 0.0
    worst = max(h * floats[var[own.FASTEST]] / SWING, lost / LOST) ** 3
    for block in range(numbers[BLOCKS]):
        place, count = numbers[HEAD + 2 * block], numbers[HEAD + 2 * block + 1]
        total = 0.0
        size = max(settings[SIZES + block], STILL * spacing(0, floats, var) / h if place == at else 0.0)
        for k in range(place, place + count):
            straight = 2.0 * half[k] - y0[k] if at <= k < at + faces else y0[k] + h * rate_a[k]
            total += (y1[k] - straight) ** 2
            size = max(size, abs(y0[k]), abs(y1[k]))
        if not math.isfinite(total):
            return math.inf
        if size > 0.0 and count > 0:  # what order 1 errs by is d; in a swing order 2 errs by (2 d)^(3/2)/6
            worst = max(worst, (2.0 * math.sqrt(total / count) / size) ** 1.5 / (6.0 * settings[TOLERANCE]))
    if worst <= 1.0:
        for block in range(numbers[BLOCKS]):
            place, count = numbers[HEAD + 2 * block], numbers[HEAD + 2 * block + 1]
            for k in range(place, place + count):
                settings[SIZES + block] = max(settings[SIZES + block], abs(y1[k]))
    return worst
