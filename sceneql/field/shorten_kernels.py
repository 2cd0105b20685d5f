# mypy: ignore-errors
"""What of a tape matters along a bundle of rays: branches that cannot win in any slab and parts out of reach are left
out."""

import numpy as np

from sceneql.field.affine_kernels import GROW, PAD
from sceneql.field.packet_density_kernels import keep_near
from sceneql.field.packet_kernels import C1, LANES, E
from sceneql.field.short_rows_kernels import ALIAS, LIVE, mark, write_row
from sceneql.field.tape_ops import DENSITY, MAX, MIN, WHOLE
from sceneql.kernels import inlined


@inlined
def exceeds(a, b, first, stop):
    """Whether what a register encloses is more than what another does, in lanes first..stop-1."""
    doubted = np.int32(0)
    for i in range(first, stop):
        size = abs(a[i]) + abs(b[i]) + abs(a[C1 + i]) + abs(b[C1 + i])
        reach = (abs(a[C1 + i] - b[C1 + i]) + a[E + i] + b[E + i]) * GROW + PAD * size
        doubted += np.int32(0) if a[i] - b[i] > reach else np.int32(1)
    return doubted == 0


@inlined
def winner(code, k, registers, scratch, first, stop):
    """The row whose value row k has in lanes first..stop-1: that of a branch which must win, else k itself."""
    op = code[k, 0]
    if op == MIN or op == MAX:
        left, right = code[k, 1], code[k, 2]
        if exceeds(registers[left], registers[right], first, stop):
            return int(scratch[left if op == MAX else right, ALIAS])
        if exceeds(registers[right], registers[left], first, stop):
            return int(scratch[right if op == MAX else left, ALIAS])
    return k


@inlined
def whole_in(status, first, stop):
    """Whether a tape is defined all over lanes first..stop-1."""
    torn = np.int32(0)
    for i in range(first, stop):
        torn += np.int32(0) if status[i] == np.float32(WHOLE) else np.int32(1)
    return torn == 0


@inlined
def shorten(code, registers, status, first, final, singles, parts, scratch, short, near_singles, near_parts):
    """Write what matters in slabs first..final into ``short``, behind as many rows as ``code`` has; how many rows.

    Before those, the whole tape with the parts alone that are near. ``registers`` and ``status`` are those of all slabs
    in lanes; a branch must win in their neighbors, too, so that it does wherever a ray is looked at.
    """
    length = code.shape[0]
    low, stop = max(first - 1, 0), min(final + 2, LANES)
    whole = whole_in(status, low, stop)
    for k in range(length):
        scratch[k, ALIAS] = winner(code, k, registers, scratch, low, stop) if whole else k
    mark(code, length - 1, scratch)
    rows, kept = length, 0
    for k in range(length):
        for j in range(4):
            short[k, j] = code[k, j]
        begin = kept
        if code[k, 0] == DENSITY:
            kept = keep_near(code, k, registers, first, final + 1, singles, parts, kept, near_singles, near_parts)
            short[k, 1], short[k, 2] = begin, kept
        if scratch[k, LIVE] != 0.0:
            write_row(code, k, scratch, short[length:], rows - length)
            if code[k, 0] == DENSITY:
                short[rows, 1], short[rows, 2] = begin, kept
            rows += 1
    return rows - length
