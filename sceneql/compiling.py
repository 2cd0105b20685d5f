# mypy: ignore-errors
"""How numba compiles our kernels: its own steps, less those that our code has no use for.

Three quarters of the time that numba takes are spent in Python. What is left out here makes a third less, and changes
neither the code that comes out nor what kernels may contain, but for closures, comprehensions, ``with`` and raises.
"""

import gc
import operator
from contextlib import contextmanager

from numba import types
from numba.core.compiler import CompilerBase
from numba.core.compiler_machinery import PassManager
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


PLAIN = (types.Number, types.Boolean)
PLAIN_OR_PACKED = (*PLAIN, types.Array, types.BaseTuple)

remember_signatures()
