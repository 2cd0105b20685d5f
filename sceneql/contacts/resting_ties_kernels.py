# mypy: ignore-errors
"""Ties of resting bodies, for solvers that need slopes where contacts act between steps.

A body that rests at the start of a step is tied to the surface up to its end, even where the tie pulls: Newton's method
does not converge across the discontinuity. The end of the step releases it (respond_kernels). The tie removes the
normal acceleration, and damps the normal velocity at a rate far above that of springs: this term is zero at the
solution, but its slopes show the constraint to the linear systems and keep them symmetric
(stage_contacts_slopes_kernels).
"""

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts import layout
from sceneql.contacts.pair_kernels import OF_BODY, OF_PAIR, body_of, tightness
from sceneql.contacts.pressing_kernels import pressing
from sceneql.contacts.shape_kernels import surface, velocity

SWEEPS = 50
"""Most Gauss-Seidel sweeps over the objects that a body rests on at once."""
CLOSE = 1e-12
"""Change in a sweep, relative to the body's acceleration, that ends the sweeps."""


@lean_inlined
def restrain(k, memory, nx, ny, nz, y, rate, floats, ints):
    """Store the pair's load and damp its normal velocity."""
    floats[memory + layout.PRESS] = -floats[memory + layout.LOAD]
    floats[memory + layout.LOAD] = max(0.0, floats[memory + layout.LOAD])
    to = ints[layout.VELOCITY] + 3 * k
    px, py, pz, vx, vy, vz = body_of(ints, k, y)
    j = (memory - ints[layout.PAIRS]) // layout.PAIR - k * ints[layout.OBJECTS]
    ux, uy, uz = velocity(floats, ints, layout.HEAD + layout.OBJECT * j, px, py, pz)
    speed = tightness(floats, ints) * ((vx - ux) * nx + (vy - uy) * ny + (vz - uz) * nz)
    rate[to] -= speed * nx
    rate[to + 1] -= speed * ny
    rate[to + 2] -= speed * nz


@lean(OF_PAIR, inner=True)
def tie_one(k, memory, nx, ny, nz, y, rate, floats, ints):
    """Tie body k to the only object that it rests on, given the acceleration into it."""
    to = ints[layout.VELOCITY] + 3 * k
    press = floats[memory + layout.PRESS]
    floats[memory + layout.LOAD] = -press
    rate[to] -= press * nx
    rate[to + 1] -= press * ny
    rate[to + 2] -= press * nz
    restrain(k, memory, nx, ny, nz, y, rate, floats, ints)


@lean(OF_BODY, inner=True)
def tie(k, y, rate, floats, ints):
    """Tie body k to all objects that it rests on."""
    to = ints[layout.VELOCITY] + 3 * k
    objects = ints[layout.OBJECTS]
    size = abs(rate[to]) + abs(rate[to + 1]) + abs(rate[to + 2])
    for _ in range(SWEEPS):
        change = 0.0
        for j in range(objects):
            memory = ints[layout.PAIRS] + layout.PAIR * (k * objects + j)
            if floats[memory] == layout.FREE:
                continue
            press, nx, ny, nz = pressing(k, j, y, rate, floats, ints)
            floats[memory + layout.LOAD] -= press
            rate[to] -= press * nx
            rate[to + 1] -= press * ny
            rate[to + 2] -= press * nz
            change = max(change, abs(press))
        if change <= CLOSE * size:
            break
    px, py, pz, _, _, _ = body_of(ints, k, y)
    for j in range(objects):
        memory = ints[layout.PAIRS] + layout.PAIR * (k * objects + j)
        if floats[memory] != layout.FREE:
            _, nx, ny, nz = surface(floats, ints, layout.HEAD + layout.OBJECT * j, px, py, pz)
            restrain(k, memory, nx, ny, nz, y, rate, floats, ints)
