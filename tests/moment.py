"""A moment and values for tests of words, without a run behind them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from itertools import product
from typing import Any

import numpy as np

from sceneql.field.tape.builder import TapeBuilder
from sceneql.field.tape.tape_solid import field_values
from sceneql.frame import Implicit, Quadric, Segments, Surface
from sceneql.kinds import Formula, Ref, Value
from sceneql.quantities.dimension import PLAIN
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Expr, Link, Number, Symbol, Type, Vector

IDENTITY = np.eye(3, 4)


def const(number: Any) -> Value:
    """A constant value: a number, or nested lists of numbers."""
    return Value(_tree(np.asarray(number, dtype=float)))


def _tree(number: Any) -> Expr:
    if number.ndim == 0:
        return Number(float(number))
    return Vector(tuple(_tree(item) for item in number), Type(number.shape, PLAIN))


def link(task: str, output: str, shape: tuple[int | None, ...] = ()) -> Value:
    """A link to another part's output."""
    return Value(Link(task, output, Type(shape, PLAIN)))


@dataclass
class FakeMoment:
    """An instant whose parts, outputs and bounds are given."""

    time: float = 0.0
    parts: Mapping[str, Any] = field(default_factory=dict)
    given: Mapping[tuple[str, str], Any] = field(default_factory=dict)
    box: tuple[Any, Any] = ((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0))
    room: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)

    rooms: tuple[tuple[float, Any], ...] = ()

    end: float = 1.0

    def at(self, value: Value) -> Any:
        return evaluate(value.expr, self._look_up, arrays=True)

    def _look_up(self, node: Symbol | Link) -> Any:
        return self.time if isinstance(node, Symbol) else self.read(node.task, node.output)

    def read(self, task: str, output: str) -> Any:
        return self.given[task, output]

    def object(self, ref: Ref) -> Any:
        return self.parts[ref.name]

    def place(self, name: str) -> Any:
        return IDENTITY

    def surface(self, name: str, material: Ref | None, color: Value | None) -> Surface:
        return Surface() if color is None else Surface(color=tuple(self.at(color)))

    def kept(self, name: str, key: Any, make: Callable[[], Any]) -> Any:
        return make()

    def bounds(self, names: Iterable[str]) -> tuple[Any, Any]:
        return np.array(self.box[0], dtype=float), np.array(self.box[1], dtype=float)

    def around(self) -> tuple[Any, Any] | None:
        return None

    def boxes(self) -> Any:
        return np.array([self.box], dtype=float)

    def outline(self) -> Any:
        return np.array(list(product(*zip(*self.box, strict=True))), dtype=float)

    def standing(self) -> Any:
        return self.outline()

    def left_out(self) -> Any:
        return np.zeros((0, 4))

    def moving(self, window: float | None) -> Any:
        return np.zeros((0, 4))


def fields_of(thing: Any, moment: FakeMoment, points: Any) -> Any:
    """An object's implicit field (n,) at points (n, 3) of its parent's coordinates."""
    build = TapeBuilder()
    return field_values(build.finish(thing.implicit(build, build.x, build.y, build.z, moment)), points)


def drawn(shapes: Iterable[Any], points: Any) -> Any:
    """Whether points (n, 3) of the world lie inside one of the solid shapes of a frame."""
    result = np.zeros(len(points), dtype=bool)
    for shape in shapes:
        result |= _INSIDE[type(shape)](shape, points)
    return result


def _in_quadric(shape: Quadric, points: Any) -> Any:
    p = points @ shape.to_local[:, :3].T + shape.to_local[:, 3]
    within = ((p >= shape.low) & (p <= shape.high)).all(axis=1)
    return within & ((p * p) @ shape.squares + p @ shape.linear + shape.constant <= 0)


def _in_implicit(shape: Implicit, points: Any) -> Any:
    return ((points >= shape.low) & (points <= shape.high)).all(axis=1) & (field_values(shape.tape, points) < 0)


def _in_segments(shape: Segments, points: Any) -> Any:
    return np.any([capsule(points, a, b) < r for (a, b), r in zip(shape.ends, shape.radii, strict=True)], axis=0)


def capsule(points: Any, a: Any, b: Any) -> Any:
    """Distance (n,) of points to a segment, by its ends and, between them, the component across."""
    along = b - a
    length = np.linalg.norm(along)
    away = points - a
    if length == 0:
        return np.linalg.norm(away, axis=1)
    s = away @ along / length
    between = np.linalg.norm(np.cross(away, along / length), axis=1)
    ends = np.minimum(np.linalg.norm(away, axis=1), np.linalg.norm(points - b, axis=1))
    return np.where((s > 0) & (s < length), between, ends)


_INSIDE: Mapping[type, Callable[[Any, Any], Any]] = {
    Quadric: _in_quadric,
    Implicit: _in_implicit,
    Segments: _in_segments,
}


def formula(text: str, symbols: tuple[str, ...] = ("x", "y", "z", "t")) -> Formula:
    """A formula bound as the checker binds it."""
    from sceneql.quantities.bind import bind
    from sceneql.quantities.diagnostic import Diagnostics
    from sceneql.quantities.parser import parse_expression
    from sceneql.quantities.span import Source, Span

    found = Diagnostics()
    tree = bind(
        parse_expression(text, Span(Source("test", text), 0, len(text))),
        lambda parts, span: Symbol("time" if parts == ("t",) else parts[0]) if parts[0] in symbols else None,
        found,
    )
    found.raise_errors()
    assert tree is not None
    return Formula(tree)
