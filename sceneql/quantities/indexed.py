"""Help for square brackets behind a value, by which other programs take an item of a list."""

from __future__ import annotations

import re

from sceneql.quantities.expression import Expr, Name, Vector

_INDEX = re.compile(r"\[\s*(\d+)\s*\](?!\.)")
_COPY = re.compile(r"\[\s*([^\[\]{}\"']+?)\s*\](\.[\w.]+)?")
AXES = "xyz"


def indexed(expr: Expr, before: str, text: str, at: int) -> str | None:
    """The help for brackets at ``at`` in a text behind an expression, whose last token is ``before``; else None."""
    if isinstance(expr, Vector):
        found = _COPY.match(text, at)
        if found is None or found[2] or expr.span is None or not expr.items:
            return None
        take = "item" if isinstance(expr.items[0], Vector) else "component"
        return f"write `{take}({expr.span.text}, {found[1]})`"
    if not isinstance(expr, Name):
        return None
    if (index := _INDEX.match(text, at)) is not None:
        whole = f"item({before}, {index[1]})"
        if int(index[1]) >= len(AXES) or before.endswith("s"):  # positions, radii of a list
            return f"write `{whole}`"
        return f"write `{before}.{AXES[int(index[1])]}`, or of a list `{whole}`"
    if (copy := _COPY.match(text, at)) is None:
        return None
    number, rest = copy[1], copy[2] or ""
    of_copies = f'a copy\'s number stands in braces: write `"{before}.{{{number}}}{rest}"`'
    if number.isdecimal():
        of_copies = f"a copy's number stands behind a dot: write `{before}.{number}{rest}`"
    if rest:
        return of_copies
    if "." in before:
        return f"an item of a list is `item({before}, {number})`; {of_copies}"
    inner = f"({before}, {number})"
    return f"of a list of numbers it is `component{inner}`, of vectors `item{inner}`; {of_copies}"
