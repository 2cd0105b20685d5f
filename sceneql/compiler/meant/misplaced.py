"""Help for a field, a word or a part that stands at the left margin, as a section: the entry in which it belongs.

``reader`` is a `Reader` (`sceneql.compiler.read`) of the script's settings.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, get_args

from pydantic import BaseModel

from sceneql.compiler.catalogue import Catalogue
from sceneql.compiler.meant.chained import mended
from sceneql.compiler.meant.likely import wrong_as
from sceneql.compiler.meant.together import together
from sceneql.compiler.meant.unknown import DEFAULT, having_fields
from sceneql.compiler.meant.values_elsewhere import quantities_fitting
from sceneql.kinds import Settings, written_name
from sceneql.language.one_line import one_line
from sceneql.language.script import Script
from sceneql.language.tree import Mapping, Node, Scalar, Sequence
from sceneql.quantities.diagnostic import STRONG, Diagnostics, nearest, same_as
from sceneql.quantities.instead import instead

ORDER = ("solvers", "outputs", "cameras", "objects", "contacts", "lights", "overlays", "materials", "models", "forces")
"""Families in whose words a field is looked for, the likeliest first."""
PLAIN = 3
"""Number of the first of them whose fields by other names are meant by nothing else."""
USUAL = {**DEFAULT, "solvers": "rk4", "lights": "sun", "materials": "glossy", "models": "particles"}
"""The word of a family that is shown where several have a field."""
NAMES = {"outputs": "film", "cameras": "main", "solvers": "main", "contacts": "touch"}
"""Names of parts in examples."""
SETTING = "clock"
"""The group of settings whose fields stand at the left margin in other programs."""
LENGTHS = ("time", "duration", "length", "seconds")
"""Sections of other programs for how long a film lasts."""
SHOWN = 200
"""Longest value that a message repeats."""
VARIED = ("solvers", "cameras", "outputs")
"""Families of which one part by another word makes a variant."""
SWITCHES = ("yes", "true", "on")


@dataclass(frozen=True, slots=True)
class _Section:
    """A section that there is not: its key and value; where it stands."""

    key: str
    value: Node
    script: Script
    catalogue: Catalogue
    reader: Any
    own: bool
    """Whether there is a sentence on its key: then only little is looked at by other names."""

    def entries(self) -> Iterator[str]:
        """The entries that it is most likely meant as, the likeliest first."""
        yield from self._as_setting()
        for exact in (True, False):
            yield from self._in_setting(exact)
            yield from self._word(exact)
            yield from self._single() if exact else self._as_output()
            yield from self._in_word(exact)

    def _as_setting(self) -> Iterator[str]:
        """It as the clock: ``animation: {fps: 24, duration: 4 s}``."""
        (cls,) = _records(Settings.model_fields[SETTING])
        if self.key in LENGTHS and SETTING not in self.script.root.entries and self._takes(cls, "end", self.value):
            yield f"{SETTING}: {{end: {one_line(self.value)}}}"
        told = self._renamed(cls)
        if told and SETTING not in self.script.root.entries:
            yield f"{SETTING}: {{{told}}}"

    def _as_output(self) -> Iterator[str]:
        """It as an output: ``render: {size: 720p}``."""
        cls = self.catalogue.load("outputs", USUAL["outputs"])
        if self.own and same_as(self.key, ["outputs"]) is None:
            return
        if cls is not None and (told := self._renamed(cls)):
            yield self._part("outputs", NAMES["outputs"], f"{{{USUAL['outputs']}: {{{told}}}}}")

    def _renamed(self, cls: type[BaseModel]) -> str:
        """Its fields as those of a record, where this has all of them, by other names too; else empty."""
        fields = self.value.entries if isinstance(self.value, Mapping) else {}
        told = [(_field(cls, name, exact=False), node) for name, node in fields.items()]
        if not all(field is not None and self._takes(cls, field, node) for field, node in told):
            return ""
        return ", ".join(f"{field}: {one_line(node)}" for field, node in told)

    def _named(self, cls: type[BaseModel]) -> str:
        """Its fields under the names that a record has for them, where it has all of them; else empty."""
        fields = self.value.entries if isinstance(self.value, Mapping) else {}
        ours = [written_name(name) for name in cls.model_fields]
        told = [(nearest(name, ours, STRONG), node) for name, node in fields.items()]
        known = all(field is not None for field, _ in told)
        return ", ".join(f"{field}: {one_line(node)}" for field, node in told) if known else ""

    def _in_setting(self, exact: bool) -> Iterator[str]:
        """It as a field of the clock: ``fps: 24``."""
        (cls,) = _records(Settings.model_fields[SETTING])
        field = _field(cls, self.key, exact)
        given = self.script.root.entries.get(SETTING)
        own = given.entries if isinstance(given, Mapping) else {}
        if field is not None and field not in own and (text := self._taken(cls, field)) is not None:
            fields = [f"{name}: {one_line(one)}" for name, one in own.items()]
            yield f"{SETTING}: {{{', '.join([*fields, f'{field}: {text}'])}}}"

    def _word(self, exact: bool) -> Iterator[str]:
        """It as a word of a family, with its fields, or with a value of one of them: ``gravity: 1.62 m/s^2``."""
        value, text = self.value, one_line(self.value)
        words = [(family, self.key) for family in self.catalogue.families_of(self.key)]
        if not exact:
            others = [] if self.own else [(one, same_as(self.key, self.catalogue.words(one))) for one in ORDER]
            words = [(family, word) for family, word in others if word is not None]
        for family, key in words:
            cls = self.catalogue.load(family, key)
            name = NAMES.get(family, f"my_{key}")
            if cls is None:
                continue
            needed = [key for key, info in cls.model_fields.items() if info.is_required()]
            if isinstance(value, Mapping) and {*value.entries} <= {*map(written_name, cls.model_fields)}:
                yield self._part(family, name, f"{{{key}: {text}}}")
            elif isinstance(value, Scalar) and value.text.lower() in SWITCHES:
                yield self._part(family, "", key)
            elif isinstance(value, Scalar):
                fits = list(quantities_fitting(self.reader, value, cls.model_fields))
                fits = [one for one in fits if self._takes(cls, written_name(one), value)]
                fits = fits or (needed if len(needed) == 1 and value.kind == "text" else [])
                if len(fits) == 1:
                    yield self._part(family, name, f"{{{key}: {{{written_name(fits[0])}: {text}}}}}")

    def _single(self) -> Iterator[str]:
        """It as the only part of a section, under a name: ``camera: {position: 0 1 4 m}``, ``light: sun``."""
        family, value = f"{self.key}s", self.value
        if family not in self.catalogue.families:
            return
        name = NAMES.get(family, f"my_{self.key}")
        choices = self.catalogue.words(family)
        word = None if not isinstance(value, Scalar) else value.text if value.text in choices else None
        if isinstance(value, Scalar) and (word := word or same_as(value.text, choices)) is not None:
            yield self._part(family, name, word)
        if not isinstance(value, Mapping) or not value.entries:
            return
        if len(value.entries) == 1 and self.catalogue.load(family, next(iter(value.entries))) is not None:
            yield self._part(family, name, one_line(value))
        elif all(self._has_word(family, one) for one in value.entries.values()):
            yield f"{family}: {one_line(value)}"
        elif words := having_fields(list(value.entries), family, self.catalogue):
            word = USUAL[family] if USUAL.get(family) in words else words[0]
            yield self._part(family, name, f"{{{word}: {one_line(value)}}}")
        elif (word := nearest(next(iter(value.entries)), choices, STRONG)) is not None and len(value.entries) == 1:
            yield self._part(family, name, f"{{{word}: {one_line(next(iter(value.entries.values())))}}}")
        elif (cls := self.catalogue.load(family, USUAL.get(family, ""))) is not None and (told := self._named(cls)):
            yield self._part(family, name, f"{{{USUAL[family]}: {{{told}}}}}")

    def _has_word(self, family: str, part: Node) -> bool:
        """Whether a part has a word of a family."""
        word = (
            next(iter(part.entries), "") if isinstance(part, Mapping) else part.text if isinstance(part, Scalar) else ""
        )
        return self.catalogue.load(family, word) is not None

    def _in_word(self, exact: bool) -> Iterator[str]:
        """It as a field of a part of the script, or of a word: ``layout: [{each: variant}]`` of a video."""
        for family in ORDER if exact or not self.own else ORDER[:PLAIN]:
            for name, entry in self.script.sections.get(family, {}).items():
                cls = self.catalogue.load(family, entry.word)
                field = None if cls is None else _field(cls, self.key, exact)
                given = entry.fields.entries if isinstance(entry.fields, Mapping) else {}
                if cls is None or field is None or field in given:
                    continue
                if (text := self._taken(cls, field)) is not None:
                    inner = ", ".join(
                        [*(f"{one}: {one_line(node)}" for one, node in given.items()), f"{field}: {text}"]
                    )
                    yield f"{family}: {{{name}: {{{entry.word}: {{{inner}}}}}}}"
            usual = [USUAL[family]] if family in USUAL else []
            for word in dict.fromkeys([*usual, *self.catalogue.words(family)]):
                cls = self.catalogue.load(family, word)
                field = None if cls is None else _field(cls, self.key, exact)
                if cls is not None and field is not None and (text := self._taken(cls, field)) is not None:
                    yield self._part(family, NAMES.get(family, "name"), f"{{{word}: {{{field}: {text}}}}}")

    def _taken(self, cls: type[BaseModel], field: str) -> str | None:
        """Its value as a field of a record takes it: as it is written, or with its mistakes mended."""
        if self._takes(cls, field, self.value):
            return one_line(self.value)
        found = mended(self.reader, self.value, cls, field) if isinstance(self.value, Scalar) else None
        return None if found is None else found[0]

    def _takes(self, cls: type[BaseModel], field: str, value: Node) -> bool:
        """Whether a field of a record accepts a value."""
        info = next(info for name, info in cls.model_fields.items() if written_name(name) == field)
        wrong = wrong_as(self.reader, value, info, field)
        return wrong is None or (wrong == () and isinstance(value, Sequence))  # names that it has are not looked up

    def _part(self, family: str, name: str, part: str) -> str:
        """A part in its section, behind those that stand there in a line; a list where the section is one."""
        given = self.script.root.entries.get(family)
        text = "" if given is None else one_line(given)
        inner = text[1:-1] + ", " if text[1:-1].strip() and "\n" not in text and len(text) <= SHOWN else ""
        listed = text.startswith("[") or (family == "forces" and not text) or not name
        return f"{family}: [{inner}{part}]" if listed else f"{family}: {{{inner}{name}: {part}}}"


def improve_sections(script: Script, catalogue: Catalogue, reader: Any, found: Diagnostics) -> None:
    """Let the errors of unknown sections say in which entry what is written there belongs, with its value."""
    places = {node.span.start: key for key, node in script.root.keys.items()}
    _improve_variants(script, catalogue, found)
    known = [*catalogue.families, *Settings.model_fields]
    for k, one in enumerate(found.found):
        key = places.get(-1 if one.span is None else one.span.start)
        if one.code != "unknown-section" or key is None or (one.help or "").startswith("what belongs"):
            continue
        value = script.root.entries[key]
        text = one_line(value)
        guessed = (one.help or "").startswith("did you mean")
        near = guessed and f"{key}s" not in known and nearest(key, known, STRONG) is not None
        if near or not text or "\n" in text or len(text) > SHOWN:
            continue
        section = _Section(key, value, script, catalogue, reader, own=instead("section", key) is not None)
        told = next(section.entries(), None)
        by_frames = together(key, [key], script.root, ("end", "fps"))
        if by_frames is not None and "end" in by_frames:
            found.found[k] = replace(one, help=f"{by_frames} in the `{SETTING}`")
            continue
        if told is not None:
            found.found[k] = replace(one, help=f"write `{told}`")


def _records(info: Any) -> Iterator[type[BaseModel]]:
    """The classes of a field's records."""
    for cls in (info.annotation, *get_args(info.annotation)):
        if isinstance(cls, type) and issubclass(cls, BaseModel):
            yield cls


def _field(cls: type[BaseModel], key: str, exact: bool) -> str | None:
    """The field of a record by its name, or (``exact`` False) by one that other programs have."""
    known = [written_name(name) for name in cls.model_fields]
    return key if key in known else None if exact else same_as(key, known)


def _improve_variants(script: Script, catalogue: Catalogue, found: Diagnostics) -> None:
    """Let the error of variants in a list of words of one family say the path of what they vary: of solvers."""
    node = script.root.entries.get("variants")
    items = node.items if isinstance(node, Sequence) else []
    words = [one.text for one in items if isinstance(one, Scalar)]
    if node is None or not words or len(words) < len(items):
        return
    same = [family for family in VARIED if {*words} <= {*catalogue.choices(family)}]
    if not same:
        return
    part = next(iter(script.sections.get(same[0], {})), NAMES.get(same[0], "main"))
    told = ", ".join(f"{word}: {{{same[0]}.{part}: {word}}}" for word in words)
    for k, one in enumerate(found.found):
        if one.code == "section-shape" and one.span == node.span:
            help = f"each has a name, and the value by its path: write `variants: {{{told}}}`"
            found.found[k] = replace(one, help=help)
