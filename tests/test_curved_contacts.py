"""Curved rigid bodies in contact, mode `exact`: how contacts wander over them, and what rolls, against exact values."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import runs
from sceneql.bodies.rigid.tie_rows_kernels import AT_R, AT_V, AT_W, AT_X, MOVED
from sceneql.contacts.rigid_exact import contact_kernels as records
from sceneql.contacts.rigid_exact.curved import column, ellipsoid, ring
from sceneql.contacts.rigid_exact.curved_contact_kernels import ON_CORNER, ON_EDGE, ON_FACE, follow
from sceneql.contacts.rigid_exact.curved_surface_kernels import away

A_AT = np.array([1.1, 0.4, 1.3])
TIGHT = "dop853: {tolerance: 1e-12}"


def mover(x, turn, v, w):
    found = np.zeros(MOVED)
    found[AT_X : AT_X + 3], found[AT_V : AT_V + 3], found[AT_W : AT_W + 3] = x, v, w
    found[AT_R : AT_R + 9] = turn.as_matrix().ravel()
    return found


@pytest.mark.parametrize("shape", [ellipsoid((0.3, 0.5, 0.9)), ring(0.6, 0.2), column(0.5, 0.4)], ids=lambda s: s.form)
@pytest.mark.parametrize("kind", [ON_FACE, ON_EDGE, ON_CORNER])
def test_the_gap_of_a_curved_body_changes_as_its_row_says(shape, kind):
    """Both move freely: the gap's two derivatives are what its row tells at no acceleration."""
    random = np.random.default_rng(kind)
    whole = shape.mapped(np.column_stack([Rotation.random(random_state=1).as_matrix(), [0.1, -0.2, 0.05]]))
    numbers = whole.shape(np.array([0.03, 0.02, -0.01])).floats
    for _ in range(5):
        motions = random.normal(size=(2, 6))
        turns = Rotation.random(2, random_state=random)
        line = random.normal(size=3)
        record = np.zeros(records.RECORD)
        record[records.KIND], record[records.SIGN], record[records.RADIUS_B] = kind, 1, 0.1
        record[records.LINE_A] = records.RECORD
        record[records.OWN_B : records.OWN_B + 3] = 0.2, -0.1, 0.3
        record[records.LINE_B : records.LINE_B + 3] = line = line / np.linalg.norm(line)
        # Where along the line the body is nearest, roughly.
        start, along = np.array([0.2, -0.1, 0.3]), np.linspace(-4, 4, 4001)
        places = turns[1].apply(start + along[:, None] * line)
        gaps = [away(numbers, 0, *place)[0] for place in turns[0].inv().apply(places - A_AT)]
        record[records.LINE_A + 1] = along[np.argmin(gaps)]

        def told(t):
            begins = records.RECORD + len(numbers)
            both = [
                mover(x + t * m[:3], Rotation.from_rotvec(t * m[3:]) * turn, m[:3], m[3:])
                for x, turn, m in zip((A_AT, np.zeros(3)), turns, motions, strict=True)
            ]
            floats = np.concatenate([record, numbers, *both])
            follow(floats, 0, begins, begins + MOVED)
            return floats[[records.GAP, records.SPEED, records.BIAS]]

        h = 1e-4
        early, now, late = told(-h), told(0.0), told(h)
        assert (late[0] - early[0]) / (2 * h) == pytest.approx(now[1], abs=3e-6)
        assert (late[1] - early[1]) / (2 * h) == pytest.approx(now[2], abs=3e-5 * (1 + abs(now[2])))
