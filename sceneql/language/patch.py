"""Patches: variants and `--set` replace values of the tree by dotted paths, before templates are written out."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator
from typing import Final, cast

from sceneql.language.compose import compose_node
from sceneql.language.plain import kind_of
from sceneql.language.reuse import USE
from sceneql.language.sections import empty
from sceneql.language.syntax import unprintable
from sceneql.language.tree import Mapping, Node, Scalar, Sequence, broken, unsure
from sceneql.quantities.diagnostic import STRONG, Diagnostic, Diagnostics, ScriptError, suggestion
from sceneql.quantities.span import Source, Span

Patch = tuple[str, Node, Span]
"""(dotted path, the node to put there, the span of the path)."""

SET: Final = "--set"
"""Source name of values given by `--set`."""
WORD: Final = 2
"""Number of steps of a path before the word of a part."""
MOST_PATHS: Final = 3
"""Largest number of paths that a message offers."""
VARIANT_OPTIONS: Final = ("may_fail",)
"""Keys of a variant that are no paths."""


def apply_patch(
    root: Mapping,
    patches: Iterable[Patch],
    families: Collection[str],
    settings: Collection[str] = (),
    found: Diagnostics | None = None,
) -> Mapping:
    """A tree with values replaced; the old tree is not changed, and subtrees off the paths are shared.

    A path names a section, a part and a field: ``models.cage.stiffness``. The part's word may stand between
    (``models.cage.mass_spring.stiffness``), the section may be left out where only one part or define has the name, and
    a number selects an item of a list. A path may end in a new field or part, not go through one. Raises ScriptError
    (`unknown-path`), or records it in ``found``. A path through an unreadable value changes nothing.
    """
    wrong = Diagnostics() if found is None else found
    for patch in patches:
        try:
            root = _Path(patch, families, settings).put_into(root)
        except ScriptError as error:
            wrong.extend(error.diagnostics)
        except _LostError:
            pass
    if found is None:
        wrong.raise_errors()
    return root


def _by_name(node: Node, root: Mapping) -> str:
    """Variants under their names, of a list in which each has a field `name`; else an example."""
    define = root.entries.get("define")
    known = define.entries if isinstance(define, Mapping) else {}
    shown = []
    for item in node.items if isinstance(node, Sequence) else ():
        fields = item.entries if isinstance(item, Mapping) else {}
        if not isinstance(fields.get("name"), Scalar):
            return EXAMPLE
        values = (
            f"{'define.' if key in known else ''}{key}: {value.span.text}"
            for key, value in fields.items()
            if key != "name"
        )
        shown.append(f"{fields['name'].span.text}: {{{', '.join(values)}}}")
    return f"{{{', '.join(shown)}}}" if shown else EXAMPLE


EXAMPLE: Final = "{soft: {define.k: 200 N/m}}"
"""Variants, for messages."""


class _LostError(Exception):
    """A path leads through an unreadable value."""


def report_unnamed(root: Mapping, found: Diagnostics) -> None:
    """Report variants that have no names."""
    node = root.entries.get("variants")
    if node is not None and not (isinstance(node, Mapping) or unsure(node) or empty(node)):
        text, help = "variants hold values by path, each under a name", f"write `variants: {_by_name(node, root)}`"
        found.error("section-shape", text, node.span, help=help)


def variant_names(root: Mapping) -> tuple[str, ...]:
    """The names of the script's variants."""
    node = root.entries.get("variants")
    return tuple(node.entries) if isinstance(node, Mapping) else ()


def variant(root: Mapping, name: str) -> list[Patch]:
    """The patches of a variant. Raises ScriptError (`unknown-variant`, `section-shape`)."""
    node = root.entries.get("variants")
    if not isinstance(node, Mapping) or name not in node.entries:
        if unsure(root if node is None else node):
            return []
        names = variant_names(root)
        help = suggestion(name, names) or (f"the variants are {', '.join(names)}" if names else "the script has none")
        span = root.keys["variants"].span if "variants" in root.keys else None
        raise ScriptError([Diagnostic("unknown-variant", f"there is no variant '{name}'", span, help)])
    patches = node.entries[name]
    if empty(patches) or broken(patches):
        return []
    if not isinstance(patches, Mapping):
        help = _by_path(root, name, patches)
        raise ScriptError([Diagnostic("section-shape", "a variant holds values by path", patches.span, help)])
    return [(path, n, patches.keys[path].span) for path, n in patches.entries.items() if path not in VARIANT_OPTIONS]


def _by_path(root: Mapping, name: str, patches: Node) -> str:
    """The help for a variant that is a value, an equation, or a list of values of a define."""
    define = root.entries.get("define")
    known = [*define.entries] if isinstance(define, Mapping) else []
    items = [one.span.text for one in patches.items] if isinstance(patches, Sequence) else []
    if name in known and items:
        told = ", ".join(f"{name}_{k}: {{define.{name}: {text}}}" for k, text in enumerate(items, 1))
        return f"each variant has a name, and the value by its path: write `variants: {{{told}}}`"
    given = re.fullmatch(r"[\"']?(\w+)\s*[=:]\s*([^\"']+)[\"']?", patches.span.text)
    if given is not None and given[1] in known:
        return f"write `{name}: {{define.{given[1]}: {given[2]}}}`"
    return f"write `{name}: {{define.{known[0] if known else 'k'}: 200 N/m}}`, with its value"


def parse_set(text: str) -> Patch:
    """The patch of an option ``--set path=value``, whose value is written as in a script. Raises ScriptError.

    Lists, mappings and quoted texts are read as YAML; anything else is one plain value, so that
    ``objects.ball.color=#ff8800`` needs no quotes.
    """
    source = Source(SET, text)
    path, equals, value = text.partition("=")
    at = len(path) + 1 + len(value) - len(value.lstrip())
    span = Span(source, len(path) - len(path.lstrip()), len(path.rstrip()))
    if not equals or not path.strip() or not value.strip():
        help = "write `--set 'define.k=2 kN/m'`"
        raise ScriptError([Diagnostic("set-shape", "a path, an equals sign and a value belong here", span, help)])
    if value.strip()[0] in "[{\"'" or unprintable(text) is not None:
        return path.strip(), compose_node(source, at), span
    value = value.strip()
    return path.strip(), Scalar(value, kind_of(value), False, source, at, at + len(value)), span


class _Path:
    def __init__(self, patch: Patch, families: Collection[str], settings: Collection[str]) -> None:
        self.path, self.value, self.span = patch
        self.families, self.settings = families, settings
        self.steps = self.path.split(".")
        self.unsure = False
        """Whether some definitions of the script are unknown, as they were unreadable."""
        self.shift = 0
        """1 where the section is left out of the path."""

    def fail(self, at: int, message: str, help: str | None) -> ScriptError:
        """The error of the path's step ``at``."""
        before = "".join(f"{step}." for step in self.steps[self.shift : at])
        start = max(self.span.text.find(self.path), 0) + len(before)
        place = self.span.part(start, start + len(self.steps[at]))
        return ScriptError([Diagnostic("unknown-path", message, place, help)])

    def put_into(self, root: Mapping) -> Mapping:
        """The tree with the value at the path."""
        if "" in self.steps:
            raise self.fail(self.steps.index(""), "a step of this path is empty", "write `section.part.field`")
        self.unsure = root.partial
        first = self.steps[0]
        if first not in root.entries and first not in self.families and first not in self.settings:
            sections = (*self.families, "define", "parts")
            owners = [key for key in sections if first in _keys(root.entries.get(key))]
            if not owners and any(unsure(node) for node in (root, *(root.entries.get(key, root) for key in sections))):
                raise _LostError
            if len(owners) != 1:
                help = f"write {' or '.join(f'{key}.{self.path}' for key in owners)}"
                names = [*root.entries, *self.families, *(n for key in sections for n in _keys(root.entries.get(key)))]
                message = f"'{first}' is in several sections" if owners else f"the script has no '{first}'"
                single = None if owners else _of_section(root, first, self.value, self.families)
                there = (
                    None if owners else single or suggestion(first, names, STRONG) or _written_as(root, self.steps[-1])
                )
                if not owners and (given := re.fullmatch(r"\s*([\w.]+)\s*=\s*(.+?)\s*", self.path)) is not None:
                    there = f"a colon stands between a name and its value: write `{given[1]}: {given[2]}`"
                raise self.fail(0, message, help if owners else there or suggestion(first, names))
            self.steps, self.shift = [owners[0], *self.steps], 1
        return cast(Mapping, self.put(root, 0))

    def put(self, node: Node, at: int) -> Node:
        """A node with the value set below it, along the steps from ``at`` on."""
        if at == len(self.steps):
            return self.value
        if empty(node):
            node = _nothing(node.span)
        if at == self.entry_level():
            return self.put_into_entry(node, at)
        return self.put_below(node, at)

    def entry_level(self) -> int:
        """Number of steps that lead to a part; -1 where the path leads to none."""
        part = (*self.families, "parts")
        if self.steps[0] == "templates":
            return 4 if len(self.steps) > 2 and self.steps[2] in part else -1
        return 2 if self.steps[0] in part else -1

    def put_into_entry(self, node: Node, at: int) -> Node:
        """A part with the value set in its fields; the part's word may be a step of the path."""
        if isinstance(node, Scalar) and node.kind == "text":
            fields = _nothing(node.span)
            node = Mapping({node.text: fields}, {node.text: node}, True, node.source, node.start, node.end)
        if isinstance(node, Mapping) and self.steps[at] not in node.entries and USE not in node.entries:
            words = [key for key in node.entries if key != "repeat"]
            if len(words) == 1:
                inner = node.entries[words[0]]
                inner = self.put_below(_nothing(inner.span) if empty(inner) else inner, at)
                return self.with_item(node, words[0], inner)
        return self.put_below(node, at)

    def put_below(self, node: Node, at: int) -> Node:
        """A mapping or list with the value below one of its items."""
        step, before = self.steps[at], ".".join(self.steps[:at])
        section = at == 1 and self.steps[0] in (*self.families, "define", "parts")
        if broken(node) or (section and isinstance(node, Scalar)):
            raise _LostError  # it is reported where it stands
        if isinstance(node, Scalar):
            raise self.fail(at, f"there is nothing called '{step}' here", f"'{before}' is a single value")
        if isinstance(node, Sequence):
            if not step.isdecimal() or len(step) > 9 or int(step) >= len(node.items):
                help = f"its items are numbered from 0 to {len(node.items) - 1}" if node.items else "the list is empty"
                help = _written_as(node, self.steps[-1], f"{before}.") or help
                raise self.fail(at, f"the list '{before}' has no item '{step}'", help)
            items = list(node.items)
            items[int(step)] = self.put(items[int(step)], at + 1)
            return Sequence(items, node.flow, node.source, node.start, node.end)
        # Parts without names are numbered: `gravity.2`, the second of them, is two steps of a path.
        numbered = ".".join(self.steps[at : at + 2])
        if numbered != step and numbered in node.entries:
            self.steps[at : at + 2] = [step := numbered]
        if step in node.entries:
            whole = at + 1 == len(self.steps)
            return self.with_item(node, step, self.put(node.entries[step], at + 1), replaced=whole)
        if at == 0 and len(self.steps) > 1:
            return self.with_item(node, step, self.put(_nothing(self.span), 1))
        if at + 1 == len(self.steps) and self.steps[0] != "define":
            return self.with_item(node, step, self.value)
        if node.partial or (at == 1 and self.unsure):
            raise _LostError
        has = ", ".join(list(node.entries)[:8])
        hint = (
            (_written_as(node, self.steps[-1], f"{before}.") if at + 1 < len(self.steps) else None)
            or suggestion(step, node.entries)
            or (f"it has {has}" if has else None)
        )
        raise self.fail(at, f"'{before}' has no '{step}'", hint)

    def with_item(self, node: Mapping, key: str, value: Node, replaced: bool = False) -> Mapping:
        """A copy of a mapping with one value replaced or added.

        A value replaced as a whole gets the place of the patch, not that of the old key.
        """
        entries, keys = dict(node.entries), dict(node.keys)
        entries[key] = value
        if replaced or key not in keys:
            keys[key] = Scalar(key, "text", False, self.span.source, self.span.start, self.span.end)
        return node.holding(entries, keys)


def _of_section(root: Mapping, key: str, value: Node, families: Collection[str]) -> str | None:
    """The help for a section of one part by its name in the singular with the part's word: ``solver: euler``."""
    section = next((one for one in families if key.lower() in (one, one.removesuffix("s"))), None)
    if section is None or not isinstance(value, Scalar) or not value.text.isidentifier():
        return None
    given = [*_keys(root.entries.get(section))]
    return f"write `{section}.{given[0] if given else 'main'}: {value.text}`"


def _written_as(node: Node, name: str, before: str = "") -> str | None:
    """The help for a path that ends in a name: the few paths below a node that end so; None where there are none."""
    found = [path for path, _ in zip(_paths_to(node, name, before), range(MOST_PATHS + 1), strict=False)]
    if not before:  # the word of a part may be left out of a path
        apart = [path.split(".") for path in found]
        found = [".".join((*one[:2], *one[3:]) if len(one) > WORD + 1 else one) for one in apart]
    return f"write {' or '.join(f'`{one}`' for one in found)}" if 1 <= len(found) <= MOST_PATHS else None


def _paths_to(node: Node, name: str, before: str) -> Iterator[str]:
    items = node.entries.items() if isinstance(node, Mapping) else enumerate(getattr(node, "items", ()))
    for key, inner in items:
        if key == "variants":
            continue
        if key == name:
            yield f"{before}{key}"
        yield from _paths_to(inner, name, f"{before}{key}.")


def _keys(node: Node | None) -> Collection[str]:
    return node.entries if isinstance(node, Mapping) else ()


def _nothing(span: Span) -> Mapping:
    return Mapping({}, {}, True, span.source, span.end, span.end)
