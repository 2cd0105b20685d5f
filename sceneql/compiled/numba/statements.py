# mypy: ignore-errors
"""How statements of a kernel are lowered to LLVM code: as by numba, without what numbers have no need for.

numba frees every variable after its last use, zeroes its memory, and reads the old value before each assignment: all to
count references. Here only variables that hold references are freed. Nothing is logged.
"""

import operator
from collections import defaultdict

from numba import types
from numba.core import errors, ir
from numba.core.analysis import must_use_alloca
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
        for block in state.func_ir.blocks.values():
            block.body = [
                one
                for one in block.body
                if type(one) is not ir.Del or models[state.typemap[one.value]].contains_nrt_meminfo()
            ]
        return True


class KernelLower(Lower):
    """The ``lowering_class`` of our lowering passes."""

    def _find_singly_assigned_variable(self):
        """Names of variables that are set once and read later in the same block: they need no place in memory."""
        assigned, blocks_of, early = defaultdict(int), defaultdict(set), set()
        for label, block in self.blocks.items():
            for statement in block.body:
                target = None
                if type(statement) is ir.Assign:
                    target = statement.target.name
                for variable in statement.list_vars():
                    name = variable.name
                    if name != target:
                        blocks_of[name].add(label)
                        if not assigned[name]:
                            early.add(name)
                if target is not None:
                    assigned[target] += 1
                    blocks_of[target].add(label)
        kept = must_use_alloca(self.func_ir.blocks) | early
        self._singly_assigned_vars = {
            name for name, times in assigned.items() if times == 1 and len(blocks_of[name]) == 1 and name not in kept
        }
        self._blk_local_varmap = {}

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
            self.storevar(self.lower_assign(self.typeof(name), inst), name)
        elif kind is ir.SetItem:
            self.lower_setitem(inst.target, inst.index, inst.value, self.fndesc.calltypes[inst])
        elif kind is ir.Jump:
            self.builder.branch(self.blkmap[inst.target])
        elif kind is ir.Del:
            self.delvar(inst.value)
        else:
            super().lower_inst(inst)

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
