"""A tape cut at a box."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.field.tape import tape_ops as ops

if TYPE_CHECKING:
    from sceneql.frame import Tape

Corner = tuple[float, float, float]


def bounded(tape: Tape, low: Corner, high: Corner) -> Tape:
    """The tape of max(f, distance to the box low..high in the maximum norm) [m]: the solid capped at the box."""
    import numpy as np

    from sceneql.frame import Tape

    code = [tuple(int(number) for number in row) for row in tape.code]
    constants = [float(number) for number in tape.constants]
    value = len(code) - 1
    for axis in range(3):
        code.append((ops.X + axis, 0, 0, 0))
        place = len(code) - 1
        for corner, above in ((low, False), (high, True)):
            code.append((ops.CONSTANT, len(constants), 0, 0))
            constants.append(float(corner[axis]))
            bound = len(code) - 1
            code.append((ops.SUB, place, bound, 0) if above else (ops.SUB, bound, place, 0))
            code.append((ops.MAX, value, len(code) - 1, 0))
            value = len(code) - 1
    return Tape(np.array(code, dtype=np.int32), np.array(constants, dtype=np.float64), tape.parts)
