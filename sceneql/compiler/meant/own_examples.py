"""Examples of fields that name parts, made of the parts that a script has: for messages."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, get_origin

from sceneql import kinds
from sceneql.compiler.annotations import is_fixed, marks_of
from sceneql.compiler.names import Names

WORLD = "world"


def own_example(names: Names, info: Any) -> str | None:
    """What a field that names parts could hold in this script: a name, or a list; None for other fields.

    None, too, where the script has no such parts.
    """
    if "position of a mass" in (info.description or ""):
        bodies = _bodies(names, kinds.Refers("models", bodies=True))
        return next((f"{one}.position" for one in bodies), None)
    mark = next((one for one in marks_of(info) if isinstance(one, kinds.Refers)), None)
    if mark is None or get_origin(info.annotation) is dict:
        return None
    found = list(dict.fromkeys(_bodies(names, mark) if mark.bodies else _parts(names, mark)))
    said = info.description or ""
    found = [one for one in found if one in names.parts and f"`{names.parts[one].word}`" in said] or found
    if not found:
        return None
    if is_fixed(info.annotation):
        return f"[{', '.join(([*found, WORLD] if mark.bodies else found)[:2])}]"
    return found[0] if info.annotation is kinds.Ref else f"[{', '.join(found[:2])}]"


def _parts(names: Names, mark: kinds.Refers) -> Iterator[str]:
    """The parts of the families of a mark, in the script's order."""
    for name, entry in names.parts.items():
        families = [] if names.catalogue is None else names.catalogue.families_of(entry.word)
        if "." not in name and {mark.family, mark.also} & set(families):
            yield name


def _bodies(names: Names, mark: kinds.Refers) -> Iterator[str]:
    """The bodies of models: a model that is one, or those in it, as ``stones.first``."""
    for name in _parts(names, kinds.Refers(mark.family)):
        outputs = names.outputs_of(name) or {}
        own = [one.removesuffix(".position") for one in outputs if one.endswith(".position")]
        yield from [name] if "position" in outputs else [f"{name}.{one}" for one in own]
