"""Expressions of time: shifted in time, and their rates of change, exact or by central differences."""

from __future__ import annotations

from collections.abc import Callable
from math import inf

from sceneql.quantities.derivative import differentiate
from sceneql.quantities.dimension import PLAIN, TIME
from sceneql.quantities.expression import (
    TIME_SYMBOL,
    Call,
    Expr,
    Keys,
    Link,
    Number,
    Symbol,
    Type,
    Vector,
    children,
    each_once,
    rebuilt,
)

APART = 1e-4
"""Seconds to either side for a central difference: its error is APART^2/6 times the third derivative."""

MOST_KEYS = 64
"""Most keys of a value whose derivative is formed exactly: it would be too large a formula."""


def later(expr: Expr, by: float, follow: Callable[[Link], Expr | None] = lambda link: None) -> Expr:
    """The expression at time t + ``by`` [s]. ``follow`` returns a linked output as an expression of time, or None.

    Raises ValueError for a link to an output that is no function of time.
    """

    meanings: dict[Link, Expr] = {}

    def shifted(old: Expr, node: Expr) -> Expr:
        match node:
            case Symbol(name=name) if name == TIME_SYMBOL:
                return Call("add", (node, Number(by, Type((), TIME), False)), node.type, node.span) if by else node
            case Link(task=task, output=output):
                if node not in meanings:
                    meaning = follow(node)
                    if meaning is None:
                        raise ValueError(f"{task}.{output} is not known as a function of time")
                    meanings[node] = rebuilt(meaning, shifted)
                return meanings[node]
        return node

    return rebuilt(expr, shifted)


def goes_evenly(expr: Expr, follow: Callable[[Link], Expr | None]) -> bool:
    """Whether an expression is known to be linear in time; ``follow`` as in `later`."""

    meanings: dict[Link, float] = {}

    def degree(expr: Expr) -> float:
        """Degree as a polynomial of the time; infinite where it is not known to be one."""
        known: dict[int, float] = {}
        for node in each_once(expr):
            known[id(node)] = of_node(node, [known[id(child)] for child in children(node)])
        return known[id(expr)]

    def of_node(node: Expr, below: list[float]) -> float:
        match node:
            case Number():
                return 0.0
            case Symbol(name=name) if name == TIME_SYMBOL:
                return 1.0
            case Link():
                if node not in meanings:
                    meaning = follow(node)
                    meanings[node] = inf if meaning is None else degree(meaning)
                return meanings[node]
            case Vector() | Call(op="add" | "sub" | "neg" | "component"):
                return max(below)
            case Call(op="mul"):
                return sum(below)
            case Call(op="div") if below[1] == 0.0:
                return below[0]
            case Call() if not any(below):
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
