# mypy: ignore-errors
"""First-order enclosures of a tape on many ray segments at once: operations in the outer loop, lanes in the inner one.

float32; what is enclosed is the tape's value in exact arithmetic, as by ``enclosure_kernels.segment``. ``registers``
(rows, WIDTH) has c0, c1 and e of an operation in its first three columns of LANES each, then the sine and cosine of an
angle for its twin; of ``point`` (3, WIDTH), the enclosures of x, y and z, the first n lanes count, n a multiple of 16.
"""

import numpy as np

from sceneql.field.affine_kernels import (
    GROW,
    PAD,
    TINY,
    ZERO,
    F,
    absolute,
    floored,
    fraction,
    grown,
    larger_of,
    logged,
    power,
    product,
    reciprocal,
    signed,
    square_root,
    squared,
    turned,
    wave,
)
from sceneql.field.forms_kernels import never_negative
from sceneql.field.packet_density_kernels import density_lanes
from sceneql.field.single_kernels import lane, sine_cosine
from sceneql.field.tape_ops import (
    ABS,
    ADD,
    ATAN2,
    CONSTANT,
    COPY,
    COS,
    DENSITY,
    DIV,
    EXP,
    FLOOR,
    LOG,
    MAX,
    MIN,
    MUL,
    NEG,
    NOWHERE,
    PARTIAL,
    POW,
    SIGN,
    SIN,
    SQRT,
    SQUARE,
    SUB,
    WHOLE,
    X,
    Z,
)
from sceneql.kernels import inlined, lean

LANES = 64
C1, E, SINE, COSINE, WIDTH = LANES, 2 * LANES, 3 * LANES, 4 * LANES, 5 * LANES
"""Columns of a register."""
PACKET = "int32[:, ::1], float64[::1], float32[:, ::1], float32[:, ::1], float32[:, ::1]"
"""Types of (code, constants, parts, registers, point)."""


@lane
def worse(status, i, safe, never):
    """Note in a lane where an operation is defined."""
    found = F(WHOLE) if safe else (F(NOWHERE) if never else F(PARTIAL))
    status[i] = found if found > status[i] else status[i]


@inlined
def load_constants(code, constants, registers):
    """Fill the registers of constants, once for all evaluations of a tape."""
    for k in range(code.shape[0]):
        if code[k, 0] == CONSTANT:
            number = constants[code[k, 1]]
            c0 = F(number)
            e = ZERO if float(c0) == number else abs(c0) * PAD + TINY
            for i in range(LANES):
                registers[k, i] = c0
                registers[k, C1 + i] = ZERO
                registers[k, E + i] = e


@lane
def scaled(a0, a1, ea, s, es):
    """Enclosure of a product with the constant s +- es."""
    c0 = a0 * s
    c1 = a1 * s
    e = ea * (abs(s) + es) + (abs(a0) + abs(a1)) * es
    return c0, c1, e * GROW + (PAD * (abs(c0) + abs(c1)) + TINY)


@inlined
def scale_lanes(a, b, out, n):
    """A product with the constant in b."""
    s = b[0]
    es = b[E]
    for i in range(n):
        out[i], out[C1 + i], out[E + i] = scaled(a[i], a[C1 + i], a[E + i], s, es)


@inlined
def unary_lanes(op, a, out, n, status, positive):
    """The operations of one argument that are seldom; ``positive``: that is never below 0."""
    if op == ABS:
        for i in range(n):
            out[i], out[C1 + i], out[E + i] = absolute(a[i], a[C1 + i], a[E + i])
    elif op == SQRT:
        for i in range(n):
            c0, c1, e = a[i], a[C1 + i], a[E + i]
            out[i], out[C1 + i], out[E + i] = square_root(c0, c1, e)
            reach = (abs(c1) + e) * GROW + PAD * abs(c0)
            worse(status, i, positive or c0 >= reach, c0 + reach < ZERO and not positive)
    elif op == EXP:
        for i in range(n):
            out[i], out[C1 + i], out[E + i] = grown(a[i], a[C1 + i], a[E + i])
    elif op == LOG:
        for i in range(n):
            c0, c1, e = a[i], a[C1 + i], a[E + i]
            out[i], out[C1 + i], out[E + i] = logged(c0, c1, e)
            reach = (abs(c1) + e) * GROW + PAD * abs(c0)
            worse(status, i, c0 > reach, c0 + reach < ZERO)
    elif op == FLOOR:
        for i in range(n):
            out[i], out[C1 + i], out[E + i] = floored(a[i], a[C1 + i], a[E + i])
    else:
        for i in range(n):
            out[i], out[C1 + i], out[E + i] = signed(a[i], a[C1 + i], a[E + i])


@inlined
def binary_lanes(op, a, b, out, n, status, positive):
    """The operations of two arguments that are seldom; ``positive``: the first is never below 0."""
    if op == DIV:
        for i in range(n):
            b0, b1, eb = b[i], b[C1 + i], b[E + i]
            r0, r1, er = reciprocal(b0, b1, eb)
            out[i], out[C1 + i], out[E + i] = product(a[i], a[C1 + i], a[E + i], r0, r1, er)
            worse(status, i, er < F(np.inf), False)
    elif op == MAX:
        for i in range(n):
            out[i], out[C1 + i], out[E + i] = larger_of(a[i], a[C1 + i], a[E + i], b[i], b[C1 + i], b[E + i])
    elif op == MIN:
        for i in range(n):
            c0, c1, e = larger_of(-a[i], -a[C1 + i], a[E + i], -b[i], -b[C1 + i], b[E + i])
            out[i] = -c0
            out[C1 + i] = -c1
            out[E + i] = e
    elif op == POW:
        for i in range(n):
            a0, a1, ea = a[i], a[C1 + i], a[E + i]
            b0, b1, eb = b[i], b[C1 + i], b[E + i]
            out[i], out[C1 + i], out[E + i] = power(a0, a1, ea, b0, b1, eb)
            reach = (abs(a1) + ea) * GROW + PAD * abs(a0)
            plain = fraction(b0, b1, eb)
            safe = a0 > reach or (positive and plain and b0 > ZERO)
            worse(status, i, safe, a0 + reach < ZERO and plain and not positive)
    else:
        for i in range(n):
            out[i], out[C1 + i], out[E + i] = turned(a[i], a[C1 + i], a[E + i], b[i], b[C1 + i], b[E + i])


@inlined
def turn_lanes(a, out, n):
    """Sine and cosine of an angle, for both."""
    for i in range(n):
        s, c = sine_cosine(a[i])
        out[SINE + i] = s
        out[COSINE + i] = c


@inlined
def wave_lanes(op, a, out, twin, n):
    """Sine or cosine; ``twin`` is the register that keeps both."""
    if op == SIN:
        for i in range(n):
            out[i], out[C1 + i], out[E + i] = wave(twin[SINE + i], twin[COSINE + i], a[i], a[C1 + i], a[E + i])
    else:
        for i in range(n):
            out[i], out[C1 + i], out[E + i] = wave(twin[COSINE + i], -twin[SINE + i], a[i], a[C1 + i], a[E + i])


@lane
def place(row, i, o, d, middle, half):
    """Enclose o + t d in lane i, t = middle + half tau, where each of the numbers may be off by half a unit."""
    c1 = half * d
    row[i] = o + middle * d
    row[C1 + i] = c1
    row[E + i] = PAD * (abs(o) + abs(middle * d) + abs(c1)) + TINY


@lean(f"void({PACKET}, float32[::1], int64)", inner=True)
def enclose(code, constants, parts, registers, point, status, n):
    """Enclose f in n lanes, into the last operation's register; ``status`` (LANES,) gets WHOLE, PARTIAL or NOWHERE.

    Nothing is claimed of a lane in which c0, c1 or e is not finite. ``parts`` are those of
    ``packet_density_kernels``.
    """
    for i in range(n):
        status[i] = ZERO
    for k in range(code.shape[0]):
        op = code[k, 0]
        left = code[k, 1]
        right = code[k, 2]
        out = registers[k]
        if op == CONSTANT:
            continue
        if op >= X and op <= Z:
            p = point[op - X]
            for i in range(3 * LANES):
                out[i] = p[i]
            continue
        if op == DENSITY:
            p = code[k, 3]
            density_lanes(parts, left, right, registers[p], registers[p + 1], registers[p + 2], out, n)
            continue
        a = registers[left]
        b = registers[right]
        if op == MUL:
            if code[left, 0] == CONSTANT:
                scale_lanes(b, a, out, n)
            elif code[right, 0] == CONSTANT:
                scale_lanes(a, b, out, n)
            else:
                for i in range(n):
                    out[i], out[C1 + i], out[E + i] = product(a[i], a[C1 + i], a[E + i], b[i], b[C1 + i], b[E + i])
        elif op == ADD:
            for i in range(n):
                c0 = a[i] + b[i]
                c1 = a[C1 + i] + b[C1 + i]
                out[i] = c0
                out[C1 + i] = c1
                out[E + i] = (a[E + i] + b[E + i]) * GROW + PAD * (abs(c0) + abs(c1))
        elif op == SUB:
            for i in range(n):
                c0 = a[i] - b[i]
                c1 = a[C1 + i] - b[C1 + i]
                out[i] = c0
                out[C1 + i] = c1
                out[E + i] = (a[E + i] + b[E + i]) * GROW + PAD * (abs(c0) + abs(c1))
        elif op == SQUARE:
            for i in range(n):
                out[i], out[C1 + i], out[E + i] = squared(a[i], a[C1 + i], a[E + i])
        elif op == NEG:
            for i in range(n):
                out[i] = -a[i]
                out[C1 + i] = -a[C1 + i]
                out[E + i] = a[E + i]
        elif op == COPY:
            for i in range(3 * LANES):
                out[i] = a[i]
        elif op == SIN or op == COS:
            twin = registers[code[k, 3] if code[k, 3] else k]
            if code[k, 3] == 0:
                turn_lanes(a, out, n)
            wave_lanes(op, a, out, twin, n)
        elif op <= ATAN2:
            binary_lanes(op, a, b, out, n, status, never_negative(code[left, 0]))
        elif op <= SIGN:
            unary_lanes(op, a, out, n, status, never_negative(code[left, 0]))
        else:  # nothing is claimed of an operation that has no lanes
            for i in range(n):
                out[i] = F(np.nan)


@lean(
    f"void({PACKET}, float32[::1], float64[:, ::1], float64[:, ::1], float64[::1], float64[::1], float64[:, ::1])",
)
def enclose_rays(code, constants, parts, registers, point, status, origins, directions, t0, t1, out):
    """(c0, c1, e, status) of f on segments o + t d, t in [t0, t1], into ``out`` (4, n); rays are (n, 3)."""
    load_constants(code, constants, registers)
    last = registers[code.shape[0] - 1]
    for start in range(0, len(t0), LANES):
        count = min(LANES, len(t0) - start)
        for i in range(LANES):
            j = start + min(i, count - 1)
            for axis in range(3):
                o, d = origins[j, axis], directions[j, axis]
                middle, half = 0.5 * (t0[j] + t1[j]), 0.5 * (t1[j] - t0[j])
                place(point[axis], i, F(o), F(d), F(middle), F(half))
        enclose(code, constants, parts, registers, point, status, LANES)
        for i in range(count):
            for column in range(3):
                out[column, start + i] = last[column * LANES + i]
            out[3, start + i] = status[i]
