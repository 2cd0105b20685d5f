# mypy: ignore-errors
"""Copies the rows of a tape that are needed, some of them replaced by rows known to have the same value."""

from sceneql.compiled.kernels import inlined
from sceneql.field.tape import tape_ops as ops

ALIAS, LIVE, PLACE = 4, 5, 6
"""Columns of scratch: the row that replaces a row, whether a row is needed, its place in the short tape."""


@inlined
def mark(code, last, scratch):
    """Mark the rows that ``last`` depends on."""
    for k in range(last + 1):
        scratch[k, LIVE] = 0.0
    scratch[int(scratch[last, ALIAS]), LIVE] = 1.0
    for k in range(last, -1, -1):
        if scratch[k, LIVE] == 0.0:
            continue
        op = code[k, 0]
        if op == ops.DENSITY or op == ops.SKELETON:
            for j in range(3):
                scratch[code[k, 3] + j, LIVE] = 1.0
        elif not (op == ops.CONSTANT or op == ops.X or op == ops.Y or op == ops.Z):
            scratch[int(scratch[code[k, 1], ALIAS]), LIVE] = 1.0
            scratch[int(scratch[code[k, 2], ALIAS]), LIVE] = 1.0


@inlined
def write_row(code, k, scratch, short, row):
    """Write row k to row ``row`` of ``short``, operands renumbered; parts and the flags of angles stay."""
    op = code[k, 0]
    scratch[k, PLACE] = row
    short[row, 0] = op
    short[row, 1] = code[k, 1]
    short[row, 2] = code[k, 2]
    short[row, 3] = code[k, 3] if op == ops.ATAN2 else 0
    if op == ops.DENSITY or op == ops.SKELETON:
        short[row, 3] = int(scratch[code[k, 3], PLACE])
    elif not (op == ops.CONSTANT or op == ops.X or op == ops.Y or op == ops.Z):
        short[row, 1] = int(scratch[int(scratch[code[k, 1], ALIAS]), PLACE])
        short[row, 2] = int(scratch[int(scratch[code[k, 2], ALIAS]), PLACE])
        if (op == ops.SIN or op == ops.COS) and code[k, 3] and scratch[code[k, 3], LIVE] != 0.0:
            short[row, 3] = int(scratch[code[k, 3], PLACE])
