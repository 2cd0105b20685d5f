"""What the formulas of Adams promise: their growth, two evaluations a step, few where rates are smooth, new starts."""

from __future__ import annotations

import math

import numpy as np
import pytest

from islands import balls, final, fixed, simple, springs
from runs import watch
from sceneql.march.march import March
from sceneql.march.stability import stability
from sceneql.stepping.adams_growth import growth, growth_of, weights
from sceneql.words.solvers.adams import Adams
from sceneql.words.solvers.adams_kernels import KNOWN, USED
from sceneql.words.solvers.dop853 import Dop853

PENDULUM = simple("pendulum", [1.5, 0.2], paired=True)


def exact_at(end):
    return final(PENDULUM, Dop853(tolerance=1e-14).stepper(), end)


def marched(system, kind, end):
    """The last state, and the statistics."""
    march = March(system, kind.stepper(), end)
    return march.advance(end)[0], march.statistics


def test_the_weights_are_the_textbooks_own():
    # Hairer, Norsett & Wanner (1993), III.1, table 1.1
    assert weights(6) == pytest.approx([1, 1 / 2, 5 / 12, 3 / 8, 251 / 720, 95 / 288, 19087 / 60480], rel=1e-14)


@pytest.mark.parametrize("order", range(2, 10))
@pytest.mark.parametrize("rate", [-0.3, -0.1 + 0.4j])
def test_growth_is_what_a_step_does_to_the_linear_equation(order, rate):
    """On steps of one length it comes to its highest order, and each step multiplies what is left by one root."""
    h = 0.3
    march = March(simple("linear", [1.0, 0.0], [rate.real, rate.imag]), fixed(Adams(order=order).stepper(), h), 90.0)
    before, after = (march.advance(k * h)[0] @ (1, 1j) for k in (100, 101))
    assert march.scratch[USED] == order - 1
    assert abs(after / before) == pytest.approx(growth_of(np.array([h * rate]), order - 1), rel=1e-10)


def test_a_decay_and_an_oscillation_are_stable_up_to_what_the_textbooks_say():
    # Orders 2 and 3 of PECE with local extrapolation: 2 and 2.4 on the real axis, 0 and 1.2 on the imaginary one.
    assert growth(np.array([-1.999 + 0j]), 1) < 1 < growth(np.array([-2.001 + 0j]), 1)
    assert growth(np.array([-2.39 + 0j]), 11) < 1 < growth(np.array([-2.41 + 0j]), 11)
    assert growth(np.array([1.19j]), 12) < 1 + 1e-8 < growth(np.array([1.21j]), 12)


@pytest.mark.parametrize("damping", [20.0, 400.0])
def test_steps_of_what_has_died_out_come_to_the_bound(damping):
    system, kind = springs([1e4], [damping]), Adams(tolerance=1e-4)
    bound = stability(March(system, kind.stepper(), 1.0), kind).step
    march = March(system, kind.stepper(), 20.0)
    assert np.abs(march.advance(10.0)[0]).max() < 1e-3
    before = march.statistics.steps
    march.advance(20.0)
    assert 0.4 * bound < 10.0 / (march.statistics.steps - before) < 1.5 * bound


def test_a_step_costs_two_evaluations_and_the_error_follows_the_tolerance():
    exact = exact_at(20.0)
    for tolerance in 10.0 ** -np.arange(3.0, 13.0):
        y, done = marched(PENDULUM, Adams(tolerance=tolerance), 20.0)
        assert done.evaluations == 2 * done.steps + done.rejected
        assert np.abs(y - exact).max() < 100 * tolerance
        assert done.rejected < 0.15 * done.steps


def test_it_takes_half_the_evaluations_of_dop853_at_equal_error():
    exact = exact_at(20.0)
    curves = []
    for kind in (Adams, Dop853):
        runs = [marched(PENDULUM, kind(tolerance=tolerance), 20.0) for tolerance in 10.0 ** -np.arange(6.0, 13.0, 0.25)]
        off = [math.log(np.abs(y - exact).max()) for y, _ in runs]
        line = np.polyfit(off, [math.log(done.evaluations) for _, done in runs], 2)
        curves.append(math.exp(np.polyval(line, math.log(1e-9))))
    assert curves[0] < 0.6 * curves[1]


@pytest.mark.parametrize("order", [2, 3, 5])
def test_no_order_is_higher_than_the_highest_allowed(order):
    march = March(PENDULUM, Adams(tolerance=1e-7, order=order).stepper(), 3.0)
    used = {int(march.advance(t)[0].size and march.scratch[USED]) + 1 for t in np.linspace(0.5, 3, 60)}
    assert max(used) == order
    assert np.abs(march.advance(3.0)[0] - exact_at(3.0)).max() < 1e-5


def test_frames_are_as_exact_as_the_ends_of_steps():
    times = np.linspace(0.013, 3.0, 700)
    march = March(PENDULUM, Adams(tolerance=1e-10).stepper(), 3.0)
    reference = March(PENDULUM, Dop853(tolerance=1e-14).stepper(), 3.0)
    off = [np.abs(march.advance(t)[0] - reference.advance(t)[0]).max() for t in times]
    assert march.statistics.steps < 300
    assert max(off) < 1e-9


def test_an_impact_begins_anew_with_order_2():
    ball = balls([1.0], 0.8)
    march = March(ball.system, Adams().stepper(), 5.0)
    hit = math.sqrt(2 / 9.81)
    march.advance(hit - 1e-9)
    events = march.statistics.events
    while march.statistics.events == events:
        march.advance(march.time + 1e-12)
    assert (march.scratch[USED], march.scratch[KNOWN]) == (1, 0)


@pytest.mark.parametrize("force", ["where(x < 0.3, 5, -2)", "1 + 5*floor(3*x)"])
def test_a_force_that_jumps_where_nothing_tells_it_is_felt(tmp_path, force):
    def at_the_end(solver):
        script = (
            "models: {p: {particles: {list: {a: {position: 0 0 0}}}}}\n"
            f'forces: [{{force: {{components: "[{force}, 0, 0]"}}}}]\n'
            f"clock: {{end: 1 s}}\nsolvers: {{main: {{{solver}}}}}\n"
        )
        return np.concatenate(watch(tmp_path, script, [1.0], "p.a.position", "p.a.velocity")[0])

    exact = at_the_end("dop853: {tolerance: 1e-12}")
    np.testing.assert_allclose(at_the_end("adams: {tolerance: 1e-8}"), exact, rtol=0, atol=1e-6)
