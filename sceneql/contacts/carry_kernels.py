# mypy: ignore-errors
"""Normal forces on a body that rests on several objects at once, compiled at the first such body."""

from sceneql.compiled.kernels import lean
from sceneql.contacts import layout
from sceneql.contacts.pair_kernels import OF_BODY
from sceneql.contacts.pressing_kernels import pressing

SWEEPS = 50


@lean(OF_BODY, inner=True)
def carry(k, y, rate, floats, ints):
    """Nonnegative normal forces that leave no acceleration into a surface: projected Gauss-Seidel over the pairs."""
    to = ints[layout.VELOCITY] + 3 * k
    for _ in range(SWEEPS):
        change = 0.0
        for j in range(ints[layout.OBJECTS]):
            memory = ints[layout.PAIRS] + layout.PAIR * (k * ints[layout.OBJECTS] + j)
            if floats[memory] == layout.FREE:
                continue
            press, nx, ny, nz = pressing(k, j, y, rate, floats, ints)
            load = max(0.0, floats[memory + layout.LOAD] - press)
            add = load - floats[memory + layout.LOAD]
            floats[memory + layout.LOAD] = load
            rate[to] += add * nx
            rate[to + 1] += add * ny
            rate[to + 2] += add * nz
            change = max(change, abs(add))
        if change < 1e-12:
            break
