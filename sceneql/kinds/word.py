"""A word: fields with their line of the manual, default and range; outputs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any, ClassVar, Literal, Self, get_args, get_origin

from pydantic import BaseModel, ConfigDict, Field, ValidationError, ValidationInfo, model_validator
from pydantic_core import InitErrorDetails, PydanticCustomError

from sceneql.kinds.values import Paint, Quantity, Turn, Value
from sceneql.quantities import dimension as dim
from sceneql.quantities.bind import bind
from sceneql.quantities.diagnostic import Diagnostic, Diagnostics, ScriptError
from sceneql.quantities.dimension import Dimension
from sceneql.quantities.expression import Shape, Type
from sceneql.quantities.parser import parse_value
from sceneql.quantities.span import Source, Span

REQUIRED: Any = ...
LIMITS: Mapping[str, tuple[Callable[[float, float], bool], str]] = {
    "above": (lambda x, limit: x > limit, "above"),
    "at_least": (lambda x, limit: x >= limit, "at least"),
    "below": (lambda x, limit: x < limit, "below"),
    "at_most": (lambda x, limit: x <= limit, "at most"),
}
"""For each kind of limit of a field's range: the test (number, limit), and its words in messages."""


def field(
    doc: str,
    default: Any = REQUIRED,
    *,
    above: float | None = None,
    at_least: float | None = None,
    below: float | None = None,
    at_most: float | None = None,
) -> Any:
    """A field with its line of the manual, its default *as a script would write it*, and its range in SI.

    A text default (``"0.5 m"``) is read by the field's own grammar; None means that the field may be left out.
    Ranges hold for every component; a value that varies in time is checked in every frame, or where it is evaluated.
    """
    limits = {"above": above, "at_least": at_least, "below": below, "at_most": at_most}
    extra: Any = {"limits": {k: v for k, v in limits.items() if v is not None}, "default": default}
    if default is REQUIRED:
        return Field(description=doc, json_schema_extra=extra)
    return Field(default=default, description=doc, json_schema_extra=extra)


@cache
def of_default(text: str) -> Value:
    """The Value of a default's text; cached."""
    return literal(text)


def literal(text: str, place: Span | None = None) -> Value:
    """The Value of a text without names, as in a default, of any type. Raises ScriptError at ``place``."""

    def unknown(parts: tuple[str, ...], span: Span) -> Diagnostic:
        return Diagnostic("unknown-name", f"nothing is called '{'.'.join(parts)}'", span)

    found = Diagnostics()
    expr = bind(parse_value(text, place or Span(Source("default", text), 0, len(text))), unknown, found)
    if expr is None:
        raise ScriptError(found.errors)
    return Value(expr)


GRAMMAR: Mapping[type, Any] = {Paint: Quantity(dim.PLAIN, (3,)), Turn: Quantity(dim.PLAIN, (4,))}
"""How the default of a color (three sRGB numbers) and of a rotation (a quaternion) is written."""


def written_name(name: str) -> str:
    """A field's name in a script: ``from_`` is written ``from``, which Python does not allow as a name."""
    return name.removesuffix("_")


Step = str | int
"""A field's or key's name, or the number of a list's item."""


@dataclass(frozen=True, slots=True)
class Problem:
    """An error in a combination of fields that are valid one by one."""

    text: str
    path: tuple[Step, ...] = ()
    """Path from the record to the wrong value; empty: the record as a whole."""
    at_key: bool = False
    """Whether the caret is placed under the name of the path's last step, and not under its value."""
    code: str = "invalid"
    part: tuple[str, int, int] | None = None
    """Text of the value at the path, and the range [first, last) of its characters that are wrong."""
    help: str | None = None
    """The suggested correction."""


def grammar_of(info: Any) -> tuple[Quantity | Paint | Turn | None, Any]:
    """The grammar and the type by which a field's text default is read; of a union, the first member with a grammar.

    None where the default is itself a text or a choice.
    """
    members = get_args(info.annotation) if get_origin(info.annotation) is not tuple else ()
    if str in members or any(info.default in get_args(one) for one in members if get_origin(one) is Literal):
        return None, info.annotation
    marked = [(info.annotation, info.metadata)]
    marked += [(get_args(one)[0], one.__metadata__) for one in members if get_origin(one) is Annotated]
    found = ((mark, kind) for kind, marks in marked for mark in marks if isinstance(mark, Quantity | Paint | Turn))
    return next(found, (None, info.annotation))


@dataclass(frozen=True, slots=True)
class Item:
    """An item of a tuple default, with the attributes of pydantic's FieldInfo that grammar_of reads."""

    annotation: Any
    metadata: tuple[Any, ...]
    default: Any


def items_of(info: Any) -> list[Item]:
    """The items of a field's tuple default, each with its own type."""
    types = [one for one in (info.annotation, *get_args(info.annotation)) if get_origin(one) is tuple]
    each = get_args(types[0]) if types else (Any, ...)
    each = (each[0],) * len(info.default) if each[1:] == (Ellipsis,) else each
    apart = [(get_args(one)[0], one.__metadata__) if get_origin(one) is Annotated else (one, ()) for one in each]
    return [Item(of, marks, default) for (of, marks), default in zip(apart, info.default, strict=False)]


def text_of(default: Any) -> str | None:
    """A default that is a text, or a tuple containing texts, as a script would write it; None for any other."""
    if not isinstance(default, tuple):
        return default if isinstance(default, str) else None
    texts = [text_of(item) for item in default]
    if all(text is None for text in texts):
        return None
    return f"[{', '.join(str(d) if text is None else text for d, text in zip(default, texts, strict=True))}]"


def read_default(info: Any) -> Any:
    """A field's default; texts in it are parsed by the grammar of the field or of their place in a tuple."""
    text = text_of(info.default)
    if text is None:
        return info.default
    mark, annotation = grammar_of(info)
    if mark is not None:
        value = of_default(text)
        return value if annotation is Value else value.number()
    return tuple(map(read_default, items_of(info))) if isinstance(info.default, tuple) else info.default


class Record(BaseModel):
    """A group of fields inside a word (a mass, a spring, a clock): the same types, no methods of a family."""

    said_by: ClassVar[Mapping[str, str]] = {}
    """Help texts, by name, for fields that it lacks but that are likely to be tried, and for own ones that are given in
    another unit, where no other field takes that."""
    own_time: ClassVar[bool] = False
    """Whether `time` in its values is a time of its own, as an age, and not the film's."""

    # Schemas are built when a word is first used: most words of the vocabulary never are.
    model_config = ConfigDict(frozen=True, strict=True, extra="forbid", arbitrary_types_allowed=True, defer_build=True)

    @model_validator(mode="before")
    @classmethod
    def _read_defaults(cls, given: Any) -> Any:
        if not isinstance(given, dict):
            return given
        filled = dict(given)
        for name, info in cls.model_fields.items():
            if name not in filled and (value := read_default(info)) is not info.default:
                filled[name] = value
        return filled

    @classmethod
    def meant_by(cls, text: str) -> str | None:
        """The help for a text in place of the fields, where it tells what they would be."""
        return None

    def problems(self) -> Iterable[Problem]:
        """Errors in combinations of its fields; each becomes an error of the script."""
        return ()

    @model_validator(mode="after")
    def _is_sound(self, info: ValidationInfo) -> Self:
        if isinstance(info.context, list):  # the reader reports them, and goes on with the parts around
            info.context.extend((self, problem) for problem in self.problems())
            return self
        wrong = [
            InitErrorDetails(
                type=PydanticCustomError("problem", "{text}", {"text": problem.text, "problem": problem}),
                loc=problem.path,
                input=None,
            )
            for problem in self.problems()
        ]
        if wrong:
            raise ValidationError.from_exception_data(type(self).__name__, wrong)
        return self


@dataclass(frozen=True, slots=True)
class Gives:
    """An output of a word: its type and its line of the manual."""

    type: Type
    doc: str
    tally: bool = False
    """Whether it is accumulated over the run in the state, as dissipated energy: values that read it have no slopes."""
    computed: bool = False
    """Whether it is computed from the state, as an energy: values inside solved systems cannot read it."""


def quantity_type(dimension: Dimension, shape: Shape = ()) -> Type:
    """Type of an output."""
    return Type(shape, dimension)


class Kind(Record):
    """A word: its fields, its outputs, its manual."""

    family: ClassVar[str] = ""
    also_under: ClassVar[str] = ""
    """Another section of the script whose entries may be of this family, too (as a collision under `forces`)."""
    gives: ClassVar[Mapping[str, Gives]] = {}
    imports: ClassVar[tuple[str, ...]] = ()
    """Libraries that its methods import during a run and that other scenes do not need (`explain` names them)."""

    @classmethod
    def outputs(cls, written: Mapping[str, Any]) -> Mapping[str, Gives]:
        """The outputs of an entry. ``written``: its fields as plain nested dicts, lists and texts."""
        return cls.gives

    @classmethod
    def formula_symbols(cls, written: Mapping[str, Any]) -> tuple[str, ...]:
        """The free symbols of its formulas marked ``Symbols(None)``; ``written`` as in `outputs`."""
        return ()

    @classmethod
    def formula_dimension(cls, written: Mapping[str, Any]) -> Dimension | None:
        """The dimension of the field to which formulas marked ``of_field`` belong; None: not known."""
        return None

    def told_by_layout(self) -> bool:
        """Whether `check` lays the island of this model out, for errors that fields alone do not show."""
        return False

    def darkens(self) -> bool:
        """Whether it is shown before the dark, where there is no ground: what shines, or moves in empty space."""
        return False
