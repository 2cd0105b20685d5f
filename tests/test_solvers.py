"""What every solver promises: its order, its stability, its dense output, the same physics whatever the frames."""

from __future__ import annotations

import math

import numpy as np
import pytest

from islands import TETHER, balls, final, fixed, march_by, simple, springs
from sceneql.compiled import kernels
from sceneql.failure import RunFailure
from sceneql.march.march import March
from sceneql.march.stability import stability
from sceneql.stepping import dormand_prince_8, tableau
from sceneql.words.solvers.adams import Adams
from sceneql.words.solvers.blanes_moan import BlanesMoan
from sceneql.words.solvers.boris import Boris
from sceneql.words.solvers.dop853 import Dop853
from sceneql.words.solvers.dopri5 import Dopri5
from sceneql.words.solvers.euler import Euler
from sceneql.words.solvers.gauss_radau15 import GaussRadau15
from sceneql.words.solvers.heun import Heun
from sceneql.words.solvers.midpoint import Midpoint
from sceneql.words.solvers.rk4 import Rk4
from sceneql.words.solvers.runge_kutta import RungeKutta
from sceneql.words.solvers.semi_implicit_euler import SemiImplicitEuler
from sceneql.words.solvers.verlet import Verlet
from solver_words import EVERY, HEUN_3, solver

DENSE = {
    "radau": 3,
    "implicit_midpoint": 1,
    "bdf2": 1,  # it starts with a step of implicit Euler
    "dop853": 7,
    "auto": 7,
    "gauss_radau15": 8,
    "adams": 2,  # it starts with order 2
}
"""Order of dense output where it is neither the cubic Hermite interpolant's nor 4."""

MULTISTEP = {"bdf2", "adams"}
ELSEWHERE = {"blanes_moan": 2}
"""Order where accelerations depend on velocities, or states have none."""

CLAIMED = {
    "boris": 2,
    "heun": 2,
    "verlet": 2,
    "blanes_moan": 4,
    "dop853": 8,
    "gauss_radau15": 15,
    "adams": 12,
    "euler": 1,
    "semi_implicit_euler": 1,
    "midpoint": 2,
    "rk4": 4,
    "dopri5": 5,
    "runge_kutta": 3,
}


WORDS = [
    word
    for word in EVERY
    if solver(word).marches == "anything" and not solver(word).static and solver(word).stepper().method.step
]


def reference(system, end):
    return final(system, tableau.DORMAND_PRINCE.fixed(end / 40000), end)


PENDULUM = simple("pendulum", [1.5, 0.2], paired=True)
PENDULUM_AT_2 = reference(PENDULUM, 2.0)
DOUBLE = simple("double_pendulum", [0.3, 0.5, 0, 0], [9.81], paired=True)
PROBLEMS = {
    "forced": (simple("forced", [0.8]), 6.0, 1 / (1.25 + math.sin(6.0))),
    "pendulum": (PENDULUM, 20.0, reference(PENDULUM, 20.0)),
    "double pendulum": (DOUBLE, 10.0, reference(DOUBLE, 10.0)),
}


@pytest.mark.parametrize("word", WORDS)
@pytest.mark.parametrize("problem", PROBLEMS)
def test_its_order_is_the_one_it_claims(word, problem):
    stepper = solver(word).stepper()
    claimed = stepper.method.order
    assert claimed == CLAIMED.get(word, claimed)
    system, end, exact = PROBLEMS[problem]
    if claimed > 5:
        pytest.skip("too accurate for halved steps: see the next test")
    order = claimed if problem == "pendulum" else ELSEWHERE.get(word, claimed)
    finest = 120 if claimed > 2 else 960
    error = math.inf
    orders = []
    while finest <= 120_000 and error > 3e-11:  # as fine as the reference lets one see
        before, error = error, np.abs(final(system, fixed(stepper, end / finest), end) - exact).max()
        if error > 3e-11 or not orders:
            orders.append(math.log2(before / error) if before < math.inf else math.inf)
        finest *= 2
    assert orders[-1] == pytest.approx(order, abs=0.1)


@pytest.mark.parametrize("word", WORDS)
def test_impacts_are_found_where_its_own_flight_has_them(word):
    """Free fall is a parabola, which all but the methods of order 1 (and the first step of bdf2) follow exactly."""
    ball, kind = balls([1.0], 0.8), solver(word)
    march = march_by(kind, ball.system, 1.0)
    heights = [march.advance(k / 60)[0][0] for k in range(61)]
    order, control = kind.stepper().method.order, kind.stepper().control
    off = 0.55 * control.first_step if order == 1 else control.tolerance if word in MULTISTEP else 1e-12
    assert march.floats[ball.hit_at] == pytest.approx(math.sqrt(2 / 9.81), abs=off)
    assert march.statistics.events == 1
    assert min(heights) > -1e-12
    assert max(heights[30:]) == pytest.approx(0.64, abs=max(20 * off, 1e-3))


@pytest.mark.parametrize(("word", "shortest", "longest"), [("dop853", 0.3, 0.9), ("gauss_radau15", 1.8, 3.2)])
def test_a_high_order_is_seen_in_one_long_step(word, shortest, longest):
    stepper = solver(word).stepper()

    def error(h):
        exact = [math.cos(h) + math.sin(h), math.cos(h) - math.sin(h)]
        return np.abs(final(springs([1.0], [0.0]), fixed(stepper, h), h) - exact).max()

    order = math.log(error(longest) / error(shortest)) / math.log(longest / shortest) - 1
    assert order == pytest.approx(stepper.method.order, abs=0.4)


@pytest.mark.parametrize("word", WORDS)
@pytest.mark.parametrize(("re", "im"), [(-1.0, 0.0), (-0.3, 1.0), (0.0, 1.0), (-2.0, 2.0)])
def test_growth_is_what_a_step_does_to_the_linear_equation(word, re, im):
    if word in MULTISTEP:
        pytest.skip("its growth is that of many steps")
    kind = solver(word)
    if kind.stepper().method.last_stage == 0:
        pytest.skip("hands its rate on from step to step: see the next test")
    jacobian = np.array([[re, -im], [im, re]])
    for step in (0.1, 0.9, 2.3):
        if word == "gauss_radau15" and step > 0.1:
            continue  # its sweeps do not converge to all digits
        end = np.abs(final(simple("linear", [1.0, 0.0], [re, im]), fixed(kind.stepper(), step), 4 * step) @ (1, 1j))
        # A method that trusts the Jacobian shows what differences leave of it.
        accuracy = 1e-7 if kind.stepper().needs.jacobian else 0.0
        expected = kind.growth(jacobian, np.array([-1, -1]), step) ** 4
        assert end == pytest.approx(expected, rel=1e-9, abs=accuracy)


@pytest.mark.parametrize("z", [-1.5, -1.01, -0.99, -0.3, 0.3])
def test_verlet_on_what_has_no_velocity_is_heun_with_the_slope_handed_on(z):
    # (y, h y') goes by this matrix: predict y + h y', take its slope, end on the mean of both slopes
    matrix = np.array([[1 + z / 2, (1 + z) / 2], [z, z]])
    y, _ = np.linalg.matrix_power(matrix, 12) @ [1, z]
    end = final(simple("linear", [1.0, 0.0], [z, 0.0]), fixed(solver("verlet").stepper(), 1.0), 12.0)
    assert end[0] == pytest.approx(y, rel=1e-12)
    radius = np.abs(np.linalg.eigvals(matrix)).max()
    assert solver("verlet").growth(np.array([[z]]), np.array([-1]), 1.0) == pytest.approx(radius, rel=1e-12)
    assert (radius <= 1) == (-1 <= z <= 0)


@pytest.mark.parametrize("word", WORDS)
@pytest.mark.parametrize(("square", "damping"), [(1e4, 0.0), (1e4, 20.0), (1e4, 400.0), (0.0, 50.0)])
def test_the_bound_parts_stable_from_unstable_steps(word, square, damping):
    kind = solver(word)
    system = springs([1.0, square], [0.3, damping])
    found = stability(March(system, fixed(kind.stepper(), 1e-3), 1.0), kind)
    jacobian = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.diag([1.0, square]), -np.diag([0.3, damping])]])
    if found.step == math.inf:
        assert all(kind.growth(jacobian, system.partner, step) <= 1.0 + 1e-9 for step in np.geomspace(1e-6, 1e3, 60))
        return
    if word == "adams":
        pytest.skip("steps of one length do not lower its order where they would be unstable: see test_adams.py")
    if word == "gauss_radau15":  # its bound is where its iteration stops converging, not a matter of growth
        assert np.abs(final(system, fixed(kind.stepper(), 0.5 * found.step), 450 * found.step)).max() < 200
        return
    if found.step == 0.0:
        assert damping == 0.0
        assert kind.growth(jacobian, system.partner, 1e-3) > 1.0
        return
    assert kind.growth(jacobian, system.partner, 0.999 * found.step) <= 1.0 + 1e-9
    assert kind.growth(jacobian, system.partner, 1.01 * found.step) > 1.0 + 1e-9
    # Near its bound leapfrog that drifts first moves an oscillation 1/sqrt(1 - 0.99^2) times as fast: 700 for boris.
    most = 800 if word == "boris" else 200
    assert np.abs(final(system, fixed(kind.stepper(), 0.99 * found.step), 900 * found.step)).max() < most


def test_the_bounds_on_an_undamped_spring_are_the_textbooks_own():
    omega = 100.0
    system = springs([1.0, omega**2], [0.0, 0.0])

    def bound(kind):
        return stability(March(system, kind.stepper(), 1.0), kind)

    assert bound(Rk4()).step == pytest.approx(2 * math.sqrt(2) / omega, rel=1e-3)
    assert bound(SemiImplicitEuler()).step == pytest.approx(2 / omega, rel=1e-3)
    assert bound(Verlet()).step == pytest.approx(2 / omega, rel=1e-3)
    for kind in (Euler(step=2e-3), Midpoint(step=2e-3), Heun(step=2e-3)):
        found = bound(kind)
        z = omega * kind.step
        assert found.step == 0.0
        assert found.growth == pytest.approx(math.sqrt(1 + (z**2 if isinstance(kind, Euler) else z**4 / 4)), rel=1e-6)
        assert "no step is stable" in found.text
    assert (bound(Rk4()).part, bound(Rk4()).span) == ("springs", TETHER)
    assert bound(Rk4()).frequency == pytest.approx(omega / (2 * math.pi), rel=1e-6)
    assert "unstable" in bound(Rk4(step=0.03)).text


def test_the_bound_of_a_large_island_is_found_without_its_matrix():
    frequencies = np.linspace(1, 100, 900)
    for damping in (0.0, 3.0):
        march = March(springs(frequencies**2, np.full(900, damping)), Rk4().stepper(), 1.0)
        z = stability(March(springs([1e4], [damping]), Rk4().stepper(), 1.0), Rk4()).step
        assert stability(march, Rk4()).step == pytest.approx(z, rel=1e-2)


def test_what_does_not_depend_on_the_state_limits_no_step():
    assert stability(March(balls([1.0], 0.5).system, Rk4().stepper(), 1.0), Rk4()).step == math.inf


@pytest.mark.parametrize("factor", [0.95, 1.05])
def test_rk4_runs_below_its_bound_and_is_stopped_above(factor):
    system = springs([1.0, 1e4], [0.0, 0.0])
    march = March(system, Rk4(step=factor * 2 * math.sqrt(2) / 100).stepper(), 100.0)
    if factor < 1:
        assert np.abs(march.advance(100.0)[0]).max() < 200
        return
    with pytest.raises(RunFailure) as caught:
        march.advance(100.0)
    assert (caught.value.part, caught.value.span) == ("springs", TETHER)
    assert 1 < caught.value.time < 100
    assert "scene.yaml:3" in str(caught.value)


@pytest.mark.parametrize("word", WORDS)
def test_dense_output_has_the_order_that_its_ends_or_its_own_formula_allow(word):
    stepper = solver(word).stepper()
    method = stepper.method
    inside = min(DENSE.get(word, 4 if method.dense else 3), ELSEWHERE.get(word, method.order))
    high = method.order > 5
    errors = []
    for h in (1.2, 0.6) if high else (0.1, 0.05):
        march = March(springs([1.0], [0.0]) if high else simple("forced", [1.0]), fixed(stepper, h), 2.0)
        worst = 0.0
        for t in h * np.array([0.21, 0.37, 0.5, 0.83]):
            exact = [math.cos(t) + math.sin(t), math.cos(t) - math.sin(t)] if high else [1 / (1 + math.sin(t))]
            worst = max(worst, np.abs(march.advance(t)[0] - exact).max())
        errors.append(worst)
    assert math.log2(errors[0] / errors[1]) == pytest.approx(inside + 1, abs=0.35)


@pytest.mark.parametrize("word", WORDS)
def test_frames_change_nothing(word):
    ends = []
    for fps in (0.5, 24, 30, 60):
        march = march_by(solver(word), simple("pendulum", [1.5, 0.2], paired=True), 2.0)
        for k in range(int(2 * fps)):
            march.advance(k / fps)
        y, rate = march.advance(2.0)
        ends.append((*y, *rate, march.statistics.steps, march.statistics.evaluations))
    assert len(set(ends)) == 1


def test_a_grid_that_does_not_meet_the_end_is_cut_there():
    march = March(simple("forced", [1.0]), Rk4(step=0.3).stepper(), 1.0)
    assert march.advance(1.0)[0][0] == pytest.approx(1 / (1 + math.sin(1.0)), abs=1e-3)
    assert march.statistics.steps == 4
    exact = March(simple("forced", [1.0]), Rk4(step=0.1).stepper(), 1.0)
    exact.advance(1.0)
    assert exact.statistics.steps == 10


ADAPTIVE = [(Dopri5(tolerance=1e-11), 1e-8), (Dop853(tolerance=1e-11), 1e-9), (GaussRadau15(), 1e-9)]
ADAPTIVE += [(Adams(tolerance=1e-11), 1e-8)]


@pytest.mark.parametrize(("kind", "accuracy"), ADAPTIVE, ids=lambda part: type(part).__name__)
@pytest.mark.parametrize("paired", [False, True])
def test_adaptive_methods_follow_the_double_pendulum(kind, accuracy, paired):
    start = [math.pi / 2, math.pi / 2, 0.0, 0.0]
    exact = [-0.482971534252, -1.324048712302, 3.065288192073, 2.949271547572]
    y = final(simple("double_pendulum", start, [9.81], paired=paired), kind.stepper(), 2.0)
    np.testing.assert_allclose(y, exact, rtol=0, atol=accuracy)


def energy(y):
    """Of the pendulum."""
    return 0.5 * y[1] ** 2 - math.cos(y[0])


@pytest.mark.parametrize(
    ("kind", "bound"), [(Verlet(step=0.1), 2e-3), (Boris(step=0.1), 2e-3), (BlanesMoan(step=0.3), 2e-7)]
)
def test_a_symplectic_method_keeps_the_energy_for_ever(kind, bound):
    march = March(PENDULUM, kind.stepper(), 10_000.0)
    errors = np.array([energy(march.advance(t)[0]) - energy(PENDULUM.y) for t in np.arange(0.0, 10_000.0, 0.3)])
    assert 0.1 * bound < np.abs(errors).max() < bound
    halves = np.abs(errors[: len(errors) // 2]).max(), np.abs(errors[len(errors) // 2 :]).max()
    assert halves[1] == pytest.approx(halves[0], rel=0.02)


@pytest.mark.parametrize("kind", [Verlet(step=0.1), Boris(step=0.1), BlanesMoan(step=0.3)])
def test_a_symmetric_method_finds_its_way_back(kind):
    y = final(PENDULUM, kind.stepper(), 30.0)
    back = final(simple("pendulum", [y[0], -y[1]], paired=True), kind.stepper(), 30.0)
    np.testing.assert_allclose(back, PENDULUM.y * (1, -1), rtol=0, atol=1e-12)


def test_gauss_radau15_keeps_the_energy_to_rounding():
    march = March(PENDULUM, GaussRadau15().stepper(), 3000.0)
    y = march.advance(3000.0)[0]
    assert abs(energy(y) - energy(PENDULUM.y)) < 1e-14
    assert march.statistics.rejected < 0.06 * march.statistics.steps


def test_dop853_looks_closer_only_at_steps_that_a_frame_is_read_from():
    system = simple("pendulum", [1.5, 0.2])
    march = March(system, Dop853().stepper(), 2.0)
    for t in np.linspace(0, 2, 200):
        march.advance(t)
    whole = March(system, Dop853().stepper(), 2.0)
    whole.advance(2.0)
    assert march.statistics.evaluations == whole.statistics.evaluations
    assert whole.statistics.evaluations == 12 * (whole.statistics.steps + whole.statistics.rejected)


def test_the_error_follows_the_tolerance():
    errors = [
        np.abs(final(simple("pendulum", [1.5, 0.2]), Dopri5(tolerance=tol).stepper(), 2.0) - PENDULUM_AT_2).max()
        for tol in (1e-5, 1e-7, 1e-9)
    ]
    for tolerance, error in zip((1e-5, 1e-7, 1e-9), errors, strict=True):
        assert error < 20 * tolerance


def test_steps_are_no_longer_than_the_longest_allowed():
    march = March(simple("pendulum", [1.5, 0.2]), Dopri5(largest_step=0.01).stepper(), 1.0)
    march.advance(1.0)
    assert march.statistics.steps >= 100


# --- the script's own tableau ---


def test_the_orders_of_known_tableaus_are_found():
    assert [len(tableau.trees(order)) for order in range(1, 9)] == [1, 1, 2, 4, 9, 20, 48, 115]
    methods = (tableau.EULER, tableau.MIDPOINT, tableau.CLASSIC, tableau.DORMAND_PRINCE)
    assert [method.order for method in methods] == [1, 2, 4, 5]
    assert tableau.DORMAND_PRINCE.first_same_as_last
    assert not tableau.CLASSIC.first_same_as_last


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"a": ((), (0.5, 0.5)), "b": (0.0, 1.0)}, "explicit"),
        ({"a": ((),), "b": (0.5, 0.5)}, "one of each"),
        ({"a": ((), (0.5,)), "b": (0.5, 0.6)}, "sum to"),
        ({"a": ((), (0.5,)), "b": (0.0, 1.0), "c": (0.0, 1.0)}, "row sums"),
        ({"a": ((), (0.5,)), "b": (0.0, 1.0), "tolerance": 1e-3}, "embedded"),
        ({"a": ((), ()), "b": (0.0, 1.0)}, "it needs 1"),
    ],
)
def test_a_tableau_that_is_none_is_refused(fields, message):
    with pytest.raises(ValueError, match=message):
        RungeKutta(**fields)


def test_an_embedded_tableau_steps_by_its_error():
    # Bogacki and Shampine (1989)
    kind = RungeKutta(
        a=((0.0,), (1 / 2,), (0.0, 3 / 4), (2 / 9, 1 / 3, 4 / 9)),
        b=(2 / 9, 1 / 3, 4 / 9, 0.0),
        b_hat=(7 / 24, 1 / 4, 1 / 3, 1 / 8),
        tolerance=1e-7,
    )
    assert kind.stepper().method.order == 3
    assert kind.stepper().method.last_stage == 3
    y = final(simple("pendulum", [1.5, 0.2]), kind.stepper(), 2.0)
    np.testing.assert_allclose(y, PENDULUM_AT_2, atol=2e-6)


# --- what is compiled ---


def test_a_changed_number_count_or_tolerance_compiles_nothing():
    final(springs([1.0], [0.0]), Dopri5().stepper(), 0.1)
    final(balls([1.0], 0.5).system, Rk4().stepper(), 0.1)
    before = kernels.compiled.count
    final(springs(np.arange(1.0, 50.0), np.zeros(49)), Dopri5(tolerance=1e-9).stepper(), 0.2)
    final(springs([3.0], [0.1]), RungeKutta(**HEUN_3).stepper(), 0.3)
    final(balls([1.0, 2.0], 0.7, g=1.62).system, Euler(step=1e-2).stepper(), 0.1)
    assert kernels.compiled.count == before


def test_the_coefficients_of_dop853_satisfy_all_conditions_of_order_8():
    assert dormand_prince_8.DORMAND_PRINCE_8.order == 8
    for estimate, power in ((dormand_prince_8.FIFTH, 5), (dormand_prince_8.THIRD, 3)):
        places = np.array(dormand_prince_8.DORMAND_PRINCE_8.c)
        moments = [np.dot(estimate, places**k) for k in range(power + 1)]
        np.testing.assert_allclose(moments[:power], 0, atol=1e-13)
        assert abs(moments[power]) > 1e-6
