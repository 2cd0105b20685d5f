"""Check of all variants and studies of a script: it is read once, and what no variant changes is parsed once."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from sceneql.compiler.catalogue import Catalogue
from sceneql.compiler.check import KEYS
from sceneql.compiler.compile import compile_script
from sceneql.compiler.names import Parsed
from sceneql.compiler.studies import alone
from sceneql.graph import SimulationGraph
from sceneql.kinds import FAMILIES
from sceneql.language.patch import Patch
from sceneql.language.script import compose_script
from sceneql.quantities.diagnostic import Diagnostic, Diagnostics, ScriptError, told_once


def check_variants(
    graph: SimulationGraph, path: Path, variant: str | None, sets: Sequence[str], words: Path | None
) -> list[Diagnostic]:
    """The errors of the variants (only of the chosen one, if any) and studies of a script without errors."""
    tries: list[tuple[str | None, Sequence[str | Patch]]] = []
    tries += [(name, sets) for name in graph.variants.names if variant is None]
    tries += [(variant, (*sets, *more)) for study in graph.settings.studies.values() for more in alone(study)]
    if not tries:
        return []
    composed = compose_script(path, tuple(kind.family for kind in FAMILIES), KEYS, None, Diagnostics())
    catalogue, parsed = Catalogue(words), Parsed()
    wrong: list[Sequence[Diagnostic]] = []
    for name, patches in tries:
        found = Diagnostics()
        try:
            compile_script(composed.script(name, patches, found), catalogue, found, parsed=parsed)
        except ScriptError as error:
            wrong.append(error.diagnostics)
    return told_once(wrong)
