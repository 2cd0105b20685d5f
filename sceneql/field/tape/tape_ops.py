"""The one table of tape operations and the outcomes of root isolation: small integers shared with the kernels.

Names are those of the scalar operations of ``quantities.operations``; what is not here is lowered by the builder.
"""

CONSTANT, X, Y, Z, COPY = range(5)
ADD, SUB, MUL, DIV, MIN, MAX, POW, ATAN2 = range(5, 13)
NEG, ABS, SQUARE, SQRT, SIN, COS, EXP, LOG, FLOOR, SIGN = range(13, 23)
DENSITY, SKELETON = 23, 24
KEEP = -1
"""In ``batch_kernels.evaluate`` alone: the register already holds its values."""
OF_PARTS = (DENSITY, SKELETON)
"""Operations on a range of the tape's parts and on a point in three consecutive registers."""

BINARY = {"add": ADD, "sub": SUB, "mul": MUL, "div": DIV, "min": MIN, "max": MAX, "pow": POW, "atan2": ATAN2}
UNARY = {
    "neg": NEG,
    "abs": ABS,
    "square": SQUARE,
    "sqrt": SQRT,
    "sin": SIN,
    "cos": COS,
    "exp": EXP,
    "log": LOG,
    "floor": FLOOR,
    "sign": SIGN,
}

MISS, HIT, INSIDE, UNDECIDED = range(4)
"""Outcome of a root search on a ray: see isolation_kernels."""

WHOLE, PARTIAL, NOWHERE = range(3)
"""Where a tape is defined on a segment or box: everywhere, perhaps not everywhere, nowhere."""

TAPE = "int32[:, ::1], float64[::1], float64[:, ::1], float64[:, ::1]"
"""Types of (code, constants, parts, scratch), the first arguments of every kernel on a tape."""

SCRATCH_COLUMNS = 8


def scratch_rows(operations: int, parts: int) -> int:
    """Rows of scratch that the kernels need: a register a row, then one row for each part within a ray's reach."""
    return operations + parts
