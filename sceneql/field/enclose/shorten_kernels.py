# mypy: ignore-errors
"""Tapes shortened for a bundle of rays, with the sign of f: without branches that cannot win, or change the sign, in
any slab, and without parts out of reach."""

import numpy as np

from sceneql.compiled.kernels import inlined
from sceneql.field.enclose.affine_kernels import GROW, PAD
from sceneql.field.packets.packet_density_kernels import keep_near
from sceneql.field.packets.packet_kernels import C1, LANES, SINE, E, keep_skeleton
from sceneql.field.skeleton import skeleton_parts_kernels as part
from sceneql.field.tape import tape_ops as ops
from sceneql.field.tape.short_rows_kernels import ALIAS, LIVE, write_row

BY_SIGN, BY_VALUE = 1.0, 2.0
"""What must be kept of a row: only its sign, as of f, or its value."""
MANY, FEW = 6, 96
"""A bundle may be near MANY times as many parts as a ray, and FEW more, before its rays are searched one by one."""
CLIPS = 7
"""Column of scratch: 1 for a clip's row."""


@inlined
def exceeds(a, b, first, stop):
    """Whether register a is proved larger than register b in lanes first..stop-1."""
    doubted = np.int32(0)
    for i in range(first, stop):
        size = abs(a[i]) + abs(b[i]) + abs(a[C1 + i]) + abs(b[C1 + i])
        reach = (abs(a[C1 + i] - b[C1 + i]) + a[E + i] + b[E + i]) * GROW + PAD * size
        doubted += np.int32(0) if a[i] - b[i] > reach else np.int32(1)
    return doubted == 0


@inlined
def one_sided(a, sign, first, stop):
    """Whether a register times ``sign`` is proved positive in lanes first..stop-1."""
    doubted = np.int32(0)
    for i in range(first, stop):
        m = abs(a[C1 + i])
        e = a[E + i] * GROW + PAD * (abs(a[i]) + m)
        doubted += np.int32(0) if sign * a[i] - m > e else np.int32(1)
    return doubted == 0


@inlined
def counts_alone(op, a, b, by_sign, first, stop):
    """Whether max or min has the value of its branch a in lanes first..stop-1, or ``by_sign`` its sign, for any b.

    A max has the sign of a where b is negative, a min where b is positive.
    """
    if op == ops.MAX:
        return exceeds(a, b, first, stop) or (by_sign and one_sided(b, np.float32(-1.0), first, stop))
    return exceeds(b, a, first, stop) or (by_sign and one_sided(b, np.float32(1.0), first, stop))


@inlined
def mark_needed(code, registers, scratch, clips, whole, first, stop):
    """Mark the rows that f needs in lanes first..stop-1, given the registers there, and the rows that replace others.

    Unless the tape is defined everywhere (``whole``), no row but those in ``clips`` is left out.
    """
    last = code.shape[0] - 1
    for k in range(last + 1):
        scratch[k, LIVE] = scratch[k, CLIPS] = 0.0
    for k in range(clips.shape[0]):
        scratch[clips[k], CLIPS] = 1.0
    scratch[last, LIVE] = BY_SIGN
    for k in range(last, -1, -1):
        scratch[k, ALIAS] = k
        use = scratch[k, LIVE]
        op = code[k, 0]
        if use == 0.0 or op == ops.CONSTANT or op == ops.X or op == ops.Y or op == ops.Z:
            continue
        if op == ops.DENSITY or op == ops.SKELETON:
            for j in range(3):
                scratch[code[k, 3] + j, LIVE] = BY_VALUE
            continue
        left, right = code[k, 1], code[k, 2]
        if op == ops.MIN or op == ops.MAX:
            clipped = op == ops.MAX and use == BY_SIGN
            alone = k
            if clipped and scratch[right, CLIPS] > 0.0:
                alone = left
            elif clipped and scratch[left, CLIPS] > 0.0:
                alone = right
            elif whole and counts_alone(op, registers[left], registers[right], use == BY_SIGN, first, stop):
                alone = left
            elif whole and counts_alone(op, registers[right], registers[left], use == BY_SIGN, first, stop):
                alone = right
            if alone < k:
                scratch[k, ALIAS], scratch[k, LIVE] = alone, 0.0
                scratch[alone, LIVE] = max(scratch[alone, LIVE], use)
                continue
        # The sign of these operations follows from the signs of their operands.
        signs = op == ops.MIN or op == ops.MAX or op == ops.NEG or op == ops.COPY or op == ops.MUL
        use = use if signs else BY_VALUE
        scratch[left, LIVE] = max(scratch[left, LIVE], use)
        scratch[right, LIVE] = max(scratch[right, LIVE], use)
    for k in range(last + 1):
        scratch[k, ALIAS] = scratch[int(scratch[k, ALIAS]), ALIAS]


@inlined
def whole_in(status, first, stop):
    """Whether a tape is defined everywhere in lanes first..stop-1."""
    torn = np.int32(0)
    for i in range(first, stop):
        torn += np.int32(0) if status[i] == np.float32(ops.WHOLE) else np.int32(1)
    return torn == 0


@inlined
def shorten(code, registers, status, first, final, clips, singles, parts, scratch, short, near_singles, near_parts):
    """Write the tape shortened for slabs first..final into ``short``, from row len(code) on.

    Returns (number of its rows, whether the bundle is near so many more parts of a skeleton than a ray that its rays
    are better searched one by one).

    The rows before are the whole tape with only the near parts. ``registers`` and ``status`` are those of all slabs, in
    lanes; a branch must win in the neighboring slabs, too, so that it does wherever a ray is searched. The short tape
    has the sign of f there, not always its value; the rows ``clips`` are left out.
    """
    length = code.shape[0]
    low, stop = max(first - 1, 0), min(final + 2, LANES)
    whole = whole_in(status, low, stop)
    mark_needed(code, registers, scratch, clips, whole, low, stop)
    rows, kept, parted = length, 0, False
    for k in range(length):
        for j in range(4):
            short[k, j] = code[k, j]
        begin = kept
        if code[k, 0] == ops.DENSITY:
            kept = keep_near(code, k, registers, first, final + 1, singles, parts, kept, near_singles, near_parts)
            short[k, 1], short[k, 2] = begin, kept
        elif code[k, 0] == ops.SKELETON:
            p = code[k, 3]
            kept, own = keep_skeleton(
                code[k, 1], code[k, 2], registers[p], registers[p + 1], registers[p + 2], registers[k, SINE:], first,
                final + 1, singles, parts, kept, near_singles, near_parts,
            )  # fmt: skip
            short[k, 1], short[k, 2] = begin, kept
            parted = parted or kept - begin > part.STRIDE * (MANY * own + FEW)
        if scratch[k, LIVE] != 0.0:
            write_row(code, k, scratch, short[length:], rows - length)
            if code[k, 0] == ops.DENSITY or code[k, 0] == ops.SKELETON:
                short[rows, 1], short[rows, 2] = begin, kept
            rows += 1
    return rows - length, parted
