# mypy: ignore-errors
"""Affine enclosures of single operations, for tests to call."""

from sceneql.compiled.kernels import kernel
from sceneql.field.enclose.enclosure_kernels import binary, unary
from sceneql.field.enclose.forms_kernels import TINY, WIDER, product
from sceneql.field.tape.tape_ops import ATAN2, MUL


@kernel("UniTuple(float64, 3)(int64, float64[::1], float64[::1])")
def enclosed(op, a, b):
    """(c0, c1, e) of an operation on the forms a and b (3,), widened as ``segment`` does.

    One of one argument takes the first.
    """
    if op == MUL:
        c0, c1, e = product(a[0], a[1], a[2], b[0], b[1], b[2])
    elif op <= ATAN2:
        c0, c1, e = binary(op, a[0], a[1], a[2], b[0], b[1], b[2])
    else:
        c0, c1, e = unary(op, a[0], a[1], a[2])
    return c0, c1, (e + TINY) * WIDER
