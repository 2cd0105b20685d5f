"""Expressions of time, shifted a little, for rates of change of any motion by differences."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import inf

from sceneql.quantities.derivative import differentiate
from sceneql.quantities.dimension import PLAIN, TIME
from sceneql.quantities.expression import (
    TIME_SYMBOL,
    Call,
    Expr,
    Key,
    Keys,
    Link,
    Number,
    Symbol,
    Type,
    Vector,
    each_once,
)

APART = 1e-4
"""Seconds to either side for a central difference: its error is APART^2/6 times the third derivative."""

MOST_KEYS = 64
"""Keys of a value above which its derivative would be too large a formula."""


def later(expr: Expr, by: float, follow: Callable[[Link], Expr | None] = lambda link: None) -> Expr:
    """The value ``by`` [s] later. ``follow`` gives a linked output as an expression of time.

    Raises ValueError for a link to something that is not a function of time.
    """

    def shifted(node: Expr) -> Expr:
        match node:
            case Symbol(name=name) if name == TIME_SYMBOL:
                return Call("add", (node, Number(by, Type((), TIME), False)), node.type, node.span) if by else node
            case Link(task=task, output=output):
                meaning = follow(node)
                if meaning is None:
                    raise ValueError(f"{task}.{output} is not known as a function of time")
                return shifted(meaning)
            case Call(args=args):
                return replace(node, args=tuple(shifted(arg) for arg in args))
            case Vector(items=items):
                return replace(node, items=tuple(shifted(item) for item in items))
            case Keys(argument=argument, keys=keys):
                return replace(node, argument=shifted(argument), keys=tuple(shifted_key(key) for key in keys))
        return node

    def shifted_key(key: Key) -> Key:
        slopes = [None if slope is None else shifted(slope) for slope in (key.slope_in, key.slope_out)]
        return Key(key.time, shifted(key.value), *slopes)

    return shifted(expr)


def goes_evenly(expr: Expr, follow: Callable[[Link], Expr | None]) -> bool:
    """Whether an expression is known to be linear in time; ``follow`` as in `later`."""

    def degree(node: Expr) -> float:
        """Degree of a node as a polynomial of the time; infinite where it is not known to be one."""
        match node:
            case Number():
                return 0.0
            case Symbol(name=name) if name == TIME_SYMBOL:
                return 1.0
            case Link():
                meaning = follow(node)
                return inf if meaning is None else degree(meaning)
            case Vector(items=items):
                return max(map(degree, items))
            case Call(op="add" | "sub" | "neg" | "component", args=args):
                return max(map(degree, args))
            case Call(op="mul", args=args):
                return sum(map(degree, args))
            case Call(op="div", args=(above, below)) if degree(below) == 0.0:
                return degree(above)
            case Call(args=args) if not any(map(degree, args)):
                return 0.0
        return inf

    return degree(expr) <= 1.0


def exact_rate(expr: Expr, follow: Callable[[Link], Expr | None] = lambda link: None) -> Expr | None:
    """d expr / d time by the rules of derivatives, with plain types; ``follow`` as in `later`.

    None where an operation has no derivative, and for keyframes of rotations or of more than MOST_KEYS keys.

    Raises ValueError for a link to something that is not a function of time.
    """
    found = later(expr, 0.0, follow)
    nodes = each_once(found)
    if any(isinstance(node, Keys) and (node.type.shape == (4,) or len(node.keys) > MOST_KEYS) for node in nodes):
        return None
    times = [node for node in nodes if isinstance(node, Symbol) and node.name == TIME_SYMBOL]
    try:
        return differentiate(found, times[0] if times else Symbol(TIME_SYMBOL))
    except TypeError:
        return None


def rate_of_change(expr: Expr, follow: Callable[[Link], Expr | None] = lambda link: None) -> Expr:
    """d expr / d time as a central difference, for expressions and keyframes alike; ``follow`` as in `later`.

    Raises ValueError for a link to something that is not a function of time.
    """
    dimension = PLAIN if expr.type.dimension is None else expr.type.dimension
    difference = Call("sub", (later(expr, APART, follow), later(expr, -APART, follow)), expr.type)
    return Call("div", (difference, Number(2 * APART, Type((), TIME), False)), Type(expr.type.shape, dimension / TIME))
