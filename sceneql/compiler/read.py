"""Reading of field values by the field's own type: a word's annotations define what a script may write.

One reader for every word: quantities, colors, rotations, keyframes, formulas, references, choices, records and lists of
these. An error is reported where it stands, and reading goes on, so that all errors come in one run.
"""

from __future__ import annotations

import re
import types
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel

from sceneql import kinds
from sceneql.compiler import limits, paint, values
from sceneql.compiler.annotations import could_be, is_fixed, unwrap
from sceneql.compiler.formulas import Wanted, read_formula
from sceneql.compiler.meant import by_side, likely, picture_sizes, under_names
from sceneql.compiler.meant import quantity_help as helped
from sceneql.compiler.meant.chained import improve
from sceneql.compiler.meant.quantity_help import TRUE
from sceneql.compiler.meant.unknown import report_unknown
from sceneql.compiler.names import Names
from sceneql.compiler.number_files import names_a_file, read_numbers
from sceneql.compiler.paths import read_path
from sceneql.compiler.problems import Unreadable, report_known, validated
from sceneql.compiler.texts import read_text, unescaped
from sceneql.kinds.values import Verbatim
from sceneql.language.dashed import without_dashes
from sceneql.language.repeat import numbered
from sceneql.language.scope import Scope
from sceneql.language.tree import Mapping as MappingNode
from sceneql.language.tree import Node, Scalar, Sequence, broken, unsure, whole
from sceneql.language.tree import written as plainly
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.dimension import Dimension
from sceneql.quantities.instead import instead
from sceneql.quantities.span import Span

FALSE = ("false", "no", "off")
COMPARISON = re.compile(r"[<>]|[=!]=")


@dataclass(frozen=True, slots=True)
class Reader:
    """Reads the fields of one entry. ``refer`` resolves a reference, or an entry written in place, to a part."""

    names: Names
    found: Diagnostics
    refer: Callable[[Node, kinds.Refers, str], kinds.Ref | None]
    """(node, families that it may name, name for an entry written in place)."""
    owner: str
    """Name of the part whose fields these are."""
    folder: Path
    """The scene's folder."""
    files: list[str]
    """Paths of the files that fields have named so far; it grows."""
    symbols: tuple[str, ...] = ()
    """Free symbols of formulas of this word (Kind.formula_symbols)."""
    solved: Dimension | None = None
    """Dimension of the field that this word solves (Kind.formula_dimension)."""
    outer: type[BaseModel] | None = None
    """The class of the record around this one."""
    copies: Callable[[Scalar, kinds.Refers], list[str]] = lambda node, mark: []
    """Resolves a collective name (of a repeated part, or a template's instance) to its parts; empty for other names."""

    def record(self, node: Node | None, cls: type[BaseModel], span: Span, title: str) -> Any:
        """An instance of a record or kind from a mapping (None: no fields are written). Raises Unreadable."""
        written: Mapping[str, Node] = {}
        if isinstance(node, MappingNode):
            written = node.entries
        elif node is not None and broken(node):
            raise Unreadable
        elif node is not None and not (isinstance(node, Scalar) and node.kind == "null"):
            fields = list(map(kinds.written_name, cls.model_fields))
            help = without_dashes(node, fields) or likely.field_meant(self, node, cls)
            help = help or f"it has {', '.join(fields)}"
            raise self._fail("wrong-shape", f"{title} takes fields, `{{name: value}}`", node.span, help)
        symbols, solved = self.symbols, self.solved
        if isinstance(node, MappingNode) and issubclass(cls, kinds.Kind):
            symbols = cls.formula_symbols(plainly(node))
            solved = None if node.partial else cls.formula_dimension(plainly(node))
        ok, other = True, False
        got: dict[str, Any] = {}
        mistaken: set[str | None] = set()
        shown: set[str] = set()
        if isinstance(node, MappingNode):
            known = [kinds.written_name(name) for name in cls.model_fields]
            counter = node.entries.get("repeat") if "repeat" not in known else None
            number = counter.entries.get("as") if isinstance(counter, MappingNode) else None
            if isinstance(number, Scalar):  # the copies' number is not known, which the field's error tells
                self.names.broken.add(number.text)
            before = len(self.found.found)
            ok = report_unknown(node, known, title, self.found, **likely.asked(self, cls))
            ok = ok and not node.partial
            unknown = [name for name in node.entries if name not in known]
            alone = len(unknown) > 1 or len(written) == 1  # another thing may well be meant
            other = alone and all(instead(f"field.{title}", one) for one in unknown) and bool(unknown)
            mistaken = likely.meant(self, cls, node)
            helps = [one.help or "" for one in self.found.found[before:]]
            if any(help.startswith(likely.ANOTHER) for help in helps):
                mistaken |= {*known}
            mistaken |= (shown := {name for name in known for help in helps if re.search(rf"`\{{?{name}: ", help)})
        for python_name, info in cls.model_fields.items():
            name = kinds.written_name(python_name)
            if name not in written:
                if info.is_required():
                    ok = False
                if (
                    info.is_required()
                    and name not in mistaken
                    and not other
                    and not (node is not None and unsure(node))
                ):
                    help = likely.example_line(self, cls, name, info)
                    self.found.error("missing-field", f"{title} needs '{name}'", span, help=help)
                continue
            owner = f"{self.owner}.{name}" if self.owner else ""
            reader, before = (
                replace(self, owner=owner, symbols=symbols, solved=solved, outer=cls),
                len(self.found.found),
            )
            try:
                got[python_name] = reader.field(written[name], info, name)
            except Unreadable:
                ok = False
                improve(self, written, cls, name, title, before)
                errors = self.found.found[before:]
                if name in shown and [one.code for one in errors] == ["wrong-shape"]:
                    del self.found.found[before:]  # an unknown field's help writes it anew
        if not ok:
            if {*written} <= {*map(kinds.written_name, cls.model_fields)} and not (node is not None and unsure(node)):
                report_known(cls, got, node, span, self.found)
            raise Unreadable
        return self._some(validated(cls, got, node, span, self.found))

    def field(self, node: Node, info: Any, name: str) -> Any:
        """The value of a field, within its range. Raises Unreadable after reporting."""
        annotation = Annotated[(info.annotation, *info.metadata)] if info.metadata else info.annotation
        value = self.read(node, annotation, name)
        errors = len(self.found.errors)
        bounds = (info.json_schema_extra or {}).get("limits", {})
        limits.check_limits(value, bounds, name, annotation, node.span, self.found, self._copy())
        if len(self.found.errors) > errors:
            raise Unreadable
        return value

    def read(self, node: Node, annotation: Any, what: str) -> Any:
        """A value of the annotation's type. Raises Unreadable after reporting."""
        if broken(node):
            raise Unreadable
        if isinstance(node, Scalar) and not node.quoted:
            field = self.names.field(node.text)
            if field is not None:
                node, outer = field
                if isinstance(node, Scalar) and node.kind == "null":
                    raise Unreadable  # a template's field that was not given: reported at the instance
                return replace(self, names=outer).read(node, annotation, what)
        base, marks = unwrap(annotation)
        if isinstance(node, MappingNode) and node.index and not any(isinstance(mark, kinds.Refers) for mark in marks):
            names = replace(self.names, scope=Scope({}, dict([node.index]), self.names.scope))
            return replace(self, names=names).read(replace(node, index=None), annotation, what)
        for mark in marks:
            if isinstance(mark, kinds.Quantity):
                return self._quantity(node, base, mark, what)
            if isinstance(mark, kinds.Paint):
                return self._some(paint.read_color(node, self.names, self.found))
            if isinstance(mark, kinds.Turn):
                return self._some(paint.read_rotation(node, self.names, self.found))
            if isinstance(mark, kinds.Refers):
                return self._some(self.refer(node, mark, self.owner))
            if isinstance(mark, kinds.Interpolated):
                return self._some(read_text(node, mark, what, self.names, self.found))
            if isinstance(mark, Verbatim) and isinstance(node, Scalar) and (plain := unescaped(node)) is not None:
                text = "in double quotes a backslash begins a sign of YAML's, and is none of the text"
                raise self._fail("syntax", text, node.span, f"write single quotes: `{what}: {plain}`")
            if isinstance(mark, kinds.SceneFile):
                path = self._some(read_path(node, self.folder, what, self.found))
                self.files.append(path)
                return path
            if isinstance(mark, kinds.Symbols):
                return self.formula(node, mark, what)
        origin, arms = get_origin(base), get_args(base)
        if origin in (Union, types.UnionType):
            return self._union(node, arms, what)
        if origin is Literal:
            return self._choice(node, arms, what)
        if origin in (list, tuple):
            return self._list(node, origin, arms, what)
        if origin is dict:
            return self._dict(node, arms, what)
        if isinstance(base, type) and issubclass(base, BaseModel):
            return self.record(node, base, node.span, what)
        if base is kinds.Formula:
            return self.formula(node, kinds.Symbols(None), what)
        if base is bool:
            return self._bool(node, what)
        if base in (int, float):
            return self._number(node, base, what)
        if base is str:
            if isinstance(node, Scalar):
                return node.text
            raise self._fail("wrong-shape", f"{what} is a text", node.span, under_names.text_meant(node, what))
        if base is Any:
            return node
        raise TypeError(f"no reading for {annotation!r}")

    def _copy(self) -> str:
        """The name of the part, where the script writes it once for several; else empty."""
        return "" if self.names.scope is None else self.owner.rpartition(".")[0]

    # --- one method a shape ---

    def _quantity(self, node: Node, base: Any, mark: kinds.Quantity, what: str) -> Any:
        if names_a_file(node, mark):
            value = self._some(read_numbers(node, mark, what, self.folder, self.files, self.found))
        else:
            value = self._some(values.read_value(node, mark, what, self.names, self.found))
        helped.warn_of_hertz(value.expr, mark, self.found)
        if base is kinds.Value:
            return value
        if not value.constant:
            raise self._fail("not-constant", f"{what} must be constant", node.span)
        number = value.number()
        if not limits.finite(number):
            raise self._fail("not-finite", f"{what} is {number}", node.span)
        return number

    def formula(self, node: Node, mark: kinds.Symbols, what: str) -> kinds.Formula:
        """A formula of the symbols that its field allows. Raises Unreadable after reporting."""
        symbols, wanted = self.symbols if mark.names is None else mark.names, mark.dimension
        if mark.of_field and wanted is not None:
            wanted = None if self.solved is None else self.solved * wanted
        # A plain field may stand for any quantity, such as rabbits or moles; so may the defines in its formulas.
        of_any = mark.of_field and self.solved is not None and self.solved.plain
        by_of = mark.of_field and self.solved is not None and not self.solved.plain
        of = Wanted(wanted, of_any, mark.at_start, by_of)
        expr = self._some(read_formula(node, symbols, of, what, self.names, self.found))
        if expr.type.shape and not mark.several and (mark.names is not None or mark.of_field):
            raise self._fail("wrong-shape", f"{what} is one number at each place, not several", node.span)
        return kinds.Formula(expr, node.span)

    def _union(self, node: Node, arms: tuple[Any, ...], what: str) -> Any:
        if type(None) in arms and isinstance(node, Scalar) and node.kind == "null":
            return None
        fitting = [arm for arm in arms if arm is not type(None) and could_be(arm, node)]
        fitting = fitting or [arm for arm in arms if arm is not type(None)]
        if len(fitting) > 1 and not whole(node):
            raise Unreadable  # which arm was meant is not known
        if all(get_origin(arm) is Literal for arm in fitting):
            return self._choice(node, tuple(choice for arm in fitting for choice in get_args(arm)), what)
        if (alone := likely.value_alone(self, node, arms, what)) is not None:
            raise self._fail("wrong-shape", f"{what} takes its value alone", node.span, alone)
        for arm in fitting[:-1]:
            attempt = replace(self, found=Diagnostics())
            attempt = replace(attempt, names=replace(self.names, found=attempt.found))
            try:
                value = attempt.read(node, arm, what)
            except Unreadable:
                continue
            if not attempt.found.errors:
                return value
        *others, last = fitting
        if get_origin(last) is Literal and (several := [len(get_args(arm)) for arm in others if is_fixed(arm)]):
            return self._choice(node, get_args(last), what, f"{several[0]} values")
        return self.read(node, last, what)

    def _choice(self, node: Node, choices: tuple[Any, ...], what: str, other: str = "") -> Any:
        text = node.text if isinstance(node, Scalar) else ""
        for choice in choices:
            if text == str(choice):
                return choice
        every = ", ".join(str(c) for c in choices)
        if other:
            hint = picture_sizes.size_meant(text, choices) or likely.choice_meant(text, list(map(str, choices)))
            raise self._fail("unknown-choice", f"{what} is {other} or one of {every}, not '{text}'", node.span, hint)
        hint = likely.choice_meant(text, [str(c) for c in choices]) or f"one of {every}"
        hint = f"it is always `{what}: {every}`" if len(choices) == 1 else hint
        hint = hint if text else f"it is one of {every}, by its name"
        raise self._fail("unknown-choice", f"{what} cannot be '{text or node.span.text}'", node.span, hint)

    def _list(self, node: Node, origin: Any, arms: tuple[Any, ...], what: str) -> Any:
        fixed = origin is tuple and arms[-1] is not Ellipsis
        if fixed and isinstance(node, Scalar):
            return tuple(self._spread(node, arms, what))
        items = node.items if isinstance(node, Sequence) else [node]
        help = None if fixed or not isinstance(node, MappingNode) else under_names.listed(node, arms[0], what)
        if help is not None:
            raise self._fail("wrong-shape", f"{what} is a list, not parts by name", node.span, help)
        if not fixed:
            items = [one for item in items for one in self._copies(item, arms[0])]
        if fixed and len(items) != len(arms):
            raise self._miscounted(node, arms, what, len(items))
        result, ok = [], True
        for k, item in enumerate(items):
            reader = (
                replace(self, owner=f"{self.owner}.{k}") if len(items) > 1 or not isinstance(item, Scalar) else self
            )
            try:
                result.append(reader.read(item, arms[k] if fixed else arms[0], what))
            except Unreadable:
                ok = False
        if not ok:
            raise Unreadable
        return tuple(result) if origin is tuple else result

    def _miscounted(self, node: Node, arms: tuple[Any, ...], what: str, count: int) -> Unreadable:
        marks = [mark for arm in arms for mark in unwrap(arm)[1] if isinstance(mark, kinds.Quantity)]
        vectors = [mark.shape[0] for mark in marks if mark.shape and mark.shape[0]]
        help = helped.by_corners(node, what, vectors[0]) if len(vectors) == 2 == len(arms) else None
        names = re.split(r"\s*[-/&+>]+\s*", node.text) if isinstance(node, Scalar) else []
        if len(names) == len(arms) and all(name.isidentifier() for name in names):
            help = f"write `{what}: [{', '.join(names)}]`"
        if help is None and count == 1 and isinstance(node, Scalar):
            help = f"write `{' '.join(len(arms) * [node.text])}`, one for each"
            if node.text.isidentifier():  # a name
                bodies = any(isinstance(mark, kinds.Refers) and mark.bodies for arm in arms for mark in unwrap(arm)[1])
                help = f"write `{what}: [{node.text}, {'world' if bodies else '...'}]`"
        return self._fail("wrong-count", f"{what} takes {len(arms)} values, not {count}", node.span, help)

    def _copies(self, node: Node, annotation: Any) -> list[Node]:
        """The nodes that an item of a list stands for: one for each part of a collective name, else the item itself."""
        marks = [mark for mark in unwrap(annotation)[1] if isinstance(mark, kinds.Refers)]
        if not marks or not isinstance(node, Scalar):
            return [node]
        copies = self.copies(node, marks[0])
        return [Scalar(name, "text", False, node.source, node.start, node.end) for name in copies] or [node]

    def _spread(self, node: Scalar, arms: tuple[Any, ...], what: str) -> list[Any]:
        """The values of a tuple written in one text: ``960 540`` for a pair of whole numbers."""
        words = node.text.replace(",", " ").split()
        if len(words) != len(arms):
            raise self._miscounted(node, arms, what, len(words))
        at, result = node.content.start, []
        for word, arm in zip(words, arms, strict=True):
            start = node.source.text.find(word, at)
            at = start + len(word)
            part = Scalar(word, "integer", False, node.source, start, at)
            result.append(self.read(part, arm, what))
        return result

    def _dict(self, node: Node, arms: tuple[Any, ...], what: str) -> dict[Any, Any]:
        if not isinstance(node, MappingNode):
            better = by_side.parts_at_sides(self, node, arms[1], what)
            better = better or under_names.by_name(node, arms[1], bool(unwrap(arms[0])[1]))
            raise self._fail("wrong-shape", f"{what} takes names with values, `{{name: value}}`", node.span, better)
        if (better := under_names.nameless(node, arms[1], what)) is not None:
            raise self._fail("wrong-shape", f"{what} holds parts, each with a name of its own", node.span, better)
        named, result, ok = unwrap(arms[0])[1], {}, True  # names of parts are references
        for name, item in node.entries.items():
            if (other := numbered(name)) is not None:
                self.found.error("part-name", f"'{name}' cannot be a name", node.keys[name].span, help=other)
                ok = False
                continue
            try:
                key = self.read(node.keys[name], arms[0], what) if named else name
                result[key] = replace(self, owner=f"{self.owner}.{name}").read(item, arms[1], f"{what}.{name}")
            except Unreadable:
                ok = False
        if not ok:
            raise Unreadable
        return result

    def _bool(self, node: Node, what: str) -> bool:
        text = node.text.lower() if isinstance(node, Scalar) else ""
        if text in TRUE or text in FALSE:
            return text in TRUE
        if isinstance(node, Scalar) and COMPARISON.search(text):  # `i == 0` in copies
            value = self._some(values.read_value(node, values.PLAIN_NUMBER, what, self.names, self.found))
            if value.constant:
                return bool(value.number())
        help = f"write `{what}: yes` or `{what}: no`"
        raise self._fail("unknown-choice", f"{what} is yes or no, not '{text}'", node.span, help)

    def _number(self, node: Node, base: Any, what: str) -> Any:
        value = self._some(values.read_value(node, values.PLAIN_NUMBER, what, self.names, self.found))
        if not value.constant:
            raise self._fail("not-constant", f"{what} must be constant", node.span)
        number = value.number()
        if base is float:
            return number
        if not limits.finite(number) or number != int(number):
            raise self._fail("not-whole", f"{what} must be a whole number, not {number:g}", node.span)
        if abs(number) > limits.LARGEST_WHOLE:
            text = f"{what} must be at most {limits.LARGEST_WHOLE:,}, not {number:g}"
            raise self._fail("out-of-range", text, node.span)
        return int(number)

    def _some(self, value: Any) -> Any:
        if value is None:
            raise Unreadable
        return value

    def _fail(self, code: str, message: str, span: Span, help: str | None = None) -> Unreadable:
        self.found.error(code, message, span, help=help)
        return Unreadable()
