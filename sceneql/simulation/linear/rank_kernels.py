# mypy: ignore-errors
"""The inner loop of factorizations: some rows of a matrix less a product, their sums held in vector registers.

    target[at + r stride + j] += sum over k < count of coefficients[k rows + r] source[start + k height + j]

for r < rows and j < columns, products and sums fused and added in the order of k: the bits do not depend on how wide
the vectors are. What LLVM makes of plain loops loads and stores every sum again for each four k, which halves the speed
(Goto & van de Geijn 2008, ACM TOMS 34, 12: what is to stay in registers, and what in the caches).
"""

import numba
import numpy as np
from llvmlite import binding, ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numba.np.arrayobj import populate_array

from sceneql.kernels import lean
from sceneql.simulation.arithmetic_kernels import fma, widest
from sceneql.system_kernels import A, N

PLAIN = numba.config.DISABLE_JIT
MOST = 64
"""Terms of a sum at a time: what of the source belongs to them stays in the caches."""
WIDE = bool(binding.get_host_cpu_features().get("avx512f"))
LANES, ROWS, VECTORS = (8, 8, 3) if WIDE else (4, 4, 3)
"""Numbers of a vector, rows that are updated at once, vectors of each: their sums fill 3/4 of the registers."""

REAL, WORD = ir.DoubleType(), ir.IntType(64)


def _data(context, builder, given, array):
    return context.make_array(array)(context, builder, given).data


def _pointer(builder, data, at):
    return builder.bitcast(builder.gep(data, [at]), ir.PointerType(ir.VectorType(REAL, LANES)))


def _spread(builder, value):
    vector = ir.VectorType(value.type, LANES)
    one = builder.insert_element(ir.Constant(vector, ir.Undefined), value, ir.Constant(ir.IntType(32), 0))
    zeros = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES)
    return builder.shuffle_vector(one, ir.Constant(vector, ir.Undefined), zeros)


def _called(builder, name, result, arguments):
    """A call of an intrinsic of LLVM's that llvmlite has no word for."""
    kind = ir.FunctionType(result, [argument.type for argument in arguments])
    declared = builder.module.globals.get(name) or ir.Function(builder.module, kind, name)
    return builder.call(declared, arguments)


def _rank(rows, vectors, whole):
    """The intrinsic for so many rows and vectors; not ``whole``: of one vector so many columns as are left."""
    vector = ir.VectorType(REAL, LANES)
    shape = f"v{LANES}f64.p0" if binding.llvm_version_info[0] > 16 else f"v{LANES}f64.p0v{LANES}f64"
    align = ir.Constant(ir.IntType(32), 8)

    def code(context, builder, signature, given):
        target, source, weights = (_data(context, builder, given[k], signature.args[k]) for k in (0, 3, 6))
        at, stride, start, height, count, left = (given[k] for k in (1, 2, 4, 5, 7, 8))
        lanes = ir.Constant(ir.VectorType(WORD, LANES), list(range(LANES)))
        mask = None if whole else builder.icmp_signed("<", lanes, _spread(builder, left))

        def load(data, place):
            where = _pointer(builder, data, place)
            if whole:
                return builder.load(where, align=8)
            zero = ir.Constant(vector, [0.0] * LANES)
            return _called(builder, f"llvm.masked.load.{shape}", vector, [where, align, mask, zero])

        def store(value, data, place):
            where = _pointer(builder, data, place)
            if whole:
                builder.store(value, where, align=8)
            else:
                _called(builder, f"llvm.masked.store.{shape}", ir.VoidType(), [value, where, align, mask])

        def place(row, column):
            shifted = builder.add(at, builder.mul(stride, ir.Constant(WORD, row)))
            return builder.add(shifted, ir.Constant(WORD, LANES * column))

        cells = [(r, c) for r in range(rows) for c in range(vectors)]
        sums = [load(target, place(r, c)) for r, c in cells]
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
        read = [load(source, builder.add(row, ir.Constant(WORD, LANES * c))) for c in range(vectors)]
        own = builder.mul(k, ir.Constant(WORD, rows))
        found = []
        for r in range(rows):
            weight = builder.load(builder.gep(weights, [builder.add(own, ir.Constant(WORD, r))]))
            factor = _spread(builder, weight)
            for c in range(vectors):
                given = [factor, read[c], running[r * vectors + c]]
                found.append(_called(builder, f"llvm.fma.v{LANES}f64", vector, given))
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
            store(value, target, place(r, c))
        return context.get_dummy_value()

    @intrinsic
    def rank(typing, target, at, stride, source, start, height, coefficients, count, left):
        return types.none(A, N, N, A, N, N, A, N, N), code

    return rank


def _in_python(rows, columns):
    def rank(target, at, stride, source, start, height, coefficients, count, left):
        for r in range(rows):
            for j in range(columns or left):
                for k in range(count):
                    place = at + r * stride + j
                    target[place] = fma(coefficients[k * rows + r], source[start + k * height + j], target[place])

    return rank


@intrinsic
def _coefficients(typing):
    def code(context, builder, signature, arguments):
        data = cgutils.alloca_once(builder, REAL, size=ir.Constant(WORD, ROWS * MOST))
        made = context.make_array(A)(context, builder)
        size, step = ([ir.Constant(WORD, number)] for number in (ROWS * MOST, 8))
        populate_array(made, data, size, step, ir.Constant(WORD, 8), None)
        return made._getvalue()

    return A(), code


coefficients = (lambda: np.empty(ROWS * MOST)) if PLAIN else _coefficients
"""Room for the coefficients of MOST terms, on the stack of the calling kernel."""

rank_strip = _in_python(ROWS, LANES * VECTORS) if PLAIN else _rank(ROWS, VECTORS, True)
rank_strip_end = _in_python(ROWS, 0) if PLAIN else _rank(ROWS, 1, False)
rank_row = _in_python(1, LANES * VECTORS) if PLAIN else _rank(1, VECTORS, True)
rank_row_end = _in_python(1, 0) if PLAIN else _rank(1, 1, False)

ADD_ROWS = types.void(A, N, N, N, A, N, N, A, N, N)


@lean(ADD_ROWS, inner=True)
def add_rows(target, at, stride, rows, source, start, height, coefficients, count, left):
    """Add the product to ``rows`` rows (ROWS, or 1) and ``left`` columns of ``target``."""
    widest()
    if rows == ROWS:
        while left >= LANES * VECTORS:
            rank_strip(target, at, stride, source, start, height, coefficients, count, left)
            at += LANES * VECTORS
            start += LANES * VECTORS
            left -= LANES * VECTORS
        while left > 0:
            rank_strip_end(target, at, stride, source, start, height, coefficients, count, left)
            at += LANES
            start += LANES
            left -= LANES
    else:
        while left >= LANES * VECTORS:
            rank_row(target, at, stride, source, start, height, coefficients, count, left)
            at += LANES * VECTORS
            start += LANES * VECTORS
            left -= LANES * VECTORS
        while left > 0:
            rank_row_end(target, at, stride, source, start, height, coefficients, count, left)
            at += LANES
            start += LANES
            left -= LANES
