"""Warnings of names under `define` that stand nowhere else in the script: a value was changed that nothing reads."""

from __future__ import annotations

import re
from collections import Counter

from sceneql.language.script import Script
from sceneql.language.tree import Mapping
from sceneql.quantities.diagnostic import Diagnostics

_WORD = re.compile(r"[^\W\d]\w*")
_COMMENT = re.compile(r"(?:^|(?<=\s))#[^\n]*", re.MULTILINE)


def warn_of_unused_defines(script: Script, found: Diagnostics) -> None:
    """Warn of each define of the script itself whose name is written once in all of its texts, comments left out.

    What an included script defines is for whoever includes it.
    """
    define = script.root.entries.get("define")
    if not isinstance(define, Mapping):
        return
    words = Counter(word for source in script.sources for word in _WORD.findall(_COMMENT.sub("", source.text)))
    once = [name for name in define.entries if words[name] == 1]
    for name in once:
        key = define.keys[name]
        if key.source.name == script.sources[0].name:
            help = f"write `{name}` where the value is meant, or leave it out"
            found.warning("unused-define", f"nothing reads '{name}'", key.span, help=help)
