"""Help for fields that another part of the script has: one of a force for each mass, one of a contact.

``reader`` is the `Reader` (`sceneql.compiler.read`) that met the field.
"""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel

from sceneql import kinds
from sceneql.language.scope import Entry
from sceneql.language.tree import Mapping as MappingNode
from sceneql.quantities.diagnostic import same_as

USUAL_FORCE = "electrostatic"
"""The word of forces between charges."""


def for_each_mass(reader: Any, name: str) -> str | None:
    """The help for a field of listed masses that is a force's, which has one for each: ``charge``."""
    part, _, path = reader.owner.partition(".")
    node: Any = reader.names.parts[part].fields if part in reader.names.parts else None
    for step in path.split(".")[:-1]:
        node = node.entries.get(step) if isinstance(node, MappingNode) else None
    items = list(node.entries.values()) if isinstance(node, MappingNode) and path.count(".") else []
    each = [one.entries[name].span.text for one in items if isinstance(one, MappingNode) and name in one.entries]
    words = [word for family, word in reader.names.catalogue.having(name) if family == "forces"] if each else []
    if not words or len(each) < len(items):
        return None
    used = [entry.word for entry in reader.names.parts.values() if entry.word in words]
    word = (used or [one for one in words if one == USUAL_FORCE] or words)[0]
    told = f"{{{word}: {{{name}: [{', '.join(each)}]}}}}"
    return f"it is a force's, one for each in their order: write `forces: {{all: {told}}}`"


def of_contact(reader: Any, cls: type[BaseModel], name: str, text: str) -> str | None:
    """The help for a field of a contact that the script has, in another part: ``restitution`` of a body."""
    if not issubclass(cls, kinds.Kind) or cls.family not in ("models", "objects") or reader.names.catalogue is None:
        return None
    for part, entry in reader.names.parts.items():
        contact = reader.names.catalogue.load("contacts", entry.word) or _lacking(reader, entry, name)
        known = [] if contact is None else [kinds.written_name(key) for key in contact.model_fields]
        field = same_as(name, known) if cls.family == "models" else name if name in known else None
        if field is not None:
            inner = "" if entry.fields is None else "..., "
            own = f"{part}: " if part != entry.word else ""
            told = f"{own}{{{entry.word}: {{{inner}{field}: {text}}}}}"
            what = "the contact" if issubclass(contact, kinds.Contact) else "the force"
            return f"'{part}' has it, {what} of the script: write `{told}` there"
    return None


def _lacking(reader: Any, entry: Entry, name: str) -> Any:
    """The class of a force of the script that needs a field and has not got it: the charge of a `magnetic` one."""
    cls = reader.names.catalogue.load("forces", entry.word)
    fields = entry.fields.entries if isinstance(entry.fields, MappingNode) else {}
    info = None if cls is None else cls.model_fields.get(name)
    return cls if info is not None and info.is_required() and name not in fields else None
