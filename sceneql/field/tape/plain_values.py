"""Values of a tape's field by numpy alone, for callers that must not wait for numba, as the command `check`.

Imports numpy. The last bits may differ from those of the kernels, and from machine to machine.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.field.tape import tape_ops as ops

if TYPE_CHECKING:
    from sceneql.frame import Floats, Tape

BINARY: dict[int, Callable[..., Any]] = {
    ops.ADD: np.add,
    ops.SUB: np.subtract,
    ops.MUL: np.multiply,
    ops.DIV: np.divide,
    ops.MIN: np.minimum,
    ops.MAX: np.maximum,
    ops.POW: np.power,
    ops.ATAN2: np.arctan2,
}
UNARY: dict[int, Callable[..., Any]] = {
    ops.COPY: np.positive,
    ops.NEG: np.negative,
    ops.ABS: np.abs,
    ops.SQUARE: np.square,
    ops.SQRT: np.sqrt,
    ops.SIN: np.sin,
    ops.COS: np.cos,
    ops.EXP: np.exp,
    ops.LOG: np.log,
    ops.FLOOR: np.floor,
    ops.SIGN: np.sign,
}


def plain_values(tape: Tape, points: Floats) -> Floats | None:
    """Values (n,) of f at points (n, 3) [m], NaN where undefined; None for a tape with parts, which need kernels."""
    if len(tape.parts):
        return None
    registers: list[Floats] = []
    with np.errstate(all="ignore"):
        for op, left, right, _ in tape.code.tolist():
            if op == ops.CONSTANT:
                registers.append(np.full(len(points), tape.constants[left]))
            elif op in (ops.X, ops.Y, ops.Z):
                registers.append(points[:, op - ops.X])
            elif op in UNARY:
                registers.append(UNARY[op](registers[left]))
            else:
                registers.append(BINARY[op](registers[left], registers[right]))
    return registers[-1]
