"""Decoding of a script's bytes: UTF-8, up to a largest size."""

from __future__ import annotations

from typing import Final

from sceneql.quantities.diagnostic import Diagnostic, Diagnostics, ScriptError
from sceneql.quantities.span import Source, Span

MOST_BYTES: Final = 32_000_000
_LARGE: Final = "keep large tables in data files of their own"


def source_of(name: str, data: bytes) -> Source:
    """A source from a file's bytes, which are UTF-8, with or without a byte order mark. Raises ScriptError."""
    if len(data) > MOST_BYTES:
        raise too_large(Source(name, ""))
    try:
        return Source(name, data.decode("utf-8-sig"))
    except UnicodeDecodeError as error:
        source = Source(name, data.decode("utf-8", errors="replace"))
        at = len(data[: error.start].decode("utf-8"))
        found = Diagnostics()
        message = f"the byte {data[error.start]:#04x} is not UTF-8"
        found.error("not-utf8", message, Span(source, at, at + 1), help="save the file as UTF-8")
        raise ScriptError(found.errors) from None


def too_large(source: Source) -> ScriptError:
    """The error for a text longer than any script needs."""
    message = f"the script is larger than {MOST_BYTES // 1_000_000} MB"
    return ScriptError([Diagnostic("too-large", message, Span(source, 0, 1), _LARGE)])
