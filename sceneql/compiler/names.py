"""Resolution of the names of a script: defines, `time`, a template's fields, and outputs of other parts."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import count, takewhile
from typing import Protocol

from sceneql.compiler.css_colors import NAMED, css_color
from sceneql.compiler.meant.output_help import NATURE, output_alone, output_meant, usual
from sceneql.kinds import Gives
from sceneql.language.scope import Broken, Entry, Given, Scope
from sceneql.language.tree import Mapping as MappingNode
from sceneql.language.tree import Node, Scalar, Sequence
from sceneql.quantities.bind import Lookup, bind, component
from sceneql.quantities.diagnostic import Diagnostic, Diagnostics, nearest, suggestion
from sceneql.quantities.dimension import PLAIN, TIME
from sceneql.quantities.expression import Expr, Link, Name, Symbol, Type, each_once, rebuilt
from sceneql.quantities.instead import instead
from sceneql.quantities.literal import WORD
from sceneql.quantities.operations import CONSTANTS
from sceneql.quantities.other_words import OURS
from sceneql.quantities.parser import parse_value
from sceneql.quantities.spaced import at_rate, declared
from sceneql.quantities.span import Span
from sceneql.quantities.unit_table import UNITS
from sceneql.quantities.units import continues_unit, in_words, unit_hint

WORDS = re.compile(WORD)
PICTURES = ("jpg", "jpeg", "png", "hdr", "exr", "tif", "tiff", "webp", "gif")
DOTTED = re.compile(r"[^\W\d]\w*(\.\w+)+")
COPY_NUMBERS = ("index", "idx", "id", "n", "k", "j", "copy", "number", "num", "instance")
"""Names of other programs for the number of a copy."""
DEEPEST = 40
"""Largest depth of defines that are read within one another; what a define needs is read before it."""


class Vocabulary(Protocol):
    """The words of all families, as the catalogue has them."""

    def families_of(self, word: str) -> list[str]:
        """The families that have a word of this name."""

    def having(self, field: str) -> list[tuple[str, str]]:
        """The (family, word) of all words with a field of this name."""


class Parsed:
    """Cache of parsed texts by node: the variants of a script share the nodes that none of them replaces."""

    def __init__(self) -> None:
        self._trees: dict[int, tuple[Node, Expr, bool, Expr | None]] = {}

    def tree(self, node: Scalar, text: str, lookup: Lookup, found: Diagnostics) -> Expr | None:
        """The bound tree of a text; None after reporting errors. Raises ScriptError."""
        known = self._trees.get(id(node))
        if known is None:
            expr = parse_value(text, node.content)
            alone = not any(isinstance(part, Name) for part in each_once(expr))
        else:
            _, expr, alone, bound = known
            if bound is not None:
                return bound
        bound = bind(expr, lookup, found)
        self._trees[id(node)] = node, expr, alone, bound if alone else None
        return bound


@dataclass
class Names:
    """The names of a script. ``outputs_of`` returns a part's outputs; ``read`` turns a define's node into a tree."""

    defines: Mapping[str, Node]
    parts: Mapping[str, Entry]
    outputs_of: Callable[[str], Mapping[str, Gives] | None]
    read: Callable[[Node, Names], Expr | None]
    found: Diagnostics
    given: Mapping[str, Given]
    """Outputs of template instances, by dotted name."""
    broken: Broken = field(default_factory=Broken)
    """Names whose definitions were reported as unreadable; no further error is reported about them."""
    unsure: Callable[[str], bool] = lambda name: False
    """Whether a part may have more outputs than are known, because its fields have errors."""
    mover: Callable[[str], str] = lambda name: ""
    """The model, or the body of it, that moves an object; empty where none does."""
    catalogue: Vocabulary | None = None
    """The words of all families, for messages."""
    parsed: Parsed = field(default_factory=lambda: Parsed())
    scope: Scope | None = None
    _bound: dict[str, Expr | None] = field(default_factory=dict)
    _open: list[str] = field(default_factory=list)
    _named: dict[str, list[str]] = field(default_factory=dict)
    _read: dict[tuple[int, int], tuple[Node, Scope | None, Expr | None]] = field(default_factory=dict)
    _plain: dict[int, tuple[Expr, Expr]] = field(default_factory=dict)

    def define(self, name: str, span: Span) -> Expr | None:
        """The value of a define; a define that needs itself is an error."""
        if name in self._open:
            circle = " -> ".join([*self._open[self._open.index(name) :], name])
            help = f"write one of these without the others: `{name}: 1 m`"
            self.found.error("circular-define", f"'{name}' is defined by itself: {circle}", span, help=help)
            return None
        # The defines that a define needs are bound before it, except in a circle.
        if name not in self._bound and len(self._open) > DEEPEST:
            self.found.error("circular-define", f"'{name}' is defined by itself, over more than {DEEPEST} others", span)
            self._bound[name] = None
        for each in self._needed(name):
            self._open.append(each)
            self._bound[each] = self.read(self.defines[each], replace(self, scope=None))
            self._open.pop()
        return self._bound[name]

    def _needed(self, name: str) -> Iterator[str]:
        """The defines to bind before a define, and the define itself, each after what it needs; none of a circle."""
        stack, known = [(name, False)], set[str]()
        while stack:
            each, ready = stack.pop()
            if ready:
                if each == name or all(word in self._bound for word in self._named[each]):
                    yield each
            elif each not in known and each not in self._bound:
                known.add(each)
                if each not in self._named:
                    self._named[each] = [word for word in _words(self.defines[each]) if word in self.defines]
                stack.append((each, True))
                stack.extend((word, False) for word in reversed(self._named[each]))

    def field(self, name: str) -> tuple[Node, Names] | None:
        """The node that an instance of a template has for a field, and the names valid at that node.

        None if there is none.
        """
        scope = self.scope
        while scope is not None:
            if name in scope.fields:
                return scope.fields[name], replace(self, scope=scope.outer)
            scope = scope.outer
        return None

    def lookup(self, parts: tuple[str, ...], span: Span) -> Expr | Diagnostic | None:
        """The expression of a dotted name, the Diagnostic that says why it has none, or None after reporting errors."""
        head = parts[0]
        if parts == ("time",):
            return Symbol("time", Type((), TIME), span)
        field = self.field(head)
        if field is not None:
            expr = self._once(*field)
            return None if expr is None else self._component(expr, parts, 1, span)
        if head in self.defines:
            expr = self.define(head, span)
            return None if expr is None else self._component(expr, parts, 1, span)
        for size in range(len(parts) - 1, 0, -1):
            task = ".".join(parts[:size])
            task = task if self.scope is None else self.scope.resolve(task)
            given = self.given.get(f"{task}.{parts[size]}")
            if given is not None:
                expr = self._once(given.node, replace(self, scope=given.scope))
                return None if expr is None else self._component(expr, parts, size + 1, span)
            outputs = self.outputs_of(task)
            if outputs is not None:
                return self._output(task, outputs, parts, size, span)
            if task in self.parts:
                return None  # it is reported there
        if self._is_reported(parts):
            return None
        return self._unknown(parts, span)

    def _once(self, node: Node, names: Names) -> Expr | None:
        """The tree of a node in a scope, read at its first use and shared by all others."""
        place = id(node), id(names.scope)
        if place not in self._read:
            self._read[place] = node, names.scope, self.read(node, names)
        return self._read[place][2]

    def plain(self, expr: Expr) -> Expr:
        """The tree with plain numbers in SI: formulas in plain numbers are not homogeneous, so dimensions are dropped.

        The former dimension of the whole stays at its root, in words (Dimension.kind).
        """
        if id(expr) not in self._plain:
            tree = rebuilt(expr, lambda node, new: replace(new, type=Type(node.type.shape, PLAIN)))
            was = expr.type.dimension
            if was is not None and (was.kind or not was.plain):
                tree = replace(tree, type=Type(tree.type.shape, replace(PLAIN, kind=in_words(was))))
            self._plain[id(expr)] = expr, tree
        return self._plain[id(expr)][1]

    def part_of(self, name: str) -> tuple[str, str]:
        """Split a name into the longest part's name that it begins with, and the rest: ``deck`` and ``plank.0``.

        (name, "") where there is no such part.
        """
        part = name
        while part and part not in self.parts:
            part = part.rpartition(".")[0]
        return (part, name[len(part) + 1 :]) if part else (name, "")

    def copies_of(self, name: str) -> list[str]:
        """What is meant by an output of what `repeat` made many of, parts or masses, in the copies' order; [] for none.

        ``bead.0.position``, ``bead.1.position``, ... for ``bead.position``.
        """
        if DOTTED.fullmatch(name) is None:
            return []
        pieces = name.split(".")
        for size in range(1, len(pieces)):
            first, last = ".".join(pieces[:size]), ".".join(pieces[size:])
            inside = first if self.scope is None else self.scope.resolve(f"{first}.0").removesuffix(".0")
            every = (f"{inside}.{k}.{last}" for k in count())
            copies = list(takewhile(lambda one: one in self.given or self.gives(one), every))
            if copies and not self.gives(f"{inside}.{last}"):
                return copies
        return []

    def of_copy(self, node: Node) -> Names:
        """These names with the number of a copy that `repeat` made inside of a list; the same for other nodes."""
        if not isinstance(node, MappingNode) or node.index is None:
            return self
        return replace(self, scope=Scope({}, dict([node.index]), self.scope))

    def gives(self, name: str) -> bool:
        """Whether a dotted name is the output of a part, or a component of one."""
        part, output = self.part_of(name)
        known = self.outputs_of(part) or {}
        return bool(output) and (output in known or output.rpartition(".")[0] in known)

    def readers(self, name: str, parts: Iterable[str]) -> list[str]:
        """Those of the parts whose fields name a value."""
        written = {part: self.parts[part].fields for part in parts if part in self.parts}
        return [part for part, fields in written.items() if fields is not None and name in fields.span.text]

    def model_of(self, body: str) -> str | None:
        """The model with a body or mass of this name, written with or without the model's name.

        None if there is none.
        """
        for part in self.parts:
            if f"{body.removeprefix(f'{part}.')}.position" in (self.outputs_of(part) or ()):
                return part
        return None

    def _is_reported(self, parts: tuple[str, ...]) -> bool:
        """Whether the definition of the name, or of the part that would give it, was reported as unreadable."""
        wanted = ".".join(parts)
        inside = wanted if self.scope is None else self.scope.resolve(wanted)
        return wanted in self.broken or inside in self.broken

    def _output(
        self, task: str, outputs: Mapping[str, Gives], parts: tuple[str, ...], first: int, span: Span
    ) -> Expr | None:
        """The output, or a component of it, named by the pieces of the name from number ``first`` on.

        None after an error.
        """
        for size in range(len(parts), first, -1):
            name = ".".join(parts[first:size])
            if name in outputs:
                link = Link(task, name, outputs[name].type, span, outputs[name].computed)
                return self._component(link, parts, size, span)
            whole = size == len(parts) or set(parts[size:]) <= {"x", "y", "z"}
            if f"{name}.position" in outputs and whole:  # a mass's or point's bare name is its position
                link = Link(task, f"{name}.position", outputs[f"{name}.position"].type, span)
                return self._component(link, parts, size, span)
        if self.unsure(task):
            return None
        wanted = ".".join(parts[first:])
        help = self._of_copies(".".join(parts)) or self._of_mover(task, parts[first:])
        help = help or output_meant(task, wanted, outputs, self._giving)
        help = help or suggestion(wanted, outputs)
        help = help or f"it gives {', '.join(sorted(outputs)) or 'nothing'}"
        self.found.error("unknown-output", f"'{'.'.join(parts[:first])}' gives no '{wanted}'", span, help=help)
        return None

    def _giving(self, output: str) -> list[str]:
        """The parts with an output of this name."""
        return [part for part in self.parts if output in (self.outputs_of(part) or ())]

    def _of_mover(self, task: str, wanted: tuple[str, ...]) -> str | None:
        """The help for an output that an object lacks and the model that moves it gives."""
        mover = self.mover(task)
        model, body = self.part_of(mover) if mover else ("", "")
        known = self.outputs_of(model) or {}
        inner = f"{body}.{wanted[0]}".strip(".")
        gives = inner in known or f"{inner}.position" in known
        return f"'{model}' moves it: write `{'.'.join((mover, *wanted))}`" if gives else None

    def _component(self, whole: Expr, parts: tuple[str, ...], size: int, span: Span) -> Expr | None:
        """The component named by the pieces behind the first ``size``, if any; None after an error."""
        for at in range(size, len(parts)):
            part = component(whole, ".".join(parts[:at]), parts[at], span)
            if isinstance(part, Diagnostic):
                self.found.add(part)
                return None
            whole = part
        return whole

    def _unknown(self, parts: tuple[str, ...], span: Span) -> Diagnostic:
        wanted = ".".join(parts)
        if continues_unit(span.source.text, span.start):
            message = f"there is no unit '{wanted}', and nothing is called so"
            meant = (parts[-1].lower(), *OURS.get(wanted, ()))
            constant = next((name for name in meant if name in CONSTANTS), None)
            rated = at_rate(unit_hint(wanted), span.source.text)
            help = f"did you mean '{constant}'?" if constant else rated or suggestion(wanted, self.defines)
            help = help or "units are such as m, s, kg, N or deg: `sceneql words units`"
            return Diagnostic("unknown-unit", message, span, help)
        hint: str | None
        message, parts_known = f"nothing is called '{wanted}'", list(self.parts)
        if wanted in parts_known:
            message = f"'{wanted}' is a part, not a value"
            some = f"write one of its outputs, such as '{self._some_output(wanted)}'"
            hint = some if self.outputs_of(wanted) != {} else instead("name", wanted) or "it has no values to read"
        else:
            hint = self._copy_number(wanted) or self._of_copies(wanted)
            hint = hint or at_rate(instead("name", wanted), span.source.text)
            hint = hint or (output_alone(wanted, self._giving) if len(parts) == 1 < len(wanted) else None)
            giving = [part for part in parts_known if self.outputs_of(part) != {}]
            hint = hint or suggestion(wanted, [*self._inside(), *self.defines, *giving, "time", *CONSTANTS])
            model = None if hint else self.model_of(parts[0])
            if model is not None:
                hint = f"it is one of the bodies or masses of '{model}': write `{model}.{wanted}`"
            if hint is None and len(parts) > 1:
                hint = self._meant(parts, parts_known)
            if hint is None and wanted in NAMED:
                numbers = ", ".join(f"{one:.3g}" for one in css_color(wanted) or ())
                hint = f"a color by its name stands alone, `color: {wanted}`; in a formula it is `[{numbers}]`"
            if hint is None and wanted in UNITS and wanted not in NATURE:
                hint = f"a unit stands behind a number: write `(1 {wanted})`"
            if hint is None and (first := next(iter(self._giving(wanted)), None)) is not None:
                hint = f"a value is named with its part: write `{first}.{wanted}`"
            if hint is None and len(parts) == 1:
                hint = declared(span.source.text, wanted)
            if hint is None and len(parts) == 1:
                hint = f"names stand under `define`, `define: {{{wanted}: {usual(wanted)}}}`: `sceneql words define`"
        return Diagnostic("unknown-name", message, span, hint)

    def _meant(self, parts: tuple[str, ...], known: list[str]) -> str:
        """The help for a dotted name of an unknown part: the nearest part, or the part without its section."""
        if parts[0] == "define":
            return f"what is defined is named by itself: write `{'.'.join(parts[1:])}`"
        if parts[-1].lower() in PICTURES:
            return "no picture is read here: write a color, `skyblue`"
        if parts[1] in known:
            return f"a part is named without its section: write `{'.'.join(parts[1:])}`"
        part = nearest(parts[0], known)
        if part is None:
            return "a link is a part's name, a dot and its value's, `ball.position`: `sceneql words links`"
        return f"did you mean '{'.'.join((part, *parts[1:]))}'?"

    def _inside(self) -> list[str]:
        """The names defined by the templates and copies around."""
        names: list[str] = []
        scope = self.scope
        while scope is not None:
            names += [*scope.fields, *scope.names]
            scope = scope.outer
        return names

    def _of_copies(self, wanted: str) -> str | None:
        """The help for the name, or an output, of what `repeat` made many of, where one value is wanted."""
        meant = (wanted, wanted.removesuffix("s"), f"{wanted}.position")
        together, every = next(((one, found) for one in meant if (found := self.copies_of(one))), ("", []))
        if not every:
            return None
        head, _, tail = every[0].partition(".0.")
        help = f"its copies are {head}.0, {head}.1, ...: one is `{every[0]}`"
        return f"{help}, all of them in a list of places `{together}`" if tail.endswith("position") else help

    def _copy_number(self, wanted: str) -> str | None:
        """The help for the number of a copy by another program's name: the name that it has in the copies around."""
        scope = self.scope if wanted.lower() in COPY_NUMBERS else None
        while scope is not None:
            for name, node in scope.fields.items():
                text = node.span.text
                if isinstance(node, Scalar) and node.kind == "integer" and text != node.text:  # made by `repeat`
                    here = f"the number of a copy is `{name}` here"
                    named = text[:-1] if text.startswith("{") and "\n" not in text else ""
                    return f"{here}; write `repeat: {named}, as: {wanted}}}` for another name" if named else here
            scope = scope.outer
        return None

    def _some_output(self, task: str) -> str:
        outputs = self.outputs_of(task) or {}
        fields = [name for name, gives in outputs.items() if gives.type.shape == (None,)]
        places = [name for name in ("position", "positions") if name in outputs]
        return f"{task}.{next(iter([*places, *fields, *outputs]), 'position')}"


def _words(node: Node) -> list[str]:
    """The first pieces of all words in a value that may be names, in the order of the text."""
    match node:
        case Scalar(text=text):
            return [word.partition(".")[0] for word in WORDS.findall(text)]
        case Sequence(items=items):
            return [word for item in items for word in _words(item)]
    return [word for item in (*node.keys.values(), *node.entries.values()) for word in _words(item)]
