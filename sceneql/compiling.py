# mypy: ignore-errors
"""How numba compiles our kernels: its own steps, less those that our code has no use for.

Most of the time that numba takes is spent in Python. What is left out here is half of it all, and changes neither what
kernels compute nor what they may contain, but for closures, comprehensions, ``with`` and raises of computed errors.
"""

import gc
import operator
from contextlib import contextmanager
from copy import copy

from llvmlite import binding
from llvmlite.binding import ffi
from numba import config, types
from numba.core import ir
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase
from numba.core.compiler_machinery import PassManager, register_pass
from numba.core.typed_passes import (
    IRLegalization,
    NativeLowering,
    NoPythonBackend,
    NopythonTypeInference,
    PreLowerStripPhis,
)
from numba.core.untyped_passes import (
    FixupArgs,
    GenericRewrites,
    InlineInlinables,
    IRProcessing,
    ReconstructSSA,
    TranslateByteCode,
)

FRONT = (
    TranslateByteCode,
    FixupArgs,
    IRProcessing,
    GenericRewrites,
    InlineInlinables,
    ReconstructSSA,
    NopythonTypeInference,
    PreLowerStripPhis,
    IRLegalization,
)


class HelperLibrary(JITCodeLibrary):
    """Code of a helper: it goes into its callers, is made good there, and never becomes machine code of its own."""

    def _optimize_final_module(self):
        passes, builder = self._codegen._module_pass_manager(
            loop_vectorize=False, slp_vectorize=False, opt=self._codegen._opt_level, cost="cheap"
        )
        passes.run(self._final_module, builder)

    def _finalize_final_module(self):
        self._finalize_dynamic_globals()
        self._finalized = True


@register_pass(mutates_CFG=True, analysis_only=False)
class HelperLowering(NativeLowering):
    """Lower a helper to a HelperLibrary."""

    def run_pass(self, state):
        """Leave the code in state.library, and in state.cr what callers know it by."""
        state.flags = state.flags.copy()
        state.flags.no_compile = True
        state.library = HelperLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        super().run_pass(state)
        name = _kept_out(state.func_id.func_name)
        state.targetctx.insert_user_function(name, state.cr.fndesc, [state.library])
        state.cr = state.cr._replace(cfunc=name)
        return True


def _kept_out(name):
    """What stands for a function in Python that only kernels may call: it raises KeyError.

    numba asks for a builtin function, one of its own for each.
    """
    return f"{{{name} is for kernels only}}".format


def _pipeline(*passes):
    manager = PassManager("kernels")
    for one in passes:
        manager.add_pass(one, one.__name__)
    manager.finalize()
    return [manager]


class KernelCompiler(CompilerBase):
    """For ``pipeline_class`` of numba.jit."""

    def define_pipelines(self):
        """The one list of passes."""
        return _pipeline(*FRONT, NativeLowering, NoPythonBackend)


class HelperCompiler(CompilerBase):
    """The same for functions that only compiled ones call."""

    def define_pipelines(self):
        """The one list of passes."""
        return _pipeline(*FRONT, HelperLowering, NoPythonBackend)


def call_by_name(kernel, inner):
    """Let other kernels call this one by its name, where numba would put its code into each of them once more.

    The name is the function's own: what numba makes of it differs from process to process, and callers are cached.
    An ``inner`` kernel has no code for calls from Python, which are kept out.
    """
    ((types_in, made),) = kernel.overloads.items()  # of one signature: a name stands for one function
    called = copy(made.fndesc)
    called.mangled_name = f"{made.fndesc.modname}.{made.fndesc.qualname}"
    binding.add_symbol(called.mangled_name, made.library.get_pointer_to_function(made.fndesc.mangled_name))
    context = made.target_context
    context.remove_user_function(made.entry_point)
    if inner:
        kernel._clear()
        kernel.overloads[types_in] = made = made._replace(entry_point=_kept_out(kernel.__name__))
    context.insert_user_function(made.entry_point, called, [])


@contextmanager
def collecting_later():
    """Leave the garbage collector off: a compilation makes millions of objects that live on, looked over in vain."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()


def remember_signatures():
    """Let numba keep what an operation on numbers, or the picking of an element, gives.

    At every ``a + b`` it tries up to twenty rules, those for strings, lists and sets among them, and that twice.
    """
    resolve = types.Function.get_call_type
    known = {}

    def remembering(self, typing, args, keywords):
        plain = PLAIN_OR_PACKED if self.typing_key in (operator.getitem, operator.setitem) else PLAIN
        if keywords or not all(isinstance(arg, plain) for arg in args):
            return resolve(self, typing, args, keywords)
        key = self, typing, tuple(args)
        if key not in known:
            known[key] = resolve(self, typing, args, keywords)
        return known[key]

    types.Function.get_call_type = remembering


def list_quickly():
    """Let numba list a statement's variables by looking at the types of its parts in one step, not in up to six."""
    slowly = ir.Inst._rec_list_vars

    def listed(self, value):
        kind = type(value)
        if kind is ir.Var:
            return [value]
        if kind in WITHOUT_VARIABLES:
            return ()
        if kind is dict or kind is list or kind is tuple:
            return [one for part in (value.values() if kind is dict else value) for one in listed(self, part)]
        return slowly(self, value)

    ir.Inst._rec_list_vars = listed


def widen():
    """Let LLVM use vectors of 512 bits where they do not slow the clock, which is from AVX512-VBMI2 on (Ice Lake)."""
    if config.CPU_NAME is None and config.CPU_FEATURES is None and config.ENABLE_AVX:
        features = binding.get_host_cpu_features()
        if features.get("avx512vbmi2"):
            config.CPU_FEATURES = f"{features.flatten()},-prefer-256-bit"


WITHOUT_VARIABLES = {str, int, float, bool, type(None), ir.Loc, ir.Const, ir.Global, ir.Arg, type(operator.add)}
PLAIN = (types.Number, types.Boolean)
PLAIN_OR_PACKED = (*PLAIN, types.Array, types.BaseTuple)

remember_signatures()
list_quickly()
widen()
ffi.lib._lock._cblist.clear()  # LLVM's calls are many, and how long it is held asks nobody here
