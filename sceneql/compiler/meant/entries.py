"""Help for entries without a word, and with one that no family has: the word is told by their fields or by a type."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

from pydantic import BaseModel

from sceneql.compiler.annotations import quantities
from sceneql.compiler.catalogue import Catalogue
from sceneql.compiler.meant.unknown import word_having
from sceneql.compiler.meant.unwrapped import unwrapped
from sceneql.kinds import written_name
from sceneql.language.script import Script
from sceneql.language.sections import empty
from sceneql.language.tree import Mapping, Node, Scalar
from sceneql.quantities.diagnostic import Diagnostics, same_as
from sceneql.quantities.units import unit_of

TYPES = ("type", "kind", "joint_type", "shape")
"""Fields by which other programs tell the word of a part."""
UNTOLD = ("{WORD:", "an entry is `name: word`")
"""What stands in a help that does not know the word."""


def improve_entries(script: Script, catalogue: Catalogue, found: Diagnostics) -> None:
    """Let the errors of entries without a word say which one their fields, or those beside them, are of."""
    told = {
        one.span.start: k for k, one in enumerate(found.found) if one.code == "entry-shape" and one.span is not None
    }
    for family, name, node in _entries(script, catalogue) if told else ():
        several = isinstance(node, Mapping) and len(node.entries) > 1
        at = [*node.keys.values()][1].span.start if isinstance(node, Mapping) and several else node.span.start
        k = told.get(at)
        if k is not None and several and (plain := unwrapped(node, family, catalogue)) is not None:
            told_anew = f"the word says the shape, and its fields stand in it: write `{name}: {plain}`"
            found.found[k] = replace(found.found[k], help=told_anew)
            continue
        if k is None or not any(one in (found.found[k].help or "") for one in UNTOLD):
            continue
        help = _indented(script, family, name, catalogue)
        if help is not None:
            found.found[k] = replace(found.found[k], help=help)
            continue
        help = word_having(node, family, catalogue) if isinstance(node, Mapping) and several else None
        if help is not None and name.isidentifier():
            own = "main" if catalogue.load(family, name) is not None else name
            help = help.replace("write `{", f"write `{own}: {{")
        if isinstance(node, Scalar) and node.kind in ("number", "integer"):
            help = _field_alone(script, catalogue, family, name, node)
        found.found[k] = replace(found.found[k], help=help or found.found[k].help)


def _indented(script: Script, family: str, name: str, catalogue: Catalogue) -> str | None:
    """The help for an empty entry, and for the one behind it, called like a word, that belongs to it."""
    section = script.root.entries.get(family)
    entries = section.entries if isinstance(section, Mapping) else {}
    for first, second in pairwise(entries):
        if name in (first, second) and empty(entries[first]) and catalogue.load(family, second) is not None:
            return f"what belongs to `{first}` is indented below it: write two spaces more before `{second}:`"
    return None


def _entries(script: Script, catalogue: Catalogue) -> Iterator[tuple[str, str, Node]]:
    for family in catalogue.families:
        section = script.root.entries.get(family)
        for name, node in section.entries.items() if isinstance(section, Mapping) else ():
            yield family, name, node


def _field_alone(script: Script, catalogue: Catalogue, family: str, name: str, node: Scalar) -> str | None:
    """The help for a number that stands under the name of a field of a family's word, beside the word or without."""
    section = script.root.entries.get(family)
    beside = section.entries.values() if isinstance(section, Mapping) else ()
    others = section.entries.items() if isinstance(section, Mapping) else ()
    words = [same_as(one.text, catalogue.choices(family)) or one.text for one in beside if isinstance(one, Scalar)]
    for word in [*words, *catalogue.choices(family)]:
        cls = catalogue.load(family, word)
        fields = [] if cls is None else [written_name(key) for key in cls.model_fields]
        field = name if name in fields else same_as(name, fields)
        if cls is not None and field is not None:
            more = ((key, one) for key, one in others if isinstance(one, Scalar) and one.kind in ("number", "integer"))
            ours = {key if key in fields else same_as(key, fields): one for key, one in more}
            inner = ", ".join(f"{key}: {_unit(cls, key, one)}" for key, one in ours.items() if key is not None)
            inner = f"{{{inner}}}"
            return f"a part has a name, and a word around its fields: write `main: {{{word}: {inner}}}`"
    return None


def _unit(cls: type[BaseModel], field: str, node: Scalar) -> str:
    """A number with the unit of a field."""
    info = next(info for key, info in cls.model_fields.items() if written_name(key) == field)
    wanted = next((one.dimension for one in quantities(info) if one.dimension is not None), None)
    return node.text if wanted is None or wanted.plain else f"{node.text} {unit_of(wanted)}"


def typed_meant(fields: Node | None, family: str, catalogue: Catalogue) -> str | None:
    """The help for an entry whose word other programs have, and whose type is a word here, as a joint of a type."""
    if not isinstance(fields, Mapping):
        return None
    key = next((one for one in TYPES if isinstance(fields.entries.get(one), Scalar)), None)
    word = None if key is None else same_as(fields.entries[key].span.text, catalogue.choices(family))
    word = fields.entries[key].span.text if key and fields.entries[key].span.text in catalogue.choices(family) else word
    cls = None if word is None else catalogue.load(family, word)
    if cls is None:
        return None
    known = [written_name(name) for name in cls.model_fields]
    told: dict[str, list[str]] = {}
    for name, node in fields.entries.items():
        field = name if name in known else same_as(name, known)
        if name != key and field is not None:
            told.setdefault(field, []).append(node.span.text)
    if len(ends := told.get("between", ["", "", ""])) <= 2 and not ends[0].startswith("["):
        told["between"] = [f"[{', '.join([*ends, 'world'][:2])}]"]
    inner = ", ".join(f"{field}: {texts[0]}" for field, texts in told.items())
    return f"its type is the word: write `{{{word}: {{{inner}}}}}`"
