"""The types that a field may hold (values in time, references, formulas), and the marks that select them."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeGuard, TypeVar, cast

from sceneql.quantities.diagnostic import Diagnostic
from sceneql.quantities.dimension import Dimension
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Call, Expr, Link, Shape, Symbol, walk
from sceneql.quantities.operations import OPERATIONS
from sceneql.quantities.span import Span

if TYPE_CHECKING:
    from pydantic_core import CoreSchema

T = TypeVar("T")
TIME = ("t", "time")
"""Names of the time in formulas."""


MOST_READ = 600
"""Largest number of state entries by which a value is differentiated, for implicit solvers."""


FEW = range(5)
"""Lengths of lists of which everybody gets a copy; vectors and quaternions have these."""


class Checked:
    """A value that the compiler has built and checked: pydantic tests its class alone, which saves time."""

    __slots__ = ()

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: Any) -> CoreSchema:
        from pydantic_core.core_schema import is_instance_schema

        return is_instance_schema(cls)


@dataclass(frozen=True, slots=True)
class Value(Checked):
    """A value in time: a constant, an expression of `time`, a link to another part's output, or keyframes."""

    expr: Expr
    span: Span | None = None
    _read: tuple[Symbol | Link | Call, ...] | None = field(default=None, init=False, repr=False, compare=False)
    """Cache: the symbols of time, links and whole-run operations in the expression; None until first asked for."""
    _list: Any = field(default=None, init=False, repr=False, compare=False)
    """Cache of ``fixed_list``."""
    _few: Any = field(default=None, init=False, repr=False, compare=False)
    """Cache of ``fixed``: a number, or an array of few."""

    @property
    def constant(self) -> bool:
        """Whether it depends neither on time nor on another part's output."""
        return not self._reads()

    @property
    def links(self) -> tuple[Link, ...]:
        """The outputs of other parts that it reads."""
        return tuple(node for node in self._reads() if isinstance(node, Link))

    def _reads(self) -> tuple[Symbol | Link | Call, ...]:
        if self._read is None:
            read = tuple(node for node in walk(self.expr) if isinstance(node, Symbol | Link) or _over_time(node))
            object.__setattr__(self, "_read", read)
            return read
        return self._read

    def fixed_list(self) -> Any:
        """The array of a constant list, made once and marked as ``held``; None for other values."""
        if (
            self._list is None
            and len(self.expr.type.shape) > 0
            and self.expr.type.shape[0] not in FEW
            and self.constant
        ):
            from sceneql.frame import held

            object.__setattr__(self, "_list", held(evaluate(self.expr, {}.__getitem__, arrays=True)))
        return self._list

    def fixed(self) -> Any:
        """The float or array of a constant value, evaluated once: a long list as ``fixed_list``; None for others."""
        if self._few is None:
            shape = self.expr.type.shape
            if len(shape) > 0 and shape[0] not in FEW:
                return self.fixed_list()
            if not self.constant:
                return None
            object.__setattr__(self, "_few", evaluate(self.expr, {}.__getitem__, arrays=True))
        return self._few if isinstance(self._few, float) else self._few.copy()

    def number(self) -> Any:
        """The float, or nested tuple of floats, of a constant value, in SI."""
        return evaluate(self.expr, {})


def _over_time(node: Expr) -> TypeGuard[Call]:
    return isinstance(node, Call) and OPERATIONS[node.op].series


def unreadable(link: Link, place: Span | None = None) -> Diagnostic:
    """The error for a value in a solved system that links to an output which is not part of the state."""
    text = f"'{link.task}.{link.output}' is no part of the state that is solved together with this"
    help = "link to a position or velocity of a model of the same island, or to a kinematic model"
    return Diagnostic("unsupported-link", text, link.span or place, help)


@dataclass(frozen=True, slots=True)
class Quantity:
    """Type of a field that holds a quantity: dimension and shape.

    On a ``Value`` it may vary in time; on a ``float`` or ``tuple`` it must be constant and is stored in SI.
    """

    dimension: Dimension | None
    """None: any."""
    shape: Shape | None = ()
    """None: any."""
    needs_unit: bool = False
    """Whether a number without a unit is refused (angles, temperatures)."""
    direction: bool = False
    """Whether the vector must not be zero."""
    over_time: bool = False
    """Whether it may use operations over the whole run, such as `final`."""
    turning: bool = False
    """Whether it is an angular velocity, of which 1 Hz is 1 rad/s."""


class Paint:
    """Marks a color: CSS name, ``#rrggbb``, three sRGB numbers or an expression such as ``hue(i/7)``."""


class Turn:
    """Marks a rotation: ``{about: z, angle: 30 deg}``, intrinsic ``{xyz: ...}``, or a quaternion ``[w, x, y, z]``."""


@dataclass(frozen=True, slots=True)
class Refers:
    """Marks a ``Ref`` and the family it names; an entry written in place is allowed too."""

    family: str
    also: str = ""
    """A second family whose parts it may name."""
    bodies: bool = False
    """Whether it may name one of several bodies, `stones.first`, or the `world`."""
    panel: bool = False
    """Whether it fills a panel of a layout."""
    showing: str = ""
    """The word that shows a value where the value itself was written in place of a part, for messages."""

    def __str__(self) -> str:
        return f"{self.family} or {self.also}" if self.also else self.family


@dataclass(frozen=True, slots=True)
class Interpolated:
    """Marks a text with values in braces (kinds.texts); ``over_time``: they may look over the run so far."""

    over_time: bool = False


class Verbatim:
    """Marks a text of another language, as TeX, whose backslashes are its own: YAML reads them in double quotes."""


class SceneFile:
    """Marks a text that is the path of a file, read as a path below the scene's folder where there is a file."""


@dataclass(frozen=True, slots=True)
class Ref(Checked):
    """A named part of the script."""

    name: str
    """Name of the part; empty for the world, where a field may name that."""
    span: Span | None = None
    within: str = ""
    """The name of one of the part's bodies, where a field may name these."""


@dataclass(frozen=True, slots=True)
class Formula(Checked):
    """A formula of an `implicit` or `equations` entry in plain numbers, with free symbols."""

    expr: Expr
    span: Span | None = None
    _made: dict[Hashable, Any] = field(default_factory=dict, init=False, repr=False, compare=False)
    """Cache of ``kept``."""

    def kept(self, key: Hashable, make: Callable[[], T]) -> T:
        """What was made of it once under a key, for all runs and frames; for constant formulas."""
        if key not in self._made:
            self._made[key] = make()
        return cast(T, self._made[key])

    @property
    def constant(self) -> bool:
        """Whether it depends neither on time nor on another part; it may depend on position."""
        return not any(
            isinstance(node, Link) or (isinstance(node, Symbol) and node.name in TIME) for node in walk(self.expr)
        )


@dataclass(frozen=True, slots=True)
class Symbols:
    """Marks a ``Formula`` and names the free symbols that it may use besides defines; ``None``: the kind binds them."""

    names: tuple[str, ...] | None
    dimension: Dimension | None = None
    """Dimension of its values, which are in SI where the formula is a plain number; None: any."""
    of_field: bool = False
    """Whether its values have this dimension times that of the field that the kind solves for
    (Kind.formula_dimension)."""
    at_start: bool = False
    """Whether it is evaluated before the run, when no other part has a value yet."""
    several: bool = False
    """Whether its values may be vectors."""
