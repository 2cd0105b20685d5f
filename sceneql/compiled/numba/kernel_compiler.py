# mypy: ignore-errors
"""How numba compiles our kernels: by its own passes, without those that our code has no use for.

Most of the time that numba takes is spent in Python. What is left out here is half of it all, and changes neither what
kernels compute nor what they may contain, but for closures, comprehensions, ``with`` and raises of computed errors.
"""

from collections.abc import Callable
from copy import copy
from typing import Any

from llvmlite import binding
from numba import config
from numba.core import cgutils
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase
from numba.core.compiler_machinery import PassManager, _pass_registry, register_pass
from numba.core.typed_passes import NativeLowering, NoPythonBackend, NopythonTypeInference, PreLowerStripPhis
from numba.core.untyped_passes import FixupArgs, GenericRewrites, InlineInlinables, ReconstructSSA, TranslateByteCode

from sceneql.compiled.numba.builtin_calls import take_builtin_calls
from sceneql.compiled.numba.calls import take_calls
from sceneql.compiled.numba.elements import take_elements
from sceneql.compiled.numba.loops import take_loops
from sceneql.compiled.numba.python_entry import PythonEntry, add_python_entry
from sceneql.compiled.numba.shortcuts import SHORTCUTS
from sceneql.compiled.numba.statements import Free, KernelLower

FRONT = (
    TranslateByteCode,
    FixupArgs,
    GenericRewrites,
    InlineInlinables,
    ReconstructSSA,
    NopythonTypeInference,
    PreLowerStripPhis,
    Free,
)


class KernelLibrary(JITCodeLibrary):
    """Code of a kernel: without LLVM's verification, and without its function passes over declarations.

    Without those over functions, before helpers are inlined, most loops over lanes of a tape stay loops over numbers.
    """

    def add_ir_module(self, ir_module):
        """Add a module of LLVM code."""
        module = binding.parse_assembly(cgutils.normalize_ir_text(str(ir_module)))
        module.name = ir_module.name
        module.data_layout = self._codegen._data_layout
        passes, builder = self._codegen._function_pass_manager()
        for function in module.functions:
            if not function.is_declaration:
                passes.run(function, builder)
        self._final_module.link_in(module)

    def serialize_using_object_code(self):
        """What is cached: machine code, and the names in it. No other code is linked with its LLVM code."""
        self._ensure_finalized()
        names = (one.name for one in self.get_defined_functions())
        words = "".join(f'define void @"{name}"() {{\nret void\n}}\n' for name in names)
        return self.name, "object", (self._get_compiled_object(), binding.parse_assembly(words).as_bitcode())


class HelperLibrary(KernelLibrary):
    """Code of a helper: it is inlined in its callers, optimized there, and never becomes machine code of its own."""

    def _optimize_final_module(self):
        passes, builder = self._codegen._module_pass_manager(
            loop_vectorize=False, slp_vectorize=False, opt=self._codegen._opt_level, cost="cheap"
        )
        passes.run(self._final_module, builder)

    def _finalize_final_module(self):
        self._finalize_dynamic_globals()
        self._finalized = True


@register_pass(mutates_CFG=True, analysis_only=False)
class KernelLowering(NativeLowering):
    """Lower a kernel to a KernelLibrary."""

    lowering_class = KernelLower

    def run_pass(self, state):
        """Leave the code in state.library, to be cached."""
        state.library = KernelLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        state.library.enable_object_caching()
        return super().run_pass(state)


@register_pass(mutates_CFG=True, analysis_only=False)
class HelperLowering(NativeLowering):
    """Lower a helper to a HelperLibrary."""

    lowering_class = KernelLower

    def run_pass(self, state):
        """Leave the code in state.library, and in state.cr the description that callers use."""
        state.flags = state.flags.copy()
        state.flags.no_compile = True
        state.library = HelperLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        super().run_pass(state)
        name = _kept_out(state.func_id.func_name)
        state.targetctx.insert_user_function(name, state.cr.fndesc, [state.library])
        state.cr = state.cr._replace(cfunc=name)
        return True


def _kept_out(name):
    """Stands for the Python function of a helper that only kernels may call: it raises KeyError.

    numba requires a builtin function, a different one for each helper.
    """
    return f"{{{name} is for kernels only}}".format


class Passes(PassManager):
    """A list of passes, with nothing in between: numba would analyze the lifetimes of variables anew after each."""

    def run(self, state):
        """Run all passes on the state."""
        for one, _ in self.passes:
            _pass_registry.get(one).pass_inst.run_pass(state)
            if state.func_ir is not None:
                state.func_ir.of_kernel = True


def _pipeline(*passes):
    manager = Passes("kernels")
    for one in passes:
        manager.add_pass(one, one.__name__)
    manager.finalize()
    return [manager]


class KernelCompiler(CompilerBase):
    """The ``pipeline_class`` of numba.jit for a kernel."""

    def define_pipelines(self):
        """The single list of passes."""
        return _pipeline(*FRONT, KernelLowering, NoPythonBackend)


class HelperCompiler(CompilerBase):
    """The ``pipeline_class`` for a helper, which only compiled functions call."""

    def define_pipelines(self):
        """The single list of passes."""
        return _pipeline(*FRONT, HelperLowering, NoPythonBackend)


@register_pass(mutates_CFG=True, analysis_only=False)
class LowerPythonEntry(PythonEntry):
    """Lower a kernel's Python entry to a KernelLibrary."""

    _name = "lower_python_entry"

    def run_pass(self, state):
        """Leave the code in state.library, to be cached."""
        state.library = KernelLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        state.library.enable_object_caching()
        return super().run_pass(state)


class PythonEntryCompiler(CompilerBase):
    """The ``pipeline_class`` for the Python entry of a kernel that is compiled already."""

    def define_pipelines(self):
        """The single list of passes."""
        return _pipeline(LowerPythonEntry, NoPythonBackend)


PIPELINES = tuple({"pipeline_class": compiler} for compiler in (KernelCompiler, HelperCompiler, PythonEntryCompiler))
"""The option of numba.jit for a kernel, for a helper, and for the Python entry of a kernel."""


def call_by_name(kernel: Any, python_entry: Callable[[], Any] | None) -> None:
    """Let other kernels call this one by its name, where numba would link its code into each of them once more.

    The name is the function's own: numba's mangled names differ from process to process, and callers are cached.
    ``python_entry()`` gives the dispatcher for calls from Python; where it is None, such calls raise TypeError.
    """
    (made,) = kernel.overloads.values()  # one signature, so that the name stands for one function
    called = copy(made.fndesc)
    called.mangled_name = f"{made.fndesc.modname}.{made.fndesc.qualname}"
    binding.add_symbol(called.mangled_name, made.library.get_pointer_to_function(made.fndesc.mangled_name))
    context = made.target_context
    context.remove_user_function(made.entry_point)
    context.insert_user_function(made.entry_point, called, [])
    if python_entry is not None:
        add_python_entry(kernel, called, python_entry)
    else:
        kernel._clear()
        kernel._explain_matching_error = _refusal(kernel.__name__)


def _refusal(name):
    """A function that raises TypeError for a call from Python of a function for kernels."""

    def refuse(*_, **__):
        raise TypeError(f"{name} is for kernels only")

    return refuse


def widen():
    """Let LLVM use vectors of 512 bits where they do not slow the clock: from AVX512-VBMI2 on (Ice Lake)."""
    if config.CPU_NAME is None and config.CPU_FEATURES is None and config.ENABLE_AVX:
        features = binding.get_host_cpu_features()
        if features.get("avx512vbmi2"):
            config.CPU_FEATURES = f"{features.flatten()},-prefer-256-bit"


REPLACEMENTS = [take_elements, take_calls, take_loops, *SHORTCUTS, take_builtin_calls, widen]
"""Functions that replace parts of numba for this whole process; the passes above are only for our kernels."""


def take_all() -> None:
    """Replace those parts, once, before anything is compiled."""
    for replace in REPLACEMENTS:
        replace()
