"""Scripts read from texts, and what is wrong with them."""

from __future__ import annotations

import pytest

from sceneql.language.script import Script, read_script
from sceneql.language.tree import Mapping, Node, Sequence
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.span import Source


def script(
    text: str, files: dict[str, str] | None = None, *, variant: str | None = None, sets: tuple[str, ...] = ()
) -> Script:
    def read(name: str) -> Source:
        if name not in (files or {}):
            raise FileNotFoundError(2, "there is no such file")
        return Source(name, (files or {})[name])

    return read_script(Source("s.yaml", text), variant, sets, read=read)


def errors(text: str, files: dict[str, str] | None = None, **options: object) -> tuple[Diagnostic, ...]:
    with pytest.raises(ScriptError) as caught:
        script(text, files, **options)  # type: ignore[arg-type]
    return caught.value.diagnostics


def found(text: str, files: dict[str, str] | None = None, **options: object) -> list[tuple[str, str]]:
    return [(d.code, str(d.span)) for d in errors(text, files, **options)]


def plain(node: Node | None) -> object:
    if isinstance(node, Mapping):
        return {key: plain(item) for key, item in node.entries.items()}
    if isinstance(node, Sequence):
        return [plain(item) for item in node.items]
    return None if node is None else node.text


def entries(script: Script) -> dict[str, object]:
    return {n: {e.word: plain(e.fields)} for section in script.sections.values() for n, e in section.items()}
