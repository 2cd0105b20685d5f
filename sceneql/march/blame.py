"""Search for the term that makes an island's rate not finite."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sceneql.island import layout

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.island.system import Origin, System
    from sceneql.march.driver import Driver


def culprit(system: System, driver: Driver, floats: Floats, t: float, y: Floats) -> Origin | None:
    """The first term with which the rate at time t [s] and state y is not finite; None where the rate is finite.

    The driver is called with groups that end after the first term, the second and so on, up to the culprit. None, too,
    where the state itself is not finite.
    """
    ints, floats, rate = system.ints.copy(), floats.copy(), np.empty_like(y)
    firsts = ints[layout.GROUPS_AT : layout.GROUPS_AT + len(system.structure.terms) + 1].copy()
    if not np.isfinite(y).all():
        return None
    for count, term in enumerate(system.terms, 1):
        ints[layout.GROUPS_AT : layout.GROUPS_AT + len(firsts)] = np.minimum(firsts, firsts[0] + count)
        driver.rate(t, y, rate, floats, ints)
        if not np.isfinite(rate).all():
            return term
    return None
