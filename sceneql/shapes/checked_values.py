"""Values of this instant that must lie in a range: a constant is checked in the script, a varying one here."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from sceneql.failure import RunFailure

if TYPE_CHECKING:
    from sceneql.kinds import Moment, Value


def positive(moment: Moment, value: Value, part: str) -> float:
    """A value that is above 0 now. Raises RunFailure at its line of the script if it is not."""
    now = float(moment.at(value))
    if not (now > 0 and math.isfinite(now)):
        raise RunFailure(
            f"must be above 0 and finite, but is {now:g} now", part=part, time=moment.time, span=value.span
        )
    return now


def not_negative(moment: Moment, value: Value, part: str) -> float:
    """A value that is not below 0 now. Raises RunFailure at its line of the script if it is."""
    now = float(moment.at(value))
    if not (now >= 0 and math.isfinite(now)):
        raise RunFailure(
            f"must be at least 0 and finite, but is {now:g} now", part=part, time=moment.time, span=value.span
        )
    return now
