"""Printing of trees as text that parses to the same tree again, and of dimensions in words."""

from __future__ import annotations

from sceneql.quantities.expression import Call, Expr, Keys, Link, Name, Number, Symbol, Vector, each_once
from sceneql.quantities.operations import OPERATIONS
from sceneql.quantities.units import describe, format_quantity

__all__ = ["describe", "show"]

COMPARISON, SUM, LITERAL, PRODUCT, SIGN, POWER, ATOM = range(7)
BINDING = {"add": SUM, "sub": SUM, "mul": PRODUCT, "div": PRODUCT, "neg": SIGN, "pow": POWER}
BINDING |= dict.fromkeys(("lt", "le", "gt", "ge", "eq"), COMPARISON)


def show(expr: Expr) -> str:
    """The text of a tree, numbers in SI. Parsing it gives the same tree, if that was made by parsing."""
    texts: dict[int, tuple[str, int]] = {}
    for node in each_once(expr):
        texts[id(node)] = _text(node, texts)
    return texts[id(expr)][0]


def _text(node: Expr, texts: dict[int, tuple[str, int]]) -> tuple[str, int]:
    """The text of a node, and the precedence of its outermost operator."""

    def at_least(arg: Expr, binding: int) -> str:
        text, own = texts[id(arg)]
        return text if own >= binding else f"({text})"

    match node:
        case Number():
            return _number(node)
        case Name(parts=parts):
            return ".".join(parts), ATOM
        case Symbol(name=name):
            return name, ATOM
        case Link(task=task, output=output):
            return f"{task}.{output}", ATOM
        case Vector(items=items):
            return "[" + ", ".join(texts[id(item)][0] for item in items) + "]", ATOM
        case Keys(keys=keys, curve=curve):
            return f"{curve} curve through {len(keys)} keys", COMPARISON
        case Call(op="neg", args=(arg,)):
            return f"-{at_least(arg, SIGN)}", SIGN
        case Call(op=op, args=args) if op in BINDING:
            binding, sign = BINDING[op], OPERATIONS[op].infix
            # Powers group to the right, sums and products to the left, comparisons not at all.
            left, right = {POWER: (ATOM, SIGN), COMPARISON: (SUM, SUM)}.get(binding, (binding, binding + 1))
            gap = " " if binding <= SUM else ""
            return f"{at_least(args[0], left)}{gap}{sign}{gap}{at_least(args[1], right)}", binding
        case Call(op=op, args=args):
            return f"{op}({', '.join(texts[id(arg)][0] for arg in args)})", ATOM


def _number(number: Number) -> tuple[str, int]:
    dimension = number.type.dimension
    text = format_quantity(number.value, dimension)
    if dimension is not None and dimension.plain and not number.bare:
        text += " rad"
    # Unbracketed, a unit reads on over the sign behind it: `1 m/s` is a speed, `(1 m)/s` a length over the name s.
    if " " in text:
        return text, LITERAL
    return text, SIGN if number.value < 0 else ATOM
