# mypy: ignore-errors
"""One step of semi-implicit Euler: velocities first, then positions by the new velocities."""

from sceneql.compiled.kernels import lean
from sceneql.island import layout
from sceneql.system.signatures_kernels import STEP


@lean(STEP, inner=True)
def step(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints):
    """Explicit Euler on every entry, then positions of pairs advance by their velocities at the end."""
    for k in range(y0.size):
        y1[k] = y0[k] + h * rate0[k]
    for pair in range(ints[layout.TRIPLES]):
        at = ints[layout.TRIPLES_AT] + layout.TRIPLE * pair
        position, velocity, count = ints[at + layout.POSITION], ints[at + layout.VELOCITY], ints[at + layout.COUNT]
        place = y1[position : position + count]
        acceleration = rate0[velocity : velocity + count]
        for k in range(place.size):
            place[k] += h * (h * acceleration[k])
    return 0.0
