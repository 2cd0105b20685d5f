"""Warnings of angles in radians whose numbers are those of degrees, `90 rad`, and the other way: `1.57 deg`."""

from __future__ import annotations

import re
from math import pi

from sceneql.compiler.meaning.facts import Facts
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.span import Span

RADIANS = re.compile(r"(?<![\w.])(\d+)(?:\.0*)?\s*rad(?![\w/^*.]| *[/*])")
DEGREES = re.compile(r"(?<![\w.])(0?\.785\d*|1\.57\d*|3\.14\d*|4\.71\d*|6\.28\d*)\s*(?:deg|°)(?![\w/^*.]| *[/*])")
"""Quarters of a turn, and an eighth, with the digits that they have in radians."""
FEWEST, STEP = 30, 15
"""Least number that is taken for degrees, and of what such numbers are multiples."""
WORDS = re.compile(r"\b(text|title|label|because)\s*:|#")
"""Fields that hold words, and what begins a comment."""


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of each such angle in the script's own text."""
    source = facts.script.sources[0]
    for match in RADIANS.finditer(source.text):
        number = int(match[1])
        line = source.text[source.text.rfind("\n", 0, match.start()) + 1 : match.start()]
        if number < FEWEST or number % STEP or WORDS.search(line):
            continue
        text = f"{number} rad is {number / (2.0 * pi):.3g} turns"
        help = f"for degrees write `{number} deg`"
        found.warning("radians", text, Span(source, match.start(), match.end()), help=help)
    for match in DEGREES.finditer(source.text):
        line = source.text[source.text.rfind("\n", 0, match.start()) + 1 : match.start()]
        if not WORDS.search(line):
            text = f"{match[1]} deg is hardly a turn: in radians it is {float(match[1]) / (2.0 * pi):.3g} turns"
            help = f"for radians write `{match[1]} rad`"
            found.warning("radians", text, Span(source, match.start(), match.end()), help=help)
