"""Printing of scalar expressions as lines of a compiled kernel: shared parts once, generated names, no numbers.

Every constant becomes an entry of the kernel's floats, so that the text depends on the form of a formula alone and a
changed number finds its compiled code. The one exception is an exponent of 2, 3 or 4, which is part of the form (a
product), since a general power costs some twenty multiplications.
"""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import reduce

from sceneql.compiled import generated
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import (
    Call,
    Expr,
    Link,
    Number,
    Symbol,
    children,
    each_once,
    holders,
    rebuilt,
    recursive,
    walk,
)

PRODUCTS = {2.0: "{0} * {0}", 3.0: "{0} * {0} * {0}", 4.0: "({0} * {0}) * ({0} * {0})"}
"""Products for powers, by the exponent."""

TERM_HEAD = (
    "import math",
    "",
    "import numpy as np",
    "",
    "from sceneql.compiled.printer_kernels import ease, smoothstep, truth",
    "from sceneql.compiled.kernels import kernel",
    "from sceneql.system.signatures_kernels import TERM",
)
OWN_HEADS = {
    "noise_": "from sceneql.compiled.noise_kernels import noise_line, noise_space",
    "uniform(": "from sceneql.compiled.chance_kernels import uniform",
}
"""Imports of kernels with noise or random numbers, by the text that needs them: others need not compile these."""

TEXTS: Mapping[str, str] = {
    "add": "{0} + {1}",
    "sub": "{0} - {1}",
    "mul": "{0} * {1}",
    "div": "{0} / {1}",
    "neg": "-{0}",
    "pow": "{0} ** {1}",
    "abs": "abs({0})",
    "sign": "np.sign({0})",
    "floor": "np.floor({0})",
    "ceil": "np.ceil({0})",
    "round": "np.rint({0})",
    "mod": "np.mod({0}, {1})",
    **{name: f"math.{name}({{0}})" for name in ("sqrt", "exp", "log", "log10", "sin", "cos", "tan", "asin", "acos")},
    **{name: f"math.{name}({{0}})" for name in ("atan", "sinh", "cosh", "tanh")},
    "atan2": "math.atan2({0}, {1})",
    "hypot": "math.hypot({0}, {1})",
    "min": "min({0}, {1})",
    "max": "max({0}, {1})",
    "clamp": "min(max({0}, {1}), {2})",
    "mix": "{0} + ({1} - {0}) * {2}",
    "step": "truth({1} >= {0})",
    "smoothstep": "smoothstep({0}, {1}, {2})",
    "ease": "ease({0})",
    "lt": "truth({0} < {1})",
    "le": "truth({0} <= {1})",
    "gt": "truth({0} > {1})",
    "ge": "truth({0} >= {1})",
    "eq": "truth({0} == {1})",
    "where": "{1} if {0} else {2}",
    "random": "uniform({0}, {1}, {2})",
    "noise_line": "noise_line({0}, {1})",
    "noise_space": "noise_space({0}, {1}, {2}, {3})",
}
"""The text of each operation that a kernel may use; {0}, ... are names of floats, 0 where not given."""
NOT_GIVEN = ("0.0", "0.0")


@dataclass
class Constants:
    """Inputs of formulas as symbols: ``#0``, ``#1``, ... constants, ``@0``, ``@1``, ...

    values that read other parts.
    """

    values: list[float] = field(default_factory=list)
    inputs: list[Expr] = field(default_factory=list)
    """Subexpressions that read outputs of other parts of the script."""

    def lift(self, expr: Expr) -> Expr:
        """The scalar formula with each largest subexpression without a free symbol replaced by a new symbol.

        Two constants never share a symbol, even where their values are equal: otherwise a new value would change the
        form.
        """
        expr = rebuilt(expr, lambda node, new: _in_pairs(new))
        varying = holders(lambda node: isinstance(node, Symbol), expr)

        def lifted(node: Expr) -> Generator[Expr, Expr, Expr]:
            if id(node) not in varying:
                return self._constant(node)
            if not isinstance(node, Call):
                return node
            kept = node.args[1:] if exponent(node) in PRODUCTS else ()
            args = []
            for arg in node.args[: len(node.args) - len(kept)]:
                args.append((yield arg) if id(arg) in varying else self._constant(arg))
            return Call(node.op, (*args, *kept))

        found: Expr = recursive(lifted, expr)
        return found

    def _constant(self, expr: Expr) -> Symbol:
        """A new symbol for a subexpression without a free symbol."""
        if any(isinstance(node, Link) for node in walk(expr)):
            self.inputs.append(expr)
            return Symbol(f"@{len(self.inputs) - 1}")
        return self.number(float(evaluate(expr, {})))

    def number(self, value: float) -> Symbol:
        """The symbol of a new constant."""
        self.values.append(value)
        return Symbol(f"#{len(self.values) - 1}")


@dataclass
class Printer:
    """Prints lifted expressions as assignments to ``v0``, ``v1``, ...; equal subexpressions are assigned once.

    ``names``: the kernel's text for a symbol; ``meanings``: expressions that symbols stand for, printed where first
    used.
    """

    names: Mapping[str, str]
    meanings: Mapping[str, Expr]
    constants: Constants
    lines: list[str] = field(default_factory=list)
    _names_of: dict[Expr, str] = field(default_factory=dict)
    _names_of_texts: dict[str, str] = field(default_factory=dict)

    def name(self, expr: Expr) -> str:
        """The name of the variable that holds the expression's value after ``lines``."""
        name: str = recursive(self._named, expr)
        return name

    def _named(self, expr: Expr) -> Generator[Expr, str, str]:
        if expr not in self._names_of:
            self._names_of[expr] = yield from self._print(expr)
        return self._names_of[expr]

    def _print(self, expr: Expr) -> Generator[Expr, str, str]:
        match expr:
            case Number(value=value):
                # Numbers that are left come from differentiation: part of the form, but floats like the others.
                return (yield self.constants.number(value))
            case Symbol(name=name) if name in self.meanings:
                return (yield self.meanings[name])
            case Symbol(name=name):
                return self.names[name] if name in self.names else name.replace("#", "c").replace("@", "u")
            case Call(op=op, args=args):
                text, operands = PRODUCTS.get(exponent(expr)), []
                for arg in args if text is None else args[:1]:
                    operands.append((yield arg))
                return self._assign((text or TEXTS[op]).format(*operands, *NOT_GIVEN))
        raise TypeError(f"a {type(expr).__name__.lower()} has no place in a scalar formula")

    def _assign(self, text: str) -> str:
        if text not in self._names_of_texts:
            self._names_of_texts[text] = f"v{len(self.lines)}"
            self.lines.append(f"v{len(self.lines)} = {text}")
        return self._names_of_texts[text]


def printable(expr: Expr) -> bool:
    """Whether a kernel can compute an expression.

    Apart from constants and links it must consist of scalars and operations of TEXTS alone.
    """
    varying = holders(lambda node: isinstance(node, Symbol), expr)

    def operands(node: Expr) -> tuple[Expr, ...]:
        return tuple(part for part in children(node) if id(part) in varying)

    known = (node for node in each_once(expr, below=operands) if id(node) in varying)
    return all(isinstance(node, Symbol) or (isinstance(node, Call) and node.op in TEXTS) for node in known)


def _in_pairs(expr: Expr) -> Expr:
    """`min` and `max` of many arguments as nested calls of two, from the left, as kernels compute them."""
    if isinstance(expr, Call) and expr.op in ("min", "max") and len(expr.args) > 2:
        return reduce(lambda before, arg: Call(expr.op, (before, arg)), expr.args)
    return expr


def exponent(expr: Expr) -> float:
    """The constant exponent of a power; NaN where there is none."""
    if isinstance(expr, Call) and expr.op == "pow" and isinstance(expr.args[1], Number):
        return expr.args[1].value
    return float("nan")


def write_term(
    function: str, constants: Constants, first: int, lines: Sequence[str], imports: Sequence[str] = ()
) -> str:
    """Write a kernel with the signature of a term; returns its ``"module:function"``.

    ``lines``: its body; ``imports``: import lines for what the body calls. The constants stand in floats from ints[0]
    on, each value read from other parts at one of ints[first:].
    """
    text = [
        *TERM_HEAD,
        *(head for start, head in OWN_HEADS.items() if any(f"= {start}" in line for line in lines)),
        *imports,
        *("", "", "@kernel(TERM)"),
        f"def {function}(t, y, out, floats, ints):",
        *(f"    c{k} = floats[ints[0] + {k}]" for k in range(len(constants.values))),
        *(f"    u{k} = floats[ints[{first + k}]]" for k in range(len(constants.inputs))),
        *lines,
    ]
    return f"{generated.write(function, chr(10).join(text) + chr(10))}:{function}"
