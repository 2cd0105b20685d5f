"""Bundles of rays that pass near each other, and their roots beside those of the certified routine."""

import numpy as np
import pytest

from sceneql.field.packets.packets import cast_together
from sceneql.field.tape.tape_ops import (
    HIT,
    INSIDE,
    UNDECIDED,
)
from sceneql.field.tape.tape_solid import cast


def bundle(origin, direction, generator, count, spread):
    """Rays near one another."""
    return origin + spread * generator.uniform(-1, 1, (count, 3)), direction + spread * generator.uniform(
        -1, 1, (count, 3)
    )


def agree_with_the_certified(tape, origins, directions, t0, t1, within, cut=()):
    """First places, and whether there is any, as the certified routine has them, wherever both decide."""
    status, t = cast_together(tape, origins, directions, t0, t1, cut=cut)
    exact, places = cast(tape, origins, directions, t0, t1)
    told = (status != UNDECIDED) & (exact != UNDECIDED)
    assert told.mean() > 0.9
    met, truly = np.isin(status, [HIT, INSIDE]), np.isin(exact, [HIT, INSIDE])
    assert (met == truly)[told].all()
    assert t[met & told] == pytest.approx(places[met & told], abs=within)
    blocked, _ = cast_together(tape, origins, directions, t0, t1, anywhere=True, cut=cut)
    told &= blocked != UNDECIDED
    assert (np.isin(blocked, [HIT, INSIDE]) == truly)[told].all()
