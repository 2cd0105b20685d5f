"""Plain scalars: YAML 1.2 core types, and keys that are the remainder of a value cut at a comma."""

from __future__ import annotations

import re
from typing import Final, Literal

Kind = Literal["null", "boolean", "integer", "number", "text"]

_WORDS: Final[dict[str, Kind]] = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL"), "null"),
    **dict.fromkeys(("true", "True", "TRUE", "false", "False", "FALSE"), "boolean"),
}
_NUMBER = re.compile(
    r"(?P<integer>[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+)"
    r"|[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)"
)
_CUT_OFF = re.compile(r"[-+]?\.?[0-9]")


def kind_of(text: str) -> Kind:
    """The YAML 1.2 core type of a plain scalar: ``1e3`` is a number, ``no`` and ``yes`` are text."""
    if (word := _WORDS.get(text)) is not None:
        return word
    if text[0] not in "+-.0123456789" or (found := _NUMBER.fullmatch(text)) is None:
        return "text"
    return "number" if found["integer"] is None else "integer"


def cut_off(key: str) -> bool:
    """Whether a key without a value is the remainder of a cut value: ``{radius: 1,5 m}`` has a key ``5 m``."""
    return _CUT_OFF.match(key) is not None
