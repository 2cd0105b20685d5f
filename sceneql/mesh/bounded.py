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

    rows, value, known = len(tape.code), len(tape.code) - 1, len(tape.constants)
    code: list[tuple[int, int, int, int]] = []
    for axis in range(3):
        place = rows + len(code)
        code.append((ops.X + axis, 0, 0, 0))
        for number, above in ((known + 2 * axis, False), (known + 2 * axis + 1, True)):
            bound = rows + len(code)
            code.append((ops.CONSTANT, number, 0, 0))
            code.append((ops.SUB, place, bound, 0) if above else (ops.SUB, bound, place, 0))
            code.append((ops.MAX, value, bound + 1, 0))
            value = bound + 2
    bounds = np.array([low, high], dtype=np.float64).T.ravel()
    return Tape(
        np.concatenate([tape.code, np.array(code, dtype=np.int32)]),
        np.concatenate([tape.constants, bounds]),
        tape.parts,
    )
