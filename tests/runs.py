"""Scripts run by the real march, for the tests of models, forces and contacts: no picture is made."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from sceneql.pipeline import load
from sceneql.quantities.diagnostic import ScriptError
from sceneql.run.run import Run


def watch(folder: Path, script: str, times: Sequence[float], *outputs: str, pruned: bool = True) -> list[list[Any]]:
    """For every instant the values of the outputs, written as `part.output`.

    ``pruned``: without what no output of the script needs.
    """
    path = folder / "scene.yaml"
    path.write_text(script, encoding="utf-8")
    rows = []
    for moment in Run(load(path, pruned=pruned)).moments(times):
        rows.append([moment.read(*output.split(".", 1)) for output in outputs])
    return rows


def complaint(folder: Path, script: str) -> str:
    """What is said of a wrong script."""
    path = folder / "scene.yaml"
    path.write_text(script, encoding="utf-8")
    try:
        load(path)
    except ScriptError as error:
        return str(error)
    return ""
