# mypy: ignore-errors
"""How statements of a kernel are lowered to LLVM code: as by numba, without what numbers have no need for.

numba frees every variable after its last use, zeroes its memory, and reads the old value before each assignment: all to
count references. Here only variables that hold references are freed, and arguments, which the caller keeps, are not.
Variables that are set once stay out of memory. Nothing is logged.
"""

import operator
from collections import defaultdict

from numba import types
from numba.core import errors, ir
from numba.core.analysis import compute_cfg_from_blocks, must_use_alloca
from numba.core.compiler_machinery import FunctionPass, register_pass
from numba.core.ir_utils import check_and_legalize_ir
from numba.core.lowering import BaseLower, Lower
from numba.core.transforms import canonicalize_cfg

BY_CONSTANT = {operator.pow, operator.ipow}
"""Operations that numba lowers differently for constants."""


@register_pass(mutates_CFG=True, analysis_only=False)
class Free(FunctionPass):
    """Free variables that hold references after their last use."""

    _name = "free"

    def __init__(self):
        FunctionPass.__init__(self)

    def run_pass(self, state):
        """Insert ir.Del after last uses."""
        blocks = state.func_ir.blocks
        if not state.flags.nrt:
            state.func_ir.blocks = canonicalize_cfg(blocks)
            state.func_ir.generator_info = None
            return True
        check_and_legalize_ir(state.func_ir, flags=state.flags)
        models = state.targetctx.data_model_manager
        given = given_names(state.func_ir.blocks)
        for block in state.func_ir.blocks.values():
            block.body = [
                one
                for one in block.body
                if type(one) is not ir.Del
                or (one.value not in given and models[state.typemap[one.value]].contains_nrt_meminfo())
            ]
        return True


def given_names(blocks):
    """Names of variables that hold an argument and never anything else."""
    times, given = defaultdict(int), set()
    for block in blocks.values():
        for statement in block.body:
            if type(statement) is ir.Assign:
                name = statement.target.name
                times[name] += 1
                if type(statement.value) is ir.Arg:
                    given.add(name)
    return {name for name in given if times[name] == 1}


class KernelLower(Lower):
    """The ``lowering_class`` of our lowering passes."""

    def setup_function(self, fndesc):
        """Begin a function."""
        super().setup_function(fndesc)
        self.builder.of_kernel = True

    def _find_singly_assigned_variable(self):
        """Names of variables that need no place in memory.

        They are set once, and read later in the same block, or in blocks that are reached through it alone.
        """
        assigned, set_in, blocks_of, early = defaultdict(int), {}, defaultdict(set), set()
        used = defaultdict(int)
        for label, block in self.blocks.items():
            for statement in block.body:
                target = called = None
                if type(statement) is ir.Assign:
                    target = statement.target.name
                    if type(statement.value) is ir.Expr and statement.value.op == "call":
                        called = statement.value.func.name
                for variable in statement.list_vars():
                    name = variable.name
                    if name == called:
                        used[name] -= 1
                    if name != target:
                        used[name] += 1
                        blocks_of[name].add(label)
                        if not assigned[name]:
                            early.add(name)
                if target is not None:
                    assigned[target] += 1
                    set_in[target] = label
        kept = must_use_alloca(self.func_ir.blocks) | early
        once = {name for name, times in assigned.items() if times == 1 and name not in kept}
        given = given_names(self.blocks)
        before = compute_cfg_from_blocks(self.blocks).dominators()
        self._singly_assigned_vars = {
            name
            for name in once
            if all(
                label == set_in[name]
                or (label > set_in[name] and set_in[name] in before.get(label, ()) and self.is_held(name, given))
                for label in blocks_of[name]
            )
        }
        self._given = given & self._singly_assigned_vars
        self._only_called = {name for name in assigned if used[name] == 0}
        self._blk_local_varmap = {}

    def is_held(self, name, given):
        """Whether a variable may be read in other blocks than the one that sets it: where none of them may free it."""
        if name in given or not self.context.enable_nrt:
            return True
        return not self.context.data_model_manager[self.typeof(name)].contains_nrt_meminfo()

    def pre_block(self, block):
        """No search for ``try`` blocks, which kernels do not have; stack slots are made where they are needed."""
        BaseLower.pre_block(self, block)
        self._cur_ir_block = block

    def lower_block(self, block):
        """Lower the statements of a block."""
        self.pre_block(block)
        for statement in block.body:
            self.loc = statement.loc
            try:
                self.lower_inst(statement)
            except errors.NumbaError as error:
                error.add_context(f'lowering "{statement}" at {self.loc}')
                raise
        self.post_block(block)

    def lower_inst(self, inst):
        """Lower a statement."""
        kind = type(inst)
        if kind is ir.Assign and type(inst.value) is not ir.Arg:
            name = inst.target.name
            if type(inst.value) is ir.Global and name in self._only_called and self.is_compiled(name):
                self.storevar(self.context.get_dummy_value(), name)
            else:
                self.storevar(self.lower_assign(self.typeof(name), inst), name)
        elif kind is ir.Assign and inst.target.name in self._given:
            name, given = inst.target.name, self.typeof(f"arg.{inst.value.name}")
            if isinstance(given, types.Omitted):
                super().lower_inst(inst)
            else:
                value = self.fnargs[inst.value.index]
                self.storevar(self.context.cast(self.builder, value, given, self.typeof(name)), name)
        elif kind is ir.SetItem:
            self.lower_setitem(inst.target, inst.index, inst.value, self.fndesc.calltypes[inst])
        elif kind is ir.Jump:
            self.builder.branch(self.blkmap[inst.target])
        elif kind is ir.Del:
            self.delvar(inst.value)
        else:
            super().lower_inst(inst)

    def is_compiled(self, name):
        """Whether a variable stands for a compiled function, whose Python object no call needs."""
        return isinstance(self.typeof(name), types.Dispatcher)

    def storevar(self, value, name, argidx=None):
        """Assign to a variable."""
        if name in self._singly_assigned_vars:
            self._blk_local_varmap[name] = value
        elif self.context.enable_nrt and not isinstance(self.typeof(name), types.Number | types.Boolean):
            super().storevar(value, name, argidx)
        else:
            self.builder.store(value, self.getvar(name))

    def loadvar(self, name):
        """The value of a variable."""
        if name in self._blk_local_varmap:
            return self._blk_local_varmap[name]
        return self.builder.load(self.getvar(name))

    def lower_binop(self, resty, expr, op):
        """The value of a binary operation."""
        left, right = self.typeof(expr.lhs.name), self.typeof(expr.rhs.name)
        if op in BY_CONSTANT or not (isinstance(left, types.Number) and isinstance(right, types.Number)):
            return super().lower_binop(resty, expr, op)
        context, builder = self.context, self.builder
        function = context.typing_context.resolve_value_type(op)
        signature = self.fndesc.calltypes[expr]
        first = context.cast(builder, self.loadvar(expr.lhs.name), left, signature.args[0])
        second = context.cast(builder, self.loadvar(expr.rhs.name), right, signature.args[1])
        chosen = function.get_call_type(context.typing_context, signature.args, {})
        result = context.get_function(function, chosen)(builder, (first, second))
        return context.cast(builder, result, signature.return_type, resty)
