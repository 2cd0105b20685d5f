# mypy: ignore-errors
"""How calls of compiled functions are lowered: as by numba, with less LLVM code around each.

numba looks at what a call returned in eight ways, of which one is asked for, and takes structures apart that were put
together just before. The machine code is the same.
"""

from llvmlite import ir
from llvmlite.ir.instructions import InsertValue
from numba.core import callconv, cgutils, types
from numba.core.callconv import RETCODE_EXC, RETCODE_NONE, RETCODE_OK, RETCODE_STOPIT, RETCODE_USEREXC, CPUCallConv

WHOLE = ir.IRBuilder.extract_value, CPUCallConv.return_status_propagate
"""The implementations of llvmlite and of numba."""


class Status:
    """What a call returned (callconv.Status): each answer becomes code where it is asked for."""

    def __init__(self, builder, code, error, optional):
        self.builder, self.code, self.error, self.optional = builder, code, error, optional

    @property
    def is_none(self):
        """Whether it returned None."""
        return self.builder.icmp_signed("==", self.code, RETCODE_NONE)

    @property
    def is_ok(self):
        """Whether it returned a value, or None."""
        well = self.builder.icmp_signed("==", self.code, RETCODE_OK)
        return self.builder.or_(well, self.is_none) if self.optional else well

    @property
    def is_error(self):
        """Whether it raised."""
        return self.builder.not_(self.is_ok)

    @property
    def is_stop_iteration(self):
        """Whether a generator has ended."""
        return self.builder.icmp_signed("==", self.code, RETCODE_STOPIT)

    @property
    def is_python_exc(self):
        """Whether Python knows the exception."""
        return self.builder.icmp_signed("==", self.code, RETCODE_EXC)

    @property
    def is_user_exc(self):
        """Whether the exception is described in ``excinfoptr``."""
        return self.builder.icmp_signed(">=", self.code, RETCODE_USEREXC)

    @property
    def excinfoptr(self):
        """The description of the exception."""
        return self.builder.select(self.is_user_exc, self.error, self.error.type(ir.Undefined))


def call_function(self, builder, callee, resty, argtys, args, attrs=None):
    """Call a compiled function: its Status, and what it returned (CPUCallConv.call_function)."""
    kind = self.get_return_type(resty).pointee
    expected = self._get_return_argument(callee.function_type).pointee
    if kind != expected:
        raise ValueError(f"Function type returns {expected} but resty={kind}")
    with builder.goto_entry_block():
        result, error = builder.alloca(kind), builder.alloca(callconv.excinfo_ptr_t)
        builder.store(error.type.pointee(None), error)
    builder.store(cgutils.get_null_value(kind), result)
    values = self._get_arg_packer(argtys).as_arguments(builder, args)
    code = builder.call(callee, [result, error, *values], attrs=tuple(attrs or ()))
    optional = isinstance(resty, types.Optional)
    status = Status(builder, code, builder.load(error), optional)
    return status, self.context.get_returned_value(builder, resty, builder.load(result))


def return_status_propagate(self, builder, status):
    """Return the exception of a call (CPUCallConv.return_status_propagate); kernels have no ``try``."""
    if not getattr(builder, "of_kernel", False):
        WHOLE[1](self, builder, status)
        return
    builder.store(status.excinfoptr, self._get_excinfo_argument(builder.function))
    self._return_errcode_raw(builder, status.code)


def part_of(value, place):
    """The part of a structure at a place, and the rest of the place: followed back to where it was put in."""
    while place and isinstance(value, InsertValue):
        known = tuple(value.indices)
        if place[: len(known)] == known:
            value, place = value.value, place[len(known) :]
        elif known[: len(place)] == place:
            break
        else:
            value = value.aggregate
    return value, place


def extract_value(self, agg, idx, name=""):
    """A part of a structure (IRBuilder.extract_value)."""
    value, place = part_of(agg, tuple(idx) if isinstance(idx, tuple | list) else (idx,))
    return WHOLE[0](self, value, place, name) if place else value


def take_calls():
    """Let numba lower calls, and llvmlite take structures apart, by the functions of this file."""
    CPUCallConv.call_function = call_function
    CPUCallConv.return_status_propagate = return_status_propagate
    ir.IRBuilder.extract_value = extract_value
