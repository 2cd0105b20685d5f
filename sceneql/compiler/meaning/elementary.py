"""Warnings of charges in Euler's number, where the elementary charge is meant."""

from __future__ import annotations

import re
from typing import Any

from sceneql.compiler.meaning.facts import Facts, constant
from sceneql.kinds import Interaction, Value
from sceneql.quantities.diagnostic import Diagnostics

E = re.compile(r"(?<![\w.])e(?![\w.(])")


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of each force whose `charge` reads e."""
    if "define" in facts.script.settings and "e" in getattr(facts.script.settings["define"], "entries", ()):
        return
    for task in facts.of(Interaction):
        charge: Any = getattr(task.kind, "charge", None)
        if isinstance(charge, Value) and charge.span is not None and E.search(charge.span.text):
            number = constant(charge)
            told = "" if not isinstance(number, float) else f": this is {number:.3g} C"
            meant = E.sub("(1.602e-19 C)" if "*" in charge.span.text else "1.602e-19 C", charge.span.text)
            text = f"`e` is 2.718, Euler's number{told}"
            found.warning("euler", text, charge.span, help=f"the elementary charge is `charge: {meant}`")
