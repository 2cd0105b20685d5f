# mypy: ignore-errors
"""Slopes of local contacts: within a stage of Newton's method (stage_contacts_kernels) or of resting_ties_kernels."""

import math

import sceneql.system.channels as channels
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts import layout
from sceneql.contacts.impact_kernels import STILL
from sceneql.contacts.pair_kernels import body_of, firmness, tightness
from sceneql.contacts.shape_kernels import surface, velocity
from sceneql.system.signatures_kernels import TERM


@lean_inlined
def add_square(entries, at, factor, x, y, z):
    """Add factor times v v to the block, v = (x, y, z)."""
    entries[at] += factor * x * x
    entries[at + 1] += factor * x * y
    entries[at + 2] += factor * x * z
    entries[at + 3] += factor * y * x
    entries[at + 4] += factor * y * y
    entries[at + 5] += factor * y * z
    entries[at + 6] += factor * z * x
    entries[at + 7] += factor * z * y
    entries[at + 8] += factor * z * z


@lean_inlined
def add_around(entries, at, across, along, nx, ny, nz, dx, dy, dz):
    """Add ties along the normal n and across both n and d to the block."""
    add_square(entries, at, across - along, nx, ny, nz)
    add_square(entries, at, across, dx, dy, dz)
    for c in range(0, 9, 4):
        entries[at + c] -= across


@lean_inlined
def grip(memory, k, j, nx, ny, nz, y, floats, ints):
    """d friction/d slip [1/s] across the slip, and the slip's direction, of a pair that rests between steps."""
    if floats[ints[layout.FRICTION]] > 0.0 and floats[memory] == layout.STICKS:
        return tightness(floats, ints), 0.0, 0.0, 0.0
    if floats[ints[layout.FRICTION]] > 0.0 and floats[memory] == layout.SLIDES:
        px, py, pz, vx, vy, vz = body_of(ints, k, y)
        ux, uy, uz = velocity(floats, ints, layout.HEAD + layout.OBJECT * j, px, py, pz)
        vx, vy, vz = vx - ux, vy - uy, vz - uz
        vn = vx * nx + vy * ny + vz * nz
        vx, vy, vz = vx - vn * nx, vy - vn * ny, vz - vn * nz
        slip = math.sqrt(vx * vx + vy * vy + vz * vz)
        if slip > STILL:
            return floats[ints[layout.FRICTION]] * floats[memory + layout.LOAD] / slip, vx / slip, vy / slip, vz / slip
    return 0.0, 0.0, 0.0, 0.0


@lean(TERM, inner=True)
def holds(t, y, entries, floats, ints):
    """Add ties to the block of body k by its own velocity at entries[9 k:], with the rates that `hold` has stored."""
    between = floats[channels.STAGE] == channels.BETWEEN
    if floats[channels.STAGE] <= 0.0 and not between:
        return
    firm = tightness(floats, ints) if between else firmness(floats[channels.STAGE], floats, ints)
    for i in range(int(floats[ints[layout.LAST] + layout.RESTING])):
        k = int(floats[ints[layout.LAST] + layout.LIST + i])
        if floats[ints[layout.INVERSE] + k] == 0.0:
            continue
        at, mass = ints[layout.POSITION] + 3 * k, floats[ints[layout.MASS] + k]
        for j in range(ints[layout.OBJECTS]):
            memory = ints[layout.PAIRS] + layout.PAIR * (k * ints[layout.OBJECTS] + j)
            if floats[memory + layout.TIED] == 0.0 if not between else floats[memory] == layout.FREE:
                continue
            _, nx, ny, nz = surface(floats, ints, layout.HEAD + layout.OBJECT * j, y[at], y[at + 1], y[at + 2])
            if between:
                across, dx, dy, dz = grip(memory, k, j, nx, ny, nz, y, floats, ints)
            else:
                # Across the slip, or both ways where the mass sticks.
                across = floats[memory + layout.PULL]
                slide = memory + layout.ALONG
                dx, dy, dz = floats[slide], floats[slide + 1], floats[slide + 2]
            add_around(entries, 9 * k, mass * across, mass * firm, nx, ny, nz, dx, dy, dz)
