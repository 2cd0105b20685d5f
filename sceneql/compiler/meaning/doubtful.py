"""All warnings of meaning, in the order in which they are told."""

from __future__ import annotations

from collections.abc import Mapping

from sceneql.compiler.meaning import (
    after_end,
    enclosed,
    lighting,
    still_keys,
    strobing,
    unread_text,
    unused_parts,
    views,
)
from sceneql.compiler.meaning.facts import Facts
from sceneql.graph import Task
from sceneql.quantities.diagnostic import Diagnostics


def warn_of_meaning(facts: Facts, found: Diagnostics) -> None:
    """Warn of all that is valid and most likely not meant."""
    still_keys.warn(facts, found)
    strobing.warn(facts, found)
    after_end.warn(facts, found)
    unread_text.warn(facts, found)
    enclosed.warn(facts, found)
    views.warn(facts, found)
    lighting.warn(facts, found)


def warn_of_unused_parts(facts: Facts, order: Mapping[str, Task], found: Diagnostics) -> None:
    """Warn of parts that nothing uses; ``order``: those that outputs need."""
    unused_parts.warn(facts, order, found)
