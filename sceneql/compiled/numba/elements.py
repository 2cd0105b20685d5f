# mypy: ignore-errors
"""How elements and slices of arrays are read and written in compiled code: as by numba, with less LLVM code.

numba copies the whole structure of an array to memory at each use, and looks up conversions by other libraries
(``__array__``). Most of a kernel's LLVM code comes from that; the machine code is the same without.
"""

import operator
from functools import cache

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.imputils import impl_ret_borrowed, lower_builtin, lower_getattr
from numba.np import arrayobj

from sceneql.compiled.rows_kernels import field

WHOLE = arrayobj.getitem_arraynd_intp, arrayobj.getitem_array_tuple, arrayobj.setitem_array, arrayobj.make_array
"""numba's own implementations."""


def wrapped(context, builder, kind, index, size):
    """An index as a machine word, negative ones counted from the end."""
    if not kind.signed:
        return context.cast(builder, index, kind, types.uintp)
    index = context.cast(builder, index, kind, types.intp)
    if isinstance(index, ir.Constant) and index.constant >= 0:
        return index
    negative = builder.icmp_signed("<", index, index.type(0))
    return builder.select(negative, builder.add(index, size), index)


def pointer(context, builder, kind, array, kinds, indices):
    """Address of an element; None unless there is one integer index for each dimension of an array in C order."""
    plain = isinstance(kind, types.Array) and kind.layout == "C" and len(kinds) == kind.ndim > 0
    if not plain or context.enable_boundscheck or not all(isinstance(one, types.Integer) for one in kinds):
        return None
    place = None
    for axis, (index_kind, index) in enumerate(zip(kinds, indices, strict=True)):
        size = field(context, builder, kind, array, "shape", axis)
        index = wrapped(context, builder, index_kind, index, size)
        place = index if place is None else builder.add(builder.mul(place, size), index)
    return builder.gep(field(context, builder, kind, array, "data"), [place])


def parts(builder, kind, index):
    """Types and values of the integers in an index."""
    if isinstance(kind, types.BaseTuple):
        return tuple(kind), cgutils.unpack_tuple(builder, index, count=len(kind))
    return (kind,), (index,)


def element(context, builder, signature, arguments):
    """``array[i]`` and ``array[i, j]``."""
    kind, index_kind = signature.args
    array, index = arguments
    at = None
    if not isinstance(signature.return_type, types.Buffer):
        at = pointer(context, builder, kind, array, *parts(builder, index_kind, index))
    if at is None:
        numba_way = WHOLE[isinstance(index_kind, types.BaseTuple)]
        return numba_way(context, builder, signature, arguments)
    return impl_ret_borrowed(context, builder, signature.return_type, arrayobj.load_item(context, builder, kind, at))


def set_element(context, builder, signature, arguments):
    """``array[i] = value`` and ``array[i, j] = value``."""
    kind, index_kind, value_kind = signature.args
    array, index, value = arguments
    at = None
    if not isinstance(value_kind, types.Buffer):
        at = pointer(context, builder, kind, array, *parts(builder, index_kind, index))
    if at is None:
        WHOLE[2](context, builder, signature, arguments)
    else:
        arrayobj.store_item(context, builder, kind, context.cast(builder, value, value_kind, kind.dtype), at)


def section(context, builder, signature, arguments):
    """``array[i:j]``."""
    kind, slice_kind = signature.args
    array, section = arguments
    if slice_kind.has_step or kind.ndim != 1 or kind.layout != "C" or signature.return_type != kind:
        return WHOLE[0](context, builder, signature, arguments)
    size = field(context, builder, kind, array, "shape", 0)
    zero = size.type(0)

    def bound(position):
        place = wrapped(context, builder, types.intp, builder.extract_value(section, position), size)
        place = builder.select(builder.icmp_signed("<", place, zero), zero, place)
        return builder.select(builder.icmp_signed(">=", place, size), size, place)

    start, stop = bound(0), bound(1)
    length = builder.select(builder.icmp_signed("<=", stop, start), zero, builder.sub(stop, start))
    model = context.data_model_manager[kind]
    data = builder.gep(field(context, builder, kind, array, "data"), [start])
    for name, value in (("nitems", length), ("data", data), ("shape", (0, length))):
        position = model.get_field_position(name)
        where = (position, value[0]) if isinstance(value, tuple) else position
        array = builder.insert_value(array, value[1] if isinstance(value, tuple) else value, where)
    return impl_ret_borrowed(context, builder, signature.return_type, array)


def count(context, builder, kind, array):
    """``array.size``."""
    return field(context, builder, kind, array, "nitems")


def shape(context, builder, kind, array):
    """``array.shape``."""
    return field(context, builder, kind, array, "shape")


def length(context, builder, signature, arguments):
    """``len(array)``."""
    return field(context, builder, signature.args[0], arguments[0], "shape", 0)


@cache
def make_array(kind):
    """numba's structure of an array, without a lookup of conversions by other libraries (``__array__``)."""
    made = WHOLE[3](kind)
    if type(kind) is types.Array:
        made._make_refs = cgutils._StructProxy._make_refs
    return made


def take_elements():
    """Let numba lower operations on arrays by the functions of this file."""
    for index in (types.Integer, types.BaseTuple):
        lower_builtin(operator.getitem, types.Array, index)(element)
        lower_builtin(operator.setitem, types.Array, index, types.Any)(set_element)
    lower_builtin(operator.getitem, types.Array, types.SliceType)(section)
    lower_builtin(len, types.Array)(length)
    lower_getattr(types.Array, "size")(count)
    lower_getattr(types.Array, "shape")(shape)
    arrayobj.make_array = make_array
