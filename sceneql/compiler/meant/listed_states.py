"""Help for a system of equations whose states stand in lists, as solvers of other languages take them.

``reader`` is the `Reader` (`sceneql.compiler.read`) that met the system.
"""

from __future__ import annotations

import re
from collections.abc import Mapping as Naming
from itertools import permutations
from typing import Any

from sceneql.language.tree import Node, Scalar, Sequence
from sceneql.quantities.operations import CONSTANTS, FUNCTIONS

_NAME = re.compile(r"(?<![\w.'])[^\W\d]\w*(?![\w(])")
_NUMBER_BEFORE = re.compile(r"\d\s*$")
TIMES = ("t", "time")
MOST = 5
"""Largest number of states whose order is looked for."""


def listed_states(reader: Any, written: Naming[str, Node], name: str) -> str | None:
    """The help for ``start: [1.2, 0]`` beside ``rate: ["w", "-a"]``: each value under the name that the formulas use.

    Their names are known from here on.
    """
    both = [written.get(one) for one in ("start", "rate")]
    texts = [[item.span.text for item in one.items] if isinstance(one, Sequence) else [] for one in both]
    start, rates = texts
    if not 1 <= len(start) == len(rates) <= MOST or name not in ("start", "rate"):
        return None
    formulas = [item.text for item in both[1].items if isinstance(item, Scalar)]  # type: ignore[union-attr]
    gives = written.get("gives")
    more = [] if gives is None else [gives.span.text.partition(":")[2]]
    known = {*reader.names.defines, *reader.names.parts, *CONSTANTS, *FUNCTIONS, *TIMES}
    free: dict[str, None] = {}
    for text in [*formulas, *more]:
        for one in _NAME.finditer(text):
            if one[0] not in known and not _NUMBER_BEFORE.search(text[: one.start()]):
                free.setdefault(one[0])
    if len(free) != len(start) or len(formulas) != len(start):
        return None
    orders = [order for order in permutations(sorted(free)) if not any(map(str.__eq__, order, formulas))]
    order = orders[0] if orders else tuple(free)
    for key in order:
        reader.names.broken.add(key)
    value = dict(zip(order, start if name == "start" else rates, strict=True))
    return f"each has its name: write `{name}: {{{', '.join(f'{key}: {text}' for key, text in value.items())}}}`"
