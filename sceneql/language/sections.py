"""Sections and entries: joining several scripts to one tree, and the shape of entries."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable
from dataclasses import dataclass, replace
from typing import Final

from sceneql.language.dashed import words_apart
from sceneql.language.in_group import in_group
from sceneql.language.scope import Broken
from sceneql.language.tree import Mapping, Node, Scalar, Sequence, broken
from sceneql.quantities.diagnostic import STRONG, Diagnostics, Note, nearest
from sceneql.quantities.instead import instead

NAMED: Final = ("define", "templates", "parts", "defaults", "variants", "expect", "studies")
"""Sections beside the families that hold names."""

TEXTS: Final = ("about", "background", "sceneql")
"""Sections that hold a single value."""
NOTHING: Final = ("none", "no", "false", "off")
"""Words of what is not to be there."""
TYPES: Final = ("type", "kind", "shape", "geometry", "primitive")
"""Keys by which other programs tell the word of a part."""
NAMES: Final = ("name", "id")
"""Keys by which other programs name a part."""
COPIES = (
    "copy",
    "copy_of",
    "clone",
    "like",
    "instance",
    "instance_of",
    "prototype",
    "extends",
    "inherits",
    "duplicate",
)
"""Words of other programs for a part that is as another one."""
SHOWN: Final = 80
"""Longest text of fields that a message repeats."""
_EQUATED = re.compile(r"([^\W\d]\w*)\s*=\s*(\S.*)")
_ENTRY = "an entry is `name: word` or `name: {word: {fields}}`"


@dataclass(frozen=True, slots=True)
class Written:
    """An entry as written: ``word`` is the node of the word, ``fields`` None where there are none."""

    word: Scalar
    fields: Node | None
    repeat: Node | None


def empty(node: Node) -> bool:
    """Whether a node is an empty value."""
    return isinstance(node, Scalar) and node.kind == "null" and not node.quoted


def read_entry(what: str, node: Node, found: Diagnostics, sections: Collection[str] = ()) -> Written | None:
    """The word and fields of an entry; None after reporting a wrong shape, as of one of the ``sections`` in another."""
    name = what.strip("'")
    margin = f"`{name}` is a section: write it at the left margin, as `objects`"
    if isinstance(node, Scalar):
        if broken(node):
            return None
        if node.kind == "text":
            return Written(node, None, None)
        message = f"{what} has no word" if empty(node) else f"{what} is the {node.kind} {node.text}, not a part"
        found.error("entry-shape", message, node.span, help=instead("named", name) or _ENTRY)
        return None
    if isinstance(node, Sequence):
        help = margin if name in sections else instead("list", name) or _ENTRY
        found.error("entry-shape", f"{what} is a list, not a part", node.span, help=help)
        return None
    words = [key for key in node.entries if key != "repeat"]
    if not words and node.partial:
        return None
    if node.partial and node.flow and node.span.text.lstrip("{ ").startswith("<<"):
        return None  # the part that it is like is what stands there, which is reported
    if not words:
        help = f"if {what} is the word, a name stands before it: write `main: {name}`; {_ENTRY}"
        found.error("entry-shape", f"{what} has no word", node.span, help=help if name.isidentifier() else _ENTRY)
        return None
    if len(words) > 1:
        first, second = node.keys[words[0]], node.keys[words[1]]
        message = f"{what} holds '{words[0]}' and '{words[1]}', but a part has one word"
        both = f"{{{words[0]}: ..., {words[1]}: ...}}"
        help = f"fields stand below the word: {{word: {both}}}: `sceneql words` lists them"
        if name in sections:
            help = margin
        elif name.isidentifier():
            help = (
                f"if '{name}' is the word, a name stands before it: `NAME: {{{name}: {both}}}`; if it is the name, a "
                f"word stands around the fields: `{name}: {{WORD: {both}}}`: `sceneql words` lists them"
            )
        holding = [word for word in words if isinstance(node.entries[word], Mapping)]
        main = holding[0] if len(holding) == 1 or (holding and holding[0] == words[0]) else ""
        main = words[0] if not main and empty(node.entries[words[0]]) else main
        beside = (instead("beside", word) for word in words if word != main)
        typed = next((key for key in TYPES if key in words and isinstance(node.entries[key], Scalar)), None)
        if typed is not None:
            word = node.entries[typed].span.text
            own = next((node.entries[key].span.text for key in words if key in NAMES), "")
            more = [key for key in words if key != typed and key not in NAMES]
            inner = ", ".join(f"{key}: {node.entries[key].span.text}" for key in more)
            inner = f"{{{word}: {{{inner if len(inner) <= SHOWN else '...'}}}}}"
            help = f"the word stands around its fields: write `{inner}`"
            if own.isidentifier():
                help = f"its name stands before its word, without a dash: write `{own}: {inner if more else word}`"
        elif (copied := next((one for one in COPIES if one in words), None)) and name.isidentifier():
            beside_it = ", ".join(f"{key}: {node.entries[key].span.text}" for key in words if key != copied)
            help = f"write `{name}: {{use: {node.entries[copied].span.text}, {beside_it}}}`: `sceneql words use`"
        elif main not in ("", "group") and "scale" in words:
            help = f"a group scales what is in it: write `{name}: {in_group(main, _fields_of(main, words, node))}`"
        elif (other := instead("entry", words[0]) or next(filter(None, beside), None)) is not None:
            help = other
        elif main:
            help = f"fields stand inside the braces of the word: write `{_put_inside(main, words, node)}`"
        found.error("entry-shape", message, second.span, help=help, notes=[Note("the first stands here", first.span)])
        return None
    fields = node.entries[words[0]]
    return Written(node.keys[words[0]], None if empty(fields) else fields, node.entries.get("repeat"))


def _fields_of(main: str, words: Collection[str], node: Mapping) -> dict[str, Node]:
    """The fields of an entry's word and those beside it."""
    inner = node.entries[main]
    fields = dict(inner.entries) if isinstance(inner, Mapping) else {}
    return fields | {name: node.entries[name] for name in words if name != main}


def _put_inside(main: str, words: Collection[str], node: Mapping) -> str:
    """The entry with the fields beside its word among those of the word: ``{cloth: {size: 1 1 m, color: red}}``."""
    inner = node.entries[main]
    fields = dict(inner.entries) if isinstance(inner, Mapping) else {}
    own = ", ".join(f"{name}: {one.span.text}" for name, one in fields.items())
    own = own if fields and "\n" not in own and len(own) <= SHOWN else "..."
    more = [(name, node.entries[name].span.text) for name in words if name != main]
    told = ", ".join(f"{name}: {text if chr(10) not in text and len(text) <= SHOWN else '...'}" for name, text in more)
    return f"{{{main}: {{{own if fields else ''}{', ' if fields else ''}{told}}}}}"


def with_known_keys(node: Mapping, known: Collection[str], holder: str, lost: Broken, found: Diagnostics) -> Mapping:
    """The sections of a script or template, which messages call ``holder``; unknown ones are reported.

    An unknown section of parts is read as the known one with the nearest name, unless that is present too; otherwise
    the names in it are added to ``lost``.
    """
    result = node.holding({}, {})
    for key, value in node.entries.items():
        name = key
        if key not in known:
            other = instead("section", key) or instead("section", key.partition(" ")[0])
            if other is not None and isinstance(value, Scalar) and value.text.lower() in NOTHING:
                other = instead("absent", key) or other
            near = _near(key, known, value) if other is None else None
            above = next(reversed(result.entries), "") if not node.flow else ""
            if above and empty(result.entries[above]) and not isinstance(value, Scalar) and near is None:
                other = f"what belongs to `{above}:` is indented below it: write two spaces before `{key}:`"
            every = f"{holder} may have {', '.join(dict.fromkeys(known))}: `sceneql words sections`"
            help = other or (f"did you mean '{near}'?" if near is not None else every)
            found.error("unknown-section", f"{holder} has no section '{key}'", node.keys[key].span, help=help)
            taken = node.entries.keys() | result.entries.keys()
            whole = key != str(near)[:-1] or _holds_parts(value)
            if near is not None and near not in taken and not isinstance(value, Scalar) and whole:
                name = near
            else:
                for inner in _names_in(value):
                    lost.add(inner)
        result.entries[name], result.keys[name] = value, node.keys[key]
    return result


def _holds_parts(value: Node) -> bool:
    """Whether a value is a section of parts by name, and not a part itself: ``camera: {perspective: {...}}`` is one."""
    parts = value.entries if isinstance(value, Mapping) else {}
    for name, one in parts.items():
        inner = list(one.entries.values()) if isinstance(one, Mapping) else []
        word = isinstance(one, Scalar) and one.kind == "text" and name not in TYPES and one.text.isidentifier()
        if not word and not (len(inner) == 1 and (isinstance(inner[0], Mapping) or empty(inner[0]))):
            return False
    return True


def _near(key: str, known: Collection[str], value: Node) -> str | None:
    """The section most likely meant by its letters; one that is but a little like it has to suit the value."""
    if (strong := nearest(key, known, STRONG)) is not None:
        return strong
    near = nearest(key, known)
    return near if near is None or isinstance(value, Scalar) == (near in TEXTS) else None


def _names_in(node: Node) -> list[str]:
    """The names of parts in a value that may be a section."""
    if isinstance(node, Mapping):
        return list(node.entries)
    words = node.items if isinstance(node, Sequence) else []
    return [name for word in words for name in ([word.text] if isinstance(word, Scalar) else _names_in(word))]


def section(name: str, node: Node, taken: Collection[str], found: Diagnostics) -> Mapping:
    """A section as a mapping; the items of a list are named by their words: ``gravity``, ``gravity.2``, ..."""
    if isinstance(node, Mapping):
        return node
    result = Mapping({}, {}, True, node.source, node.start, node.end, broken(node))
    if isinstance(node, Sequence):
        for item in node.items:
            written = read_entry(f"this item of '{name}'", item, found)
            if written is not None:
                own = _free(written.word.text, result.entries.keys() | set(taken))
                result.entries[own], result.keys[own] = item, written.word
    elif not (empty(node) or broken(node)):
        help = f"write `{name}: [{words_apart(node.text)}]`" if node.kind == "text" else _ENTRY
        if (equated := _EQUATED.fullmatch(node.text.strip())) is not None:
            help = f"a name has a colon behind it: write `{equated[1]}: {equated[2]}`"
        if name == "outputs" and "." in node.text:
            help = "write `outputs: {film: video}`; `sceneql render SCENE -o FILE` names the file"
        found.error("section-shape", f"'{name}' holds parts by name, or a list of words", node.span, help=help)
    return result


def _free(word: str, taken: Collection[str]) -> str:
    number, name = 1, word
    while name in taken:
        number += 1
        name = f"{word}.{number}"
    return name


def join(trees: Iterable[Mapping], families: Collection[str], found: Diagnostics) -> Mapping:
    """One tree of a script and those it includes.

    Families and sections of names are merged, and a name in two scripts is an error; of other keys the first script's
    value stands. Sections that are lists become mappings.
    """
    trees = list(trees)
    first = trees[0]
    partial = any(tree.partial for tree in trees)
    root = Mapping({}, {}, False, first.source, first.start, first.end, partial)
    named = {*families, *NAMED}
    lists: list[tuple[str, Node]] = []
    for tree in trees:
        for key, node in tree.entries.items():
            if key in families and not isinstance(node, Mapping):
                lists.append((key, node))
                node = Mapping({}, {}, True, node.source, node.start, node.end)
            if key not in root.entries:
                root.entries[key], root.keys[key] = node, tree.keys[key]
            elif key in named:
                root.entries[key] = _merged(key, root.entries[key], node, found)
    taken = {name for key in (*families, "define", "parts") for name in _names(root.entries.get(key))}
    for key, node in lists:
        more = section(key, node, taken, found)
        taken |= more.entries.keys()
        root.entries[key] = _merged(key, root.entries[key], more, found)
    return root


def _names(node: Node | None) -> Iterable[str]:
    return node.entries if isinstance(node, Mapping) else ()


def _merged(key: str, one: Node, other: Node, found: Diagnostics) -> Node:
    if empty(one) or empty(other):
        return other if empty(one) else one
    if broken(one) or broken(other):
        known = other if broken(one) else one
        return replace(known, partial=True) if isinstance(known, Mapping) else known
    if not isinstance(one, Mapping) or not isinstance(other, Mapping):
        odd = other if isinstance(one, Mapping) else one
        found.error("section-shape", f"'{key}' holds values by name", odd.span, help="write `name: value`")
        return one
    result = one.holding(dict(one.entries), dict(one.keys))
    result.partial = one.partial or other.partial
    for name, node in other.entries.items():
        if name in result.entries:
            duplicate(name, result.keys[name], other.keys[name], found)
        else:
            result.entries[name], result.keys[name] = node, other.keys[name]
    return result


def duplicate(name: str, first: Scalar, second: Scalar, found: Diagnostics) -> None:
    """Report a name that two parts have."""
    help = "all parts of a script share one set of names: rename one of the two"
    note = Note("the first stands here", first.span)
    found.error("duplicate-name", f"the name '{name}' is used twice", second.span, help=help, notes=[note])
