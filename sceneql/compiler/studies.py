"""Studies: the patches by which sweeps and references replace values of the script."""

from __future__ import annotations

import math
import re
from collections.abc import Collection
from collections.abc import Mapping as Naming
from dataclasses import dataclass

from sceneql.compiler.catalogue import Catalogue
from sceneql.kinds import Study
from sceneql.language.patch import Patch, apply_patch
from sceneql.language.plain import kind_of
from sceneql.language.tree import Mapping, Node, Scalar, Sequence, unsure
from sceneql.quantities.diagnostic import Diagnostic, Diagnostics, ScriptError
from sceneql.quantities.span import Source, Span

NUMBER = r"[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?"
RANGE = re.compile(rf"\s*({NUMBER})\s*\.\.\s*({NUMBER})\s*([^,]*?)\s*(?:,\s*(\d+) points)?\s*(?:,\s*(log|linear))?\s*")
_ENDS = re.compile(rf"(?:from )?({NUMBER})[^\d+-]*?(?:to|-|:|,|\.\.\.)\s*({NUMBER})([^,:]*)")
_STEPS = re.compile(rf"\s*(?P<low>{NUMBER})\s*:\s*(?P<step>{NUMBER})\s*:\s*(?P<high>{NUMBER})(?P<unit>[^:]*)")
_ARANGE = re.compile(
    rf"(?:np\.)?a?range\(\s*(?P<low>{NUMBER})\s*,\s*(?P<high>{NUMBER})\s*,\s*(?P<step>{NUMBER})\s*\)(?P<unit>.*)"
)
_EVEN = re.compile(
    rf"(?:linspace|logspace|geomspace|arange|range)\(\s*({NUMBER}[^,]*),\s*({NUMBER}[^,)]*)(?:,\s*(\d+))?"
)
POINTS = 13
_LOW, _HIGH = ("from", "start", "min", "low", "first", "lower"), ("to", "end", "stop", "max", "high", "last", "upper")
_COUNT = ("steps", "points", "n", "count", "num", "number", "samples")
"""Fields of other programs for the ends of a range, and how many values it has."""
_TWO_UNITS = re.compile(r"(\S+ ?[^\W\d][^.]*?)\s*\.\.\s*([^,]+?)\s*(?:,\s*(\d+) points?)?(?:,\s*(linear|log))?")
"""A range with a unit at both ends."""
MOST_POINTS = 200
HELP = "write `1e0 .. 1e12 N/m, 13 points`, or a list of values"


@dataclass(frozen=True, slots=True)
class Tried:
    """One value of a sweep: its label, its number in ``unit`` if it is from a range, and the patch."""

    label: str
    number: float
    unit: str
    patch: Patch


def tried(path: str, node: Node) -> list[Tried]:
    """The values that a sweep tries for a path. Raises ScriptError (`sweep-shape`)."""
    if isinstance(node, Sequence) and node.items:
        labels = [_label(item) for item in node.items]
        several = len(set(labels)) < len(labels)
        if several:  # labels alone would be ambiguous
            labels = [" ".join(item.span.text.split()) for item in node.items]
        pairs = zip(labels, node.items, strict=True)
        return [Tried(label, math.nan, "", (path, item, item.span)) for label, item in pairs]
    found = RANGE.fullmatch(" ".join(node.text.split())) if isinstance(node, Scalar) else None
    if found is None:
        ends = _ENDS.fullmatch(node.text.strip()) if isinstance(node, Scalar) else None
        even = _EVEN.search(node.text) if isinstance(node, Scalar) else None
        help = HELP if ends is None else f'write `"{ends[1]} .. {ends[2]}{ends[3].rstrip()}, {POINTS} points"`'
        text = node.text.strip() if isinstance(node, Scalar) else ""
        if (steps := _STEPS.fullmatch(text) or _ARANGE.fullmatch(text)) is not None:
            help = _by_steps(steps, "range" in text)
        elif even is not None:
            help = f'write `"{_ends_of(even[1], even[2])}, {even[3] or POINTS} points, {_way(node)}"`'
        if (spread := _spread(node) or _TWO_UNITS.fullmatch(text)) is not None:
            both = _ends_of(spread[1], spread[2])
            help = f'write `"{both}, {spread[3] or POINTS} points{"" if spread[4] is None else ", " + spread[4]}"`'
        raise ScriptError([Diagnostic("sweep-shape", "this is neither a range nor a list", node.span, help)])
    low, high, unit, count, way = float(found[1]), float(found[2]), found[3], float(found[4] or POINTS), found[5]
    if not (math.isfinite(low) and math.isfinite(high)):
        raise ScriptError([Diagnostic("sweep-shape", "a range has finite ends", node.span)])
    if not 2 <= count <= MOST_POINTS:
        message = f"a range has 2 to {MOST_POINTS} points, not {count:g}"
        raise ScriptError([Diagnostic("sweep-shape", message, node.span)])
    if way == "log" and not _alike(low, high):
        raise ScriptError([Diagnostic("sweep-shape", "a logarithmic range has no 0 within", node.span)])
    result = []
    for number in spaced(low, high, int(count), log=way != "linear"):
        text = f"{number!r} {unit}".rstrip()
        value = Scalar(text, kind_of(text), False, Source(f"{path} of a study", text), 0, len(text))
        result.append(Tried(f"{number:.4g} {unit}".rstrip(), number, unit, (path, value, node.span)))
    return result


def _by_steps(steps: re.Match[str], open_end: bool) -> str:
    """The help for a range by its steps, as ``10:10:100 N/m``; ``open_end``: the last value is not one of it."""
    first, by, last = (float(steps[name]) for name in ("low", "step", "high"))
    number = (last - first) / by if by else 0.0
    count = math.ceil(number - 1e-9) if open_end else 1 + math.floor(number + 1e-9)
    if not 2 <= count <= MOST_POINTS:
        return HELP
    ends = f"{steps['low']} .. {first + (count - 1) * by:g} {steps['unit'].strip()}".rstrip()
    return f'write `"{ends}, {count} points, linear"`'


def _spread(node: Node) -> tuple[str, str, str, str | None, str | None] | None:
    """A range in fields of other programs, ``{from: 1 ms, to: 50 ms, steps: 6}``, as the groups of `_TWO_UNITS`."""
    fields = {name.lower(): one.span.text for name, one in node.entries.items()} if isinstance(node, Mapping) else {}
    low, high, count = (next((fields[one] for one in names if one in fields), None) for names in (_LOW, _HIGH, _COUNT))
    if low is None or high is None:
        return None
    even = "linear" if count is not None else None
    return "", low, high, count if count is None or count.isdecimal() else None, even


def _ends_of(low: str, high: str) -> str:
    """The ends of a range with one unit, behind the second: ``1 .. 50 ms`` for ``1 ms`` and ``50 ms``."""
    first, second = (re.fullmatch(rf"\s*({NUMBER})\s*(.*?)\s*", one) for one in (low, high))
    if first is None or second is None or first[2] not in ("", second[2]):
        return f"{low.strip()} .. {high.strip()}"
    return f"{first[1]} .. {second[1]} {second[2]}".rstrip()


def _way(node: Node) -> str:
    return "log" if isinstance(node, Scalar) and "space" in node.text and "lin" not in node.text else "linear"


def _label(node: Node) -> str:
    """The word of an entry, else the node's text."""
    if isinstance(node, Mapping) and len(node.entries) == 1:
        return next(iter(node.entries))
    return " ".join(node.span.text.split())


def spaced(low: float, high: float, points: int, *, log: bool = True) -> tuple[float, ...]:
    """Evenly spaced values from ``low`` to ``high``, both exact; with ``log`` and one sign, spaced in the logarithm."""
    parts = [k / (points - 1) for k in range(points)]
    if log and _alike(low, high):
        middle = [math.copysign(abs(low) ** (1 - part) * abs(high) ** part, low) for part in parts[1:-1]]
        decades = math.log10(abs(high)) - math.log10(abs(low))
        if abs(decades) < 300 and high / low == 10.0 ** round(
            decades
        ):  # whole decades: round to the digits that are meant
            middle = [float(f"{value:.6g}") for value in middle]
    else:
        middle = [low + (high - low) * part for part in parts[1:-1]]
    return (low, *middle, high)


def _alike(low: float, high: float) -> bool:
    """Whether both numbers have the same sign and none is 0."""
    return (low > 0 and high > 0) or (low < 0 and high < 0)


def instead(study: Study) -> list[Patch]:
    """The patches of a study's reference run."""
    return [(path, node, node.span) for path, node in (study.reference or {}).items()]


def check_studies(
    studies: Naming[str, Study], root: Mapping, catalogue: Catalogue, keys: Collection[str], found: Diagnostics
) -> None:
    """Report sweeps that are neither ranges nor lists, and paths that lead nowhere.

    ``keys``: the top-level keys except the families.
    """
    for name, study in studies.items():
        patches = instead(study)
        for path, node in study.sweep.items():
            if not unsure(node):
                try:
                    patches += [value.patch for value in tried(path, node)][:1]
                except ScriptError as error:
                    found.extend(error.diagnostics)
        written = _paths(root, name)
        placed = [(path, node, written.get(path, span)) for path, node, span in patches]
        apply_patch(root, placed, tuple(catalogue.families), keys, found)


def _paths(root: Mapping, name: str) -> dict[str, Span]:
    """The spans of the paths in a study."""
    section = root.entries.get("studies")
    study = section.entries.get(name) if isinstance(section, Mapping) else None
    fields = [study.entries.get(key) for key in ("sweep", "reference")] if isinstance(study, Mapping) else []
    groups = [field for field in fields if isinstance(field, Mapping)]
    return {path: key.span for group in groups for path, key in group.keys.items()}


def alone(study: Study) -> list[list[Patch]]:
    """The patches of each run that is checked: each value of the sweeps alone, and the reference."""
    values = [[value.patch] for path, node in study.sweep.items() for value in tried(path, node)]
    return [*values, *([instead(study)] if study.reference else [])]
