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
from sceneql.quantities.span import Span

SHOWN = ("unstable-step",)
"""Warnings of what variants are often there to show."""
MOST = 20
"""Largest number of variants that are looked at where the script has errors itself."""


def check_variants(
    graph: SimulationGraph, path: Path, variant: str | None, sets: Sequence[str], words: Path | None
) -> list[Diagnostic]:
    """The errors of the variants (only of the chosen one, if any) and studies of a script without errors.

    And the warnings of what stands in the variants themselves.
    """
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
            made = compile_script(composed.script(name, patches, found), catalogue, found, parsed=parsed)
            section = composed.root.entries.get("variants")
            own = [one for one in made.warnings if section is not None and _within(one, section.span)]
            wrong.append([one for one in own if one.code not in SHOWN])
        except ScriptError as error:
            wrong.append(error.diagnostics)
    return told_once(wrong)


def errors_in_variants(
    path: Path, sets: Sequence[str], words: Path | None, known: Sequence[Diagnostic]
) -> list[Diagnostic]:
    """The errors in what the variants of a script give, where the script as it stands has the ``known`` errors.

    Errors elsewhere may well be those of the script again, and are left out.
    """
    found = Diagnostics()
    try:
        composed = compose_script(path, tuple(kind.family for kind in FAMILIES), KEYS, None, found)
    except ScriptError:
        return []
    section = composed.root.entries.get("variants")
    catalogue, parsed = Catalogue(words), Parsed()
    wrong: list[Sequence[Diagnostic]] = []
    for name in composed.variants if section is not None and len(composed.variants) <= MOST else ():
        found = Diagnostics()
        try:
            compile_script(composed.script(name, sets, found), catalogue, found, parsed=parsed)
        except ScriptError as error:
            wrong.append([one for one in error.diagnostics if section is not None and _within(one, section.span)])
    told = {(one.code, None if one.span is None else one.span.start) for one in known}
    return [one for one in told_once(wrong) if (one.code, None if one.span is None else one.span.start) not in told]


def _within(one: Diagnostic, place: Span) -> bool:
    """Whether an error or a warning stands in a part of the script."""
    return one.span is not None and one.span.source is place.source and place.start <= one.span.start <= place.end
