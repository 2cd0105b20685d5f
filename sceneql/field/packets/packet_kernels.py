# mypy: ignore-errors
"""First-order enclosures of a tape on many ray segments at once: operations in the outer loop, lanes in the inner one.

In float32; enclosed is the tape's value in exact arithmetic, as by ``enclosure_kernels.segment``. ``registers`` (rows,
WIDTH) has c0, c1 and e of an operation in its first three columns of LANES each, then the sine and cosine of an angle
for its twin; of ``point`` (3, WIDTH), the enclosures of x, y and z, the first n lanes count, n a multiple of 16.
"""

import numpy as np
from numba import types
from numba.core.sigutils import normalize_signature

from sceneql.compiled.kernels import inlined
from sceneql.compiled.lanes_kernels import load, store
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.field.enclose import affine_kernels as affine
from sceneql.field.enclose.affine_kernels import GROW, PAD, TINY, ZERO, F
from sceneql.field.tape import tape_ops as ops
from sceneql.field.tape.single_kernels import lane, sine_cosine

LANES, VECTOR = 64, 16
C1, E, SINE, COSINE, WIDTH = LANES, 2 * LANES, 3 * LANES, 4 * LANES, 5 * LANES
"""Columns of a register."""
TWICE, FIVE_TIMES = F(1.2e-7), F(3.0e-7)
"""Half units in the last place."""
PACKET = "int32[:, ::1], float64[::1], float32[:, ::1], float32[:, ::1], float32[:, ::1]"
"""Types of (code, constants, parts, registers, point)."""
ENCLOSE = types.void(*normalize_signature(f"void({PACKET}, float32[::1], int64)")[0])
enclose = lazy("sceneql.field.packets.enclose_kernels:enclose", ENCLOSE)
_singles, _row, _many = types.float32[:, ::1], types.float32[::1], types.int64
SKELETON_LANES = types.void(_singles, _many, _many, _row, _row, _row, _row, _many)
skeleton_lanes = lazy("sceneql.field.packets.packet_skeleton_kernels:skeleton_lanes", SKELETON_LANES)
BUNDLE = f"{PACKET}, float32[::1], float32[::1], int64[::1], float64[:, ::1], float32[:, ::1], int64[::1]"
MEMORY = "float64[:, ::1]," * 6 + "int32[:, ::1], float32[:, ::1], float64[:, ::1]"
"""Types of a bundle of rays, and of the working memory for a tape: see ``packets.Memory``."""
_wide = types.float64[:, ::1]
KEEP_SKELETON = types.UniTuple(_many, 2)(
    _many, _many, _row, _row, _row, _row, _many, _many, _singles, _wide, _many, _singles, _wide
)  # fmt: skip
keep_skeleton = lazy("sceneql.field.packets.packet_near_kernels:keep_skeleton", KEEP_SKELETON)
_place = types.float64
TAPE_ROOTS = types.Tuple((types.int64, types.int64, types.int64, _place, _place, _place))(
    *normalize_signature(f"void({BUNDLE}, int64, int64, boolean, {MEMORY}, int64[::1])")[0]
)
tape_roots = lazy("sceneql.field.packets.tape_bundle_kernels:tape_roots", TAPE_ROOTS)
CHECK_INSIDE = types.void(
    types.int32[:, ::1],
    types.float64[::1],
    _wide,
    _wide,
    _wide,
    _wide,
    types.int64[::1],
    _many,
    _many,
    types.float64,
    _wide,
)
check_inside = lazy("sceneql.field.packets.inside_kernels:check_inside", CHECK_INSIDE)


@lane
def worse(status, i, safe, never):
    """Lower a lane's status: unchanged where an operation is ``safe``, NOWHERE where ``never``, else PARTIAL."""
    found = F(ops.WHOLE) if safe else (F(ops.NOWHERE) if never else F(ops.PARTIAL))
    status[i] = found if found > status[i] else status[i]


@inlined
def load_constants(code, constants, registers):
    """Fill the registers of constants, once per tape."""
    for k in range(code.shape[0]):
        if code[k, 0] == ops.CONSTANT:
            number = constants[code[k, 1]]
            c0 = F(number)
            e = ZERO if float(c0) == number else abs(c0) * TWICE + TINY
            for i in range(LANES):
                registers[k, i] = c0
                registers[k, C1 + i] = ZERO
                registers[k, E + i] = e


@inlined
def taken(row, i):
    """Read c0, c1 and e of VECTOR lanes of a register from the ith on."""
    return load(row, i), load(row, C1 + i), load(row, E + i)


@inlined
def put(row, i, c0, c1, e):
    """Write c0, c1 and e of VECTOR lanes of a register from the ith on."""
    store(row, i, c0)
    store(row, C1 + i, c1)
    store(row, E + i, e)


@inlined
def common_lanes(op, a, b, out, n):
    """Sums, differences, products and squares."""
    for i in range(0, n, VECTOR):
        a0, a1, ea = taken(a, i)
        b0, b1, eb = taken(b, i)
        if op == ops.MUL:
            c0, c1, e = affine.product(a0, a1, ea, b0, b1, eb)
        elif op == ops.ADD:
            c0, c1, e = affine.total(a0, a1, ea, b0, b1, eb)
        elif op == ops.SUB:
            c0, c1, e = affine.difference(a0, a1, ea, b0, b1, eb)
        else:
            c0, c1, e = affine.squared(a0, a1, ea)
        put(out, i, c0, c1, e)


@inlined
def scale_lanes(a, b, out, n):
    """A product with the constant in b."""
    s = b[0]
    es = b[E]
    for i in range(0, n, VECTOR):
        a0, a1, ea = taken(a, i)
        c0, c1, e = affine.scaled(a0, a1, ea, s, es)
        put(out, i, c0, c1, e)


@inlined
def unary_lanes(op, a, out, n, status, positive):
    """The rarer operations of one argument; ``positive``: the argument is never below 0."""
    if op == ops.ABS:
        for i in range(n):
            out[i], out[C1 + i], out[E + i] = affine.absolute(a[i], a[C1 + i], a[E + i])
    elif op == ops.SQRT:
        for i in range(n):
            c0, c1, e = a[i], a[C1 + i], a[E + i]
            out[i], out[C1 + i], out[E + i] = affine.square_root(c0, c1, e)
            reach = (abs(c1) + e) * GROW + PAD * abs(c0)
            worse(status, i, positive or c0 >= reach, c0 + reach < ZERO and not positive)
    elif op == ops.EXP:
        for i in range(n):
            out[i], out[C1 + i], out[E + i] = affine.grown(a[i], a[C1 + i], a[E + i])
    elif op == ops.LOG:
        for i in range(n):
            c0, c1, e = a[i], a[C1 + i], a[E + i]
            out[i], out[C1 + i], out[E + i] = affine.logged(c0, c1, e)
            reach = (abs(c1) + e) * GROW + PAD * abs(c0)
            worse(status, i, c0 > reach, c0 + reach < ZERO)
    elif op == ops.FLOOR:
        for i in range(n):
            out[i], out[C1 + i], out[E + i] = affine.floored(a[i], a[C1 + i], a[E + i])
    else:
        for i in range(n):
            out[i], out[C1 + i], out[E + i] = affine.signed(a[i], a[C1 + i], a[E + i])


@inlined
def binary_lanes(op, a, b, out, n, status, positive):
    """The rarer operations of two arguments; ``positive``: the first is never below 0."""
    if op == ops.DIV:
        for i in range(n):
            b0, b1, eb = b[i], b[C1 + i], b[E + i]
            r0, r1, er = affine.reciprocal(b0, b1, eb)
            out[i], out[C1 + i], out[E + i] = affine.product(a[i], a[C1 + i], a[E + i], r0, r1, er)
            worse(status, i, er < F(np.inf), False)
    elif op == ops.MAX:
        for i in range(n):
            out[i], out[C1 + i], out[E + i] = affine.larger_of(a[i], a[C1 + i], a[E + i], b[i], b[C1 + i], b[E + i])
    elif op == ops.MIN:
        for i in range(n):
            c0, c1, e = affine.larger_of(-a[i], -a[C1 + i], a[E + i], -b[i], -b[C1 + i], b[E + i])
            out[i] = -c0
            out[C1 + i] = -c1
            out[E + i] = e
    elif op == ops.POW:
        for i in range(n):
            a0, a1, ea = a[i], a[C1 + i], a[E + i]
            b0, b1, eb = b[i], b[C1 + i], b[E + i]
            out[i], out[C1 + i], out[E + i] = affine.power(a0, a1, ea, b0, b1, eb)
            reach = (abs(a1) + ea) * GROW + PAD * abs(a0)
            plain = affine.fraction(b0, b1, eb)
            safe = a0 > reach or (positive and plain and b0 > ZERO)
            worse(status, i, safe, a0 + reach < ZERO and plain and not positive)
    else:
        for i in range(n):
            out[i], out[C1 + i], out[E + i] = affine.turned(a[i], a[C1 + i], a[E + i], b[i], b[C1 + i], b[E + i])


@inlined
def turn_lanes(a, out, n):
    """Sine and cosine of an angle, stored for both twins."""
    for i in range(n):
        s, c = sine_cosine(a[i])
        out[SINE + i] = s
        out[COSINE + i] = c


@inlined
def wave_lanes(op, a, out, twin, n):
    """Sine or cosine; ``twin`` is the register that stores both."""
    if op == ops.SIN:
        for i in range(n):
            out[i], out[C1 + i], out[E + i] = affine.wave(twin[SINE + i], twin[COSINE + i], a[i], a[C1 + i], a[E + i])
    else:
        for i in range(n):
            out[i], out[C1 + i], out[E + i] = affine.wave(twin[COSINE + i], -twin[SINE + i], a[i], a[C1 + i], a[E + i])


@lane
def placed(o, d, middle, half):
    """Enclosure of o + t d, t = middle + half tau, with inputs rounded by half a unit in the last place."""
    c1 = half * d
    way = middle * d
    return o + way, c1, TWICE * abs(o) + FIVE_TIMES * (abs(way) + abs(c1)) + TINY


@lane
def place(row, i, o, d, middle, half):
    """Write ``placed`` to lane i."""
    row[i], row[C1 + i], row[E + i] = placed(o, d, middle, half)


@inlined
def has(code, op):
    """Whether a tape has an operation."""
    for k in range(code.shape[0]):
        if code[k, 0] == op:
            return True
    return False
