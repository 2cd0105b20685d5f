# mypy: ignore-errors
"""A one-dimensional array viewed as a table (n, columns), which numba's own views and reshapes do only in Python."""

from llvmlite import ir
from numba import config, types
from numba.core import cgutils
from numba.core.imputils import impl_ret_borrowed
from numba.extending import intrinsic
from numba.np.numpy_support import as_dtype


def field(context, builder, kind, array, name, *more):
    """A field of numba's structure of an array."""
    position = context.data_model_manager[kind].get_field_position(name)
    return builder.extract_value(array, (position, *more))


def rows_of(kind, columns):
    """A function that views a one-dimensional array as an array (n, columns) of numbers of ``kind``, without a copy."""
    if config.DISABLE_JIT:
        return lambda numbers: numbers.view(as_dtype(kind)).reshape(-1, columns)
    table = types.Array(kind, 2, "C")

    @intrinsic
    def rows(typing, numbers):
        def code(context, builder, signature, arguments):
            (array,) = arguments
            words, size = context.get_value_type(types.intp), kind.bitwidth // 8
            length = builder.mul(field(context, builder, numbers, array, "nitems"), words(numbers.dtype.bitwidth // 8))
            count = builder.udiv(length, words(size * columns))
            data = field(context, builder, numbers, array, "data")
            fields = {
                "meminfo": field(context, builder, numbers, array, "meminfo"),
                "parent": field(context, builder, numbers, array, "parent"),
                "nitems": builder.mul(count, words(columns)),
                "itemsize": words(size),
                "data": builder.bitcast(data, context.get_data_type(kind).as_pointer()),
                "shape": cgutils.pack_array(builder, [count, words(columns)]),
                "strides": cgutils.pack_array(builder, [words(size * columns), words(size)]),
            }
            made = ir.Constant(context.get_value_type(table), ir.Undefined)
            model = context.data_model_manager[table]
            for name, value in fields.items():
                made = builder.insert_value(made, value, model.get_field_position(name))
            return impl_ret_borrowed(context, builder, table, made)

        return table(numbers), code

    return rows
