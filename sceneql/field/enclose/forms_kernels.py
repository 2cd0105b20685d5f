# mypy: ignore-errors
"""Affine forms c0 + c1 tau +- e, tau in [-1, 1], and their basic operations, shared by all enclosures along a ray."""

from sceneql.compiled.kernels import inlined
from sceneql.field.tape import tape_ops as ops

PAD = 1.0e-15
LARGE = 1.0e300
TINY = 1.0e-300
"""Larger than the loss by underflow."""
WIDER = 1.0 + 4.0e-15
"""Larger than the rounding of a few sums and products of nonnegative numbers."""


@inlined
def never_negative(op):
    """Whether values of an operation are at least 0, even if their enclosure reaches below."""
    return op == ops.ABS or op == ops.SQUARE or op == ops.SQRT or op == ops.EXP


@inlined
def row_never_negative(code, k):
    """As ``never_negative`` for a row, sums of such rows included."""
    while code[k, 0] == ops.ADD:
        left, right = code[k, 1], code[k, 2]
        if never_negative(code[left, 0]):
            k = right
        elif never_negative(code[right, 0]):
            k = left
        else:
            return False
    return never_negative(code[k, 0])


@inlined
def spread(a0, a1, ea):
    """Largest deviation of a form from a0, enlarged so that a0 -+ it, rounded, are still bounds."""
    return (abs(a1) + ea) * WIDER + PAD * abs(a0)


@inlined
def product(a0, a1, ea, b0, b1, eb):
    """Enclosure of a product: a1 b1 tau^2 lies in a1 b1 [0, 1]."""
    second = 0.5 * a1 * b1
    size_a = abs(a0) + abs(a1)
    size_b = abs(b0) + abs(b1)
    e = abs(second) + ea * (size_b + eb) + eb * size_a
    return a0 * b0 + second, a0 * b1 + a1 * b0, e + (PAD * size_a * size_b + TINY)


@inlined
def hull(low, high):
    """Enclosure of an interval."""
    return 0.5 * (low + high), 0.0, 0.5 * (high - low) + PAD * (abs(low) + abs(high))


@inlined
def larger_of(a0, a1, ea, b0, b1, eb):
    """Enclosure of max(a, b): where neither wins, b + the chord of max(a - b, 0), or the constant hull if better."""
    reach_a = spread(a0, a1, ea)
    reach_b = spread(b0, b1, eb)
    d0 = a0 - b0
    reach = spread(abs(a0) + abs(b0), a1 - b1, ea + eb)
    if d0 >= reach:
        return a0, a1, ea
    if -d0 >= reach:
        return b0, b1, eb
    share = 0.5 * (d0 + reach) / reach
    half_gap = 0.5 * share * (reach - d0)
    c0 = share * a0 + (1.0 - share) * b0 + half_gap
    c1 = share * a1 + (1.0 - share) * b1
    e = share * ea + (1.0 - share) * eb + half_gap
    low = max(a0 - reach_a, b0 - reach_b)
    high = max(a0 + reach_a, b0 + reach_b)
    if 0.5 * (high - low) < e or (low > 0.0 and c0 - abs(c1) <= e):
        return hull(low, high)
    return c0, c1, e + PAD * (abs(a0) + abs(a1) + abs(b0) + abs(b1))
