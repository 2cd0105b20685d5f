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
LETTERS, SHORT = "abcdefhjkmnpqruvw", 3
"""Names of states that have numbers alone, and the longest name that is taken for one."""
_ITEM = re.compile(r"(?<![\w.'])([^\W\d]\w*)(?:\[|\()(\d)(?:\]|\))")


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
    if (states := _numbered(formulas, known)) is not None:
        of, base = states
        own = [one for one in free if one != of and len(one) <= SHORT]
        own += [one for one in LETTERS if one not in {*known, *free}]
        reader.names.broken.add(of)
        formulas = [_ITEM.sub(lambda one: own[int(one[2]) - base], text) for text in formulas]
        rates = [f'"{text}"' if "," in text else text for text in formulas]
        free = dict.fromkeys(own[: len(start)])
    if len(free) != len(start) or len(formulas) != len(start):
        return None
    orders = [order for order in permutations(sorted(free)) if not any(map(str.__eq__, order, formulas))]
    orders = [tuple(free)] if states is not None else orders
    order = orders[0] if orders else tuple(free)
    for key in order:
        reader.names.broken.add(key)
    value = dict(zip(order, start if name == "start" else rates, strict=True))
    return f"each has its name: write `{name}: {{{', '.join(f'{key}: {text}' for key, text in value.items())}}}`"


def _numbered(formulas: list[str], known: set[str]) -> tuple[str, int] | None:
    """The name whose items are states in formulas, ``y`` of ``y[1]``, and the number of the first; None for none."""
    found = [one for text in formulas for one in _ITEM.finditer(text) if one[1] not in known]
    names, numbers = {one[1] for one in found}, [int(one[2]) for one in found]
    base = 1 if any("(" in one[0] for one in found) else 0
    if len(names) != 1 or not all(0 <= number - base < len(formulas) for number in numbers):
        return None
    return names.pop(), base
