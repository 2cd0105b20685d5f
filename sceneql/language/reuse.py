"""Expansion of `use`: a part that is a copy of another one, with some of its fields changed.

``twin: {use: ball, position: 0 1 0 m}`` copies what is written at ``ball`` (word, fields and `repeat`) with another
position. A given field replaces the whole field. In a template the names of its own section come first.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from typing import Final

from sceneql.language.sections import empty
from sceneql.language.tree import Mapping, Node, Scalar, broken, hole, unsure
from sceneql.quantities.diagnostic import Diagnostics, suggestion

USE: Final = "use"
_OWN: Final = (USE, "repeat")


def reused(root: Mapping, sections: Collection[str], found: Diagnostics) -> Mapping:
    """The script with every `use` written out, in its sections and in those of its templates."""
    outside = dict(_sections(root, sections))
    templates = root.entries.get("templates")
    patterns = [*templates.entries] if isinstance(templates, Mapping) else []
    result = _body(root, sections, {}, found, patterns)
    if isinstance(templates, Mapping):
        bodies = {
            name: _body(body, sections, outside, found) if isinstance(body, Mapping) else body
            for name, body in templates.entries.items()
        }
        result.entries["templates"] = templates.holding(bodies)
    return result


def _sections(body: Mapping, names: Collection[str]) -> Iterator[tuple[str, Mapping]]:
    for name in names:
        node = body.entries.get(name)
        if isinstance(node, Mapping):
            yield name, node


def _body(
    body: Mapping,
    sections: Collection[str],
    outside: dict[str, Mapping],
    found: Diagnostics,
    templates: Collection[str] = (),
) -> Mapping:
    own = dict(_sections(body, sections))
    changed = dict(body.entries)
    for name, section in own.items():
        if any(_uses(node) for node in section.entries.values()):
            changed[name] = _Section(name, section, own, outside, found, templates).written_out()
    return body.holding(changed)


def _uses(node: Node) -> bool:
    return isinstance(node, Mapping) and USE in node.entries


class _Section:
    def __init__(
        self,
        name: str,
        section: Mapping,
        own: dict[str, Mapping],
        outside: dict[str, Mapping],
        found: Diagnostics,
        templates: Collection[str],
    ) -> None:
        self.name, self.section, self.own, self.outside, self.found = name, section, own, outside, found
        self.templates = templates
        self.done: dict[str, Node] = {}

    def written_out(self) -> Mapping:
        """The section without `use`."""
        return self.section.holding({name: self.entry(name) for name in self.section.entries})

    def known(self) -> dict[str, Node]:
        """The entries that `use` may name here: those of the template, then those of the script."""
        outer = self.outside.get(self.name)
        return (outer.entries if outer is not None else {}) | self.section.entries

    def entry(self, name: str) -> Node:
        """An entry with its `use` written out; a hole, after a report, where that is impossible."""
        chain: list[Mapping] = []
        known = self.known()
        at, seen = name, [name]
        while at not in self.done:
            node = known[at]
            if not (isinstance(node, Mapping) and _uses(node)):
                self.done[at] = node
                break
            chain.append(node)
            following = self.following(node, known, seen)
            if following is None:
                self.done |= {one: hole(node.span) for one in seen}
                return self.done[name]
            at = following
            seen.append(at)
        below = self.done[at]
        for one, node in zip(reversed(seen[: len(chain)]), reversed(chain), strict=True):
            below = self.done[one] = self.changed(node, below)
        return self.done[name]

    def following(self, node: Mapping, known: dict[str, Node], seen: list[str]) -> str | None:
        """The name of the entry that this one uses; None after reporting an unknown name or a cycle."""
        used = node.entries[USE]
        if broken(used):
            return None
        if not isinstance(used, Scalar) or used.kind != "text":
            help = "write `name: {use: other, field: value}`"
            fields = next(iter(used.entries.values()), None) if isinstance(used, Mapping) else None
            if isinstance(used, Mapping) and len(used.entries) == 1 and isinstance(fields, Mapping):
                inner = "".join(f", {name}: {one.span.text}" for name, one in fields.entries.items())
                help = f"write `{{use: {next(iter(used.entries))}{inner}}}`"
            self.found.error("entry-shape", "`use` takes the name of a part", used.span, help=help)
            return None
        if used.text in seen:
            circle = " uses ".join([*seen[seen.index(used.text) :], used.text])
            help = "write one of them out"
            self.found.error("use-cycle", f"a part cannot be made of itself: {circle}", used.span, help=help)
            return None
        if used.text not in known:
            if not self.section.partial:
                elsewhere = [key for key, section in self.own.items() if used.text in section.entries]
                near = f"'{used.text}' stands under {elsewhere[0]}" if elsewhere else suggestion(used.text, known)
                if used.text in self.templates:
                    values = ", ".join(f"{k}: {v.span.text}" for k, v in node.entries.items() if k not in _OWN)
                    near = f"it is a template: write `{{{used.text}: {{{values}}}}}`"
                message = f"no part of {self.name} is called '{used.text}'"
                self.found.error("unknown-name", message, used.span, help=near)
            return None
        return used.text

    def changed(self, node: Mapping, below: Node) -> Node:
        """An entry as it would be written without `use`; ``below``: the entry that it uses."""
        if isinstance(below, Scalar) and below.kind == "text":
            nothing = Mapping({}, {}, True, below.source, below.end, below.end)
            below = Mapping({below.text: nothing}, {below.text: below}, True, below.source, below.start, below.end)
        words = [key for key in below.entries if key != "repeat"] if isinstance(below, Mapping) else []
        if not isinstance(below, Mapping) or len(words) != 1:
            return below if unsure(below) else hole(node.span)  # reported where it is written
        (word,) = words
        fields = below.entries[word]
        own = {key: value for key, value in node.entries.items() if key not in _OWN}
        keys = {key: node.keys[key] for key in own}
        if isinstance(fields, Mapping):
            merged = node.holding(fields.entries | own, fields.keys | keys)
            merged.partial = fields.partial or node.partial
        elif empty(fields):
            merged = node.holding(own, keys)
        else:
            return below
        entries: dict[str, Node] = {word: merged}
        if "repeat" in node.entries or "repeat" in below.entries:
            holder = node if "repeat" in node.entries else below
            entries["repeat"] = holder.entries["repeat"]
            return node.holding(entries, {word: below.keys[word], "repeat": holder.keys["repeat"]})
        return node.holding(entries, {word: below.keys[word]})
