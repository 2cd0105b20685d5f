"""The typed expression tree that every value of a script becomes.

Nodes are frozen; spans do not count in equality.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal, cast

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
    computed: bool = field(default=False, compare=False)
    """Whether the part computes the output from its state, where it is not stored."""


class Shared:
    """A node with children, which may be shared: a ``define`` that is used twice is one subtree.

    So a script of n lines has trees of about n nodes that would have 2^n if written out. Comparison and hashing take
    time linear in the number of distinct nodes, without recursion.
    """

    __slots__ = ("_hash",)
    _hash: int

    def __hash__(self) -> int:
        if not hasattr(self, "_hash"):
            _hash_all(cast("Expr", self))
        return self._hash

    def __eq__(self, other: object) -> bool:
        return _same(cast("Expr", self), cast("Expr", other)) if isinstance(other, Shared) else NotImplemented


@dataclass(frozen=True, slots=True, eq=False)
class Call(Shared):
    """An operation of the one table (operations.py) on arguments; ``+`` is ``add``, ``a.x`` is ``component`` and 0."""

    op: str
    args: tuple[Expr, ...]
    type: Type = SCALAR
    span: Span | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True, eq=False)
class Vector(Shared):
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


@dataclass(frozen=True, slots=True, eq=False)
class Keys(Shared):
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
    """The distinct nodes of an expression (by identity), each before those below it: a shared subtree once."""
    stack: list[Expr] = [expr]
    known: set[int] = set()
    while stack:
        node = stack.pop()
        if id(node) not in known:
            known.add(id(node))
            yield node
            if parts := children(node):
                stack.extend(reversed(parts))


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
            if parts := below(node):
                stack.append((node, True))
                stack.extend([(child, False) for child in reversed(parts)])
            else:
                order.append(node)
    return order


def holders(test: Callable[[Expr], bool], *roots: Expr) -> set[int]:
    """The ids of the nodes that pass a test, or that have one below them that does."""
    found: set[int] = set()
    for node in each_once(*roots):
        if test(node) or any(id(child) in found for child in children(node)):
            found.add(id(node))
    return found


def rebuilt(
    expr: Expr, make: Callable[[Expr, Expr], Expr], below: Callable[[Expr], tuple[Expr, ...]] = children
) -> Expr:
    """The tree with each distinct node replaced once, from the leaves up; shared subtrees stay shared.

    ``make(old, new)`` gets a node, and the node with its replaced children. ``below``: the children to descend to.
    """
    made: dict[int, Expr] = {}
    for node in each_once(expr, below=below):
        made[id(node)] = make(node, _with_children(node, made))
    return made[id(expr)]


def recursive(step: Callable[[Expr], Generator[Expr, Any, Any]], expr: Expr) -> Any:
    """The result of a recursive function on trees, called once for each distinct node, to any depth."""
    known: dict[int, tuple[Expr, Any]] = {}  # with the nodes themselves, so that no other gets the id of one
    stack = [(expr, step(expr))]
    value: Any = None
    while stack:
        node, running = stack[-1]
        try:
            child = running.send(value)
        except StopIteration as end:
            value = end.value
            known[id(node)] = node, value
            stack.pop()
            continue
        if id(child) in known:
            value = known[id(child)][1]
        else:
            stack.append((child, step(child)))
            value = None
    return value


def _with_children(node: Expr, made: Mapping[int, Expr]) -> Expr:
    """A node with its children replaced by those in ``made`` (by id); the node itself where none differs."""
    if all(made.get(id(child), child) is child for child in children(node)):
        return node

    def new(child: Any) -> Any:
        return None if child is None else made.get(id(child), child)

    match node:
        case Call(args=args):
            return replace(node, args=tuple(map(new, args)))
        case Vector(items=items):
            return replace(node, items=tuple(map(new, items)))
        case Keys(argument=argument, keys=keys, cycle=cycle):
            parts = tuple(Key(new(k.time), new(k.value), new(k.slope_in), new(k.slope_out)) for k in keys)
            return replace(node, argument=new(argument), keys=keys if parts == keys else parts, cycle=new(cycle))
    return node


def _own(node: Expr) -> Any:
    """The attributes of a node besides its children, for comparison."""
    match node:
        case Call(op=op, args=args, type=of):
            return Call, op, len(args), of
        case Vector(items=items, type=of):
            return Vector, len(items), of
        case Keys(keys=keys, curve=curve, cycle=cycle, type=of):
            given = tuple((key.slope_in is None, key.slope_out is None) for key in keys)
            return Keys, given, curve, cycle is None, of
    return node


def _hash_all(expr: Expr) -> None:
    for node in each_once(expr, below=lambda node: () if hasattr(node, "_hash") else children(node)):
        if isinstance(node, Shared) and not hasattr(node, "_hash"):
            object.__setattr__(node, "_hash", hash((_own(node), tuple(map(hash, children(node))))))


def _same(one: Expr, other: Expr) -> bool:
    stack, known = [(one, other)], set[tuple[int, int]]()
    while stack:
        a, b = stack.pop()
        if a is b or (id(a), id(b)) in known:
            continue
        known.add((id(a), id(b)))
        if hash(a) != hash(b) or _own(a) != _own(b):
            return False
        stack.extend(zip(children(a), children(b), strict=True))
    return True
