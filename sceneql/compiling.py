# mypy: ignore-errors
"""How numba compiles our kernels: its own steps, less those that our code has no use for.

Three quarters of the time that numba takes are spent in Python. What is left out here makes a third less, and changes
neither the code that comes out nor what kernels may contain, but for closures, comprehensions, ``with`` and raises.
"""

import gc
from contextlib import contextmanager

from numba import types
from numba.core.compiler import CompilerBase
from numba.core.compiler_machinery import PassManager
from numba.core.registry import cpu_target
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

PASSES = (
    TranslateByteCode,
    FixupArgs,
    IRProcessing,
    GenericRewrites,
    InlineInlinables,
    ReconstructSSA,
    NopythonTypeInference,
    PreLowerStripPhis,
    IRLegalization,
    NativeLowering,
    NoPythonBackend,
)


class Compiler(CompilerBase):
    """For ``pipeline_class`` of numba.jit."""

    def define_pipelines(self):
        """The one list of passes."""
        passes = PassManager("kernels")
        for one in PASSES:
            passes.add_pass(one, one.__name__)
        passes.finalize()
        return [passes]


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


def remember_signatures(typing):
    """Let numba's typing context keep what an operation on numbers gives.

    It tries up to twenty rules at every ``a + b``, those for strings, lists and sets of this program's numbers too.
    """
    resolve = typing.resolve_function_type
    known = {}

    def remembering(function, args, keywords):
        if keywords or not all(isinstance(arg, (types.Number, types.Boolean)) for arg in args):
            return resolve(function, args, keywords)
        kind = function if isinstance(function, types.Type) else typing.resolve_value_type(function)
        if not isinstance(kind, types.Function):
            return resolve(function, args, keywords)
        key = kind, tuple(args)
        if key not in known:
            known[key] = resolve(kind, args, keywords)
        return known[key]

    typing.resolve_function_type = remembering


remember_signatures(cpu_target.typing_context)
