"""Help for parts whose shape, place or look stands in groups of other programs: ``geometry: {sphere: ...}``."""

from __future__ import annotations

from sceneql.compiler.annotations import quantities
from sceneql.compiler.catalogue import Catalogue
from sceneql.kinds import written_name
from sceneql.language.tree import Mapping, Node, Scalar
from sceneql.quantities.diagnostic import nearest, same_as
from sceneql.quantities.dimension import LENGTH

SHAPES = ("geometry", "geom", "shape", "mesh", "collider", "primitive", "children")
"""Groups of other programs that hold the word of a shape."""
TYPES = ("type", "kind", "primitive")
"""Fields by which they tell the word."""
LOOKS = ("transform", "appearance", "texture", "finish", "pigment", "style", "pose")
"""Groups of other programs whose fields are those of the part."""
SHOWN = 200
"""Longest text that a message repeats."""


def unwrapped(fields: Node | None, family: str, catalogue: Catalogue) -> str | None:
    """A part without the groups around its shape and its look, ``{sphere: {radius: 1 m}}``; None of other fields."""
    if not isinstance(fields, Mapping) or family != "objects":
        return None
    word, told = "", dict[str, str]()
    inner: dict[str, str]
    for key, value in fields.entries.items():
        shape = _shape(key, value, family, catalogue)
        if shape is not None and not word:
            word, inner = shape
            told |= inner
        elif isinstance(value, Mapping) and key.lower() in LOOKS:
            told |= {name: one.span.text for name, one in value.entries.items()}
        else:
            told[key] = value.span.text
    cls = catalogue.load(family, word) if word else None
    if cls is None:
        return None
    known = [written_name(name) for name in cls.model_fields]
    meant = [name if name in known else same_as(name, known) or name for name in told]
    # Of several that mean one field each keeps its name, to be told of by itself.
    named = [name if meant.count(one) > 1 else one for name, one in zip(told, meant, strict=True)]
    joined = ", ".join(f"{name}: {text}" for name, text in zip(named, told.values(), strict=True))
    text = f"{{{word}: {{{joined}}}}}" if joined else word
    return text if "\n" not in text and len(text) <= SHOWN else None


def _shape(key: str, value: Node, family: str, catalogue: Catalogue) -> tuple[str, dict[str, str]] | None:
    """The word that a group tells, and its fields."""
    if key.lower() not in SHAPES:
        return None
    choices = catalogue.choices(family)
    if isinstance(value, Scalar):
        alone = _word(value.text, choices)
        return None if alone is None else (alone, {})
    if not isinstance(value, Mapping) or not value.entries:
        return None
    first, only = next(iter(value.entries.items()))
    if len(value.entries) == 1 and (word := _word(first, choices)) is not None:
        fields = only.entries if isinstance(only, Mapping) else {}
        if isinstance(only, Scalar) and only.text and (size := _size(only.text, family, word, catalogue)):
            return word, {size: only.span.text}
        return word, {name: one.span.text for name, one in fields.items()}
    typed = next((value.entries[one] for one in TYPES if isinstance(value.entries.get(one), Scalar)), None)
    word = None if typed is None else _word(typed.span.text, choices)
    if word is None:
        return None
    return word, {name: one.span.text for name, one in value.entries.items() if name not in TYPES}


def _word(text: str, choices: list[str]) -> str | None:
    return text if text in choices else same_as(text, choices) or nearest(text, choices, 0.8)


def _size(text: str, family: str, word: str, catalogue: Catalogue) -> str | None:
    """The first field of a shape that one number, or as many as are written, may stand for: its radius, its size."""
    count, cls = len(text.split()) - (text[-1:].isalpha()), catalogue.load(family, word)
    shape = () if count == 1 else (count,)
    for name, info in cls.model_fields.items() if cls is not None else ():
        if name != "position" and any(mark.shape == shape and mark.dimension == LENGTH for mark in quantities(info)):
            return written_name(name)
    return None
