# mypy: ignore-errors
"""Values that vary in time, evaluated at stage times: one interpreter of scalar programs over the island's floats.

A program is rows of WIDTH integers (operation, out, a, b, c, count, form); out, a, b, c are offsets into ``floats``,
which hold constants, intermediate values and results alike.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.noise_kernels import noise_line, noise_space
from sceneql.system.signatures_kernels import A, F, I, N

WIDTH = 7

TIME, STATE, KEYS, COPY = range(4)
"""The time; y[a]; keyframes; floats[a]."""

UNARY = ("neg", "sqrt", "abs", "sign", "floor", "ceil", "round", "exp", "log", "log10", "sin", "cos", "tan", "asin",
         "acos", "atan", "sinh", "cosh", "tanh")  # fmt: skip
BINARY = ("add", "sub", "mul", "div", "pow", "mod", "atan2", "min", "max", "lt", "le", "gt", "ge", "eq")
CODES = {name: 4 + k for k, name in enumerate((*UNARY, *BINARY, "where", "noise_line", "noise_space"))}
"""Codes of operations by their names in quantities.operations; the others are lowered to these."""

NEG, SQRT, ABS, SIGN, FLOOR, CEIL, ROUND, EXP, LOG, LOG10, SIN, COS, TAN, ASIN, ACOS, ATAN, SINH, COSH, TANH = range(
    4, 23
)
ADD, SUB, MUL, DIV, POW, MOD, ATAN2, MIN, MAX, LT, LE, GT, GE, EQ, WHERE, NOISE_LINE, NOISE_SPACE = range(23, 40)

STEP_CURVE, LINEAR, SMOOTH, CUBIC = range(4)
"""Indices into quantities.curves.CURVES."""
ROTATION = 4
"""Added to the form of keys whose values are quaternions."""


@lean_inlined
def floor(a):
    """Largest integer not above a; numba's own takes half a second to compile."""
    return a if math.isinf(a) else a - a % 1.0


@lean(types.float64(N, F), inner=True)
def unary(code, a):
    """An operation on one number."""
    if code == NEG:
        return -a
    if code == SQRT:
        return math.sqrt(a) if a >= 0.0 else math.nan
    if code == ABS:
        return abs(a)
    if code == SIGN:
        return math.nan if a != a else 1.0 * (a > 0.0) - 1.0 * (a < 0.0)
    if code == FLOOR:
        return floor(a)
    if code == CEIL:
        return -floor(-a)
    if code == ROUND:
        below = floor(a)
        half = a - below
        return below + 1.0 * (half > 0.5 or (half == 0.5 and below % 2.0 == 1.0))
    if code == EXP:
        return math.exp(a)
    if code == LOG:
        return math.log(a)
    if code == LOG10:
        return math.log10(a)
    if code == SIN:
        return math.sin(a)
    if code == COS:
        return math.cos(a)
    if code == TAN:
        return math.tan(a)
    if code == ASIN:
        return math.asin(a)
    if code == ACOS:
        return math.acos(a)
    if code == ATAN:
        return math.atan(a)
    if code == SINH:
        return math.sinh(a)
    if code == COSH:
        return math.cosh(a)
    return math.tanh(a)


@lean(types.float64(N, F, F), inner=True)
def binary(code, a, b):
    """An operation on two numbers."""
    if code == ADD:
        return a + b
    if code == SUB:
        return a - b
    if code == MUL:
        return a * b
    if code == DIV:
        return a / b
    if code == POW:
        return a**b
    if code == MOD:
        return a % b
    if code == ATAN2:
        return math.atan2(a, b)
    if code == MIN:
        return b if b < a else a
    if code == MAX:
        return b if b > a else a
    if code == LT:
        return 1.0 * (a < b)
    if code == LE:
        return 1.0 * (a <= b)
    if code == GT:
        return 1.0 * (a > b)
    if code == GE:
        return 1.0 * (a >= b)
    return 1.0 * (a == b)


@lean_inlined
def slerp(floats, a, b, s, out):
    """Interpolate the unit quaternions at offsets a and b with constant angular speed (Shoemake 1985)."""
    cosine = 0.0
    for c in range(4):
        cosine += floats[a + c] * floats[b + c]
    angle = math.acos(max(-1.0, min(1.0, cosine)))
    if angle < 1e-8:
        u, v = 1.0 - s, s
    else:
        u, v = math.sin((1.0 - s) * angle) / math.sin(angle), math.sin(s * angle) / math.sin(angle)
    for c in range(4):
        floats[out + c] = u * floats[a + c] + v * floats[b + c]


@lean(types.void(A, F, N, N, N, N, N), inner=True)
def keyframes(floats, t, table, count, components, form, out):
    """The curve at t, as quantities.curves.value_at: ``table`` has the cycle, the times, values, slopes in and out."""
    times = table + 1
    values = times + count
    arriving = values + count * components
    leaving = arriving + count * components
    if floats[table] > 0.0:
        t = floats[times] + (t - floats[times]) % floats[table]
    k = 0
    while k < count - 1 and t >= floats[times + k + 1]:
        k += 1
    a = values + k * components
    if t != t or t <= floats[times] or k == count - 1:
        for c in range(components):
            floats[out + c] = floats[a + c] if t == t else t
        return
    b = a + components
    span = floats[times + k + 1] - floats[times + k]
    s = (t - floats[times + k]) / span
    curve = form % ROTATION
    if curve == STEP_CURVE:
        s = 0.0
    elif curve == SMOOTH or (curve == CUBIC and form >= ROTATION):
        s = s * s * (3.0 - 2.0 * s)
    if form >= ROTATION:
        slerp(floats, a, b, s, out)
        return
    r = 1.0 - s
    for c in range(components):
        p, q = floats[a + c], floats[b + c]
        if curve == CUBIC:
            u, v = floats[leaving + k * components + c], floats[arriving + (k + 1) * components + c]
            floats[out + c] = p * r * r * (1.0 + 2.0 * s) + q * s * s * (3.0 - 2.0 * s) + span * s * r * (u * r - v * s)
        else:
            floats[out + c] = p + (q - p) * s


@lean(types.void(F, A, A, I))
def refresh(t, y, floats, program):
    """Run a program at a time and state."""
    for row in range(0, program.size, WIDTH):
        code, out, a, b = program[row], program[row + 1], program[row + 2], program[row + 3]
        if code == TIME:
            floats[out] = t
        elif code == STATE:
            floats[out] = y[a]
        elif code == KEYS:
            keyframes(floats, floats[a], b, program[row + 5], program[row + 4], program[row + 6], out)
        elif code == COPY:
            floats[out] = floats[a]
        elif code == WHERE:
            floats[out] = floats[b] if floats[a] != 0.0 else floats[program[row + 4]]
        elif code == NOISE_LINE:
            floats[out] = noise_line(floats[a], floats[b])
        elif code == NOISE_SPACE:
            floats[out] = noise_space(floats[a], floats[b], floats[program[row + 4]], floats[program[row + 5]])
        elif code >= ADD:
            floats[out] = binary(code, floats[a], floats[b])
        else:
            floats[out] = unary(code, floats[a])
