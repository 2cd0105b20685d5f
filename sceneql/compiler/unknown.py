"""Words that a family, and fields that a word does not have: what was meant, or what is written in their place."""

from __future__ import annotations

from collections.abc import Collection
from collections.abc import Mapping as Naming

from sceneql.compiler.catalogue import Catalogue
from sceneql.kinds import written_name
from sceneql.language.scope import Entry
from sceneql.language.tree import Mapping
from sceneql.quantities.diagnostic import Diagnostics, nearest, suggestion
from sceneql.quantities.other_words import OURS, instead

MANY = 6
"""Words up to which all that have a field are told."""


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
        if len(known) == 1 and nearest(name, known) is None and not (said_by or {}).get(name):
            help = f"it stands inside: `{{{next(iter(known))}: {{{name}: ...}}}}`"
        if (meant := meant_field(name, known)) is not None and name.startswith(f"{meant} "):
            help = f"write `{meant}: {name.removeprefix(meant).strip()}`"
        found.error("unknown-field", f"{title} has no field '{name}'", node.keys[name].span, help=help)
    return not unknown


def meant_field(name: str, known: Collection[str]) -> str | None:
    """The field meant by an unknown name: its first word, if a colon is missing behind that, or the nearest field."""
    first = name.partition(" ")[0]
    return first if first in known else nearest(name, known)


def word_meant(entry: Entry, family: str, catalogue: Catalogue) -> str | None:
    """The help for an entry whose word its family does not have."""
    words, fields = catalogue.choices(family), entry.fields
    inner = next(iter(fields.entries)) if isinstance(fields, Mapping) and len(fields.entries) == 1 else ""
    if fields is not None and entry.name == entry.word and catalogue.load(family, inner) is not None:
        return f"a part that has a name stands in no list: write `{family}: {{{entry.word}: {fields.span.text}}}`"
    if others := catalogue.families_of(entry.word):
        return f"it belongs under '{others[0]}:'"
    if catalogue.load(family, entry.name) is not None:
        return f"'{entry.name}' is a word, but stands where a name does: write `name: {{{entry.name}: ...}}`"
    having = [] if fields is None or entry.word in OURS else _having([entry.word], family, catalogue)
    if fields is not None and having:
        near = nearest(entry.name, having) or having[0]
        of = f" of {', '.join(sorted(having))}" if len(having) <= MANY else ""
        return f"it is a field{of}: write `{{{near}: {{{entry.word}: {fields.span.text}}}}}`"
    return instead(family, entry.word) or suggestion(entry.word, words)


def word_having(node: Mapping, family: str, catalogue: Catalogue) -> str | None:
    """The help for fields without the word around them."""
    having = _having(list(node.entries), family, catalogue)
    if not having:
        return None
    return f"the word stands around its fields, {', '.join(having)}: write `{{{having[0]}: {node.span.text}}}`"


def _having(fields: Collection[str], family: str, catalogue: Catalogue) -> list[str]:
    """The words of a family that have these fields, that with the fewest first."""
    found: list[tuple[int, str]] = []
    for word in catalogue.choices(family):
        cls = catalogue.load(family, word)
        if cls is not None and set(fields) <= set(map(written_name, cls.model_fields)):
            found.append((len(cls.model_fields), word))
    return [word for _, word in sorted(found)]
