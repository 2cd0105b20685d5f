# mypy: ignore-errors
"""The inner loop of factorizations: some rows of a matrix less a product, their sums held in vector registers.

    target[at + r stride + j] += sum over k < count of coefficients[k rows + r] source[start + k height + j]

for r < rows and j < columns, products and sums fused and added in the order of k: the bits do not depend on how wide
the vectors are. LLVM's code for plain loops loads and stores every sum again for each four k, which halves the speed
(Goto & van de Geijn 2008, ACM TOMS 34, 12: which data stay in registers, and which in the caches).

All arrays are of float64, or all of float32, of which a vector has twice as many.
"""

import numba
import numpy as np
from llvmlite import binding, ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numba.np.arrayobj import populate_array

from sceneql.compiled.arithmetic_kernels import fma, widest
from sceneql.compiled.kernels import lean_inlined
from sceneql.system.signatures_kernels import N

UNCOMPILED = numba.config.DISABLE_JIT
MOST = 64
"""Terms of a sum at a time: their part of the source stays in the caches."""
WIDE = bool(binding.get_host_cpu_features().get("avx512f"))
BYTES, ROWS = (64, 8) if WIDE else (32, 4)
"""Bytes of a vector, and rows that are updated at once: the sums of three vectors of each fill 3/4 of the registers."""

WORD = ir.IntType(64)


def _data(context, builder, given, array):
    return context.make_array(array)(context, builder, given).data


def _spread(builder, value, lanes):
    vector = ir.VectorType(value.type, lanes)
    one = builder.insert_element(ir.Constant(vector, ir.Undefined), value, ir.Constant(ir.IntType(32), 0))
    zeros = ir.Constant(ir.VectorType(ir.IntType(32), lanes), [0] * lanes)
    return builder.shuffle_vector(one, ir.Constant(vector, ir.Undefined), zeros)


def _called(builder, name, result, arguments):
    """A call of an LLVM intrinsic for which llvmlite has no function."""
    kind = ir.FunctionType(result, [argument.type for argument in arguments])
    declared = builder.module.globals.get(name) or ir.Function(builder.module, kind, name)
    return builder.call(declared, arguments)


def _panel_update(rows, vectors, whole):
    """The intrinsic for so many rows and vectors; not ``whole``: the last vector has only the remaining columns."""

    def code(context, builder, signature, given):
        bits = signature.args[0].dtype.bitwidth
        lanes = 8 * BYTES // bits
        vector = ir.VectorType(ir.DoubleType() if bits == 64 else ir.FloatType(), lanes)
        name = f"v{lanes}f{bits}"
        shape = f"{name}.p0" if binding.llvm_version_info[0] > 16 else f"{name}.p0{name}"
        align = ir.Constant(ir.IntType(32), bits // 8)
        target, source, weights = (_data(context, builder, given[k], signature.args[k]) for k in (0, 3, 6))
        at, stride, start, height, count, left = (given[k] for k in (1, 2, 4, 5, 7, 8))
        numbers = ir.Constant(ir.VectorType(WORD, lanes), list(range(lanes)))
        before_last = ir.Constant(WORD, lanes * (vectors - 1))
        mask = builder.icmp_signed("<", numbers, _spread(builder, builder.sub(left, before_last), lanes))

        def load(data, place, column):
            where = builder.bitcast(builder.gep(data, [place]), vector.as_pointer())
            if whole or column < vectors - 1:
                return builder.load(where, align=bits // 8)
            zero = ir.Constant(vector, [0.0] * lanes)
            return _called(builder, f"llvm.masked.load.{shape}", vector, [where, align, mask, zero])

        def store(value, data, place, column):
            where = builder.bitcast(builder.gep(data, [place]), vector.as_pointer())
            if whole or column < vectors - 1:
                builder.store(value, where, align=bits // 8)
            else:
                _called(builder, f"llvm.masked.store.{shape}", ir.VoidType(), [value, where, align, mask])

        def place(row, column):
            shifted = builder.add(at, builder.mul(stride, ir.Constant(WORD, row)))
            return builder.add(shifted, ir.Constant(WORD, lanes * column))

        cells = [(r, c) for r in range(rows) for c in range(vectors)]
        sums = [load(target, place(r, c), c) for r, c in cells]
        before = builder.block
        loop, after = builder.append_basic_block("rank.loop"), builder.append_basic_block("rank.end")
        builder.cbranch(builder.icmp_signed(">", count, ir.Constant(WORD, 0)), loop, after)
        builder.position_at_end(loop)
        k, row = builder.phi(WORD), builder.phi(WORD)
        k.add_incoming(ir.Constant(WORD, 0), before)
        row.add_incoming(start, before)
        running = [builder.phi(vector) for _ in cells]
        for phi, first in zip(running, sums, strict=True):
            phi.add_incoming(first, before)
        read = [load(source, builder.add(row, ir.Constant(WORD, lanes * c)), c) for c in range(vectors)]
        own = builder.mul(k, ir.Constant(WORD, rows))
        found = []
        for r in range(rows):
            weight = builder.load(builder.gep(weights, [builder.add(own, ir.Constant(WORD, r))]))
            factor = _spread(builder, weight, lanes)
            for c in range(vectors):
                given = [factor, read[c], running[r * vectors + c]]
                found.append(_called(builder, f"llvm.fma.{name}", vector, given))
        following = builder.add(k, ir.Constant(WORD, 1))
        k.add_incoming(following, loop)
        row.add_incoming(builder.add(row, height), loop)
        for phi, value in zip(running, found, strict=True):
            phi.add_incoming(value, loop)
        builder.cbranch(builder.icmp_signed("<", following, count), loop, after)
        builder.position_at_end(after)
        for (r, c), first, value in zip(cells, sums, found, strict=True):
            last = builder.phi(vector)
            last.add_incoming(first, before)
            last.add_incoming(value, loop)
            sums[r * vectors + c] = last
        for (r, c), value in zip(cells, sums, strict=True):
            store(value, target, place(r, c), c)
        return context.get_dummy_value()

    @intrinsic
    def panel_update(typing, target, at, stride, source, start, height, coefficients, count, left):
        return types.none(target, N, N, target, N, N, target, N, N), code

    return panel_update


def _in_python(rows, vectors, whole):
    def panel_update(target, at, stride, source, start, height, coefficients, count, left):
        most = vectors * (BYTES // target.itemsize)
        for r in range(rows):
            for j in range(most if whole else min(left, most)):
                for k in range(count):
                    place = at + r * stride + j
                    target[place] = fma(coefficients[k * rows + r], source[start + k * height + j], target[place])

    return panel_update


@intrinsic
def _coefficients(typing, like):
    def code(context, builder, signature, arguments):
        size = signature.return_type.dtype.bitwidth // 8
        number = context.get_data_type(signature.return_type.dtype)
        data = cgutils.alloca_once(builder, number, size=ir.Constant(WORD, ROWS * MOST))
        made = context.make_array(signature.return_type)(context, builder)
        shape, step = ([ir.Constant(WORD, number)] for number in (ROWS * MOST, size))
        populate_array(made, data, shape, step, ir.Constant(WORD, size), None)
        return made._getvalue()

    return like(like), code


coefficients = (lambda like: np.empty(ROWS * MOST, like.dtype)) if UNCOMPILED else _coefficients
"""Room for the coefficients of MOST terms, of an array's dtype, on the stack of the calling kernel."""

made = _in_python if UNCOMPILED else _panel_update
strip, strip_of_three, strip_of_two, strip_of_one = made(ROWS, 3, True), *(made(ROWS, k, False) for k in (3, 2, 1))
row, row_of_three, row_of_two, row_of_one = made(1, 3, True), *(made(1, k, False) for k in (3, 2, 1))


@lean_inlined
def add_rows(target, at, stride, rows, source, start, height, coefficients, count, left):
    """Add the product to ``rows`` rows (ROWS, or 1) and ``left`` columns of ``target``."""
    widest()
    lanes = BYTES // source.itemsize
    many = rows == ROWS
    while left >= 3 * lanes:
        if many:
            strip(target, at, stride, source, start, height, coefficients, count, left)
        else:
            row(target, at, stride, source, start, height, coefficients, count, left)
        at += 3 * lanes
        start += 3 * lanes
        left -= 3 * lanes
    if left > 2 * lanes:
        if many:
            strip_of_three(target, at, stride, source, start, height, coefficients, count, left)
        else:
            row_of_three(target, at, stride, source, start, height, coefficients, count, left)
    elif left > lanes:
        if many:
            strip_of_two(target, at, stride, source, start, height, coefficients, count, left)
        else:
            row_of_two(target, at, stride, source, start, height, coefficients, count, left)
    elif left > 0:
        if many:
            strip_of_one(target, at, stride, source, start, height, coefficients, count, left)
        else:
            row_of_one(target, at, stride, source, start, height, coefficients, count, left)
