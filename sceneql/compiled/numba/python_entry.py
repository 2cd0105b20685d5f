# mypy: ignore-errors
"""The code by which Python calls a kernel, compiled and cached at the first call from Python.

Most kernels are called by kernels alone and never need it. numba makes it with every function.
"""

import threading
from copy import copy

from llvmlite import ir
from numba.core.callwrapper import PyCallWrapper
from numba.core.compiler import _LowerResult
from numba.core.compiler_machinery import LoweringPass, register_pass
from numba.core.lowering import Environment

_called = {}
"""By the name that kernels call a kernel by (call_by_name): its description."""
_one_by_one = threading.RLock()


def add_python_entry(kernel, called, make):
    """Let the first call of a kernel from Python compile its Python entry, or load it, and go through it.

    ``called`` is the description under which kernels call the kernel by name; ``make()`` gives a dispatcher that was
    compiled by the pass below.
    """
    _called[called.mangled_name] = called
    kernel._clear()

    def take(*_, **__):
        with _one_by_one:
            if kernel._can_compile:
                (way,) = make().overloads.values()
                kernel.python_entry = way  # keeps it alive: numba's table does not
                kernel._insert([one._code for one in way.signature.args], way.entry_point, False)
                kernel._can_compile = False
        return kernel

    kernel._compile_for_args = take
    kernel._can_compile = True
    kernel.compile = lambda _: None  # other kernels would ask for types that are nearly its own


@register_pass(mutates_CFG=False, analysis_only=False)
class PythonEntry(LoweringPass):
    """The single pass of a Python entry: code that unpacks Python's arguments and calls the kernel by name."""

    _name = "python_entry"

    def __init__(self):
        LoweringPass.__init__(self)

    def run_pass(self, state):
        """Leave the code in state.library, to be cached."""
        context, function = state.targetctx, state.func_id
        called = _called[f"{function.modname}.{function.func_qualname}"]
        own = copy(called)
        name = f"{called.mangled_name}.from_python"
        own.mangled_name, own.env_name = (context.mangler(f"{part}{name}", own.argtypes) for part in ("", ".NumbaEnv."))
        module = context.create_module(name)
        kind = context.call_conv.get_function_type(own.restype, own.argtypes)
        kernel = ir.Function(module, kind, called.mangled_name)
        environment = Environment.from_fndesc(own)
        PyCallWrapper(context, module, kernel, own, environment, None, release_gil=True).build()
        state.library.add_ir_module(module)
        entry = context.get_executable(state.library, own, environment)
        state.cr = _LowerResult(own, None, cfunc=entry, env=environment)
        return True
