"""The one table of operations of expressions, used by every evaluator, checker and printer.

A *primitive* has a function on floats, one of numpy, and (where it has one) its partial derivatives. A *composite* is
defined by a formula over primitives, from which every evaluator and its derivative follow. A *reduction* removes the
first axis of its one argument.
"""

from __future__ import annotations

import itertools
import math
import operator
from collections.abc import Callable
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

from sceneql.quantities import chance, composites, noise, partials, real, rules
from sceneql.quantities.expression import Expr, Type

MANY = 10_000
"""Limit on the number of arguments of a variadic operation: an expression has no room for more."""

CONSTANTS = {"pi": math.pi, "tau": math.tau, "e": math.e}
"""Named constants of every expression; a define of the same name takes precedence."""


@dataclass(frozen=True, slots=True)
class Operation:
    """One operation.

    ``rule`` returns the result's type from typed arguments or raises rules.MismatchError. ``partials(o, *args)``
    returns the partial derivatives in any arithmetic ``o``. ``formula(o, *args)``, for a reduction ``formula(o,
    items)``, defines a composite. ``vector_args`` flags the arguments of a composite that are vectors, passed as tuples
    of components. ``numpy`` names numpy's function. ``series``: whether it needs values over time. ``reduces``: with
    one argument it is a reduction. ``infix``: written as a sign, not called by its name. ``angle``: whether it returns
    radians. ``part_of``: the function whose formula uses it, and which a script calls instead.
    """

    name: str
    least: int
    most: int
    rule: Callable[[tuple[Expr, ...]], Type] = field(repr=False)
    python: Callable[..., float] | None = None
    numpy: str | None = None
    partials: Callable[..., tuple[Any, ...]] | None = None
    formula: Callable[..., Any] | None = None
    vector_args: tuple[bool, ...] = ()
    vector_result: bool = False
    series: bool = False
    reduces: bool = False
    infix: str | None = None
    angle: bool = False
    part_of: str | None = None

    @property
    def primitive(self) -> bool:
        """Whether evaluators have a function of their own for it."""
        return self.python is not None

    def takes(self, count: int) -> bool:
        """Whether it can have this many arguments."""
        return self.least <= count <= self.most

    def vectors(self, args: tuple[Expr, ...]) -> tuple[bool, ...]:
        """Which of the arguments are vectors; a plain number may stand for one where the rule allows it."""
        flags = self.vector_args or (False,) * len(args)
        return tuple(flag and bool(arg.type.shape) for flag, arg in zip(flags, args, strict=True))


def _infix(name: str, sign: str, rule: rules.Rule, python: Any, numpy: str, derivative: Any) -> Operation:
    count = 1 if name == "neg" else 2
    return Operation(name, count, count, rule, python, numpy, derivative, infix=sign)


def _compared(name: str, sign: str, python: Any, numpy: str) -> Operation:
    rule = rules.alike("cannot compare {a} and {b}", result_plain=True)
    return _infix(name, sign, rule, lambda a, b: float(python(a, b)), numpy, partials.flat)


def _plain(name: str, python: Any, numpy: str, derivative: Any, *, angle: bool = False) -> Operation:
    return Operation(name, 1, 1, rules.plain(name), python, numpy, derivative, angle=angle)


def _two_alike(name: str, python: Any, numpy: str, derivative: Any, *, angle: bool = False) -> Operation:
    rule = rules.some_alike(name, (0, 1), (), result_plain=angle)
    return Operation(name, 2, 2, rule, python, numpy, derivative, angle=angle)


def _of_noise(name: str, python: Any, derivative: Any, count: int) -> Operation:
    return Operation(name, count, count, rules.plain(name), python, partials=derivative, part_of="noise")


def _scalar(name: str, rule: rules.Rule, formula: Any, count: int) -> Operation:
    return Operation(name, count, count, rule, formula=formula, vector_args=(False,) * count)


def _vector(
    name: str, formula: Any, sizes: tuple[int | None, ...], result: tuple[int, ...], dimension: rules.Rule
) -> Operation:
    rule = rules.vectors(name, sizes, result, dimension)
    flags = tuple(size is not None for size in sizes)
    count = len(sizes)
    return Operation(name, count, count, rule, formula=formula, vector_args=flags, vector_result=bool(result))


def _reduction(name: str, rule: rules.Rule, formula: Any, numpy: str) -> Operation:
    return Operation(name, 1, 1, rule, numpy=numpy, formula=formula, reduces=True)


def _extreme(name: str, python: Any, derivative: Any) -> Operation:
    formula = composites.extreme(name)
    rule = rules.least_or_most(name)
    return Operation(name, 1, MANY, rule, python, f"{name}imum", derivative, formula, reduces=True)


def _series(name: str, rule: rules.Rule, count: int = 1) -> Operation:
    return Operation(name, count, count, rule, series=True)


_ORDERS = ["".join(axes) for axes in itertools.permutations("xyz")]
_about_rule = rules.vectors("about", (3, None), (4,), rules.signed)


def _turned(args: tuple[Expr, ...]) -> Type:
    rules.plain("the angle")((args[1],))
    return _about_rule(args)


_TABLE = (
    _infix("add", "+", rules.alike("cannot add {a} and {b}"), operator.add, "add", partials.add),
    _infix("sub", "-", rules.alike("cannot subtract {b} from {a}"), operator.sub, "subtract", partials.sub),
    _infix("mul", "*", rules.multiplied, operator.mul, "multiply", partials.mul),
    _infix("div", "/", rules.divided, real.div, "divide", partials.div),
    _infix("neg", "-", rules.kept, operator.neg, "negative", partials.neg),
    _infix("pow", "^", rules.raised, real.power, "power", partials.pow),
    _compared("lt", "<", operator.lt, "less"),
    _compared("le", "<=", operator.le, "less_equal"),
    _compared("gt", ">", operator.gt, "greater"),
    _compared("ge", ">=", operator.ge, "greater_equal"),
    _compared("eq", "==", operator.eq, "equal"),
    Operation("sqrt", 1, 1, rules.rooted, real.sqrt, "sqrt", partials.sqrt),
    Operation("abs", 1, 1, rules.kept, abs, "abs", partials.abs),
    Operation("sign", 1, 1, rules.signed, real.sign, "sign", partials.flat),
    _extreme("min", real.smallest, partials.min),
    _extreme("max", real.largest, partials.max),
    _plain("sin", real.sin, "sin", partials.sin),
    _plain("cos", real.cos, "cos", partials.cos),
    _plain("tan", real.tan, "tan", partials.tan),
    _plain("asin", real.asin, "arcsin", partials.asin, angle=True),
    _plain("acos", real.acos, "arccos", partials.acos, angle=True),
    _plain("atan", math.atan, "arctan", partials.atan, angle=True),
    _two_alike("atan2", math.atan2, "arctan2", partials.atan2, angle=True),
    _two_alike("hypot", math.hypot, "hypot", partials.hypot),
    _two_alike("mod", real.modulo, "mod", partials.mod),
    _plain("sinh", real.sinh, "sinh", partials.sinh),
    _plain("cosh", real.cosh, "cosh", partials.cosh),
    _plain("tanh", math.tanh, "tanh", partials.tanh),
    _plain("exp", real.exp, "exp", partials.exp),
    _plain("log", real.log, "log", partials.log),
    _plain("log10", real.log10, "log10", partials.log10),
    _plain("floor", real.floor, "floor", partials.flat),
    _plain("ceil", real.ceil, "ceil", partials.flat),
    _plain("round", real.nearest, "rint", partials.flat),
    Operation("where", 3, 3, rules.some_alike("where", (1, 2), (0,)), real.where, "where", partials.where),
    Operation("random", 1, 3, rules.plain("random"), chance.random, "random", partials.flat),
    Operation("noise", 1, 1, rules.noise, formula=composites.noise, vector_args=(True,)),
    _of_noise("noise_line", noise.noise_line, partials.noise_line, 2),
    _of_noise("noise_space", noise.noise_space, partials.noise_space, 4),
    _scalar("step", rules.some_alike("step", (0, 1), (), result_plain=True), composites.step, 2),
    _scalar("clamp", rules.some_alike("clamp", (0, 1, 2), ()), composites.clamp, 3),
    _scalar("mix", rules.some_alike("mix", (0, 1), (2,)), composites.mix, 3),
    _scalar("ease", rules.plain("ease"), composites.ease, 1),
    _scalar("smoothstep", rules.some_alike("smoothstep", (0, 1, 2), (), result_plain=True), composites.smoothstep, 3),
    _vector("dot", composites.dot, (0, 0), (), rules.multiplied),
    _vector("cross", composites.cross, (3, 3), (3,), rules.multiplied),
    _vector("length", composites.length, (0,), (), rules.kept),
    _vector("distance", composites.distance, (0, 0), (), rules.some_alike("distance", (0, 1), ())),
    Operation(
        "normalize", 1, 1, rules.normalized, formula=composites.normalize, vector_args=(True,), vector_result=True
    ),
    Operation("component", 2, 2, rules.chosen),
    Operation("item", 2, 2, rules.picked),
    Operation("about", 2, 2, _turned, formula=composites.about, vector_args=(True, False), vector_result=True),
    *(_vector(f"euler_{o}", composites.euler(o), (3,), (4,), rules.plain(f"euler_{o}")) for o in _ORDERS),
    _vector("turn", composites.turn, (4, 4), (4,), rules.plain("turn")),
    _vector("hue", composites.hue, (None,), (3,), rules.plain("hue")),
    _reduction("sum", rules.reduced, composites.total, "sum"),
    _reduction("mean", rules.reduced, composites.mean, "mean"),
    _reduction("norm", rules.normed, composites.norm, "norm"),
    _reduction("count", rules.counted, composites.count, "count"),
    _series("final", rules.kept),
    _series("initial", rules.kept),
    _series("at", rules.sampled, 2),
    _series("relative_drift", rules.signed),
    _series("spread", rules.kept),
)

OPERATIONS = {operation.name: operation for operation in _TABLE}
"""Every operation by its name."""

FUNCTIONS = tuple(sorted(operation.name for operation in _TABLE if not (operation.infix or operation.part_of)))
"""The names that a script may call."""

FLOATS = SimpleNamespace(**{operation.name: operation.python for operation in _TABLE if operation.primitive})
"""The arithmetic ``o`` of floats for derivatives and formulas."""
