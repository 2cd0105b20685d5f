"""What the march promises with every kind of stepper: impacts on time, frames that read the flight, told failures."""

from __future__ import annotations

import math

import numpy as np
import pytest

from islands import TETHER, balls, simple
from sceneql.failure import LimitRefused, RunFailure
from sceneql.island.island import IslandAssembly
from sceneql.march.march import March
from sceneql.words.solvers.adams import Adams
from sceneql.words.solvers.blanes_moan import BlanesMoan
from sceneql.words.solvers.dop853 import Dop853
from sceneql.words.solvers.dopri5 import Dopri5
from sceneql.words.solvers.gauss_radau15 import GaussRadau15
from sceneql.words.solvers.heun import Heun
from sceneql.words.solvers.rk4 import Rk4
from sceneql.words.solvers.verlet import Verlet

BOUNCERS = [Rk4(step=1e-3).stepper(), Rk4(step=1 / 60).stepper(), Dopri5().stepper()]
BOUNCERS += [kind.stepper() for kind in (Heun(), Verlet(), BlanesMoan(step=1 / 60), Dop853(), GaussRadau15(), Adams())]


@pytest.mark.parametrize("stepper", BOUNCERS)
def test_a_bouncing_ball_hits_and_rests_on_time(stepper):
    ball = balls([1.0], 0.8)
    march = March(ball.system, stepper, 5.0)
    for k in range(150):
        y, _ = march.advance(k / 30)
        assert y[0] > -1e-9
    first = math.sqrt(2 / 9.81)
    assert march.floats[ball.hit_at] == pytest.approx(first, abs=1e-11)
    assert march.floats[ball.rest_at] == pytest.approx(first * (1 + 2 * 0.8 / (1 - 0.8)), abs=1e-9)
    assert march.floats[ball.rest_at] == pytest.approx(4.063712768872, abs=1e-9)
    assert y[0] == pytest.approx(0, abs=1e-9)
    assert 90 < march.statistics.events < 130


def test_balls_that_hit_together_and_apart_each_bounce():
    ball = balls([1.0, 1.0, 0.5, 2.0], 0.7)
    march = March(ball.system, Rk4(step=0.01).stepper(), 1.0)
    march.advance(1.0)
    times = march.floats[ball.hit_at : ball.hit_at + 4]
    np.testing.assert_allclose(times, np.sqrt(2 * np.array([1.0, 1.0, 0.5, 2.0]) / 9.81), rtol=1e-11)


@pytest.mark.parametrize("step", [1e-3, 0.1])
def test_many_balls_come_to_rest_together(step):
    ball = balls([1.0] * 7, 0.8)
    march = March(ball.system, Rk4(step=step).stepper(), 5.0)
    march.advance(5.0)
    np.testing.assert_allclose(march.floats[ball.rest_at : ball.rest_at + 7], 4.063712768872, rtol=0, atol=1e-9)


def test_a_frame_at_an_impact_reads_the_flight_before_it():
    ball = balls([1.0], 0.8)
    march = March(ball.system, Dopri5().stepper(), 5.0)
    for before in (1e-3, 1e-6, 1e-9):
        t = math.sqrt(2 / 9.81) - before
        y, _ = march.advance(t)
        assert y[1] == pytest.approx(-9.81 * t, rel=1e-9)
    assert march.advance(math.sqrt(2 / 9.81) + 1e-3)[0][1] > 0


def test_a_ball_that_lies_on_the_floor_stays():
    ball = balls([0.0], 0.8)
    march = March(ball.system, Dopri5().stepper(), 5.0)
    assert march.advance(5.0)[0].tolist() == [0.0, 0.0]
    assert march.statistics.events == 1


def test_local_contacts_act_on_every_step():
    march = March(balls([1.0], 1.0, mode="local").system, Rk4(step=1e-3).stepper(), 5.0)
    heights = [march.advance(k / 100)[0][0] for k in range(500)]
    assert min(heights) > -1e-4
    assert max(heights[100:]) > 0.9


# --- failure ---


def test_a_singularity_is_told_with_its_time():
    # y' = -y^2 cos t from y(0) = -2 has a pole where sin t = 1/2
    with pytest.raises(RunFailure, match=r"run away|singularity") as caught:
        March(simple("forced", [-2.0]), Dopri5().stepper(), 3.0).advance(3.0)
    assert caught.value.time == pytest.approx(math.pi / 6, abs=1e-3)
    assert caught.value.part == "model"


def test_a_start_without_a_rate_is_told():
    with pytest.raises(RunFailure, match="at the start"):
        March(simple("pendulum", [math.inf, 0.0]), Rk4().stepper(), 1.0).advance(0.0)


def test_a_state_that_cannot_be_held_is_refused_at_once():
    with pytest.raises(LimitRefused, match="GiB"):
        IslandAssembly(None).room(6e12, TETHER)
