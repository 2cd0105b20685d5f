# mypy: ignore-errors
"""Kernels that are compiled at their first call by another kernel: most scenes may never need them.

The callers are linked to a place in memory that holds the address of the kernel's code. While it is empty, a call
imports the kernel's module first. This extends numba by its registries of functions and LLVM's table of symbols, and
replaces nothing: it works with SCENEQL_NUMBA=plain too.
"""

import ctypes
import threading
import traceback
from _thread import interrupt_main
from functools import cache
from importlib import import_module
from os import _exit

from llvmlite import binding, ir
from numba import config, types
from numba.core import cgutils
from numba.core.imputils import lower_builtin
from numba.core.typing.templates import ConcreteTemplate, infer_global
from numba.extending import intrinsic

from sceneql.compiled.kernels import address

places: dict[int, tuple[str, ctypes.c_void_p]] = {}
"""By the address of a place: the kernel's name, and the place, which holds the address of its code."""
expected = {}
"""By the same address: the signature that callers were compiled for."""
failures: list[BaseException] = []
"""The error of the latest import that failed."""
_one_by_one = threading.RLock()
_ASK = f"{__name__}.ask"


class NotBrought(Exception):
    """Raised by compiled code whose kernel could not be loaded: making one raises the import's error instead."""

    def __init__(self):
        raise failures[-1]


def lazy(name, signature):
    """The kernel ``"package.module:function"``, to be called by kernels alone with this ``signature``."""
    module, _, function = name.partition(":")

    def stub(*arguments):
        """Stands for the kernel in Python, and calls it where numba is switched off."""
        if not config.DISABLE_JIT:
            raise TypeError(f"{function} is for kernels only")
        return getattr(import_module(module), function)(*arguments)

    if config.DISABLE_JIT:
        return stub
    symbol = f"{__name__}.{name}"
    binding.add_symbol(symbol, _new_place(name, signature))
    template = type(f"Lazy_{function}", (ConcreteTemplate,), {"key": symbol, "cases": [signature]})
    infer_global(stub, typing_key=symbol)(template)

    @lower_builtin(symbol, *signature.args)
    def call(context, builder, chosen, arguments):
        words = builder.module
        if symbol not in words.globals:
            ir.GlobalVariable(words, cgutils.voidptr_t, symbol)
        kind = context.call_conv.get_function_type(chosen.return_type, chosen.args).as_pointer()
        code = builder.bitcast(_bring(context, builder, words.globals[symbol]), kind)
        status, result = context.call_conv.call_function(builder, code, chosen.return_type, chosen.args, arguments)
        with cgutils.if_unlikely(builder, status.is_error):
            context.call_conv.return_status_propagate(builder, status)
        return result

    return stub


@cache
def place_of(name, signature):
    """The integer by which kernels find the place of a kernel ``"package.module:function"``; never 0."""
    if config.DISABLE_JIT:
        return address(lazy(name, signature), types.FunctionType(signature))
    return _new_place(name, signature)


def _new_place(name, signature):
    """The address of a new, empty place."""
    place = ctypes.c_void_p()
    at = ctypes.addressof(place)
    places[at], expected[at] = (name, place), signature
    return at


def _bring(context, builder, at):
    """The code that loads the address of a kernel from its place, and asks for it where that is empty."""
    words = builder.module
    if _ASK not in words.globals:
        ir.Function(words, ir.FunctionType(ir.VoidType(), [cgutils.voidptr_t.as_pointer()]), _ASK)
    with cgutils.if_unlikely(builder, cgutils.is_null(builder, builder.load(at))):
        builder.call(words.globals[_ASK], [at])
        with cgutils.if_unlikely(builder, cgutils.is_null(builder, builder.load(at))):
            context.call_conv.return_user_exc(builder, NotBrought, ())
    return builder.load(at)


if config.DISABLE_JIT:

    def brought(place):
        """The address of the kernel of a ``place_of``, imported at the first time."""
        return place

else:

    @intrinsic
    def brought(typing, place):
        """The address of the kernel of a ``place_of``, imported at the first time."""

        def code(context, builder, signature, arguments):
            at = builder.inttoptr(arguments[0], cgutils.voidptr_t.as_pointer())
            return builder.ptrtoint(_bring(context, builder, at), ir.IntType(64))

        return types.int64(types.int64), code


def modules() -> list[str]:
    """Modules of all lazy kernels that have been declared and not called so far."""
    return [name.partition(":")[0] for name, place in list(places.values()) if place.value is None]


def _fill(at):
    """Import the kernel of a place, and store its address there. Raises TypeError for another signature."""
    name, place = places[at]
    module, _, function = name.partition(":")
    with _one_by_one:
        if place.value is None:
            (made,) = getattr(import_module(module), function).overloads.values()
            if made.signature != expected[at]:
                raise TypeError(f"{name} is called as {expected[at]}, but is {made.signature}")
            place.value = made.library.get_pointer_to_function(made.fndesc.llvm_func_name)


@ctypes.CFUNCTYPE(None, ctypes.c_size_t)
def _ask(at):
    """Called by compiled code for an empty place; if that stays empty, the code raises NotBrought.

    Ctrl-C is raised again once Python goes on. Threads that are not Python's cannot raise: there the process ends.
    """
    interrupted = False
    while places[at][1].value is None:
        try:
            _fill(at)
        except KeyboardInterrupt:
            interrupted = True
        except BaseException as error:
            if isinstance(threading.current_thread(), threading._DummyThread):
                traceback.print_exception(error)
                _exit(1)
            failures[:] = [error]
            break
    if interrupted:
        threading.Timer(0.05, interrupt_main).start()


binding.add_symbol(_ASK, ctypes.cast(_ask, ctypes.c_void_p).value)
