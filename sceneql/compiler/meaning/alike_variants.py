"""Warnings of variants that say what another one says; one that says what the script says is there to be compared."""

from __future__ import annotations

from sceneql.compiler.meaning.facts import Facts
from sceneql.language.tree import Mapping, Node, Scalar
from sceneql.quantities.diagnostic import Diagnostics


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of each variant all of whose values are those of one before it; once, for the script itself."""
    script = facts.script
    section = script.base.entries.get("variants")
    if script.variant is not None or not isinstance(section, Mapping):
        return
    known: dict[frozenset[tuple[str, str]], str] = {}
    for name, variant in section.entries.items():
        said = _said(variant, "") if isinstance(variant, Mapping) and variant.entries else None
        if not said:
            continue
        place = section.keys[name].span
        if (which := frozenset(said.items())) in known:
            told = f"'{name}' is the same as '{known[which]}'"
            found.warning("alike", told, place, help="write another value, or leave one of them out")
        else:
            known[which] = name


def _said(node: Node, path: str) -> dict[str, str] | None:
    """Texts of the values in a variant by path; None where it says more than single values."""
    if isinstance(node, Scalar):
        return {path: _text(node) or ""}
    if not isinstance(node, Mapping):
        return None
    found: dict[str, str] = {}
    for name, inner in node.entries.items():
        below = _said(inner, f"{path}.{name}" if path else name)
        if below is None:
            return None
        found |= below
    return found


def _text(node: Node | None) -> str | None:
    return " ".join(node.span.text.split()) if isinstance(node, Scalar) else None
