# mypy: ignore-errors
"""Ties of bodies that rest, between whose steps contacts act: for solvers that ask for slopes.

What rests at the start of a step is tied to the surface up to its end, also where the tie pulls: Newton's method finds
no way across the edge between the two. The end of the step lets go (respond_kernels). The tie takes from the
acceleration all that leads off the surface, and the normal velocity at a rate far above that of springs: this is zero
at the solution, but slopes that have it say that the mass is held, and lose no symmetry
(stage_contacts_slopes_kernels).
"""

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts import layout
from sceneql.contacts.pair_kernels import OF_BODY, OF_PAIR, body_of, tightness
from sceneql.contacts.pressing_kernels import pressing
from sceneql.contacts.shape_kernels import surface, velocity

SWEEPS = 50
"""Over the objects that a body rests on at once."""
CLOSE = 1e-12
"""Change of a sweep that ends them, in parts of what accelerates the body."""


@lean_inlined
def restrain(k, memory, nx, ny, nz, y, rate, floats, ints):
    """Note what the pair bears, and take its normal velocity away."""
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
    """Tie body k to the only thing that it rests on, whose pressing is known."""
    to = ints[layout.VELOCITY] + 3 * k
    press = floats[memory + layout.PRESS]
    floats[memory + layout.LOAD] = -press
    rate[to] -= press * nx
    rate[to + 1] -= press * ny
    rate[to + 2] -= press * nz
    restrain(k, memory, nx, ny, nz, y, rate, floats, ints)


@lean(OF_BODY, inner=True)
def tie(k, y, rate, floats, ints):
    """Tie body k to all that it rests on."""
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
