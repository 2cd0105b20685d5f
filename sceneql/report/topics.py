"""Topics of the manual: the language besides its words, a page each, in the folder `topics` beside this file.

The examples are whole scripts, indented by four spaces; the suite checks each of them.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from sceneql.quantities.dimension import TEMPERATURE
from sceneql.quantities.unit_table import OFFSET_UNITS, SINGLE
from sceneql.quantities.units import describe

FOLDER = Path(__file__).parent / "topics"


def topics() -> dict[str, str]:
    """Every topic with the description in its title."""
    pages = {path.stem: path for path in sorted(FOLDER.glob("*.md"))}
    return {name: _title(path.read_text(encoding="utf-8")) for name, path in pages.items()}


def page(topic: str, **tables: Iterable[str]) -> str:
    """The page of a topic; a line ``{units}`` in it is replaced by the lines of that table."""
    text = (FOLDER / f"{topic}.md").read_text(encoding="utf-8")
    for name, lines in {**tables, "units": _units()}.items():
        text = text.replace(f"\n{{{name}}}\n", "\n" + "\n".join(lines) + "\n")
    return text.removeprefix("# ").rstrip()


def example(text: str) -> str:
    """The script in a page; empty where it has none."""
    lines = [line for line in text.splitlines() if line.startswith("    ") or not line]
    return "\n".join(line[4:] for line in lines).strip("\n")


def _title(text: str) -> str:
    return text.splitlines()[0].partition(": ")[2]


def _units() -> list[str]:
    """A line for each quantity: its units, and the prefixes that each takes."""
    found: dict[str, list[str]] = {}
    for name, _, dimension, prefixes in SINGLE:
        shown = " ".join(dict.fromkeys(prefixes.replace("μ", "µ").replace("u", "")))
        found.setdefault(describe(dimension), []).append(f"`{name}` ({shown})" if shown else f"`{name}`")
    found[describe(TEMPERATURE)] += [f"`{name}`" for name in OFFSET_UNITS]
    rows = [f"- {quantity}: {', '.join(units)}" for quantity, units in found.items()]
    return [
        *rows,
        "",
        "In brackets stand the prefixes that a unit takes: `kN`, `mN`, `cm`; `u` is micro, too.",
    ]
