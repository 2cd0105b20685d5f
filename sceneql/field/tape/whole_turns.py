"""Angles (operation ATAN2) whose branch cut, the jump from pi to -pi, causes no jump of the field.

The third operand of their rows is 1, that of other angles 0.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from sceneql.field.tape import tape_ops as ops

NEVER_BELOW = (ops.SQRT, ops.SQUARE, ops.ABS, ops.EXP)
"""Operations without negative values."""


def up_to_whole_turns(
    rows: Sequence[tuple[int, int, int, int]], constants: Mapping[int, float], values: Iterable[int]
) -> set[int]:
    """The rows of ATAN2 whose branch cut causes no jump of the rows ``values``.

    Either the angle affects ``values`` only through sines and cosines, with sums, negations and products with integers
    in between (``constants``: number by row), so that a whole turn changes nothing. Or its first argument is never
    negative, so that the angle ends at the cut instead of crossing it.
    """
    free = set(range(len(rows))) - set(values)
    for k in range(len(rows) - 1, -1, -1):
        op, left, right, third = rows[k]
        if op in ops.OF_PARTS:
            free -= {third, third + 1, third + 2}
        elif op not in (ops.CONSTANT, ops.X, ops.Y, ops.Z, ops.SIN, ops.COS):
            kept: set[int] = set()
            if k in free and op in (ops.NEG, ops.COPY, ops.ADD, ops.SUB):
                kept = {left, right}
            elif k in free and op == ops.MUL:
                kept = {a for a, b in ((left, right), (right, left)) if constants.get(b, 0.5).is_integer()}
            free -= {left, right} - kept
    angles = {k: left for k, (op, left, _, _) in enumerate(rows) if op == ops.ATAN2}
    return {k for k, left in angles.items() if k in free or rows[left][0] in NEVER_BELOW}
