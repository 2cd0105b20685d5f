"""Type rules: the shape and dimension of an operation's result from its arguments, or a MismatchError.

Shapes broadcast from the last axis: a scalar goes with anything, a vector (3,) with a list of points (None, 3). A
dimension of None (the literal 0, or not known before the run) goes with anything.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from math import prod

from sceneql.quantities.dimension import PLAIN, TIME, Dimension, common
from sceneql.quantities.expression import Call, Expr, Number, Shape, Symbol, Type, Vector
from sceneql.quantities.units import describe, format_quantity, unit_of

Args = tuple[Expr, ...]
Rule = Callable[[Args], Type]
LARGEST_POWER = 100
TURNS = ("sin", "cos", "tan")
FEWEST_DEGREES = 15.0
"""A bare number that is a multiple of it is most likely meant in degrees."""
"""Functions of an angle."""
MOST_AXES, MOST_NUMBERS = 6, 1_000_000
"""Limits on lists in an expression: with defines that hold one another twice, lists would double with each line."""


class MismatchError(Exception):
    """Arguments whose types do not match; ``first`` and ``second`` are their indices.

    ``better``: the index of an argument and the text that it should have.
    """

    def __init__(
        self,
        code: str,
        message: str,
        first: int,
        second: int | None = None,
        help: str | None = None,
        better: tuple[int, str] | None = None,
    ) -> None:
        super().__init__(message)
        self.code, self.message, self.first, self.second, self.help = code, message, first, second, help
        self.better = better


def broadcast(shapes: tuple[Shape, ...]) -> Shape:
    """The common shape. Raises MismatchError (`shape-mismatch`)."""
    result: Shape = ()
    first = 0
    for index, shape in enumerate(shapes):
        rank = min(len(result), len(shape))
        pairs = zip(result[len(result) - rank :], shape[len(shape) - rank :], strict=True)
        if any((a is None) != (b is None) or a != b for a, b in pairs):
            message = f"{shape_text(result)} and {shape_text(shape)} do not go together"
            raise MismatchError("shape-mismatch", message, first, index)
        if len(shape) > len(result):
            result, first = shape, index
    return result


def shape_text(shape: Shape) -> str:
    """A shape in words."""
    if not shape:
        return "a single value"
    sizes = ["any number" if size is None else str(size) for size in shape]
    return f"a list of {' by '.join(sizes)} values" if None in shape or len(shape) > 1 else f"a vector of {sizes[0]}"


def common_dimension(args: Args, indices: tuple[int, ...], sentence: str) -> Dimension | None:
    """The common dimension of the arguments ``indices``; ``sentence``: the error's text, with {a} and {b}."""
    first: int | None = None
    for index in indices:
        dimension = args[index].type.dimension
        if dimension is None:
            continue
        if first is None:
            first = index
        elif dimension != args[first].type.dimension:
            raise _differ(args, first, index, sentence)
    return common(args[index].type.dimension for index in indices)


def _differ(args: Args, first: int, second: int, sentence: str) -> MismatchError:
    kinds = [args[k].type.dimension for k in (first, second)]
    better = None
    for index, other in ((first, kinds[1]), (second, kinds[0])):
        arg = args[index]
        if isinstance(arg, Number) and arg.bare and other is not None and not other.plain:
            # A number by name, such as a copy's, keeps its name.
            named = arg.span is not None and arg.span.text.isidentifier()
            better = index, f"{{}}*{format_quantity(1.0, other)}" if named else format_quantity(arg.value, other)
        elif isinstance(arg, Vector) and other is not None and not other.plain:
            items = [one.value for one in arg.items if isinstance(one, Number) and one.bare]
            if len(items) == len(arg.items):
                better = index, f"[{', '.join(format_quantity(one, other) for one in items)}]"
    message = sentence.format(a=describe(kinds[0]), b=describe(kinds[1]))
    return MismatchError("dimension-mismatch", message, first, second, better=better)


def _shape(args: Args) -> Shape:
    return broadcast(tuple(arg.type.shape for arg in args))


def _plain(args: Args, indices: tuple[int, ...], name: str) -> None:
    for index in indices:
        dimension = args[index].type.dimension
        if dimension is not None and not dimension.plain:
            message = f"{name} needs a plain number, not {describe(dimension)}"
            help = "divide it by a quantity of its kind first"
            if name in TURNS and dimension == TIME and (rate := _rate(args[index])) is not None:
                help = "a speed times the time is an angle"
                raise MismatchError("dimension-mismatch", message, index, None, help, (index, f"{rate}/s*time"))
            raise MismatchError(
                "dimension-mismatch", message, index, None, help, (index, f"{{}}/(1 {unit_of(dimension)})")
            )


def _rate(angle: Expr) -> str | None:
    """The angle a second that is meant by ``time``, ``2*time`` or ``time/2``, as ``2 rad``; None for others."""
    match angle:
        case Symbol():
            rate = 1.0
        case Call("neg", (Symbol(),)):
            rate = -1.0
        case Call("mul", (Number(bare=True) as number, Symbol())) if _literal(number):
            rate = number.value
        case Call("mul", (Symbol(), Number(bare=True) as number)) if _literal(number):
            rate = number.value
        case Call("div", (Symbol(), Number(bare=True) as number)) if _literal(number) and number.value:
            rate = 1.0 / number.value
        case _:
            return None
    return f"{rate:.6g} {'deg' if rate and rate % FEWEST_DEGREES == 0 else 'rad'}"


def _literal(number: Number) -> bool:
    """Whether a number stands there by itself, and is no name, and no product that was folded to one."""
    return number.span is not None and number.span.text.replace(".", "", 1).isdecimal()


def alike(sentence: str, *, result_plain: bool = False) -> Rule:
    """Rule of an operation on arguments of one dimension, which the result has too unless it is plain."""

    def rule(args: Args) -> Type:
        dimension = common_dimension(args, tuple(range(len(args))), sentence)
        return Type(_shape(args), PLAIN if result_plain else dimension)

    return rule


def plain(name: str) -> Rule:
    """Rule of a function of plain numbers whose result is plain."""

    def rule(args: Args) -> Type:
        _plain(args, tuple(range(len(args))), name)
        return Type(_shape(args), PLAIN)

    return rule


def some_alike(name: str, same: tuple[int, ...], others: tuple[int, ...], *, result_plain: bool = False) -> Rule:
    """Rule of an operation whose arguments ``same`` have one dimension, and whose ``others`` are plain."""
    sentence = f"{name} needs quantities of one kind, not {{a}} and {{b}}"

    def rule(args: Args) -> Type:
        _plain(args, others, name)
        dimension = common_dimension(args, same, sentence)
        return Type(_shape(args), PLAIN if result_plain else dimension)

    return rule


def multiplied(args: Args) -> Type:
    """Type of a product."""
    a, b = args[0].type.dimension, args[1].type.dimension
    return _limited(Type(_shape(args), None if a is None or b is None else a * b))


def divided(args: Args) -> Type:
    """Type of a quotient."""
    a, b = args[0].type.dimension, args[1].type.dimension
    return _limited(Type(_shape(args), None if a is None or b is None else a / b))


def kept(args: Args) -> Type:
    """The result has the type of the first argument."""
    return args[0].type


def signed(args: Args) -> Type:
    """The shape of the first argument, plain."""
    return Type(args[0].type.shape, PLAIN)


def rooted(args: Args) -> Type:
    """Type of a square root."""
    dimension = args[0].type.dimension
    return _limited(Type(args[0].type.shape, None if dimension is None else dimension ** Fraction(1, 2)))


def raised(args: Args) -> Type:
    """Type of a power; a base with a dimension needs a constant exponent that is a simple fraction."""
    base, exponent = args
    shape = _shape(args)
    _plain(args, (1,), "an exponent")
    dimension = base.type.dimension
    if dimension is None or dimension.plain:
        return Type(shape, None if dimension is None else PLAIN)
    if not isinstance(exponent, Number):
        message = f"{describe(dimension)} needs a constant exponent"
        raise MismatchError("dimension-mismatch", message, 1, 0, "divide the base by a quantity of its kind first")
    if not abs(exponent.value) <= LARGEST_POWER:
        raise MismatchError("dimension-mismatch", f"an exponent of a quantity is at most {LARGEST_POWER}", 1)
    power = Fraction(exponent.value).limit_denominator(60)
    if abs(float(power) - exponent.value) > 1e-12 * max(1.0, abs(exponent.value)):
        raise MismatchError("dimension-mismatch", "an exponent of a quantity is a simple fraction, such as 3/2", 1)
    return _limited(Type(shape, dimension**power))


def _limited(result: Type) -> Type:
    exponents = () if result.dimension is None else result.dimension.exponents
    # By whole numbers: to compare fractions takes ten times as long.
    if any(e.denominator > 1000 or abs(e.numerator) > 1000 * e.denominator for e in exponents):
        raise MismatchError("dimension-mismatch", "the dimension of this has absurdly large exponents", 0)
    return result


def noise(args: Args) -> Type:
    """A plain number, or a vector of 2 or 3 plain numbers, whose outer axes are kept."""
    _plain(args, (0,), "noise")
    shape = args[0].type.shape
    if shape and shape[-1] not in (2, 3):
        message = f"noise needs a plain number or a vector of 2 or 3, not {shape_text(shape)}"
        raise MismatchError("shape-mismatch", message, 0)
    return Type(shape[:-1], PLAIN)


def chosen(args: Args) -> Type:
    """``component``: the index is a constant."""
    value, index = args
    shape = value.type.shape
    if not shape or shape[-1] is None:
        raise MismatchError("shape-mismatch", f"{shape_text(shape)} has no components", 0)
    if not isinstance(index, Number) or index.value not in range(shape[-1]):
        raise MismatchError(
            "shape-mismatch", f"the index of a component is 0 to {shape[-1] - 1}, written as a number", 1
        )
    return Type(shape[:-1], value.type.dimension)


def picked(args: Args) -> Type:
    """``item``: one of a list, by a constant number counted from 0."""
    value, index = args
    shape = value.type.shape
    if not shape or (len(shape) == 1 and shape[0] is not None):
        help = "an item of a list of points; the numbers of a vector are `component(v, 0)`, `component(v, 1)`, ..."
        raise MismatchError("shape-mismatch", f"{shape_text(shape)} has no items", 0, help=help if shape else None)
    if not isinstance(index, Number) or index.value != int(index.value) or index.value < 0:
        raise MismatchError("shape-mismatch", "the number of an item is whole, from 0, written as a number", 1)
    return Type(shape[1:], value.type.dimension)


def vectors(name: str, sizes: tuple[int | None, ...], result: tuple[int, ...], dimension: Rule) -> Rule:
    """Rule of an operation on vectors: sizes of the arguments' last axes; outer axes broadcast.

    A size of 0: any, the same for all such arguments; None: a scalar. ``result``: shape of the result's last axes.
    """

    def rule(args: Args) -> Type:
        outer: list[Shape] = []
        free: int | None = None
        for index, (arg, size) in enumerate(zip(args, sizes, strict=True)):
            shape = arg.type.shape
            if size is None:
                outer.append(shape)
                continue
            free = free if free is not None or not shape else shape[-1]
            wanted = size or free
            if not shape or shape[-1] is None or shape[-1] != wanted:
                needed = f"a vector of {wanted}" if wanted else "a vector"
                raise MismatchError("shape-mismatch", f"{name} needs {needed}, not {shape_text(shape)}", index)
            outer.append(shape[:-1])
        flat = dimension(tuple(Number(1.0, Type((), arg.type.dimension), bare=False) for arg in args))
        return Type((*broadcast(tuple(outer)), *result), flat.dimension)

    return rule


def normalized(args: Args) -> Type:
    """Type of a normalized vector: plain, of any size."""
    shape = args[0].type.shape
    if not shape or shape[-1] is None:
        raise MismatchError("shape-mismatch", f"normalize needs a vector, not {shape_text(shape)}", 0)
    return Type(shape, PLAIN)


def reduced(args: Args) -> Type:
    """Reduction of one argument over its first axis."""
    return Type(args[0].type.shape[1:], args[0].type.dimension)


def counted(args: Args) -> Type:
    """The number of items, plain."""
    return Type((), PLAIN)


def normed(args: Args) -> Type:
    """Reduction over all axes, to a scalar of the argument's dimension."""
    return Type((), args[0].type.dimension)


def least_or_most(name: str) -> Rule:
    """``min`` and ``max``: of a list, or of several arguments."""
    several = alike(f"{name} needs quantities of one kind, not {{a}} and {{b}}")
    return lambda args: reduced(args) if len(args) == 1 else several(args)


def sampled(args: Args) -> Type:
    """``at``: the type of the series; the second argument is the time."""
    dimension = args[1].type.dimension
    if args[1].type.shape or (dimension is not None and dimension != TIME):
        raise MismatchError("dimension-mismatch", f"at needs a time, not {describe(dimension)}", 1)
    return args[0].type


def listed(args: Args) -> Type:
    """Values of one shape, stacked along a new first axis."""
    shape = args[0].type.shape
    for index, arg in enumerate(args):
        if arg.type.shape != shape:
            message = f"{shape_text(shape)} and {shape_text(arg.type.shape)} cannot stand side by side"
            raise MismatchError("shape-mismatch", message, 0, index)
    dimension = common_dimension(args, tuple(range(len(args))), "{a} and {b} cannot be components of one vector")
    shape = (len(args), *shape)
    if len(shape) > MOST_AXES or prod(size or 1 for size in shape) > MOST_NUMBERS:
        message = f"a list has at most {MOST_AXES} axes and {MOST_NUMBERS} numbers, not {len(shape)} and "
        raise MismatchError("shape-mismatch", f"{message}{prod(size or 1 for size in shape)}", 0)
    return Type(shape, dimension)
