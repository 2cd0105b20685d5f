# mypy: ignore-errors
"""Shortcuts through numba's type inference and code generation: answers that never change are remembered or not asked.

None of them changes what is compiled. Each replaces the function of numba that its last lines assign to;
tests/bench/bench_shortcuts.py measures what each of them saves.
"""

import operator
from functools import cache
from importlib import import_module
from types import BuiltinFunctionType

from numba import types
from numba.core import (
    base,
    cpu,
    errors,
    interpreter,
    ir,
    postproc,
    transforms,
    typeinfer,
)
from numba.core.typing.context import BaseContext
from numba.np import linalg

from sceneql.compiled.numba.builtin_calls import RESOLVED
from sceneql.compiled.numba.builtin_calls import resolve as resolve_ours

WITHOUT_VARIABLES = {str, int, float, bool, type(None), ir.Loc, ir.Const, ir.Global, ir.Arg, type(operator.add)}
PLAIN = (types.Number, types.Boolean)
BY_TYPE = {value for name, value in vars(operator).items() if "pow" not in name and type(value) is BuiltinFunctionType}
PLAIN_OR_PACKED = (*PLAIN, types.Array, types.BaseTuple)


def remember_signatures():
    """The signature of an operation on numbers, or of indexing, is looked up once.

    At every ``a + b`` numba tries up to twenty rules, those for strings, lists and sets among them, and that twice.
    """
    resolve = types.Function.get_call_type
    known = {}

    def remembering(self, typing, args, keywords):
        if self.typing_key in RESOLVED:
            found = resolve_ours(self, typing, args, keywords)
            if found is not None:
                return found
        plain = PLAIN_OR_PACKED if self.typing_key in (operator.getitem, operator.setitem) else PLAIN
        if keywords or not all(isinstance(arg, plain) for arg in args):
            return resolve(self, typing, args, keywords)
        if self.typing_key in BY_TYPE:
            args = [types.unliteral(arg) for arg in args]
        key = self, typing, tuple(args)
        if key not in known:
            known[key] = resolve(self, typing, args, keywords)
        return known[key]

    types.Function.get_call_type = remembering


def remember_attributes():
    """Types of attributes of modules and arrays, and of builtin functions, are looked up once."""
    find, resolve = BaseContext.find_matching_getattr_template, BaseContext.resolve_value_type
    found = {}

    def finding(self, kind, name):
        key = self, kind, name
        if key in found:
            return found[key]
        match = find(self, kind, name)
        steady = match is not None and isinstance(kind, types.Module | types.Array)
        if steady and not isinstance(match["return_type"], types.BoundFunction):
            found[key] = match
        return match

    def resolving(self, value):
        known = self._lookup_global(value) if type(value) is BuiltinFunctionType else None
        return resolve(self, value) if known is None else known

    BaseContext.find_matching_getattr_template = finding
    BaseContext.resolve_value_type = resolving


def resolve_once():
    """In later rounds of type inference a call is resolved again only where the types of its arguments have changed."""
    slowly = typeinfer.CallConstraint.resolve

    def resolving(self, typeinfer, typevars, fnty):
        try:
            named = sorted(self.kws.items())
            arguments = [typevars[one.name].type for one in (*self.args, *(value for _, value in named))]
        except AttributeError:
            arguments = [None]
        if self.vararg is not None or None in arguments:
            return slowly(self, typeinfer, typevars, fnty)
        key = fnty, *arguments
        if getattr(self, "resolved", None) == key:
            return None
        slowly(self, typeinfer, typevars, fnty)
        if self.signature is not None:
            self.resolved = key
        return None

    typeinfer.CallConstraint.resolve = resolving


def propagate(self, inference):
    """One round of type inference: its errors, which the next may resolve (typeinfer.ConstraintNetwork.propagate)."""
    found = []
    for constraint in self.constraints:
        try:
            constraint(inference)
        except errors.ForceLiteralArg as error:
            found.append(error)
        except errors.TypingError as error:
            told = errors.TypingError(str(error), loc=constraint.loc, highlighting=False)
            told.__cause__ = error
            found.append(told)
    return found


def propagate_quickly():
    """Rounds of type inference format no context for errors that do not occur."""
    typeinfer.ConstraintNetwork.propagate = propagate


def refresh_rarely():
    """numba's registries are imported once; later they are only checked for new entries."""
    load = cpu.CPUContext.load_additional_registries
    loaded = set()

    def loading(self):
        if id(self) not in loaded:
            loaded.add(id(self))
            load(self)
        for registry in list(self._registries):
            self.install_registry(registry)

    cpu.CPUContext.load_additional_registries = loading
    for kind in (base.BaseContext, BaseContext):
        kind.install_registry = _when_grown(kind.install_registry)


def _when_grown(install):
    """Install a registry's entries only when there are more than before: none is ever removed."""
    installed = {}

    def installing(self, registry):
        count = sum(len(one) for one in vars(registry).values() if type(one) is list)
        if installed.get((id(self), id(registry))) != count:
            install(self, registry)
            installed[id(self), id(registry)] = count

    return installing


def look_once():
    """Lifetimes of variables are analyzed for the last of a kernel's passes, not after each of them."""
    run = postproc.PostProcessor.run

    def running(self, emit_dels=False, extend_lifetimes=False):
        if emit_dels or not getattr(self.func_ir, "of_kernel", False):
            run(self, emit_dels, extend_lifetimes)
        else:
            self.func_ir.blocks = transforms.canonicalize_cfg(self.func_ir.blocks)

    postproc.PostProcessor.run = running


def pass_over():
    """Kernels have no ``with`` and no dict displays, whose bytecode patterns numba looks for in every statement."""
    slowly = interpreter.Interpreter.post_process

    def processing(self, peepholes, function):
        kept = [one for one in peepholes if one.__name__ not in ABSENT]
        statements = [one for block in function.blocks.values() for one in block.body]
        if any(
            isinstance(one, ir.EnterWith)
            or (isinstance(one, ir.Assign) and isinstance(one.value, ir.Expr) and one.value.op == "build_map")
            for one in statements
        ):
            kept = peepholes
        return slowly(self, kept, function)

    interpreter.Interpreter.post_process = processing


def remember_sizes():
    """Sizes of types in memory are computed once: numba has LLVM parse a module for each."""
    sizeof = cache(lambda target, kind: kind.get_abi_size(target))
    base.BaseContext.get_abi_sizeof = lambda self, kind: sizeof(self.target_data, kind)


def believe_in_scipy():
    """scipy is not imported to see whether it is installed, which takes a fifth of a second."""
    look = linalg.ensure_blas
    linalg.ensure_blas = _say_nothing
    import_module("numba.np.arraymath")
    linalg.ensure_blas = look


def _say_nothing(*_, **__):
    pass


ABSENT = {"peep_hole_delete_with_exit", "peep_hole_fuse_dict_add_updates"}


SHORTCUTS = (
    remember_signatures,
    remember_attributes,
    resolve_once,
    propagate_quickly,
    refresh_rarely,
    look_once,
    pass_over,
    remember_sizes,
    believe_in_scipy,
)
"""All of them, in the order in which they are taken."""
