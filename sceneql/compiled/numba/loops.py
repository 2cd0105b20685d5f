# mypy: ignore-errors
"""How loops over ``range`` are lowered: as by numba, with a quarter of its LLVM code.

numba keeps a range, its iterator and each of its items in memory, and divides by the step. Here they are values, and a
step of 1 divides nothing. The machine code is the same.
"""

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.base import BaseContext
from numba.core.imputils import lower_builtin
from numba.cpython import rangeobj

INT = types.int64
STATE, ITERATOR = rangeobj.range_impl_map[INT]  # numba has registered its own functions by now
START, STOP, STEP = range(3)
PLACE, STRIDE, LEFT = 0, 2, 3


def packed(context, builder, kind, values):
    """The structure of a type with these values."""
    found = ir.Constant(context.get_value_type(kind), ir.Undefined)
    for position, value in enumerate(values):
        found = builder.insert_value(found, value, position)
    return found


def range_of(context, builder, signature, arguments):
    """``range(stop)``, ``range(start, stop)`` and ``range(start, stop, step)``."""
    zero, one = context.get_constant(INT, 0), context.get_constant(INT, 1)
    values = {1: (zero, *arguments, one), 2: (*arguments, one), 3: arguments}[len(arguments)]
    return packed(context, builder, STATE, values)


def count_of(context, builder, start, stop, step):
    """How many items a range has; ValueError for a step of 0."""
    far = builder.sub(stop, start)
    zero, one = far.type(0), far.type(1)
    ahead = builder.icmp_signed(">", far, zero)
    known = isinstance(step, ir.Constant)
    if known and step.constant == 1:
        return builder.select(ahead, far, zero)
    if not known or step.constant == 0:
        with cgutils.if_unlikely(builder, builder.icmp_unsigned("==", step, zero)):
            told = ("range() arg 3 must not be zero",)
            context.call_conv.return_user_exc(builder, ValueError, told)
    apart = builder.xor(ahead, builder.icmp_signed(">", step, zero))
    rest = builder.srem(far, step)
    rest = builder.select(ahead, rest, builder.neg(rest))
    uneven = builder.select(builder.icmp_signed(">", rest, zero), one, zero)
    return builder.select(apart, zero, builder.add(builder.sdiv(far, step), uneven))


def iterator(context, builder, signature, arguments):
    """The iterator of a range: in memory only the next item, and how many are left."""
    start, stop, step = (builder.extract_value(arguments[0], part) for part in (START, STOP, STEP))
    count = count_of(context, builder, start, stop, step)
    with builder.goto_entry_block():
        place, left = builder.alloca(start.type), builder.alloca(start.type)
    builder.store(start, place)
    builder.store(count, left)
    return packed(context, builder, ITERATOR, (place, stop, step, left))


def following(context, builder, signature, arguments):
    """The next item of a range, and whether there is one."""
    place, step, left = (builder.extract_value(arguments[0], part) for part in (PLACE, STRIDE, LEFT))
    count, value = builder.load(left), builder.load(place)
    there = builder.icmp_signed(">", count, count.type(0))
    with builder.if_then(there):
        builder.store(builder.sub(count, count.type(1), flags=["nsw"]), left)
        builder.store(builder.add(value, step), place)
    return packed(context, builder, signature.return_type, (value, there))


def take_loops():
    """Let numba lower ranges of 64 bits, and the pairs that iterators give, by the functions of this file."""
    for count in (1, 2, 3):
        lower_builtin(range, *[INT] * count)(range_of)
    lower_builtin("getiter", STATE)(iterator)
    lower_builtin("iternext", ITERATOR)(following)
    BaseContext.pair_first = lambda self, builder, pair, kind: builder.extract_value(pair, 0)
    BaseContext.pair_second = lambda self, builder, pair, kind: builder.extract_value(pair, 1)
