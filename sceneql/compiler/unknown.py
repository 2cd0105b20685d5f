"""Fields that a word does not have: what was meant, or what is written in their place."""

from __future__ import annotations

from collections.abc import Collection
from collections.abc import Mapping as Naming

from sceneql.language.tree import Mapping
from sceneql.quantities.diagnostic import Diagnostics, nearest, suggestion
from sceneql.quantities.other_words import instead


def report_unknown(
    node: Mapping, known: Collection[str], title: str, found: Diagnostics, said_by: Naming[str, str] | None = None
) -> bool:
    """Report the fields of a mapping that are not among the known ones; True if there are none.

    ``said_by``: what says it instead, for names that are likely to be tried.
    """
    unknown = [name for name in node.entries if name not in known]
    for name in unknown:
        help = (said_by or {}).get(name) or suggestion(name, known)
        help = help or instead("field", name) or "it has " + ", ".join(known)
        if (meant := meant_field(name, known)) is not None and name.startswith(f"{meant} "):
            help = f"write `{meant}: {name.removeprefix(meant).strip()}`"
        found.error("unknown-field", f"{title} has no field '{name}'", node.keys[name].span, help=help)
    return not unknown


def meant_field(name: str, known: Collection[str]) -> str | None:
    """The field meant by an unknown name: its first word, if a colon is missing behind that, or the nearest field."""
    first = name.partition(" ")[0]
    return first if first in known else nearest(name, known)
