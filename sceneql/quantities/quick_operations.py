"""The one table of operations: for each its type rule, its derivative, and its evaluation on floats and on arrays.

A new operation of the expression language is one entry here (and, to be used in implicit fields, one in the tape).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from sceneql.quantities import numeric
from sceneql.quantities.dimension import PLAIN, Dimension
from sceneql.quantities.expression import Call, Expr, Number, Shape, Type

TypeRule = Callable[[tuple[Expr, ...]], Type]
Partials = Callable[..., tuple[Expr | None, ...]]


class TypeMismatch(Exception):
    """Argument ``first`` (and ``second``) of an operation do not fit; indices into its arguments."""

    def __init__(self, message: str, first: int, second: int | None = None) -> None:
        super().__init__(message)
        self.first, self.second = first, second


@dataclass(frozen=True, slots=True)
class Operation:
    """An operation of the expression language."""

    name: str
    least: int
    most: int
    """Number of arguments."""
    rule: TypeRule
    python: Callable[..., Any]
    """On floats (elementwise ones) or on whole values as nested tuples (the others)."""
    arrays: str | Callable[..., Any]
    """The numpy function of that name, or a function of (numpy, *arguments)."""
    partials: Partials | None = None
    """Derivatives by the arguments, given them; None in the tuple: zero almost everywhere."""
    elementwise: bool = True
    reduces: bool = False
    """With one argument, makes one number of a list."""
    series: bool = False
    """Takes a quantity over time; evaluated by whoever has its series (`expect`)."""


# --- type rules ------------------------------------------------------------------------------------------------------


def broadcast(args: tuple[Expr, ...]) -> Shape:
    """The common shape: a scalar goes with everything, a vector with a list of vectors."""
    shape: Shape = ()
    for k, arg in enumerate(args):
        other = arg.type.shape
        if not shape or (len(other) > len(shape) and other[len(other) - len(shape) :] == shape):
            shape = other
        elif other and other != shape[len(shape) - len(other) :] and None not in (*other, *shape):
            raise TypeMismatch(f"{_shape(shape)} and {_shape(other)} do not go together", 0, k)
    return shape


def _shape(shape: Shape) -> str:
    return "a single value" if not shape else f"a vector of {shape[-1]}" if len(shape) == 1 else "a list of points"


def fits_any(arg: Expr) -> bool:
    """Whether an argument goes with every dimension: 0, or not known before the run."""
    return arg.type.dimension is None or (isinstance(arg, Number) and arg.value == 0 and arg.bare)


def common(args: tuple[Expr, ...]) -> Dimension | None:
    """The one dimension that all arguments have. Raises TypeMismatch."""
    first: int | None = None
    for k, arg in enumerate(args):
        if fits_any(arg):
            continue
        if first is None:
            first = k
        elif arg.type.dimension != args[first].type.dimension:
            raise TypeMismatch("", first, k)
    return args[first].type.dimension if first is not None else args[0].type.dimension if args else PLAIN


def _same(args: tuple[Expr, ...]) -> Type:
    return Type(broadcast(args), common(args))


def _plain_arguments(args: tuple[Expr, ...]) -> None:
    for k, arg in enumerate(args):
        if arg.type.dimension is not None and not arg.type.dimension.plain:
            raise TypeMismatch(f"needs a plain number, not {arg.type.dimension}", k)


def _plain(args: tuple[Expr, ...]) -> Type:
    _plain_arguments(args)
    return Type(broadcast(args), PLAIN)


def _ratio(args: tuple[Expr, ...]) -> Type:
    """Arguments of one dimension, a plain result: atan2, comparisons."""
    common(args)
    return Type(broadcast(args), PLAIN)


def _product(args: tuple[Expr, ...]) -> Type:
    a, b = args[0].type.dimension, args[1].type.dimension
    return Type(broadcast(args), None if a is None or b is None else a * b)


def _quotient(args: tuple[Expr, ...]) -> Type:
    a, b = args[0].type.dimension, args[1].type.dimension
    return Type(broadcast(args), None if a is None or b is None else a / b)


def _power(args: tuple[Expr, ...]) -> Type:
    base, exponent = args
    _plain_arguments((Number(0.0), exponent))
    dimension = base.type.dimension
    if dimension is not None and not dimension.plain:
        if not isinstance(exponent, Number):
            raise TypeMismatch(f"the exponent of a quantity in {dimension} must be a constant", 1)
        dimension = dimension ** Fraction(exponent.value).limit_denominator(12)
    return Type(broadcast(args), dimension)


def _root(args: tuple[Expr, ...]) -> Type:
    dimension = args[0].type.dimension
    return Type(args[0].type.shape, None if dimension is None else dimension ** Fraction(1, 2))


def _keep(args: tuple[Expr, ...]) -> Type:
    return args[0].type


def _sign(args: tuple[Expr, ...]) -> Type:
    return Type(args[0].type.shape, PLAIN)


def _where(args: tuple[Expr, ...]) -> Type:
    _plain_arguments(args[:1])
    return Type(broadcast(args), common((Number(0.0), *args[1:])) if not fits_any(args[1]) or not fits_any(args[2]) else PLAIN)


def _mix(args: tuple[Expr, ...]) -> Type:
    _plain_arguments((Number(0.0), Number(0.0), args[2]))
    return Type(broadcast(args), common(args[:2]))


def _smoothstep(args: tuple[Expr, ...]) -> Type:
    common(args)
    return Type(broadcast(args), PLAIN)


def _extreme(args: tuple[Expr, ...]) -> Type:
    """min, max: of several arguments elementwise, of one over the list."""
    return Type((), args[0].type.dimension) if len(args) == 1 else _same(args)


def _reduce(args: tuple[Expr, ...]) -> Type:
    return Type((), args[0].type.dimension)


def _count(args: tuple[Expr, ...]) -> Type:
    return Type((), PLAIN)


def _component(args: tuple[Expr, ...]) -> Type:
    return Type(args[0].type.shape[:-1], args[0].type.dimension)


def _vectors(args: tuple[Expr, ...]) -> None:
    for k, arg in enumerate(args):
        if not arg.type.shape or arg.type.shape[-1] not in (3, None):
            raise TypeMismatch(f"needs a vector of 3, not {_shape(arg.type.shape)}", k)


def _dot(args: tuple[Expr, ...]) -> Type:
    _vectors(args)
    return Type(broadcast(args)[:-1], _product(args).dimension)


def _cross(args: tuple[Expr, ...]) -> Type:
    _vectors(args)
    return _product(args)


def _length(args: tuple[Expr, ...]) -> Type:
    _vectors(args)
    return Type(args[0].type.shape[:-1], args[0].type.dimension)


def _normalize(args: tuple[Expr, ...]) -> Type:
    _vectors(args)
    return Type(args[0].type.shape, PLAIN)


def _distance(args: tuple[Expr, ...]) -> Type:
    _vectors(args)
    return Type(broadcast(args)[:-1], common(args))


def _quaternion(args: tuple[Expr, ...]) -> Type:
    _plain_arguments(args)
    return Type((4,), PLAIN)


def _rgb(args: tuple[Expr, ...]) -> Type:
    _plain_arguments(args)
    return Type((3,), PLAIN)


# --- building blocks of derivatives ----------------------------------------------------------------------------------

ONE, TWO = Number(1.0), Number(2.0)


def _n(value: float) -> Number:
    return Number(value)


def _c(op: str, *args: Expr) -> Expr:
    return Call(op, args)


def _mul(a: Expr, b: Expr) -> Expr:
    return _c("mul", a, b)


def _div(a: Expr, b: Expr) -> Expr:
    return _c("div", a, b)


def _sub(a: Expr, b: Expr) -> Expr:
    return _c("sub", a, b)


def _add(a: Expr, b: Expr) -> Expr:
    return _c("add", a, b)


def _neg(a: Expr) -> Expr:
    return _c("neg", a)


def _square(a: Expr) -> Expr:
    return _mul(a, a)


def _power_partials(a: Expr, b: Expr) -> tuple[Expr | None, ...]:
    by_base = _mul(b, _c("pow", a, _sub(b, ONE)))
    if isinstance(b, Number):
        return by_base, None
    return by_base, _mul(_c("pow", a, b), _c("log", a))


def _smoothstep_partials(a: Expr, b: Expr, x: Expr) -> tuple[Expr | None, ...]:
    s = _div(_sub(x, a), _sub(b, a))
    inside = _mul(_c("gt", s, _n(0.0)), _c("lt", s, ONE))
    slope = _div(_mul(inside, _mul(_n(6.0), _mul(s, _sub(ONE, s)))), _sub(b, a))
    return _mul(slope, _sub(s, ONE)), _neg(_mul(slope, s)), slope


def _ease_partials(x: Expr) -> tuple[Expr | None, ...]:
    inside = _mul(_c("gt", x, _n(0.0)), _c("lt", x, ONE))
    return (_mul(inside, _mul(_n(6.0), _mul(x, _sub(ONE, x)))),)


def _pick(condition: Expr, a: Expr, b: Expr) -> tuple[Expr | None, ...]:
    return None, _c("where", condition, ONE, _n(0.0)), _c("where", condition, _n(0.0), ONE)


# --- the table -------------------------------------------------------------------------------------------------------


def _table() -> dict[str, Operation]:
    rows: list[Operation] = []

    def row(
        name: str, count: int | tuple[int, int], rule: TypeRule, python: Any, arrays: Any, partials: Any = None, **kind: bool
    ) -> None:
        least, most = (count, count) if isinstance(count, int) else count
        rows.append(Operation(name, least, most, rule, python, arrays, partials, **kind))

    row("add", 2, _same, lambda a, b: a + b, "add", lambda a, b: (ONE, ONE))
    row("sub", 2, _same, lambda a, b: a - b, "subtract", lambda a, b: (ONE, _n(-1.0)))
    row("mul", 2, _product, lambda a, b: a * b, "multiply", lambda a, b: (b, a))
    row("div", 2, _quotient, numeric.divide, "divide", lambda a, b: (_div(ONE, b), _neg(_div(a, _square(b)))))
    row("neg", 1, _keep, lambda a: -a, "negative", lambda a: (_n(-1.0),))
    row("pow", 2, _power, numeric.power, "power", _power_partials)
    row("sqrt", 1, _root, numeric.guarded(math.sqrt), "sqrt", lambda a: (_div(_n(0.5), _c("sqrt", a)),))
    row("abs", 1, _keep, abs, "abs", lambda a: (_c("sign", a),))
    row("sign", 1, _sign, numeric.sign, "sign", lambda a: (None,))
    row("floor", 1, _plain, numeric.guarded(numeric.floor), "floor", lambda a: (None,))
    row("ceil", 1, _plain, numeric.guarded(numeric.ceil), "ceil", lambda a: (None,))
    row("round", 1, _plain, numeric.guarded(numeric.rounded), "rint", lambda a: (None,))
    row("mod", 2, _same, numeric.modulo, "mod", lambda a, b: (ONE, _neg(_c("floor", _div(a, b)))))
    row("exp", 1, _plain, numeric.exp, "exp", lambda a: (_c("exp", a),))
    row("log", 1, _plain, numeric.log, "log", lambda a: (_div(ONE, a),))
    row("log10", 1, _plain, numeric.log10, "log10", lambda a: (_div(_n(1 / math.log(10)), a),))
    row("sin", 1, _plain, numeric.guarded(math.sin), "sin", lambda a: (_c("cos", a),))
    row("cos", 1, _plain, numeric.guarded(math.cos), "cos", lambda a: (_neg(_c("sin", a)),))
    row("tan", 1, _plain, numeric.guarded(math.tan), "tan", lambda a: (_add(ONE, _square(_c("tan", a))),))
    root = lambda a: _c("sqrt", _sub(ONE, _square(a)))  # noqa: E731
    row("asin", 1, _plain, numeric.guarded(math.asin), "arcsin", lambda a: (_div(ONE, root(a)),))
    row("acos", 1, _plain, numeric.guarded(math.acos), "arccos", lambda a: (_div(_n(-1.0), root(a)),))
    row("atan", 1, _plain, math.atan, "arctan", lambda a: (_div(ONE, _add(ONE, _square(a))),))
    square_sum = lambda a, b: _add(_square(a), _square(b))  # noqa: E731
    row(
        "atan2", 2, _ratio, math.atan2, "arctan2",
        lambda a, b: (_div(b, square_sum(a, b)), _neg(_div(a, square_sum(a, b)))),
    )  # fmt: skip
    row("sinh", 1, _plain, numeric.sinh, "sinh", lambda a: (_c("cosh", a),))
    row("cosh", 1, _plain, numeric.cosh, "cosh", lambda a: (_c("sinh", a),))
    row("tanh", 1, _plain, math.tanh, "tanh", lambda a: (_sub(ONE, _square(_c("tanh", a))),))
    row("hypot", 2, _same, math.hypot, "hypot", lambda a, b: (_div(a, _c("hypot", a, b)), _div(b, _c("hypot", a, b))))
    row("step", 2, _smoothstep, lambda edge, x: float(x >= edge), lambda np, e, x: 1.0 * (x >= e), lambda e, x: (None, None))
    row(
        "clamp", 3, _same, numeric.clamp, lambda np, x, low, high: np.minimum(np.maximum(x, low), high),
        lambda x, a, b: (_mul(_c("gt", x, a), _c("lt", x, b)), _c("le", x, a), _c("ge", x, b)),
    )  # fmt: skip
    row(
        "mix", 3, _mix, lambda a, b, s: a + (b - a) * s, lambda np, a, b, s: a + (b - a) * s,
        lambda a, b, s: (_sub(ONE, s), s, _sub(b, a)),
    )  # fmt: skip
    row("smoothstep", 3, _smoothstep, numeric.smoothstep, numeric.smoothstep_arrays, _smoothstep_partials)
    row("ease", 1, _plain, numeric.ease, lambda np, x: numeric.smoothstep_arrays(np, 0.0, 1.0, x), _ease_partials)
    for name, python, arrays in (
        ("lt", lambda a, b: float(a < b), "less"),
        ("le", lambda a, b: float(a <= b), "less_equal"),
        ("gt", lambda a, b: float(a > b), "greater"),
        ("ge", lambda a, b: float(a >= b), "greater_equal"),
        ("eq", lambda a, b: float(a == b), "equal"),
    ):
        row(name, 2, _ratio, python, numeric.as_float(arrays), lambda a, b: (None, None))
    row("where", 3, _where, lambda c, a, b: a if c else b, lambda np, c, a, b: np.where(c, a, b), _pick)
    row("random", (1, 2), _plain, numeric.random, numeric.random_arrays)

    row("min", (1, 16), _extreme, min, lambda np, *a: numeric.fold(np.minimum, a) if len(a) > 1 else np.min(a[0]),
        lambda *a: (_c("le", a[0], a[1]), _c("gt", a[0], a[1])), reduces=True)  # fmt: skip
    row("max", (1, 16), _extreme, max, lambda np, *a: numeric.fold(np.maximum, a) if len(a) > 1 else np.max(a[0]),
        lambda *a: (_c("ge", a[0], a[1]), _c("lt", a[0], a[1])), reduces=True)  # fmt: skip
    whole = {"elementwise": False}
    row("sum", 1, _reduce, lambda a: math.fsum(numeric.flat(a)), lambda np, a: np.sum(a), reduces=True, **whole)
    row("mean", 1, _reduce, lambda a: numeric.mean(numeric.flat(a)), lambda np, a: np.mean(a), reduces=True, **whole)
    row("count", 1, _count, len, lambda np, a: float(np.shape(a)[0]), reduces=True, **whole)

    row("component", 2, _component, numeric.component, lambda np, a, k: np.asarray(a)[..., int(k)], **whole)
    row("dot", 2, _dot, numeric.dot, lambda np, a, b: np.sum(np.multiply(a, b), axis=-1), **whole)
    row("cross", 2, _cross, numeric.cross, lambda np, a, b: np.cross(a, b), **whole)
    row("length", 1, _length, numeric.length, lambda np, a: np.linalg.norm(a, axis=-1), **whole)
    row("normalize", 1, _normalize, numeric.normalize, numeric.normalize_arrays, **whole)
    row("distance", 2, _distance, lambda a, b: numeric.length(numeric.minus(a, b)),
        lambda np, a, b: np.linalg.norm(np.subtract(a, b), axis=-1), **whole)  # fmt: skip
    by_tuple = numeric.by_tuple
    row("about", 2, _quaternion, numeric.about, by_tuple(numeric.about), **whole)
    for order in ("xyz", "xzy", "yxz", "yzx", "zxy", "zyx"):
        turn = numeric.euler(order)
        row(f"euler_{order}", 1, _quaternion, turn, by_tuple(turn), **whole)
    row("turn", 2, _quaternion, numeric.quaternion_product, by_tuple(numeric.quaternion_product), **whole)
    row("hue", 1, _rgb, numeric.hue, by_tuple(numeric.hue), **whole)

    for name in ("final", "initial", "spread"):
        row(name, 1, _keep, numeric.no_series, numeric.no_series, series=True, **whole)
    row("relative_drift", 1, _sign, numeric.no_series, numeric.no_series, series=True, **whole)
    row("at", 2, _keep, numeric.no_series, numeric.no_series, series=True, **whole)
    return {operation.name: operation for operation in rows}


OPERATIONS: Mapping[str, Operation] = _table()
CONSTANTS: Mapping[str, float] = {"pi": math.pi, "tau": math.tau, "e": math.e}
"""Textbook constants, known as names."""
