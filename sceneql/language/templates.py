"""Expansion of templates, parts, copies and defaults to plain entries, each with its scope."""

from __future__ import annotations

import re
from collections.abc import Iterator
from collections.abc import Mapping as Table
from collections.abc import Sequence as List
from contextlib import suppress
from dataclasses import dataclass
from typing import Final

from sceneql.language.copies import Copies, in_braces
from sceneql.language.dashed import names_alone, undashed
from sceneql.language.repeat import numbered, read_repeat
from sceneql.language.scope import Broken, Entry, Expanded, Given, Scope
from sceneql.language.sections import Written, duplicate, empty, read_entry, section, with_known_keys
from sceneql.language.tree import Mapping, Node, Scalar, Sequence, broken, hole, unsure
from sceneql.quantities.diagnostic import Diagnostics, Note, nearest, suggestion
from sceneql.quantities.span import Span

__all__ = ["Entry", "Expanded", "Given", "Scope", "expand", "filled"]

MOST_NESTED: Final = 64
MOST_PARTS: Final = 100_000
_CALLED = re.compile(r"(\w+)\(([^()]*)\)")
_INSTANCE, _FIELD = re.compile(r"(\w+)\((.*)\)", re.DOTALL), re.compile(r"(\w+)\s*=\s*(?!=)")
_ENDING = re.compile(r"(?<=\w)\.(mp4|mov|avi|gif|webm|png|jpe?g|csv|npz)$")
"""How files are called, whose ending the word of an output tells."""
_EQUALS = re.compile(r"(\w+)\s*:?=\s*(\S+(?:[ \t]\S+)*)")
"""A value given as in other languages, ``k = 10 N/m``, alone on its line."""


def _instance(word: str, known: Table[str, Node]) -> str | None:
    """The help for a template that is called as a function of other languages, ``tree(at=[0, 0, 0], tall=1 m)``."""
    call = _INSTANCE.fullmatch(word.strip())
    if call is None or call[1] not in known:
        return None
    fields = _FIELD.sub(r"\1: ", call[2])
    template = known[call[1]]
    own = template.entries.get("fields") if isinstance(template, Mapping) else None
    values = re.split(r",\s*(?![^(\[]*[)\]])", call[2])
    if fields == call[2] and fields and isinstance(own, Mapping) and len(values) <= len(own.entries):  # by their order
        fields = ", ".join(f"{name}: {value}" for name, value in zip(own.entries, values, strict=False))
    return f"write `{{{call[1]}: {{{fields}}}}}`" if fields != call[2] else f"write `{call[1]}`" if not fields else None


def expand(root: Mapping, families: List[str], lost: Broken, found: Diagnostics, *, repeats: bool = True) -> Expanded:
    """The entries of a script, with templates and copies written out and defaults filled in.

    ``lost``: the names of unreadable entries, to which those of wrong entries are added; ``repeats``: whether `repeat`
    stands anywhere. Raises ScriptError where there are more parts than are checked.
    """
    expander = _Expander(root, families, lost, found, repeats)
    expander.unique(root)
    for name in expander.templates:
        expander.template(name)
    try:
        expander.body(root, _Place("", None, ()))
    except _FullError:
        message = f"templates and copies make more than {MOST_PARTS:,} parts"
        key = root.keys.get("parts") or next(iter(root.keys.values()))
        help = "a model such as `particles` holds many bodies in one part"
        found.error("too-many-parts", message, key.span, help=help)
        found.raise_errors()  # checking them all would take the time that the limit saves
    for name in expander.templates:
        expander.unmade(name)
    return expander.done


def filled(word: str, fields: Node | None, defaults: Table[str, Node], span: Span) -> Node | None:
    """The fields of a word, completed by its defaults."""
    more = defaults.get(word)
    if not isinstance(more, Mapping) or not (fields is None or isinstance(fields, Mapping)):
        return fields
    if fields is None:
        return Mapping(dict(more.entries), dict(more.keys), True, span.source, span.start, span.end, more.partial)
    result = fields.holding(more.entries | fields.entries, more.keys | fields.keys)
    result.partial = fields.partial or more.partial
    return result


class _FullError(Exception):
    """There are more than MOST_PARTS parts."""


@dataclass(frozen=True, slots=True)
class _Place:
    """The place where entries are added.

    Prefix of names, scope, (prefix, table of names) of each enclosing instance, and the templates around.
    """

    front: str
    scope: Scope | None
    around: tuple[tuple[str, dict[str, str]], ...]
    templates: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class _Template:
    fields: dict[str, Node]
    gives: dict[str, Node]
    body: Mapping
    partial: bool
    """Whether the template may have more fields than were readable."""


class _Expander:
    def __init__(self, root: Mapping, families: List[str], lost: Broken, found: Diagnostics, repeats: bool) -> None:
        self.families, self.found = families, found
        self.done = Expanded(broken=lost)
        self.define = self.named(root, "define")
        self.templates = self.named(root, "templates")
        self.defaults = self.named(root, "defaults")
        for word, node in self.defaults.items():
            if not (isinstance(node, Mapping) or broken(node)):
                help = f"they stand by word, as of all spheres: write `sphere: {{{word}: {node.span.text}}}`"
                help = help if isinstance(node, Scalar) else f"write `{word}: {{field: value}}`"
                found.error("section-shape", f"the defaults of '{word}' are fields with values", node.span, help=help)
        self.read: dict[str, _Template | None] = {}
        self.made: set[str] = set()
        self.sections = self.done.sections
        self.inner = Copies(self.define, self.done.broken, found, repeats)
        self.count = 0

    def named(self, mapping: Mapping, key: str) -> dict[str, Node]:
        """The entries of a section that maps names; none after reporting any other value."""
        node = mapping.entries.get(key)
        if node is None or empty(node):
            return {}
        if isinstance(node, Mapping):
            self.done.broken.any |= node.partial
            return node.entries
        self.done.broken.any = True
        if broken(node):
            return {}
        pieces = [one.strip() for one in re.split(r"[;\n]", node.span.text)] if isinstance(node, Scalar) else []
        equals = [_EQUALS.fullmatch(one) for one in pieces if one]
        told = " and ".join(f"`{one[1]}: {one[2]}`" for one in equals if one is not None)
        each = ", each on a line of its own" if len(equals) > 1 else ""
        inner = undashed(node) or (names_alone(node) if key == "fields" else None) or "{name: ...}"
        help = f"write {told}{each}" if equals and all(equals) else f"write `{key}: {inner}`"
        self.found.error("section-shape", f"'{key}' holds values by name", node.span, help=help)
        return {}

    def unique(self, root: Mapping) -> None:
        """Report names that two parts or defines of the script share."""
        seen: dict[str, Scalar] = {}
        for key in [key for key in root.entries if key in ("define", "parts", *self.families)]:
            node = root.entries[key]
            for name, written in node.keys.items() if isinstance(node, Mapping) else ():
                if name == "time":
                    message = "'time' is the time of the film's moments, and cannot name anything else"
                    self.found.error("part-name", message, written.span)
                if key == "define" and name[:1].isdigit() and "." not in name:
                    message = f"'{name}' cannot be the name of a value"
                    better = re.sub(r"^(\d+)_*(\w*)$", r"\2\1", name)
                    help = f"a name begins with a letter: write `{better}`, here and where it is used"
                    self.found.error("part-name", message, written.span, help=help)
                    for part in (name, name.lstrip("0123456789_"), better):
                        self.done.broken.add(part)
                if name in seen:
                    duplicate(name, seen[name], written, self.found)
                else:
                    seen[name] = written

    def template(self, name: str) -> _Template | None:
        """A template as written, with its shape checked once; None after reporting errors."""
        if name not in self.read:
            self.read[name] = None
            node = self.templates[name]
            if broken(node):
                return None
            if not isinstance(node, Mapping):
                help = "it holds `fields:` and sections such as `objects:`"
                self.found.error("section-shape", f"the template '{name}' is not a mapping", node.span, help=help)
                return None
            self.done.broken.any |= node.partial
            known = ("fields", "gives", "parts", *self.families)
            node = with_known_keys(node, known, "a template", self.done.broken, self.found)
            written = node.entries.get("fields")
            partial = node.partial or (written is not None and (unsure(written) or isinstance(written, Sequence)))
            self.read[name] = _Template(
                self.named(node, "fields"), self.named(node, "gives"), self.local(name, node), partial
            )
        return self.read[name]

    def local(self, template: str, node: Mapping) -> Mapping:
        """The sections of a template as mappings; names used twice are reported."""
        body = Mapping({}, {}, node.flow, node.source, node.start, node.end)
        fields = node.entries.get("fields")
        seen: dict[str, Scalar] = dict(fields.keys) if isinstance(fields, Mapping) else {}
        for key in ("parts", *self.families):
            if key in node.entries:
                inner = section(key, node.entries[key], seen, self.found)
                body.entries[key], body.keys[key] = inner, node.keys[key]
                for name, written in inner.keys.items():
                    if name in seen:
                        message = f"'{name}' is used twice in the template '{template}'"
                        note = Note("it stands here first", seen[name].span)
                        self.found.error("duplicate-name", message, written.span, help="rename one", notes=[note])
                    seen[name] = written
        return body

    def body(self, body: Mapping, place: _Place) -> None:
        """Add the entries and instances of a script's or a template's sections."""
        for family in self.families:
            for name, node in self.named(body, family).items():
                if (written := self.entry(name, node, body.entries[family], place)) is not None:
                    for full, scope in self.copies(name, written.repeat, place):
                        self.add(family, full, written, body.entries[family], name, scope, place)
        for name, node in self.named(body, "parts").items():
            if (written := self.entry(name, node, body.entries["parts"], place)) is not None:
                self.instances(name, written, place)

    def entry(self, name: str, node: Node, section: Node, place: _Place) -> Written | None:
        """The parts of an entry with a valid name and shape; None after a report."""
        assert isinstance(section, Mapping)
        key = section.keys[name]
        if not name.split(".")[0].isidentifier() or (key.text == name and "." in name):
            message = f"'{name}' cannot be the name of a part"
            letters = "a name is made of letters, digits and underscores, and begins with a letter"
            better = re.sub(r"\W+", "_", _ENDING.sub("", name)).strip("_")
            letters = f"write `{better}`: {letters}" if better.isidentifier() else letters
            called = _CALLED.fullmatch(name)
            letters = (
                letters if called is None else f"fields stand in braces: write `{{{called[1]}: {{...: {called[2]}}}}}`"
            )
            help = numbered(name) or letters
            self.found.error("part-name", message, key.span, help=help)
            for part in (name, *re.split(r"\W+", name)):  # as it may be written in an expression
                self.done.broken.add(part)
            return None
        written = read_entry(f"'{name}'", node, self.found, self.families)
        if written is None:
            self.done.broken.add(place.front + name)
        return written

    def copies(self, name: str, repeat: Node | None, place: _Place) -> Iterator[tuple[str, Scope | None]]:
        """Name in the whole script and scope of each copy of an entry; a single pair without `repeat`."""
        full = place.front + name
        if repeat is None:
            self.one_more()
            yield full, place.scope
        elif (times := read_repeat(repeat, place.scope, self.define, self.done.broken, self.found)) is None:
            self.done.broken.add(full)
        else:
            self.group(full, place)
            for number in range(times.count):
                self.one_more()
                yield f"{full}.{number}", Scope({}, {times.symbol: times.number(number)}, place.scope)

    def one_more(self) -> None:
        """Count a part or an instance. Raises _FullError when there are too many."""
        self.count += 1
        if self.count > MOST_PARTS:
            raise _FullError

    def group(self, name: str, place: _Place) -> None:
        """Register a name as a group of parts, also with the enclosing instances."""
        self.done.groups.setdefault(name, [])
        for front, names in place.around:
            names[name.removeprefix(front)] = name

    def add(
        self, family: str, name: str, written: Written, section: Node, key: str, scope: Scope | None, place: _Place
    ) -> None:
        """Add one entry, and register its name with the enclosing instances."""
        assert isinstance(section, Mapping)
        span, word = section.keys[key].span, written.word.text
        own = written.fields
        if own is not None and scope is not None and scope is not place.scope:
            own = in_braces(own, scope)
        fields = filled(word, own, self.defaults, written.word.span)
        fields = self.inner.written_out(fields, scope)
        entry = Entry(name, word, fields, span, written.word.span, scope)
        self.sections.setdefault(family, {})[name] = entry
        for front, names in place.around:
            names[name.removeprefix(front)] = name
        whole = name
        while (at := whole.rfind(".")) > 0:
            whole = whole[:at]
            if whole in self.done.groups:
                self.done.groups[whole].append(name)

    def instances(self, name: str, written: Written, place: _Place) -> None:
        """Add an instance of a template for each copy."""
        word = written.word
        if word.text not in self.templates:
            self.done.broken.add(place.front + name)
            if word.text in self.done.broken:
                return
            help = (
                _instance(word.text, self.templates)
                or suggestion(word.text, self.templates)
                or "declare it under `templates:`"
            )
            self.found.error("unknown-template", f"there is no template '{word.text}'", word.span, help=help)
            return
        if word.text in place.templates:
            self.done.broken.add(place.front + name)
            help = "a part cannot be made of itself; remove this instance"
            circle = " in ".join(reversed([*place.templates[place.templates.index(word.text) :], word.text]))
            self.found.error(
                "template-cycle", f"the template '{word.text}' holds itself: {circle}", word.span, help=help
            )
            return
        if len(place.templates) >= MOST_NESTED:
            self.found.error("too-deep", f"templates hold each other more than {MOST_NESTED} levels deep", word.span)
            return
        template = self.template(word.text)
        given = self.given(word, written.fields, template)
        if template is None or given is None:
            self.done.broken.add(place.front + name)
            return
        for full, outer in self.copies(name, written.repeat, place):
            self.group(full, place)
            own = given
            if outer is not None and outer is not place.scope:
                own = {key: in_braces(node, outer) for key, node in given.items()}
            self.instance(word.text, template, own, full, outer, place)

    def instance(
        self, name: str, template: _Template, given: dict[str, Node], full: str, outer: Scope | None, place: _Place
    ) -> None:
        """Add the entries of one instance of a template; ``full`` is the instance's name in the whole script."""
        self.made.add(name)
        scope = Scope({}, given, outer)
        for key, node in template.fields.items():
            if key not in given:
                scope = Scope({}, {key: node}, scope)
        names: dict[str, str] = {}
        front = f"{full}."
        scope = Scope(names, {}, scope)
        inner = _Place(front, scope, (*place.around, (front, names)), (*place.templates, name))
        self.body(template.body, inner)
        for key, node in template.gives.items():
            self.done.gives[front + key] = Given(node, scope)
            for before, known in inner.around:
                known[(front + key).removeprefix(before)] = front + key

    def unmade(self, name: str) -> None:
        """Add the entries of a template without an instance to `unmade`; its fields are not missed."""
        template = self.template(name)
        if template is None or name in self.made:
            return
        self.sections = self.done.unmade
        given: dict[str, Node] = {key: hole(node.span) for key, node in template.fields.items() if empty(node)}
        with suppress(_FullError):
            self.instance(name, template, given, f"the template {name}", None, _Place("", None, ()))

    def given(self, word: Scalar, fields: Node | None, template: _Template | None) -> dict[str, Node] | None:
        """The fields of an instance, None after reporting what is wrong with them."""
        if template is None:
            return None
        if fields is not None and broken(fields):
            return None
        if fields is not None and not isinstance(fields, Mapping):
            message = f"'{word.text}' takes fields with values"
            self.found.error("entry-shape", message, fields.span, help="write `{field: value}`")
            return None
        given = {} if fields is None else dict(fields.entries)
        for key in [key for key in given if key not in template.fields and not template.partial]:
            assert isinstance(fields, Mapping)
            message = f"the template '{word.text}' has no field '{key}'"
            near = suggestion(key, template.fields)
            self.found.error(
                "unknown-field",
                message,
                fields.keys[key].span,
                help=near or f"it has {', '.join(template.fields) or 'none'}",
            )
            if near is not None:  # a misspelled field is not missing as well
                given.setdefault(nearest(key, template.fields) or "", hole(fields.keys[key].span))
        for key, node in template.fields.items():
            if key in given and empty(given[key]):
                message = f"the field '{key}' of '{word.text}' has no value"
                help = f"write `{key}: ...`" if empty(node) else "write one, or leave the field out to have its default"
                self.found.error("missing-field", message, given[key].span, help=help)
                given[key] = hole(given[key].span)
            elif empty(node) and key not in given:
                given[key] = hole(word.span)
                if isinstance(fields, Mapping) and fields.partial:
                    continue
                note = Note("it has no default", node.span)
                message = f"'{word.text}' needs '{key}'"
                self.found.error("missing-field", message, word.span, help=f"write `{key}: ...`", notes=[note])
        return given
