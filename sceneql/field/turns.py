"""Which angles of a tape matter only up to whole turns: those whose cut, from pi to -pi, is no jump of the field.

The third operand of their rows is 1, else 0.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from sceneql.field import tape_ops as ops


def up_to_whole_turns(
    rows: Sequence[tuple[int, int, int, int]], constants: Mapping[int, float], values: Iterable[int]
) -> set[int]:
    """The rows of ATAN2 to which a whole turn may be added without changing the rows ``values``.

    They go into sines and cosines alone, added to others, negated or multiplied by whole numbers on their way;
    ``constants`` are the numbers of rows that are some.
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
    return {k for k in free if rows[k][0] == ops.ATAN2}
