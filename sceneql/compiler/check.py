"""Check of a script: every entry is read by its word's class, and all errors are found in one run.

Unused parts are checked too, since an error in an unused part is still an error; nothing is pruned here.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

from sceneql.compiler.catalogue import Catalogue
from sceneql.compiler.meant.by_record import balls_of, judged_as
from sceneql.compiler.meant.entries import improve_entries, typed_meant
from sceneql.compiler.meant.misplaced import improve_sections
from sceneql.compiler.meant.unknown import mover_of, report_unknown, word_having, word_meant
from sceneql.compiler.meant.unknown_part import (
    beside_world,
    of_law,
    other_family,
    part_meant,
    several_meant,
    shows_nothing,
    warn_of_another,
    word_for_name,
)
from sceneql.compiler.names import Names, Parsed
from sceneql.compiler.over_time import check_instants
from sceneql.compiler.problems import Unreadable
from sceneql.compiler.read import Reader
from sceneql.compiler.values import read_expr
from sceneql.compiler.values_below import values_of
from sceneql.graph import Task
from sceneql.kinds import Gives, Kind, Object, Quantity, Ref, Refers, Settings, Value, written_name
from sceneql.language.scope import Entry, Scope
from sceneql.language.script import Script
from sceneql.language.tree import Mapping as MappingNode
from sceneql.language.tree import Node, Scalar, unsure, whole, written
from sceneql.language.tree import Sequence as SequenceNode
from sceneql.quantities.diagnostic import Diagnostics, suggestion
from sceneql.quantities.expression import Type

SETTINGS = tuple(Settings.model_fields)
KEYS = (*SETTINGS, "sceneql", "define", "variants")
"""Top-level keys beside the families."""


@dataclass(frozen=True, slots=True)
class Checked:
    """The valid parts of a script: all of them where no error is recorded."""

    script: Script
    settings: Settings
    tasks: Mapping[str, Task]
    """In the order of the script; parts written in place stand before the part that holds them."""
    timed: bool
    """Whether the clock is valid or absent."""
    files: tuple[str, ...]
    """Paths of the files that its parts name, used or not."""
    without: frozenset[str] = frozenset()
    """Names of default parts that the script declines: `floor: none`."""
    implied: frozenset[str] = frozenset()
    """Names of default parts that the script refers to without writing them."""


def check(script: Script, catalogue: Catalogue, found: Diagnostics, parsed: Parsed | None = None) -> Checked:
    """Read every entry of a script; errors are recorded in ``found`` and wrong entries left out.

    ``parsed``: cache of texts parsed for other variants.
    """
    checker = _Checker(script, catalogue, found, parsed or Parsed())
    improve_entries(script, catalogue, found)
    for name, family in [*checker.family_of.items()]:
        if name in script.sections.get(family, ()):
            checker.task(family, name)
    made = dict(checker.tasks)
    for name, family in [*checker.family_of.items()]:  # of templates without an instance, and with a name used twice
        checker.task(family, name)
    checker.tasks = made
    checker.gives()
    checker.defaults()
    settings = checker.settings()
    improve_sections(script, catalogue, checker.reader(), found)
    tasks = checker.whole_tasks()  # what is broken may have been told before, as of a variant
    known = frozenset(checker.without), frozenset(checker.implied)
    return Checked(script, settings, tasks, checker.timed, tuple(checker.files), *known)


NONE, OPTIONAL = "none", {"floor": "plane"}
"""NONE stands in place of a word, for a default part that the script does without. OPTIONAL: the names of such parts,
and their words."""
WORLD = "world"
"""The name of the world, where a field may refer to it."""


class _Checker:
    def __init__(self, script: Script, catalogue: Catalogue, found: Diagnostics, parsed: Parsed) -> None:
        self.script, self.catalogue, self.found = script, catalogue, found
        self.tasks: dict[str, Task] = {}
        self.family_of: dict[str, str] = {}
        self.entries: dict[str, Entry] = {}
        self._done: set[str] = set()
        self._outputs: dict[int, tuple[Entry, Mapping[str, Gives] | None]] = {}
        self.timed = True
        self.files: list[str] = []
        self.without: set[str] = set()
        self.implied: set[str] = set()
        self.folder = Path(script.sources[0].name).parent
        for family, entries in (*script.sections.items(), *script.unmade.items()):
            for name, entry in entries.items():
                own = name if name not in self.entries else f"{name} of {family}"  # reported by the language
                self.family_of[own], self.entries[own] = family, entry
        templates = script.root.entries.get("templates")
        self.templates = templates.entries if isinstance(templates, MappingNode) else {}
        define = script.settings.get("define")
        self.names = Names(
            defines=define.entries if isinstance(define, MappingNode) else {},
            parts=self.entries,
            outputs_of=self.outputs_of,
            read=lambda node, names: read_expr(node, None, None, "define", names, found),
            found=found,
            given=script.gives,
            broken=script.broken,
            mover=lambda name: mover_of(name, self.entries, self.family_of),
            unsure=cache(self.unsure),  # cached: it reads a whole part, which many may name
            parsed=parsed,
            catalogue=catalogue,
        )

    def unsure(self, name: str) -> bool:
        """Whether the fields of a part are wrong or incomplete, so that it may have more outputs than are known."""
        entry = self.entries[name]
        cls, fields = self.catalogue.load(self.family_of[name], entry.word), entry.fields
        if cls is None or fields is None:
            return cls is None
        known = {written_name(each) for each in cls.model_fields}
        return not (isinstance(fields, MappingNode) and whole(fields) and known >= fields.entries.keys())

    def whole_tasks(self) -> dict[str, Task]:
        """The valid parts whose needs are all valid."""
        kept = dict(self.tasks)
        while lacking := [name for name, task in kept.items() if not all(need in kept for need in task.needs)]:
            for name in lacking:
                del kept[name]
        return kept

    def gives(self) -> None:
        """Read every output that a template instance gives, whether or not another part reads it."""
        for given in self.script.gives.values():
            self.names.read(given.node, replace(self.names, scope=given.scope))

    def defaults(self) -> None:
        """Check the words under ``defaults`` and the names of their fields, whether or not a part uses them."""
        section = self.script.root.entries.get("defaults")
        if not isinstance(section, MappingNode):
            return
        used = {entry.word for entry in self.entries.values()}
        for word, fields in section.entries.items():
            kinds = [cls for family in self.catalogue.families if (cls := self.catalogue.load(family, word))]
            if kinds and isinstance(fields, MappingNode):
                known = dict.fromkeys(written_name(name) for cls in kinds for name in cls.model_fields)
                report_unknown(fields, known, word, self.found)
                if word not in used:
                    self.unused_defaults(word, fields, kinds)
            elif not kinds:
                words = [each for family in self.catalogue.families for each in self.catalogue.words(family)]
                help = "defaults are written by word, `{sphere: {radius: 1 m}}`"
                help = suggestion(word, words) or help if isinstance(fields, MappingNode) else help
                if word in self.templates:
                    help = "the defaults of a template stand in its own `fields:`"
                self.found.error("unknown-word", f"'{word}' is no word", section.keys[word].span, help=help)

    def unused_defaults(self, word: str, fields: MappingNode, kinds: list[type[Kind]]) -> None:
        """Read the ``defaults`` of a word that no part uses; entries written in place there make no parts."""
        before = dict(self.tasks), dict(self.family_of), dict(self.entries)
        part = Entry(f"defaults.{word}", word, None, fields.span, fields.span, None)
        for cls in kinds:
            symbols = cls.formula_symbols(written(fields))
            solved = None if fields.partial else cls.formula_dimension(written(fields))
            reader = Reader(
                self.names,
                self.found,
                lambda node, mark, name: self.refer(node, mark, name, part),
                part.name,
                self.folder,
                self.files,
                symbols,
                solved,
            )
            for name, info in cls.model_fields.items():
                if (node := fields.entries.get(written_name(name))) is not None:
                    with suppress(Unreadable):
                        replace(reader, owner=f"{part.name}.{name}").field(node, info, written_name(name))
        self.tasks, self.family_of, kept = before
        self.entries.clear()  # cleared, not replaced: the names hold this dict
        self.entries.update(kept)

    def settings(self) -> Settings:
        """Read the top-level keys; every define is read, used or not."""
        for name, node in self.names.defines.items():
            self.names.define(name, node.span)
        given = {key: self.script.settings[key] for key in SETTINGS if key in self.script.settings}
        reader = self.reader()
        result: dict[str, Any] = {}
        for key, node in given.items():
            info = Settings.model_fields[key]
            try:
                result[key] = reader.field(node, info, key)
            except Unreadable:
                continue
        settings = Settings.model_validate(result, context=[])  # errors inside have been reported already
        self.timed = "clock" in result or "clock" not in given
        for expect in settings.expect.values() if self.timed else ():
            check_instants(expect, settings.clock.end, self.found)
        return settings

    def reader(self) -> Reader:
        """A reader of what is no part."""
        return Reader(self.names, self.found, lambda node, mark, name: None, "", self.folder, self.files)

    def kind(self, family: str, entry: Entry) -> tuple[type[Kind] | None, str]:
        """The class of an entry's word, or None after reporting that there is none, and the help that was given."""
        help = ""
        cls = self.catalogue.load(family, entry.word)
        if cls is None:
            words = self.catalogue.choices(family)
            hint = balls_of(self.names, entry.fields) if family == "objects" else None
            hint = hint or typed_meant(entry.fields, family, self.catalogue)
            hint = hint or word_meant(entry, family, self.catalogue, self.family_of, self.script)
            help = hint or "the words are " + ", ".join(words)
            self.found.error("unknown-word", f"'{entry.word}' is no word of {family}", entry.word_span, help=help)
        return cls, help

    def family(self, name: str) -> str:
        """The family of an entry's word; that of its section where the word is unknown."""
        cls = self.catalogue.load(self.family_of[name], self.entries[name].word)
        return self.family_of[name] if cls is None else cls.family

    def outputs_of(self, name: str) -> Mapping[str, Gives] | None:
        """The outputs of a part, found without reading its fields; None if it has none that can be known so."""
        if name not in self.entries:
            return None
        entry = self.entries[name]
        if id(entry) not in self._outputs:
            self._outputs[id(entry)] = entry, self._outputs_of(name, entry)
        return self._outputs[id(entry)][1]

    def _outputs_of(self, name: str, entry: Entry) -> Mapping[str, Gives] | None:
        cls, fields = self.catalogue.load(self.family_of[name], entry.word), entry.fields
        if cls is None or (fields is not None and unsure(fields)):
            return None
        outputs = dict(cls.outputs(written(fields) if isinstance(fields, MappingNode) else {}))
        if issubclass(cls, Object):
            for field_name, info in cls.model_fields.items():
                for mark in info.metadata:
                    if isinstance(mark, Quantity) and info.annotation is Value and mark.shape is not None:
                        outputs.setdefault(field_name, Gives(Type(mark.shape, mark.dimension), info.description or ""))
        return outputs

    def task(self, family: str, name: str) -> None:
        """Read one entry, once."""
        if name in self._done:
            return
        self._done.add(name)
        entry = self.entries[name]
        if entry.word == NONE and entry.fields is None and name in OPTIONAL:
            self.without.add(name)
            return
        known, help = self.kind(family, entry)
        cls = known or judged_as(entry, family, self.catalogue, self.names, help)
        if cls is None:
            return
        needs: list[str] = []
        names = replace(self.names, scope=entry.scope)

        def refer(node: Node, mark: Refers, anonymous: str) -> Ref | None:
            ref = self.refer(node, mark, anonymous, entry)
            if ref is not None and ref.name:
                needs.append(ref.name)
            return ref

        reader = Reader(
            names,
            self.found,
            refer,
            name,
            self.folder,
            self.files,
            copies=lambda node, mark: self.copies(node, mark, entry),
        )
        try:
            kind = reader.record(entry.fields, cls, entry.word_span, cls.__module__.rpartition(".")[2])
        except Unreadable:
            return
        if known is None:  # read only to report what is wrong in its fields
            return
        needs += [link.task for value in values_of(kind) for link in value.links]
        self.tasks[name] = Task(name, entry.word, kind, entry.span, tuple(dict.fromkeys(needs)))

    def refer(self, node: Node, mark: Refers, anonymous: str, entry: Entry) -> Ref | None:
        """The part that a field refers to, made of an entry written in place; None after an error."""
        if isinstance(node, Scalar):
            name = entry.scope.resolve(node.text) if entry.scope is not None else node.text
            if mark.bodies and name == WORLD:
                return Ref("", node.span)
            model, body = self.names.part_of(name)
            if mark.bodies and body and self.family(model) == mark.family:
                return self._body(node, model, body)
            if mark.bodies and name in self.entries and self.family(name) == mark.family:
                return self._body(node, name, "")
            if name in OPTIONAL and name in self.entries and self.entries[name].word == NONE:
                text = f"there is to be no '{name}': `{name}: {NONE}`"
                remedy = f"leave out `{name}: {NONE}`, or the name here"
                self.found.error("unknown-name", text, node.span, help=remedy)
                return None
            if name in self.entries and self.catalogue.load(self.family_of[name], self.entries[name].word) is None:
                return None  # its word is reported there
            if name in self.entries and self.family(name) in (mark.family, mark.also):
                if (wrong := shows_nothing(name, mark, self.names, self.catalogue)) is not None:
                    self.found.error("wrong-family", f"'{name}' shows no field in colors", node.span, help=wrong)
                    return None
                return Ref(name, node.span)
            if self.catalogue.load(mark.family, node.text) is not None:  # an object called `mirror` hides no material
                warn_of_another(node, mark.family, entry.name, self.entries, self.family_of, self.found)
                in_place = Entry(anonymous, node.text, None, node.span, node.span, entry.scope)
                return self._in_place(in_place, mark.family)
            if name in OPTIONAL and name not in self.entries and "objects" in (mark.family, mark.also):
                self.implied.add(name)
                return self._in_place(Entry(name, OPTIONAL[name], None, node.span, node.span, None), "objects")
            self._unknown(node, name, mark)
            return None
        named = word_for_name(anonymous, node, mark, self.catalogue)
        if isinstance(node, MappingNode) and len(node.entries) == 1 and not named:
            (word, fields), (key,) = next(iter(node.entries.items())), node.keys.values()
            scope = entry.scope if node.index is None else Scope({}, dict([node.index]), entry.scope)
            return self._in_place(Entry(anonymous, word, fields, node.span, key.span, scope), mark.family)
        if unsure(node):
            return None
        message = f"a name, or one entry `{{word: {{fields}}}}`, stands here for a part of {mark}"
        if mark.bodies and isinstance(node, SequenceNode):
            self.found.error("entry-shape", "a place is no body", node.span, help=beside_world(node.span.text))
            return None
        help = several_meant(node, mark, entry, self.catalogue) if isinstance(node, SequenceNode) else None
        if isinstance(node, MappingNode):
            help = named or word_having(node, mark.family, self.catalogue) or of_law(node, mark.family)
        self.found.error("entry-shape", message, node.span, help=help)
        return None

    def _body(self, node: Scalar, model: str, body: str) -> Ref | None:
        """A reference to a body of a model, or to the only one (``body`` empty); None after an error."""
        outputs = self.names.outputs_of(model)
        if outputs is None or self.names.unsure(model):
            return None  # it is reported there
        if (f"{body}.position" if body else "position") in outputs:
            return Ref(model, node.span, body)
        bodies = [one.removesuffix(".position") for one in outputs if one.endswith(".position")]
        message = f"'{model}' has no body '{body}'" if body else f"'{model}' is no single body"
        near = suggestion(body, bodies) if body else None
        one = (
            f"name one of its bodies, `{model}.{bodies[0]}`" if bodies else "name a model that is one body, or `world`"
        )
        self.found.error("no-body", message, node.span, help=near or one)
        return None

    def copies(self, node: Scalar, mark: Refers, entry: Entry) -> list[str]:
        """The parts of the mark's families that a collective name stands for."""
        name = entry.scope.resolve(node.text) if entry.scope is not None else node.text
        several = self.script.groups.get(name, ())
        return [part for part in several if self.family(part) in (mark.family, mark.also)]

    def _in_place(self, entry: Entry, family: str) -> Ref | None:
        if entry.name not in self.entries:
            self.entries[entry.name], self.family_of[entry.name] = entry, family
        self.task(family, entry.name)
        return Ref(entry.name, entry.span) if entry.name in self.tasks else None

    def _unknown(self, node: Scalar, name: str, mark: Refers) -> None:
        if name in self.entries:
            help = other_family(node.text, mark, self.names, self.catalogue, self.family)
            text = f"'{node.text}' is one of {self.family(name)}, not of {mark}"
            self.found.error("wrong-family", text, node.span, help=help)
            return
        if name in self.script.broken:
            return  # reported where it stands
        choices = [n for n in self.entries if self.family(n) in (mark.family, mark.also)]
        section, _, inside = name.partition(".")
        if section in self.script.sections and inside in self.entries:
            hint: str | None = f"a part is named without its section: write `{inside}`"
        elif several := self.script.groups.get(name):
            hint = (
                f"'{name}' is {len(several)} parts: name one, `{several[0]}`, or repeat this part, with `{name}.{{i}}`"
            )
        else:
            hint = part_meant(name, mark, choices, self.names, self.catalogue)
        self.found.error("unknown-name", f"no part of {mark} is called '{node.text}'", node.span, help=hint)
