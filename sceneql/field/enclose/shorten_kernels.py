# mypy: ignore-errors
"""What of a tape matters to the sign of f along a bundle of rays: branches that cannot win in any slab, or change the
sign of what does, and parts out of reach are left out."""

import numpy as np

from sceneql.compiled.kernels import inlined
from sceneql.field.enclose.affine_kernels import GROW, PAD
from sceneql.field.packets.packet_density_kernels import keep_near
from sceneql.field.packets.packet_kernels import C1, LANES, SINE, E, keep_skeleton
from sceneql.field.skeleton.skeleton_parts_kernels import STRIDE
from sceneql.field.tape import tape_ops as ops
from sceneql.field.tape.short_rows_kernels import ALIAS, LIVE, write_row

BY_SIGN, BY_VALUE = 1.0, 2.0
"""What matters of a row: its sign alone, as of f, or its value."""
MANY, FEW = 6, 96
"""So many times as many parts as are near a ray, and so many more, may be near a bundle."""
CLIPS = 7
"""Column of scratch: whether a row is a clip."""


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
def one_sided(a, sign, first, stop):
    """Whether what a register encloses, times ``sign``, is more than zero in lanes first..stop-1."""
    doubted = np.int32(0)
    for i in range(first, stop):
        m = abs(a[C1 + i])
        e = a[E + i] * GROW + PAD * (abs(a[i]) + m)
        doubted += np.int32(0) if sign * a[i] - m > e else np.int32(1)
    return doubted == 0


@inlined
def counts_alone(op, a, b, by_sign, first, stop):
    """Whether a branch a of a max or min has its value in lanes first..stop-1, or ``by_sign`` its sign, whatever b is.

    A max has the sign of a where b is below zero, a min where b is above.
    """
    if op == ops.MAX:
        return exceeds(a, b, first, stop) or (by_sign and one_sided(b, np.float32(-1.0), first, stop))
    return exceeds(b, a, first, stop) or (by_sign and one_sided(b, np.float32(1.0), first, stop))


@inlined
def mark_needed(code, registers, scratch, clips, whole, first, stop):
    """Mark the rows that f needs in lanes first..stop-1, whose registers are known, and what rows are to be read as.

    Where a tape is not defined all over (``whole``), all matters, but for the rows ``clips``.
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
        # The sign of these is known by those of what they are made of.
        signs = op == ops.MIN or op == ops.MAX or op == ops.NEG or op == ops.COPY or op == ops.MUL
        use = use if signs else BY_VALUE
        scratch[left, LIVE] = max(scratch[left, LIVE], use)
        scratch[right, LIVE] = max(scratch[right, LIVE], use)
    for k in range(last + 1):
        scratch[k, ALIAS] = scratch[int(scratch[k, ALIAS]), ALIAS]


@inlined
def whole_in(status, first, stop):
    """Whether a tape is defined all over lanes first..stop-1."""
    torn = np.int32(0)
    for i in range(first, stop):
        torn += np.int32(0) if status[i] == np.float32(ops.WHOLE) else np.int32(1)
    return torn == 0


@inlined
def shorten(code, registers, status, first, final, clips, singles, parts, scratch, short, near_singles, near_parts):
    """Write what matters in slabs first..final into ``short``, behind as many rows as ``code`` has.

    Returns (how many rows, whether the bundle is near so much more of a skeleton than a ray that these are better
    looked at alone).

    Before those, the whole tape with the parts alone that are near. ``registers`` and ``status`` are those of all slabs
    in lanes; a branch must win in their neighbors, too, so that it does wherever a ray is looked at. What is written
    has the sign of f there, not always its value; that of rows ``clips`` is left out, whatever it is.
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
            parted = parted or kept - begin > STRIDE * (MANY * own + FEW)
        if scratch[k, LIVE] != 0.0:
            write_row(code, k, scratch, short[length:], rows - length)
            if code[k, 0] == ops.DENSITY or code[k, 0] == ops.SKELETON:
                short[rows, 1], short[rows, 2] = begin, kept
            rows += 1
    return rows - length, parted
