"""The typed expression tree: what every value of a script becomes. Frozen nodes; spans take no part in equality."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Literal

from sceneql.quantities.dimension import PLAIN, Dimension
from sceneql.quantities.span import Span

Shape = tuple[int | None, ...]
"""``()`` a scalar, ``(3,)`` a vector, ``(4,)`` a quaternion [w, x, y, z], ``(None,)`` a list, ``(None, 3)`` points."""


@dataclass(frozen=True, slots=True)
class Type:
    """Shape and dimension. ``dimension`` None: any (the literal 0, or not known before the run)."""

    shape: Shape = ()
    dimension: Dimension | None = PLAIN


SCALAR = Type()


@dataclass(frozen=True, slots=True)
class Number:
    """A literal, already in SI. ``bare``: it was written without a unit (and so may stand for SI of any dimension)."""

    value: float
    type: Type = SCALAR
    bare: bool = True
    span: Span | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True)
class Name:
    """A dotted name as written; only in trees that are not yet bound."""

    parts: tuple[str, ...]
    span: Span | None = field(default=None, compare=False)
    type: Type = SCALAR


@dataclass(frozen=True, slots=True)
class Symbol:
    """A free variable of a bound tree: ``time``, a coordinate ``x``, a state of `equations`, a copy index."""

    name: str
    type: Type = SCALAR
    span: Span | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True)
class Link:
    """An output of another part, at the time asked: ``cage.positions`` is Link("cage", "positions")."""

    task: str
    output: str
    type: Type = SCALAR
    span: Span | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True)
class Call:
    """An operation of the one table (operations.py) on arguments; ``+`` is ``add``, ``a.x`` is ``component`` and 0."""

    op: str
    args: tuple[Expr, ...]
    type: Type = SCALAR
    span: Span | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True)
class Vector:
    """Components written side by side: ``[a, b, c]`` or ``0 1.2 0 m``; items may be vectors for a list of points."""

    items: tuple[Expr, ...]
    type: Type = SCALAR
    span: Span | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True)
class Key:
    """One keyframe: the value at ``time``, and for `cubic` the slopes before and after (None: from the neighbors)."""

    time: Expr
    value: Expr
    slope_in: Expr | None = None
    slope_out: Expr | None = None


@dataclass(frozen=True, slots=True)
class Keys:
    """Keyframes over ``argument`` (the symbol time unless said). Times are constant expressions that increase.

    ``curve``: `step` holds, `linear`, `smooth` (cubic with zero slope at every key: ease in and out), `cubic`
    (given slopes; Catmull-Rom where not given). Quaternion values (shape (4,)) are interpolated by slerp, under
    `smooth` with eased parameter. ``cycle`` repeats with that period; before the first and after the last key the
    value is held.
    """

    argument: Expr
    keys: tuple[Key, ...]
    curve: Literal["step", "linear", "smooth", "cubic"] = "smooth"
    cycle: Expr | None = None
    type: Type = SCALAR
    span: Span | None = field(default=None, compare=False)


Expr = Number | Name | Symbol | Link | Call | Vector | Keys

TIME_SYMBOL = "time"


def children(expr: Expr) -> tuple[Expr, ...]:
    """The direct sub-expressions."""
    match expr:
        case Call(args=args):
            return args
        case Vector(items=items):
            return items
        case Keys(argument=argument, keys=keys, cycle=cycle):
            parts: list[Expr] = [argument]
            for key in keys:
                parts += [key.time, key.value]
                parts += [slope for slope in (key.slope_in, key.slope_out) if slope is not None]
            return tuple(parts if cycle is None else [*parts, cycle])
    return ()


def walk(expr: Expr) -> Iterator[Expr]:
    """The expression and all nodes below it, a shared node once for every place where it occurs."""
    stack = [expr]
    while stack:
        node = stack.pop()
        yield node
        stack.extend(reversed(children(node)))


def each_once(*roots: Expr, below: Callable[[Expr], tuple[Expr, ...]] = children) -> list[Expr]:
    """All distinct nodes (by identity) in topological order, children first: a shared subtree is listed once.

    ``below`` gives the children to descend to.
    """
    order: list[Expr] = []
    known: set[int] = set()
    stack: list[tuple[Expr, bool]] = [(root, False) for root in reversed(roots)]
    while stack:
        node, ready = stack.pop()
        if ready:
            order.append(node)
        elif id(node) not in known:
            known.add(id(node))
            stack.append((node, True))
            stack.extend((child, False) for child in reversed(below(node)))
    return order
