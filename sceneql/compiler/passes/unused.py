"""Warnings of names under `define` that stand nowhere else in the script: a value was changed that nothing reads."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator

from sceneql.language.script import Script
from sceneql.language.tree import Mapping, Node, Sequence
from sceneql.quantities.diagnostic import Diagnostics

_WORD = re.compile(r"[^\W\d]\w*")
_PATH = re.compile(r"(?<![\w.])define\.([^\W\d]\w*)")
_COMMENT = re.compile(r"(?:^|(?<=\s))#[^\n]*", re.MULTILINE)


def warn_of_unused_defines(script: Script, found: Diagnostics) -> None:
    """Warn of each define of the script itself whose name stands nowhere else in its texts, comments left out.

    Where a variant or a study gives it another value, nothing reads it. What an included script defines is for whoever
    includes it.
    """
    define = script.root.entries.get("define")
    if not isinstance(define, Mapping):
        return
    texts = [_COMMENT.sub("", source.text) for source in script.sources]
    words = Counter(word for text in texts for word in _WORD.findall(text))
    given = Counter(name for text in texts for name in _PATH.findall(text)) + Counter(_of_variants(script))
    for name in [name for name in define.entries if words[name] == 1 + given[name]]:
        key = define.keys[name]
        if key.source.name == script.sources[0].name:
            same = _same(script, define.entries[name])
            help = f"write `{same}: {name}` where the value is meant, or leave it out" if same else ""
            help = help or f"write `{name}` where the value is meant, or leave it out"
            more = ", and it is the same with all that it is given" if given[name] else ""
            found.warning("unused-define", f"nothing reads '{name}'{more}", key.span, help=help)


def _of_variants(script: Script) -> Iterator[str]:
    """The names to which variants give another value, section by section."""
    variants = script.root.entries.get("variants")
    for variant in variants.entries.values() if isinstance(variants, Mapping) else ():
        inner = variant.entries.get("define") if isinstance(variant, Mapping) else None
        yield from inner.entries if isinstance(inner, Mapping) else ()


def _same(script: Script, value: Node) -> str | None:
    """The field of a part that has the text of a value; None where there is none, or it is no quantity with a unit."""
    text = value.span.text
    stack: list[Node] = [node for name, node in script.root.entries.items() if name in script.sections]
    while stack and " " in text:
        node = stack.pop()
        for name, inner in node.entries.items() if isinstance(node, Mapping) else ():
            if inner.span.text == text:
                return name
            stack.append(inner)
        stack += node.items if isinstance(node, Sequence) else []
    return None
