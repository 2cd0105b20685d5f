# mypy: ignore-errors
"""The builtins that kernels call most, min, max, np.empty and np.zeros, compiled inline where they are called.

numba compiles an implementation in Python for each of them, for each type of arguments and in each process, by all of
its passes. The machine code is the same without.
"""

import operator

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils, typing, utils
from numba.core.imputils import impl_ret_new_ref, lower_builtin
from numba.cpython.builtins import do_minmax
from numba.np import arrayobj

LEAST, MOST, EMPTY, ZEROS = (f"{__name__}.{word}" for word in ("least", "most", "empty", "zeros"))


def _of_numbers(typing_context, args, keywords):
    """The signature of min or max; None for what numba is to resolve itself."""
    if keywords or len(args) < 2 or not all(isinstance(arg, types.Number | types.Boolean) for arg in args):
        return None
    args = [types.unliteral(arg) for arg in args]
    if all(isinstance(arg, types.Boolean) for arg in args):
        return None
    unified = typing_context.unify_types(*args)
    return None if unified is None else typing.signature(unified, *args)


def _of_shape(typing_context, args, keywords):
    """The signature of np.empty or np.zeros; None for what numba is to resolve itself."""
    given = dict(zip(("shape", "dtype"), args, strict=False)) | keywords
    shape, dtype = given.get("shape"), given.get("dtype")
    if len(given) != len(args) + len(keywords) or set(given) - {"shape", "dtype"}:
        return None
    if isinstance(shape, types.Integer):
        dimensions = 1
    elif isinstance(shape, types.BaseTuple) and all(isinstance(one, types.Integer) for one in shape):
        dimensions = len(shape)
    else:
        return None
    if dtype is not None and not isinstance(dtype, types.NumberClass):
        return None
    kind = types.float64 if dtype is None else dtype.instance_type
    found = typing.signature(types.Array(kind, dimensions, "C"), types.unliteral(shape), *filter(None, (dtype,)))
    return found.replace(pysig=BY_NAME) if keywords else found


BY_NAME = utils.pysignature(lambda shape, dtype: None)
RESOLVED = {}
"""By the builtin: the key of its lowering, and the rule for the signature of a call."""


def resolve(function, typing_context, args, keywords):
    """The signature of a call of one of these builtins, by types of arguments; None: numba resolves it."""
    key, rule = RESOLVED[function.typing_key]
    found = rule(typing_context, args, keywords)
    if found is not None:
        function._impl_keys[found.args] = key
    return found


@lower_builtin(LEAST, types.VarArg(types.Any))
def least(context, builder, signature, arguments):
    """``min(a, b)``."""
    return do_minmax(context, builder, signature.args, arguments, operator.lt)


@lower_builtin(MOST, types.VarArg(types.Any))
def most(context, builder, signature, arguments):
    """``max(a, b)``."""
    return do_minmax(context, builder, signature.args, arguments, operator.gt)


def new_array(context, builder, kind, shapes):
    """An uninitialized array in C order (arrayobj._empty_nd_impl); ValueError for a size that overflows."""
    if kind.layout != "C" or kind.ndim == 0:
        return WHOLE(context, builder, kind, shapes)
    data_kind = context.get_data_type(kind.dtype)
    item = context.get_constant(types.intp, context.get_abi_sizeof(data_kind))
    count, beyond = context.get_constant(types.intp, 1), ir.Constant(ir.IntType(1), 0)
    sizes = [item]
    for size in (*shapes[:0:-1], shapes[0]):
        product = builder.smul_with_overflow(count, size)
        count = builder.extract_value(product, 0)
        beyond = builder.or_(beyond, builder.extract_value(product, 1))
        sizes.append(builder.mul(sizes[-1], size))
    product = builder.smul_with_overflow(count, item)
    beyond = builder.or_(beyond, builder.extract_value(product, 1))
    with cgutils.if_unlikely(builder, beyond):
        told = "array is too big; `arr.size * arr.dtype.itemsize` is larger than the maximum possible size."
        context.call_conv.return_user_exc(builder, ValueError, (told,))
    align = context.get_preferred_array_alignment(kind.dtype)
    memory = context.nrt.meminfo_alloc_aligned(builder, builder.extract_value(product, 0), align)
    array = arrayobj.make_array(kind)(context, builder)
    arrayobj.populate_array(
        array,
        data=builder.bitcast(context.nrt.meminfo_data(builder, memory), data_kind.as_pointer()),
        shape=cgutils.pack_array(builder, shapes),
        strides=cgutils.pack_array(builder, sizes[-2::-1]),
        itemsize=item,
        meminfo=memory,
    )
    return array


WHOLE = arrayobj._empty_nd_impl
"""numba's own implementation."""


@lower_builtin(EMPTY, types.Any)
@lower_builtin(EMPTY, types.Any, types.Any)
def empty(context, builder, signature, arguments):
    """``np.empty(shape, dtype)``."""
    shapes = arrayobj._parse_shape(context, builder, signature.args[0], arguments[0])
    made = new_array(context, builder, signature.return_type, shapes)
    return impl_ret_new_ref(context, builder, signature.return_type, made._getvalue())


@lower_builtin(ZEROS, types.Any)
@lower_builtin(ZEROS, types.Any, types.Any)
def zeros(context, builder, signature, arguments):
    """``np.zeros(shape, dtype)``."""
    shapes = arrayobj._parse_shape(context, builder, signature.args[0], arguments[0])
    made = new_array(context, builder, signature.return_type, shapes)
    cgutils.memset(builder, made.data, builder.mul(made.itemsize, made.nitems), 0)
    return impl_ret_new_ref(context, builder, signature.return_type, made._getvalue())


def take_builtin_calls():
    """Resolve calls of these builtins here, and let numba's other functions that make arrays use `new_array`."""
    RESOLVED[min] = LEAST, _of_numbers
    RESOLVED[max] = MOST, _of_numbers
    RESOLVED[np.empty] = EMPTY, _of_shape
    RESOLVED[np.zeros] = ZEROS, _of_shape
    arrayobj._empty_nd_impl = new_array
