# mypy: ignore-errors
"""One step of semi-implicit Euler: velocities and momenta first, then positions by the new ones."""

from sceneql.compiled.kernels import lean
from sceneql.compiled.pointers_kernels import AT_FREE_MOTION, free_motion_at
from sceneql.island import layout
from sceneql.system.signatures_kernels import STEP


@lean(STEP, inner=True)
def step(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints):
    """Explicit Euler on every entry, then positions of pairs advance by their velocities at the end.

    What has a free motion advances by it, from where it was and with the momenta at the end.
    """
    for k in range(y0.size):
        y1[k] = y0[k] + h * rate0[k]
    for pair in range(ints[layout.TRIPLES]):
        at = ints[layout.TRIPLES_AT] + layout.TRIPLE * pair
        position, velocity, count = ints[at + layout.POSITION], ints[at + layout.VELOCITY], ints[at + layout.COUNT]
        place = y1[position : position + count]
        acceleration = rate0[velocity : velocity + count]
        for k in range(place.size):
            place[k] += h * (h * acceleration[k])
    for free in range(ints[layout.FREES]):
        at = ints[layout.FREES_AT] + 2 * free
        for k in range(ints[at], ints[at] + ints[at + 1]):
            y1[k] = y0[k]
    free_motion_at(functions[AT_FREE_MOTION])(h, y1, floats, ints)
    return 0.0
