"""Help for unknown words and fields: what was meant, or what is written in their place."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection
from collections.abc import Mapping as Naming
from itertools import pairwise
from typing import Any

from pydantic import BaseModel

from sceneql.compiler.annotations import quantities
from sceneql.compiler.catalogue import Catalogue
from sceneql.compiler.meant.grouped import Renamed, ends, flat, numbered_alike, of_inner
from sceneql.compiler.meant.other_shapes import other_word
from sceneql.compiler.meant.own_values import with_own
from sceneql.compiler.meant.together import filled, together
from sceneql.compiler.meant.unwrapped import unwrapped
from sceneql.compiler.names import Vocabulary
from sceneql.kinds import written_name
from sceneql.language.one_line import one_line
from sceneql.language.replaced import word_of
from sceneql.language.scope import Entry
from sceneql.language.script import Script
from sceneql.language.sections import empty
from sceneql.language.tree import Mapping, Node, Scalar
from sceneql.quantities.diagnostic import STRONG, Diagnostics, ScriptError, all_same_as, nearest, same_as
from sceneql.quantities.expression import Number, Vector
from sceneql.quantities.instead import instead
from sceneql.quantities.parser import parse_value

DEFAULT = {"cameras": "perspective", "outputs": "video", "objects": "sphere", "contacts": "collision"}
"""The word of a family that is shown where several have a field."""
MANY = 6
"""Largest number of words of which all that have a field are listed."""
THINGS, SHORT = ("objects", "models", "cameras", "lights"), 2
"""Families whose fields are looked for among their own words alone, and the longest name that tells too little."""
OFF = ("0", "0.0", "no", "false")
"""Texts of a field that says that something is not."""
SHOWN = 160
"""Longest list of instances that a message repeats."""
WITHOUT = "\0"
"""What lets helps differ that tell of no remedy, and so do not make one mistake of two."""
FEW = 4
"""Largest number of words with a field by which it is told what has that field."""

_UNPARTED = re.compile(r"(\w+)(?:(:)|\s*=| )(.*)")


def report_unknown(
    node: Mapping,
    known: Collection[str],
    title: str,
    found: Diagnostics,
    said_by: Naming[str, str] | None = None,
    family: str = "",
    renamed: Renamed | None = None,
    catalogue: Vocabulary | None = None,
    table: str = "",
    inside: Callable[..., str | None] = lambda name, value, written=None: None,
    whole: Callable[[str, Mapping], str | None] = lambda name, node: None,
) -> bool:
    """Report the fields of a mapping that are not among the known ones; returns whether there are none.

    ``said_by``: help texts for names that are likely to be tried; ``family``: that of the word, if any;
    ``renamed``: offers a known field; ``catalogue``: to look for names among all words and their fields;
    ``table``: the field, if it has to be given, that holds entries by names of the script; ``inside``: the help for
    a name and a value that stand one level further in; ``whole``: that for a name by all that stands beside it.
    """
    offer = renamed or (lambda field, value: (True, f"did you mean '{field}'?"))
    unknown = [name for name in node.entries if name not in known]
    told: dict[str, list[str]] = {}
    clean = not unknown
    for field in [name[:-2] for name in unknown if name.endswith(".0") and name[:-2] in known]:
        items = f"copies are the items of a list: write `{field}: [{one_line(node.entries[f'{field}.0'])}]`"
        message = f"{field} is one field, of which there are no copies"
        found.error("unknown-field", message, node.keys[f"{field}.0"].span, help=items)
        unknown = [name for name in unknown if name.rpartition(".")[0] != field]
    for name in unknown:
        help = together(name, unknown, node, known)
        help = help or (said_by or {}).get(name)
        help = help or whole(name, node)
        final = help is not None and name not in (said_by or {})  # what it says is of these values already
        help = help or instead(f"field.{title.partition('.')[0]}", name)
        help = help and filled(help, node.entries[name], known)
        if (written := _UNPARTED.fullmatch(name)) is not None and written[1] in known:
            space = ", with a space behind the colon" if written[2] else ""
            help = f"write `{written[1]}: {written[3].strip()}`{space}"
        beside = {one: each for one, each in node.entries.items() if one in known}
        help = help or inside(name, node.entries[name], beside)
        same = [] if help else [one for one in all_same_as(name, known) if one not in node.entries]
        offers = [offer(one, node.entries[name]) for one in same]
        help = help or next((text for fits, text in offers if fits), None)
        help = (
            help
            or numbered_alike(name, unknown, node, known, offer)
            or ends(name, unknown, node, known, offer)
            or flat(name, node.entries[name], known)
        )
        help = help or ((own := instead(f"field.{family}", name)) and filled(own, node.entries[name], ()))
        help = help or next((text for _, text in offers if "`" in text and "..." not in text), None)
        help = help or instead("field", name)
        help = help or (offers[0][1] if offers else None)
        help = help or inside(name, node.entries[name])
        help = help or _like(name, node.entries[name], known, offer, family, catalogue)
        help = help or of_inner(node.entries[name])
        if help is None and len(known) == 1 and (only := offer(next(iter(known)), node.entries[name]))[0]:
            help = only[1]
        if help is None and len(known) == 1:
            text = node.entries[name].span.text
            text = text if "\n" not in text and len(text) <= SHOWN else "..."
            help = f"it stands inside: write `{next(iter(known))}: {{{name}: {text}}}`"
        if help is None and table and table not in node.entries:
            inner = ", ".join(f"{one}: {node.entries[one].span.text}" for one in unknown)
            help = f"names of your own stand in `{table}`: write `{table}: {{{inner}}}`"
        for one in (name, *unknown) if help and not final else ():
            help = with_own(help or "", one, node.entries[one].span.text, beside=one != name)
        told.setdefault(help or f"it has {', '.join(known)}{len(told) * WITHOUT}", []).append(name)
    for help, names in told.items():
        text = f"field '{names[0]}'" if len(names) == 1 else f"fields {', '.join(map(repr, names))}"
        found.error("unknown-field", f"{title} has no {text}", node.keys[names[0]].span, help=help.rstrip(WITHOUT))
    return clean


def _like(
    name: str, value: Node, known: Collection[str], offer: Renamed, family: str, catalogue: Vocabulary | None
) -> str | None:
    """The help for a field by its letters: nearly a known one, a word, one of other words, or like a known one by far.

    What is like a known one only by far has to be a value that this takes: else it is most likely another thing.
    """
    if (near := nearest(name, known, STRONG)) is not None:
        return offer(near, value)[1]
    if (
        catalogue is not None
        and family
        and isinstance(value, Mapping)
        and (under := catalogue.families_of(name))
        and under[0] != family
    ):
        text = value.span.text if "\n" not in value.span.text else "{...}"
        whole = f"{under[0]}: {{NAME: {{{name}: {text}}}}}"
        return f"'{name}' is a word of `{under[0]}`: write `{whole}`: `sceneql words {name}`"
    fits, help = (False, "") if (far := nearest(name, known)) is None else offer(far, value)
    having = [] if catalogue is None or fits or len(name) <= SHORT else catalogue.having(name)
    own = [word for of, word in having if of == family in THINGS]
    usual = any(of in THINGS for of, _ in having)  # too usual a name to tell what was meant
    others = [] if usual or len(having) == 1 else having
    words = own or [word for _, word in others]
    if words and len(words) <= FEW:
        where = "" if own else f" under `{others[0][0]}`"
        these = ", ".join(f"`{word}`" for word in words)
        return f"it is a field of {these}{where}: `sceneql words {words[0]}`; here are {', '.join(known)}"
    return help if fits else None


def meant_field(name: str, known: Collection[str]) -> str | None:
    """The field most likely meant by an unknown name: its first word, if a colon or space is missing; the nearest."""
    written = _UNPARTED.fullmatch(name)
    return written[1] if written is not None and written[1] in known else nearest(name, known)


def word_meant(
    entry: Entry, family: str, catalogue: Catalogue, family_of: Naming[str, str], script: Script
) -> str | None:
    """The help for an entry with a word that is not in its family; ``family_of``: the families of all parts."""
    templates = script.root.entries.get("templates")
    if isinstance(templates, Mapping) and entry.word in templates.entries:
        every = [one for one in script.sections.get(family, {}).values() if one.word in templates.entries]
        inner = ", ".join(map(_instance, every))
        inner = inner if len(inner) <= SHOWN else f"{_instance(entry)}, ..." if len(every) > 1 else _instance(entry)
        return f"it is a template, of which parts are made: write `parts: {{{inner}}}`"
    if (replaced := _field_of_replaced(entry, family, script, catalogue)) is not None:
        return replaced
    words, fields = catalogue.choices(family), entry.fields
    if (plain := unwrapped(fields, family, catalogue)) is not None:
        return f"the word says the shape, and its fields stand in it: write `{plain}`"
    if family == "materials" and isinstance(fields, Mapping) and (looks := _told(fields, words, family, catalogue)):
        return looks
    inner = next(iter(fields.entries)) if isinstance(fields, Mapping) and len(fields.entries) == 1 else ""
    if fields is not None and entry.name == entry.word and catalogue.load(family, inner) is not None:
        return f"a part that has a name stands in no list: write `{family}: {{{entry.word}: {fields.span.text}}}`"
    if isinstance(fields, Scalar) and entry.name == entry.word and catalogue.load(family, fields.text) is not None:
        return f"a part that has a name stands in no list: write `{family}: {{{entry.word}: {fields.text}}}`"
    if (other := other_word(entry.word, family, fields)) is not None:
        return other
    if fields is None and family_of.get(entry.word, family) != family:
        pairs = having_fields(["between"], family, catalogue)
        word = DEFAULT.get(family) if DEFAULT.get(family) in pairs else next(iter(pairs), None)
        if word is not None:
            return f"a part is named within a word, `{{{word}: {{between: [{entry.word}, ...]}}}}`"
    if (joined := _joined(entry.word, family_of)) is not None:
        return joined
    if (same := same_as(entry.word, words)) is not None:
        return f"did you mean '{same}'?"
    if family in ("materials", "objects") and (other := _instead(entry, family)) is not None:
        return other
    if "//" in entry.word:
        return f"a comment begins with `#`: write `{entry.word.replace('//', '#', 1)}`"
    if (others := catalogue.families_of(entry.word)) and (family, others[0]) == ("models", "objects"):
        shape = f"objects: {{{entry.name}: {{{entry.word}: {{...}}}}}}"
        return f"a shape is an object, which a model moves: write `{shape}`, and `{{rigid: {{of: {entry.name}}}}}` here"
    if others := catalogue.families_of(entry.word):
        return f"it belongs under '{others[0]}:'"
    if fields is None and not entry.word.isidentifier() and (having := having_fields([entry.name], family, catalogue)):
        beside = [one.word for one in script.sections.get(family, {}).values() if one.word in having]
        word = next(iter(beside), DEFAULT.get(family) if DEFAULT.get(family) in having else having[0])
        text = f"main: {{{word}: {{{entry.name}: {entry.word}}}}}"
        return f"a part has a name, and a word around its fields: write `{text}`"
    table = script.root.entries.get(family)
    if isinstance(table, Mapping) and catalogue.load(family, entry.name) is not None:
        before = dict(pairwise(table.entries)).get  # the entry behind each
        above = next((one for one in table.entries if before(one) == entry.name), None)
        if above is not None and empty(table.entries[above]):
            return f"what belongs to `{above}` is indented below it: write two spaces more before `{entry.name}:`"
    if (named := catalogue.load(family, entry.name)) is not None:
        inner = _fields_of(entry, named)
        return f"'{entry.name}' is a word, but stands where a name does: write `name: {{{entry.name}: {inner}}}`"
    if (other := _instead(entry, family)) is not None:
        return other
    having = [] if fields is None else having_fields([entry.word], family, catalogue)
    if fields is not None and having:
        usual = next((word for word in DEFAULT.values() if word in having), having[0])
        word = nearest(entry.name, having, STRONG) or usual
        of = f" of {', '.join(sorted(having))}" if len(having) <= MANY else ""
        return f"it is a field{of}: write `{{{word}: {{{entry.word}: {fields.span.text}}}}}`"
    near, given = nearest(entry.word, words), list(fields.entries) if isinstance(fields, Mapping) else []
    cls = None if near is None else catalogue.load(family, near)
    known = [] if cls is None else [written_name(name) for name in cls.model_fields]
    if near is not None and (not given or any(nearest(name, known, STRONG) for name in given)):
        return f"did you mean '{near}'?"
    having = having_fields(given, family, catalogue) if given else []
    return f"words with such fields are {', '.join(having[:MANY])}" if having else None


def _instead(entry: Entry, family: str) -> str | None:
    """The sentence on a word of other programs, with the entry's own values."""
    other, place = instead(family, entry.word), entry.span
    if other is not None and entry.fields is not None and not isinstance(entry.fields, Mapping):
        return re.sub(r"<\w+#?[|][^>]*>", entry.fields.span.text.replace("\\", r"\\"), other, count=1)
    nothing = Mapping({}, {}, True, place.source, place.start, place.end)
    return None if other is None else filled(other, entry.fields if isinstance(entry.fields, Mapping) else nothing, ())


def _joined(text: str, family_of: Collection[str]) -> str | None:
    """The help for names of objects with a sign between them, as other programs join solids: ``a | b``."""
    found = re.fullmatch(r"(\w+)\s*([|+&*-])\s*(\w+)", text)
    if found is None or not {found[1], found[3]} <= {*family_of}:
        return None
    word = {"|": "union", "+": "union", "-": "difference"}.get(found[2], "intersection")
    return f"write `{{{word}: {{of: [{found[1]}, {found[3]}]}}}}`"


def _instance(entry: Entry) -> str:
    """An entry as a script writes it, in a line."""
    text = "" if entry.fields is None else entry.fields.span.text
    return f"{entry.name}: {{{entry.word}: {text}}}" if text and "\n" not in text else f"{entry.name}: {entry.word}"


def _fields_of(entry: Entry, cls: type[BaseModel]) -> str:
    """The fields of a word that stands in place of a name: those written, or the one that takes a number; else dots."""
    given = entry.fields
    if given is not None and entry.word in map(written_name, cls.model_fields) and "\n" not in given.span.text:
        return f"{{{entry.word}: {given.span.text}}}"
    try:
        value = None if given is not None else parse_value(entry.word, entry.word_span)
    except ScriptError:
        value = None
    if not isinstance(value, Number | Vector) or value.type.dimension is None:
        return "..."
    first = value.items[0] if isinstance(value, Vector) else value
    shape = (len(value.items),) if isinstance(value, Vector) else ()
    for name, info in cls.model_fields.items():
        if any((one.dimension, one.shape) == (first.type.dimension, shape) for one in quantities(info)):
            extra: Any = info.json_schema_extra or {}
            above = isinstance(value, Number) and {"above", "at_least"} & extra.get("limits", {}).keys()
            return f"{{{written_name(name)}: {entry.word.lstrip('-+ ') if above else entry.word}}}"
    return "..."


def _field_of_replaced(entry: Entry, family: str, script: Script, catalogue: Catalogue) -> str | None:
    """The help for a part that a variant replaces by a field of its word."""
    table = script.base.entries.get(family)
    own = word_of(table.entries.get(entry.name)) if isinstance(table, Mapping) and script.variant else ""
    cls = catalogue.load(family, own) if own else None
    if cls is None:
        return None
    if entry.fields is None and (taken := _fields_of(entry, cls)) != "...":
        field, _, value = taken.strip("{}").partition(": ")
        by_path = f"write `{script.variant}: {{{entry.name}.{field}: {value}}}`, which changes this field alone"
        return f"'{entry.name}' is a {own}, and not a value: {by_path}"
    if entry.fields is None or entry.word not in map(written_name, cls.model_fields):
        return None
    field = f"{entry.word}: {entry.fields.span.text}"
    by_path = f"write `{script.variant}: {{{entry.name}.{field}}}`, which changes this field alone"
    return f"it is a field of '{own}', which '{entry.name}' is: {by_path}"


def mover_of(name: str, entries: Naming[str, Entry], family_of: Naming[str, str]) -> str:
    """The model that moves an object, or its body that does, as ``stones.first``; empty where none does."""
    for part, entry in entries.items():
        if family_of[part] != "models" or not isinstance(entry.fields, Mapping):
            continue
        for key, node in entry.fields.entries.items():
            if key == "of" and isinstance(node, Scalar) and node.text == name:
                return part
            for body, inner in node.entries.items() if isinstance(node, Mapping) else ():
                of = inner.entries.get("of") if isinstance(inner, Mapping) else None
                if isinstance(of, Scalar) and of.text == name:
                    return f"{part}.{body}"
    return ""


def word_having(node: Mapping, family: str, catalogue: Catalogue) -> str | None:
    """The help for fields that stand without a word around them."""
    for key in ("type", "kind", "word"):
        told = node.entries.get(key)
        if isinstance(told, Scalar) and (word := same_as(told.text, catalogue.choices(family))) is not None:
            inner = ", ".join(f"{name}: {value.span.text}" for name, value in node.entries.items() if name != key)
            return f"the word stands around its fields: write `{{{word}: {{{inner}}}}}`"
    having, text = having_fields(list(node.entries), family, catalogue), node.span.text
    if (meant := _told(node, having or catalogue.choices(family), family, catalogue)) is not None:
        return meant
    if not having and (renamed := _renamed(node, family, catalogue)) is not None:
        return f"the word stands around its fields: write `{renamed}`"
    for name, value in () if having else node.entries.items():
        having = having_fields([name], family, catalogue)
        text = f"{{{name}: {value.span.text}}}"
        if having:
            break
    return (
        f"the word stands around its fields, {', '.join(having)}: write `{{{having[0]}: {text}}}`" if having else None
    )


def _renamed(node: Mapping, family: str, catalogue: Catalogue) -> str | None:
    """Fields, some of them by names of other programs, in the first word of a family that has them all."""
    for word in sorted(catalogue.choices(family), key=lambda one: one != DEFAULT.get(family)):
        cls = catalogue.load(family, word)
        known = [] if cls is None else [written_name(name) for name in cls.model_fields]
        named = {one: one if one in known else same_as(one, known) for one in node.entries}
        if node.entries and all(named.values()) and len({*named.values()}) == len(named):
            told = ", ".join(f"{named[one]}: {value.span.text}" for one, value in node.entries.items())
            return f"{{{word}: {{{told}}}}}"
    return None


def _told(node: Mapping, words: Collection[str], family: str, catalogue: Catalogue) -> str | None:
    """The help for fields that tell which of the words is meant, as ``metallic: 1``; None for others.

    Names of other programs tell more than those that the word has as well.
    """
    best, help = 0, None
    for word in words:
        cls = catalogue.load(family, word)
        called: Naming[str, str] = getattr(cls, "told_by", {})
        telling = {key for key, value in node.entries.items() if key in called and value.span.text not in OFF}
        weight = len(telling) + len(telling - set(called.values()))
        if cls is None or weight <= best:
            continue
        best, names = weight, set(map(written_name, cls.model_fields))
        kept = {
            called.get(key, key): one.span.text for key, one in node.entries.items() if called.get(key, key) in names
        }
        inner = ", ".join(f"{key}: {text}" for key, text in kept.items())
        help = f"the word stands around its fields: write `{{{word}: {{{inner}}}}}`" if kept else f"write `{word}`"
    return help


def having_fields(fields: Collection[str], family: str, catalogue: Catalogue) -> list[str]:
    """The words of a family with all these fields, those with the fewest fields first."""
    found: list[tuple[int, str]] = []
    for word in catalogue.choices(family):
        cls = catalogue.load(family, word)
        if cls is not None and set(fields) <= set(map(written_name, cls.model_fields)):
            found.append((len(cls.model_fields), word))
    return [word for _, word in sorted(found)]
