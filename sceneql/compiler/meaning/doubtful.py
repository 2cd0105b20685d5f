"""All warnings of meaning, in the order in which they are told."""

from __future__ import annotations

from collections.abc import Mapping

from sceneql.compiler.meaning import (
    after_end,
    alike_variants,
    at_rest,
    braked,
    buried_source,
    elementary,
    enclosed,
    few_frames,
    fixed_points,
    hardly_moves,
    joined,
    lighting,
    maps,
    missed,
    one_spring,
    short_ways,
    slack,
    solid_parts,
    still_fields,
    still_flows,
    still_keys,
    strobing,
    tied,
    unattracted,
    unread_text,
    unused_parts,
    views,
    whole_degrees,
)
from sceneql.compiler.meaning.facts import Facts
from sceneql.graph import Task
from sceneql.quantities.diagnostic import Diagnostics

ALL = (
    buried_source,
    solid_parts,
    fixed_points,
    few_frames,
    alike_variants,
    still_keys,
    strobing,
    tied,
    at_rest,
    after_end,
    elementary,
    hardly_moves,
    unread_text,
    enclosed,
    views,
    whole_degrees,
    joined,
    lighting,
    maps,
    missed,
    one_spring,
    short_ways,
    slack,
    still_fields,
    still_flows,
    braked,
    unattracted,
)


def warn_of_meaning(facts: Facts, found: Diagnostics) -> None:
    """Warn of all that is valid and most likely not meant."""
    for one in ALL:
        one.warn(facts, found)


def warn_of_unused_parts(facts: Facts, order: Mapping[str, Task], found: Diagnostics) -> None:
    """Warn of parts that nothing uses; ``order``: those that outputs need."""
    unused_parts.warn(facts, order, found)
