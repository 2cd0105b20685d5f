"""Tapes evaluated by numpy, where nothing is to be compiled: by checks, of few places."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.field.tape import tape_ops as ops

if TYPE_CHECKING:
    from sceneql.frame import Floats, Tape

NAMES = {code: name for name, code in (*ops.UNARY.items(), *ops.BINARY.items())}


def values(tape: Tape, places: Floats) -> Floats:
    """The field (n,) at places (3, n). Raises TypeError for the density of a skeleton."""
    import numpy as np

    from sceneql.quantities.arrays import numpy_arithmetic

    o, known = numpy_arithmetic(), list[Any]()
    own = {"square": np.square}
    with np.errstate(all="ignore"):
        for op, left, right, _ in tape.code.tolist():
            match op:
                case ops.CONSTANT:
                    value = tape.constants[left]
                case ops.X | ops.Y | ops.Z:
                    value = places[op - ops.X]
                case ops.COPY:
                    value = known[left]
                case _ if op in NAMES:
                    name = NAMES[op]
                    function = own.get(name) or getattr(o, name)
                    value = function(*(known[k] for k in ((left, right) if name in ops.BINARY else (left,))))
                case _:
                    raise TypeError("a density is computed by compiled code alone")
            known.append(value)
    return np.broadcast_to(np.asarray(known[-1], dtype=np.float64), places.shape[1:])
