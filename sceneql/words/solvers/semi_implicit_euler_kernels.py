# mypy: ignore-errors
"""One step of semi-implicit Euler: velocities first, then positions by the new velocities."""

from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import STEP


@lean(STEP, inner=True)
def step(functions, t, h, y0, rate0, y1, work, settings, numbers, floats, ints):
    """Explicit Euler on every entry, then the positions of the island's pairs advance by their velocities at the end.

    The pairs stand at the head of ``ints``: ints[1] triples (position, velocity, count) from ints[0] on.
    """
    for k in range(y0.size):
        y1[k] = y0[k] + h * rate0[k]
    for pair in range(ints[1]):
        at = ints[0] + 3 * pair
        place = y1[ints[at] : ints[at] + ints[at + 2]]
        acceleration = rate0[ints[at + 1] : ints[at + 1] + ints[at + 2]]
        for k in range(place.size):
            place[k] += h * (h * acceleration[k])
    return 0.0
