"""Values of a force's field for each mass, as its charge: one number for all masses, or a list with one for each."""

from __future__ import annotations

from itertools import accumulate
from typing import TYPE_CHECKING, Annotated

from sceneql.kinds import Quantity, Value
from sceneql.quantities import dimension as dim
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.unit_table import CHARGE, VOLTAGE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sceneql.frame import Floats
    from sceneql.system import Assembly, Bodies, ModelState

Charges = Annotated[Value, Quantity(CHARGE, None)]
ElectricField = Annotated[Value, Quantity(VOLTAGE / dim.LENGTH, (3,))]
MagneticField = Annotated[Value, Quantity(VOLTAGE * dim.TIME / dim.AREA, (3,))]


def each(assembly: Assembly, value: Value, count: int, what: str) -> tuple[int, int]:
    """Store one number for all masses or one for each; return the first one's offset and the stride, 0 or 1.

    Raises ScriptError for a list whose length is neither 1 nor ``count``.
    """
    import numpy as np

    given = np.size(assembly.initial(value))
    if given not in (1, count):
        text = f"{given} {what}s are given for {count} masses"
        help = f"give one {what} for all, or a list with one for each"
        raise ScriptError([Diagnostic("list-length", text, value.span, help)])
    return assembly.value(value), int(given > 1)


def each_of_all(assembly: Assembly, value: Value, counts: Sequence[int], what: str) -> list[tuple[int, int]]:
    """The same for masses of several models, ``counts`` each: a list may also hold one for every mass of all, in turn.

    Raises ScriptError for a list of any other length.
    """
    import numpy as np

    given, all_of_them = np.size(assembly.initial(value)), sum(counts)
    if len(counts) > 1 and given == all_of_them:
        at = assembly.value(value)
        return [(at + before, 1) for before in accumulate((0, *counts[:-1]))]
    if given != 1 and any(given != count for count in counts) and len(counts) > 1:
        text = f"{given} {what}s are given for {' and '.join(str(count) for count in counts)} masses"
        help = f"give one {what} for all, or a list of {all_of_them}, with those of the first model first"
        raise ScriptError([Diagnostic("list-length", text, value.span, help)])
    return [each(assembly, value, count, what) for count in counts]


def of_moving(bodies: Bodies, state: ModelState, at: int, step: int) -> Floats:
    """Numbers (n,) of the masses, stored by `each` at offset ``at`` with stride ``step``; 0 for a fixed mass."""
    import numpy as np

    inverse = state.floats[bodies.inverse_at : bodies.inverse_at + bodies.count]
    numbers = state.floats[at + step * np.arange(bodies.count)]
    return np.where(inverse > 0, numbers, 0.0)
