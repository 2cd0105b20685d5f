"""Where segments leave a solid: as near as halving finds it, in a quarter of the evaluations."""

from __future__ import annotations

import numpy as np
import pytest

from meshes import tape_of
from sceneql.field.tape import exits_kernels
from sceneql.field.tape.tape_solid import exits, field_values

BALL = 0.75
FROM_BALL = f"sqrt(x^2 + y^2 + z^2) - {BALL}"
FIELDS = {
    "distance": FROM_BALL,
    "square": f"x^2 + y^2 + z^2 - {BALL}^2",
    "steep": f"exp(30*(x^2 + y^2 + z^2 - {BALL}^2)) - 1",
    "jump": f"2*step(0, {FROM_BALL}) - 1",
    "without value outside": f"-sqrt(-({FROM_BALL})) - 1e-3",
    "flat": f"({FROM_BALL})^5",
}


@pytest.mark.parametrize("name", FIELDS)
def test_a_ball_is_left_at_its_radius(name):
    ways = np.random.default_rng(1).standard_normal((200, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    found = exits(tape_of(FIELDS[name]), 0.3 * ways, 1.9 * ways)
    np.testing.assert_allclose(found, (BALL - 0.3) / 1.6, rtol=0, atol=2e-16 + 2.0**-exits_kernels.HALVINGS)
    assert exits(tape_of(FIELDS[name]), ways[:0], ways[:0]).shape == (0,)


@pytest.mark.parametrize(
    ("name", "most"), [("distance", 15), ("square", 15), ("steep", 51), ("jump", 51), ("flat", 51)]
)
def test_few_values_are_asked_where_the_field_is_smooth_and_never_more_than_by_halving(monkeypatch, name, most):
    """The kernel as Python runs it counts them: two ends, and each place that it looks at."""
    tape, asked = tape_of(FIELDS[name]), []

    def value(*arguments):
        asked.append(arguments[-3:])
        return field_values(tape, np.array([arguments[-3:]]))[0]

    written = exits_kernels.leave.py_func
    monkeypatch.setitem(written.__globals__, "value", value)
    ways = np.random.default_rng(2).standard_normal((10, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    for way in ways:
        asked.clear()
        out = np.empty(1)
        written(None, None, None, None, 0.3 * way[None], 1.9 * way[None], out)
        assert out[0] == pytest.approx((BALL - 0.3) / 1.6, abs=1e-14)
        assert len(asked) <= most
