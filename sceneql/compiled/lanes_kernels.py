# mypy: ignore-errors
"""Lanes: 64 bytes of numbers, 8 float64 or 16 float32, as one value of a kernel that is computed on at once (SIMD).

Used where LLVM's own vectorization of a loop is poor. What an operation does to a lane is fixed, so the bits are the
same on every machine, whatever the size of its vectors; a number beside lanes stands for all of them.
"""

import operator

import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, models, register_model

from sceneql.compiled.kernels import inlined

UNCOMPILED = numba.config.DISABLE_JIT
BYTES = 64
MAGIC = {64: 0x5FE6AB50C7B537A9, 32: 0x5F375A86}
INDEX = ir.IntType(32)


class Lanes(types.Type):
    """The type of lanes of float64 or float32."""

    def __init__(self, dtype):
        self.dtype = dtype
        self.count = 8 * BYTES // dtype.bitwidth
        super().__init__(name=f"Lanes({dtype})")


@register_model(Lanes)
class LanesModel(models.PrimitiveModel):
    """One vector of LLVM's."""

    def __init__(self, manager, kind):
        number = ir.DoubleType() if kind.dtype == types.float64 else ir.FloatType()
        super().__init__(manager, kind, ir.VectorType(number, kind.count))


def _splat(builder, vector, number):
    one = builder.insert_element(ir.Constant(vector, ir.Undefined), number, ir.Constant(INDEX, 0))
    return builder.shuffle_vector(one, one, ir.Constant(ir.VectorType(INDEX, vector.count), [0] * vector.count))


def _as_lanes(context, builder, kind, given, value):
    """A value as lanes of a type; a number is broadcast to all of them."""
    if isinstance(given, Lanes):
        return value
    return _splat(builder, context.get_value_type(kind), context.cast(builder, value, given, kind.dtype))


def _kind(args):
    """The type of the lanes among the arguments, where all others are numbers; else None."""
    found = [arg for arg in args if isinstance(arg, Lanes)]
    fits = all(isinstance(arg, types.Number) or arg == found[0] for arg in args) if found else False
    return found[0] if fits else None


class _Operation(AbstractTemplate):
    def generic(self, args, keywords):
        kind = _kind(args)
        return None if kind is None else signature(kind, *args)


def _operate(operation, instruction):
    infer_global(operation)(type(f"Lanes_{instruction}", (_Operation,), {}))

    def code(context, builder, signature, args):
        values = [
            _as_lanes(context, builder, signature.return_type, *one) for one in zip(signature.args, args, strict=True)
        ]
        return getattr(builder, instruction)(*values)

    for pair in ((Lanes, Lanes), (Lanes, types.Number), (types.Number, Lanes)):
        lower_builtin(operation, *pair)(code)


for _one in ((operator.add, "fadd"), (operator.sub, "fsub"), (operator.mul, "fmul"), (operator.truediv, "fdiv")):
    _operate(*_one)


@infer_global(abs)
class _Absolute(AbstractTemplate):
    def generic(self, args, keywords):
        return signature(args[0], *args) if isinstance(args[0], Lanes) else None


def _declared(builder, name, result, *args):
    return builder.module.globals.get(name) or ir.Function(builder.module, ir.FunctionType(result, args), name)


@lower_builtin(abs, Lanes)
def _absolute(context, builder, signature, args):
    vector, bits = args[0].type, signature.return_type.dtype.bitwidth
    return builder.call(_declared(builder, f"llvm.fabs.v{vector.count}f{bits}", vector, vector), args)


def _place(context, builder, array, value, at, index):
    data = context.make_array(array)(context, builder, value).data
    spot = builder.gep(data, [context.cast(builder, at, index, types.intp)])
    return builder.bitcast(spot, context.get_value_type(Lanes(array.dtype)).as_pointer()), array.dtype.bitwidth // 8


@intrinsic
def _load(typing, array, at):
    def code(context, builder, signature, args):
        place, size = _place(context, builder, array, *args, at)
        return builder.load(place, align=size)

    return Lanes(array.dtype)(array, at), code


@intrinsic
def _store(typing, array, at, value):
    def code(context, builder, signature, args):
        place, size = _place(context, builder, array, *args[:2], at)
        found = args[2]
        if value.dtype != array.dtype:
            kind = ir.VectorType(context.get_value_type(array.dtype), value.count)
            found = builder.fptrunc(found, kind)
            place = builder.bitcast(place, kind.as_pointer())
        builder.store(found, place, align=size)
        return context.get_dummy_value()

    return types.none(array, at, value), code


@intrinsic
def _turn_over(typing, source, at, step, target, to, to_step):
    kind = Lanes(source.dtype)
    count = kind.count

    def code(context, builder, signature, args):
        at, step, to, to_step = (context.cast(builder, args[k], signature.args[k], types.intp) for k in (1, 2, 4, 5))

        def spot(array, first, apart, k):
            number = builder.add(first, builder.mul(apart, ir.Constant(first.type, k)))
            return _place(context, builder, signature.args[array], args[array], number, types.intp)

        places = [spot(0, at, step, k) for k in range(count)]
        rows = [builder.load(place, align=size) for place, size in places]
        half = 1
        while half < count:  # what stands off the diagonal in each square of 2 half by 2 half numbers changes places
            low = [j if j & half == 0 else count + j - half for j in range(count)]
            high = [j + half if j & half == 0 else count + j for j in range(count)]
            picks = [ir.Constant(ir.VectorType(INDEX, count), pick) for pick in (low, high)]
            for k in [k for k in range(count) if k & half == 0]:
                both = rows[k], rows[k + half]
                rows[k], rows[k + half] = (builder.shuffle_vector(*both, pick) for pick in picks)
            half *= 2
        for k, row in enumerate(rows):
            place, size = spot(3, to, to_step, k)
            builder.store(row, place, align=size)
        return context.get_dummy_value()

    return types.none(source, at, step, target, to, to_step), code


@intrinsic
def _fma(typing, a, b, c):
    kind = _kind((a, b, c))

    def code(context, builder, signature, args):
        values = [_as_lanes(context, builder, kind, *one) for one in zip(signature.args, args, strict=True)]
        vector = values[0].type
        name = f"llvm.fma.v{vector.count}f{kind.dtype.bitwidth}"
        return builder.call(_declared(builder, name, vector, *[vector] * 3), values)

    return kind(a, b, c), code


@intrinsic
def _below(typing, a, b, x, y):
    kind = _kind((a, b, x, y))

    def code(context, builder, signature, args):
        a, b, x, y = (_as_lanes(context, builder, kind, *one) for one in zip(signature.args, args, strict=True))
        return builder.select(builder.fcmp_ordered("<", a, b), x, y)

    return kind(a, b, x, y), code


@intrinsic
def _bits_below(typing, a, b):
    kind = _kind((a, b))

    def code(context, builder, signature, args):
        a, b = (_as_lanes(context, builder, kind, *one) for one in zip(signature.args, args, strict=True))
        bits = builder.bitcast(builder.fcmp_ordered("<", a, b), ir.IntType(kind.count))
        return builder.zext(bits, ir.IntType(64))

    return types.int64(a, b), code


@intrinsic
def _first_bit(typing, bits):
    def code(context, builder, signature, args):
        return builder.cttz(args[0], ir.Constant(ir.IntType(1), 1))

    return types.int64(types.int64), code


@intrinsic
def _spread(typing, number):
    kind = Lanes(number)
    return kind(number), lambda context, builder, signature, args: _as_lanes(context, builder, kind, number, args[0])


@intrinsic
def _with_lane(typing, value, k, number):
    def code(context, builder, signature, args):
        number = context.cast(builder, args[2], signature.args[2], value.dtype)
        return builder.insert_element(args[0], number, context.cast(builder, args[1], k, types.int32))

    return value(value, k, number), code


@intrinsic
def _guess(typing, s):
    size = s.dtype.bitwidth

    def code(context, builder, signature, args):
        whole = ir.VectorType(ir.IntType(size), s.count)
        halved = builder.lshr(builder.bitcast(args[0], whole), ir.Constant(whole, [1] * s.count))
        return builder.bitcast(builder.sub(ir.Constant(whole, [MAGIC[size]] * s.count), halved), args[0].type)

    return s(s), code


@intrinsic
def _root(typing, s):
    def code(context, builder, signature, args):
        vector = args[0].type
        return builder.call(_declared(builder, f"llvm.sqrt.v{s.count}f{s.dtype.bitwidth}", vector, vector), args)

    return s(s), code


def _fold(join):
    @intrinsic
    def fold(typing, value):
        def code(context, builder, signature, args):
            (found,) = args
            count = value.count
            while count > 1:
                count //= 2
                halves = [ir.Constant(ir.VectorType(INDEX, count), list(range(at, at + count))) for at in (0, count)]
                found = join(builder, *(builder.shuffle_vector(found, found, half) for half in halves))
            return builder.extract_element(found, ir.Constant(INDEX, 0))

        return value.dtype(value), code

    return fold


_folded = _fold(lambda builder, a, b: builder.fadd(a, b))
_least = _fold(lambda builder, a, b: builder.select(builder.fcmp_ordered("<", a, b), a, b))
_most = _fold(lambda builder, a, b: builder.select(builder.fcmp_ordered(">", a, b), a, b))


def _load_in_python(array, at):
    return array[at : at + BYTES // array.itemsize].copy()


def _store_in_python(array, at, value):
    array[at : at + len(value)] = value


def _turn_over_in_python(source, at, step, target, to, to_step):
    count = BYTES // source.itemsize
    block = np.stack([source[at + k * step : at + k * step + count] for k in range(count)])
    for k in range(count):
        target[to + k * to_step : to + k * to_step + count] = block[:, k]


def _fma_in_python(a, b, c):
    return (np.longdouble(a) * np.longdouble(b) + np.longdouble(c)).astype(np.result_type(a, b, c))


def _guess_in_python(s):
    size = 8 * s.itemsize
    whole = np.dtype(f"int{size}")
    return (whole.type(MAGIC[size]) - (s.view(whole) >> whole.type(1))).view(s.dtype)


def _with_lane_in_python(value, k, number):
    changed = value.copy()
    changed[k] = number
    return changed


def _folded_in_python(value):
    while len(value) > 1:
        value = value[: len(value) // 2] + value[len(value) // 2 :]
    return value[0]


def _bits_below_in_python(a, b):
    return sum(1 << i for i, found in enumerate(np.asarray(a < b)) if found)


def _first_bit_in_python(bits):
    return (bits & -bits).bit_length() - 1


def _below_in_python(a, b, x, y):
    kind = next(one.dtype for one in (a, b, x, y) if isinstance(one, np.ndarray))
    return np.where(a < b, x, y).astype(kind)


load = _load_in_python if UNCOMPILED else _load
"""load(array, at): the lanes at array[at:]."""
store = _store_in_python if UNCOMPILED else _store
"""store(array, at, lanes): float64 may be rounded to float32."""
turn_over = _turn_over_in_python if UNCOMPILED else _turn_over
"""turn_over(source, at, step, target, to, to_step): the rows of a square of numbers, from at on, as columns
of one in target, at to"""
spread = (lambda number: np.full(BYTES // np.asarray(number).itemsize, number)) if UNCOMPILED else _spread
"""A number in all lanes."""
with_lane = _with_lane_in_python if UNCOMPILED else _with_lane
"""with_lane(lanes, k, number): the lanes, but for lane k, which is the number."""
fma = _fma_in_python if UNCOMPILED else _fma
"""a b + c, rounded once."""
below = _below_in_python if UNCOMPILED else _below
"""below(a, b, x, y): x where a < b, else y."""
bits_below = _bits_below_in_python if UNCOMPILED else _bits_below
"""bits_below(a, b): an integer whose bit k is set where a < b in lane k."""
first_bit = _first_bit_in_python if UNCOMPILED else _first_bit
"""Index of the lowest set bit of an integer that is not 0."""
least = np.min if UNCOMPILED else _least
"""The least of all lanes, none of which is NaN."""
most = np.max if UNCOMPILED else _most
"""The largest of all lanes, none of which is NaN."""
root = np.sqrt if UNCOMPILED else _root
"""The square root."""
guess = _guess_in_python if UNCOMPILED else _guess
"""s^(-1/2) for s > 0, within some 4 %, by halving the exponent (Lomont 2003)."""
folded = _folded_in_python if UNCOMPILED else _folded
"""The sum of all lanes, by adding halves."""


@inlined
def aligned(numbers):
    """An array without its first few numbers, so that it begins at a multiple of 64 bytes: lanes are loaded whole."""
    return numbers[(-numbers.ctypes.data % BYTES) // numbers.itemsize :]
