# mypy: ignore-errors
"""Numbers that are soon to be read or written, fetched ahead from memory: kernels then need not wait for them."""

import numba
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from sceneql.compiled.kernels import lean_inlined

UNCOMPILED = numba.config.DISABLE_JIT
LINE = 8
"""Numbers that memory gives at once: 64 bytes."""
TO_WRITE, NEAREST, DATA = 1, 3, 1


@intrinsic
def _fetch(typing, array, at):
    def code(context, builder, signature, args):
        data = context.make_array(signature.args[0])(context, builder, args[0]).data
        place = builder.gep(data, [context.cast(builder, args[1], signature.args[1], types.intp)])
        pointer, word = ir.IntType(8).as_pointer(), ir.IntType(32)
        kind = ir.FunctionType(ir.VoidType(), [pointer, word, word, word])
        name = "llvm.prefetch.p0i8"
        made = builder.module.globals.get(name) or ir.Function(builder.module, kind, name)
        how = [ir.Constant(word, number) for number in (TO_WRITE, NEAREST, DATA)]
        builder.call(made, [builder.bitcast(place, pointer), *how])
        return context.get_dummy_value()

    return types.none(array, at), code


def _in_python(array, at):
    return None


fetch = _in_python if UNCOMPILED else _fetch
"""Ask for the number array[at], to be written, and those about it; nothing waits for it, and it may be outside."""


@lean_inlined
def fetch_all(array, begin, end):
    """Ask for array[begin:end], to be written."""
    for at in range(begin, end, LINE):
        fetch(array, at)
