"""Help for names of parts: of none, of another family, or several where one stands."""

from __future__ import annotations

import re
from collections.abc import Callable
from collections.abc import Mapping as Naming
from collections.abc import Sequence as Sequenced

from sceneql.compiler.catalogue import Catalogue
from sceneql.compiler.css_colors import NAMED
from sceneql.compiler.meant.unknown import having_fields
from sceneql.compiler.names import Names
from sceneql.kinds import Refers
from sceneql.language.repeat import copy_meant
from sceneql.language.scope import Entry
from sceneql.language.tree import Mapping, Node, Scalar, Sequence
from sceneql.quantities.diagnostic import Diagnostics, nearest, same_as, suggestion
from sceneql.quantities.instead import instead

KEY = "color_key"
"""What a word has that shows a field in colors."""
OF_LAW = {
    "modulus": ("e", "young", "youngs_modulus", "young_modulus", "modulus", "elastic_modulus"),
    "poisson": ("nu", "poisson", "poisson_ratio", "poissons_ratio"),
}
"""Fields of a solid's law, by their names in other programs."""


def other_family(name: str, mark: Refers, names: Names, catalogue: Catalogue, family_of: Callable[[str], str]) -> str:
    """The help for a part of a wrong family: the model that moves it, a word by that name, or parts of the right."""
    body = _held_by(names.parts[name].fields) if mark.bodies and family_of(name) == "ties" else None
    if body is not None:
        return f"a tie is between bodies, not between their ties: write `{body}`"
    mover = names.mover(name)
    if mover and mark.family == "models":
        return f"'{mover}' moves it: write `{mover}`"
    if (word := same_as(name, catalogue.words(mark.family))) is not None:
        return f"write `{word}`, a word, or the name of one of {mark.family}"
    others = [part for part in names.parts if family_of(part) == mark.family]
    return f"those of {mark.family} are {', '.join(others[:8])}" if others else f"write one under `{mark.family}:`"


def _held_by(fields: Node | None) -> str | None:
    """The first body that a tie holds, but the world."""
    between = fields.entries.get("between") if isinstance(fields, Mapping) else None
    bodies = [item.span.text for item in between.items] if isinstance(between, Sequence) else []
    return next((one for one in bodies if one != "world"), None)


def several_meant(node: Sequence, mark: Refers, entry: Entry, catalogue: Catalogue) -> str | None:
    """The help for a list where an entry refers to one part."""
    kinds = [catalogue.load(family, entry.word) for family in catalogue.families_of(entry.word)]
    names = [item.span.text for item in node.items]
    if len(names) == 1:
        return f"write `{names[0]}`"
    between = entry.fields.entries.get("between") if isinstance(entry.fields, Mapping) else None
    if isinstance(between, Sequence) and node in between.items and len(between.items) != 2:
        inner = [one for item in between.items for one in (item.items if isinstance(item, Sequence) else [item])]
        all_ = ", ".join(dict.fromkeys(one.span.text for one in inner))
        return f"all of one list touch one another: write `between: [{all_}]`"
    if mark.family == "cameras":
        return f"one camera films a picture; for two side by side write `layout: [[{', '.join(names)}]]` in its place"
    if "objects" not in (mark.family, mark.also):
        return None
    if any(cls is not None and "bodies" in cls.model_fields for cls in kinds) and all(
        name.isidentifier() for name in names
    ):
        return f"each is a body of its own: write `bodies: {{{', '.join(f'{one}: {{of: {one}}}' for one in names)}}}`"
    return f"several together are one: write `{{union: {{of: {node.span.text}}}}}`"


def word_for_name(place: str, node: Node, mark: Refers, catalogue: Catalogue) -> str | None:
    """The help for fields in a mapping of parts whose word, the end of their place, stands where a name does."""
    word = place.rpartition(".")[2]
    words = catalogue.choices(mark.family)
    if word not in words or not isinstance(node, Mapping) or any(key in words for key in node.entries):
        return None
    return f"`{word}` is taken for a name here: write a list of parts, `[{{{word}: {{...}}}}, ...]`"


def warn_of_another(
    node: Scalar, family: str, user: str, entries: Naming[str, Entry], family_of: Naming[str, str], found: Diagnostics
) -> None:
    """Warn of a word in a model, ``user``, that makes another part, where there is a part by that word to be meant."""
    if family_of.get(user) != "models" or family not in ("objects", "models"):
        return  # a plain material beside a tinted one is most likely meant
    same = [name for name, entry in entries.items() if entry.word == node.text and family_of[name] == family]
    if same and "." not in same[0]:
        text = f"'{node.text}' is a word here, and makes another one, with its defaults"
        help = f"to name the one that is there write `{same[0]}`, to make another `{{{node.text}: {{}}}}`"
        found.warning("second-part", text, node.span, help=help)


def of_law(node: Mapping, family: str) -> str | None:
    """The help for the law of a solid where its look stands: ``material: {E: 2 MPa, nu: 0.3}``."""
    given = {name: one.span.text for name, one in node.entries.items()}
    told = {field: text for name, text in given.items() for field, names in OF_LAW.items() if name.lower() in names}
    if family != "materials" or "modulus" not in told:
        return None
    law = ", ".join(f"{field}: {text}" for field, text in told.items())
    return f"`material` is how it looks; a solid's law says it: write `law: {{neo_hookean: {{{law}}}}}`"


def shows_nothing(name: str, mark: Refers, names: Names, catalogue: Catalogue) -> str | None:
    """The help for a part that shows no values in colors where one that does is named: one that does; else None."""
    if not mark.showing or hasattr(catalogue.load(mark.family, names.parts[name].word), KEY):
        return None
    others = [one for one, entry in names.parts.items() if hasattr(catalogue.load(mark.family, entry.word), KEY)]
    if others:
        return f"write `of: {others[0]}`, the {names.parts[others[0]].word}"
    return f"a `{mark.showing}` shows one: `sceneql words {mark.showing}`"


def beside_world(place: str) -> str:
    """The help where a tie has a position in place of a body."""
    plain = " ".join(place.strip("[]").replace(",", " ").split())
    plain += "" if plain[-1:].isalpha() else " m"
    return f"write `world`, and the place in another field of the tie, `to: {plain}` of a rod, `at` of others"


def part_meant(name: str, mark: Refers, choices: Sequenced[str], names: Names, catalogue: Catalogue) -> str | None:
    """The help for a name of no part of the mark's families; ``choices``: the names of their parts."""
    if (copy := copy_meant(name, {*choices, *names.parts})) is not None:
        return copy
    joined = [one.strip() for one in re.split(r"[-+&|*]", name)]
    if len(joined) > 1 and all(one in choices for one in joined) and not mark.panel:
        return f"several stand in a list: write `[{', '.join(joined)}]`"
    if mark.bodies and name[:1] in "-[0123456789":
        return f"a place is no body: {beside_world(name)}"
    if "models" in (mark.family, mark.also) and (model := names.model_of(name)):
        whose = f"'{name}' is one of the bodies or masses of '{model}'"
        all_of_it = f"{whose}: write `{model}`, which means all of them"
        return f"{whose}: write `{model}.{name}`" if mark.bodies else all_of_it
    if mark.bodies:
        return suggestion(name, choices) or instead("body", name) or "name a body, or what stands still, `world`"
    if (part := names.part_of(name)[0]) != name and part in choices:
        return f"a part stands here, and none of its outputs: write `{part}`"
    having = having_fields(["color"], mark.family, catalogue) if name in NAMED else []
    if having:  # gold is metal
        word = same_as(name, having) or having[0]
        return f"write `{{{word}: {{color: {name}}}}}`, or `color: {name}` in its place"
    words = catalogue.words(mark.family)
    if names.gives(name) and (readers := names.readers(name, choices)):
        return f"a part stands here, and none of its outputs: write `{readers[0]}`, which shows it"
    model = names.part_of(name)[0]
    shown = [one for one in choices if model != name and _names(names.parts[one].fields, model)]
    if names.gives(name) and shown:
        return f"a part stands here, and none of its outputs: write `{shown[0]}`, which shows it"
    if mark.showing and names.gives(name):
        map_of = f"{{map: {{{mark.showing}: {{of: {name}}}}}}}"
        return f"a part stands here, and none of its outputs: write `{mark.family}: {map_of}`, and here `of: map`"
    row = re.findall(r"[^\W\d]\w*", name)
    if mark.panel and len(row) > 1 and all(one in choices for one in row):
        return f"a row is a list: write `[[{', '.join(row)}]]`"
    hint = instead("part", name) or suggestion(name, choices)
    meant = [one for one in choices if names.parts[one].word == nearest(name, words)]
    if hint is None and len(meant) == 1:
        return f"write `{meant[0]}`, the {names.parts[meant[0]].word} that there is"
    hint = hint or suggestion(name, words)
    if hint is None and mark.panel:
        hint = f"rows hold names of cameras and graphs, `[[{', '.join(choices[:2]) or 'front, top'}]]`"
        hint += "; variants stand side by side by `[{each: variant}]`: `sceneql words layout`"
    if hint is None and words:
        hint = f"write the name of one, or a word, `{{{words[0]}: {{...}}}}`; the words are {', '.join(words)}"
    return hint


def _names(fields: Node | None, part: str) -> bool:
    """Whether the text of an entry's fields has the name of a part."""
    return fields is not None and re.search(rf"\b{re.escape(part)}\b", fields.span.text) is not None
