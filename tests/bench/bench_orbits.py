"""Orbits: steps, error and time of dop853 beside SciPy's, and of gauss_radau15 beside rebound's IAS15, in one run.

    python tests/bench/bench_orbits.py [PART...]

    single      dop853 beside SciPy's DOP853
    multistep   evaluations and time at equal error of adams, dop853, gauss_radau15 and SciPy's LSODA
    long        gauss_radau15 beside rebound's IAS15

Times are medians of the run alone: of our compiled march, of the peers' calls. The peers' rates are numpy's (SciPy) or
their own C (rebound). Pleiades: Hairer, Norsett & Wanner (1993), II.10; its end from REFERENCES of their test set.
"""

from __future__ import annotations

import math
import statistics
import sys
import tempfile
import time
from contextlib import suppress
from pathlib import Path

import numpy as np
import rebound
from scipy.integrate import solve_ivp

from sceneql.failure import RunFailure
from sceneql.march.march import March
from sceneql.pipeline import load
from sceneql.run.run import IslandRun

REPEATS = 9
TOLERANCE = 1e-10

STARS = np.array([[3, 3], [3, -3], [-1, 2], [-3, 0], [2, 0], [-2, -4], [2, 4]], dtype=float)
SPEEDS = np.array([[0, 0], [0, 0], [0, 0], [0, -1.25], [0, 1], [1.75, 0], [-1.5, 0]], dtype=float)
MASSES = np.arange(1.0, 8.0)
X1, Y7 = 0.3706139143970502, 1.091449240428980
"""Of the Pleiades at 3 s."""

ECCENTRIC = 0.9
KEPLER = "models: {bodies: {particles: {list: {planet: {position: 0.1 0 0 m, velocity: [0, 19^0.5, 0]}}}}}\n" + (
    "forces: [attractor]\n"
)
"""Semi-axis and G M are 1, the start is the pericenter."""


def pleiades() -> str:
    bodies = (
        f"s{i}: {{mass: {m:g}, position: [{x:g}, {y:g}, 0], velocity: [{u:g}, {v:g}, 0]}}"
        for i, (m, (x, y), (u, v)) in enumerate(zip(MASSES, STARS, SPEEDS, strict=True), 1)
    )
    return (
        f"models: {{bodies: {{particles: {{list: {{{', '.join(bodies)}}}}}}}}}\n"
        "forces: {pull: {mutual_gravity: {constant: 1}}}\n"
    )


def pleiades_rate(t, y):
    x, v = y[:14].reshape(7, 2), y[14:]
    away = x[None] - x[:, None]
    squares = (away**2).sum(axis=2)
    np.fill_diagonal(squares, 1.0)
    return np.concatenate([v, ((MASSES / squares**1.5)[:, :, None] * away).sum(axis=1).ravel()])


def kepler_rate(t, y):
    r = math.hypot(y[0], y[1]) ** 3
    return [y[2], y[3], -y[0] / r, -y[1] / r]


def kepler_at(t: float) -> list[float]:
    """Exact position by Kepler's equation."""
    mean = math.remainder(t, 2 * math.pi)
    anomaly = mean
    for _ in range(100):
        off = anomaly - ECCENTRIC * math.sin(anomaly) - mean
        anomaly -= off / (1 - ECCENTRIC * math.cos(anomaly))
    return [math.cos(anomaly) - ECCENTRIC, math.sqrt(1 - ECCENTRIC**2) * math.sin(anomaly)]


def ours(script: str, solver: str, end: float, repeats: int = REPEATS):
    """Last state, positions first, with the statistics and milliseconds of the march."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.yaml"
        path.write_text(
            f"clock: {{end: {end:.17g} s, fps: {10 / end:.17g}}}\n{script}solvers: {{main: {solver}}}\n",
            encoding="utf-8",
        )
        graph = load(path, pruned=False)
        island = IslandRun(graph, graph.islands[0])
    times = []
    March(island.march.system, island.solver.stepper(), end).advance(0.01 * end)
    for _ in range(repeats):
        march = March(island.march.system, island.solver.stepper(), end)
        y, _ = march.advance(end)
        times.append(1e3 * march.statistics.seconds)
    return y, march.statistics, statistics.median(times)


def timed(call, repeats: int = REPEATS):
    times = []
    for _ in range(repeats):
        started = time.perf_counter()
        result = call()
        times.append(1e3 * (time.perf_counter() - started))
    return result, statistics.median(times)


def against_scipy(name: str, script: str, rate, start, end: float, error_of) -> None:
    y, done, ms = ours(script, f"{{dop853: {{tolerance: {TOLERANCE}}}}}", end)
    peer, peer_ms = timed(
        lambda: solve_ivp(rate, (0, end), start, method="DOP853", rtol=TOLERANCE, atol=TOLERANCE), repeats=5
    )
    theirs = len(peer.t) - 1
    print(f"{name}: dop853 {done.steps} steps, error {error_of(y):.1e}, {ms:.3f} ms")
    print(f"  scipy DOP853 {theirs} steps, error {error_of(peer.y[:, -1]):.1e}, {peer_ms:.2f} ms")
    print(f"  steps {done.steps / theirs:.2f} of SciPy's (bar 1.3), {peer_ms / ms:.0f}x as fast (bar 8)")


MOON, PERIOD = 0.012277471, 17.0652165601579625588917206249
"""Of Arenstorf's orbit in the restricted problem of three bodies (Hairer, Norsett & Wanner 1993, II.0)."""
ARENSTORF_SPEED = -2.00158510637908252240537862224
ARENSTORF = (
    f"models: {{orbit: {{equations: {{start: {{x: 0.994, y: 0, x': 0, y': {ARENSTORF_SPEED}}}, "
    f"where: {{m: {MOON}, a: (x + m)^2 + y^2, b: (x - 1 + m)^2 + y^2}}, "
    "rate: {x'': \"x + 2*y' - (1 - m)*(x + m)/a^1.5 - m*(x - 1 + m)/b^1.5\", "
    "y'': \"y - 2*x' - (1 - m)*y/a^1.5 - m*y/b^1.5\"}}}}\n"
)


def arenstorf_rate(t, y):
    a, b = ((y[0] + MOON) ** 2 + y[1] ** 2) ** 1.5, ((y[0] - 1 + MOON) ** 2 + y[1] ** 2) ** 1.5
    return [
        y[2],
        y[3],
        y[0] + 2 * y[3] - (1 - MOON) * (y[0] + MOON) / a - MOON * (y[0] - 1 + MOON) / b,
        y[1] - 2 * y[2] - (1 - MOON) * y[1] / a - MOON * y[1] / b,
    ]


def at_error(curve, good: float) -> tuple[float, float]:
    """Evaluations and ms at an error, by straight lines through the logarithms of the two runs about it."""
    curve = sorted(curve)
    at = [float(x) for x in np.log([row[0] for row in curve])]
    if not at[0] <= math.log(good) <= at[-1]:
        return math.nan, math.nan
    found = (np.interp(math.log(good), at, np.log([row[k] for row in curve])) for k in (1, 2))
    evaluations, ms = (math.exp(float(value)) for value in found)
    return evaluations, ms


def multistep(name: str, script: str, rate, start, end: float, error_of) -> None:
    """Evaluations and ms of four methods where they come to some errors."""
    curves: dict[str, list[tuple[float, float, float]]] = {}
    for word in ("adams", "dop853", "gauss_radau15"):
        curves[word] = []
        for tolerance in 10.0 ** -np.arange(3.0, 14.5):
            with suppress(RunFailure):  # a planet that a rough run leads into the sun
                y, done, ms = ours(script, f"{{{word}: {{tolerance: {tolerance:.0e}}}}}", end, repeats=3)
                curves[word].append((error_of(y), done.evaluations, ms))
    curves["SciPy LSODA"] = []
    for tolerance in 10.0 ** -np.arange(4.0, 14.0):
        peer, ms = timed(
            lambda: solve_ivp(rate, (0, end), start, method="LSODA", rtol=tolerance, atol=tolerance),  # noqa: B023
            repeats=1,
        )
        curves["SciPy LSODA"].append((error_of(peer.y[:, -1]), peer.nfev, ms))
    print(f"{name}: evaluations (ms) at errors of 1e-4, 1e-6, 1e-8, 1e-10")
    for word, curve in curves.items():
        cells = (at_error(curve, good) for good in (1e-4, 1e-6, 1e-8, 1e-10))
        print(f"  {word:14}" + "".join(f"{count:10.0f} ({ms:7.2f})" for count, ms in cells))


def against_rebound(orbits: int) -> None:
    end = 2 * math.pi * orbits

    def energy(x, v) -> float:
        return 0.5 * float(np.dot(v, v)) - 1 / float(np.linalg.norm(x))

    def theirs() -> tuple[float, int]:
        run = rebound.Simulation()
        run.add(m=1.0)
        run.add(m=0.0, a=1.0, e=ECCENTRIC)
        run.N_active = 1
        run.integrator = "ias15"
        run.integrate(end, exact_finish_time=1)
        p, sun = run.particles[1], run.particles[0]
        return energy(np.subtract(p.xyz, sun.xyz), np.subtract(p.vxyz, sun.vxyz)), run.steps_done

    ratios = []
    for _ in range(REPEATS):  # in turn, so that both meet the same machine
        y, done, ms = ours(KEPLER, "gauss_radau15", end, repeats=1)
        (their_energy, steps), their_ms = timed(theirs, repeats=1)
        ratios.append((ms, their_ms))
    ms, their_ms = (statistics.median(column) for column in zip(*ratios, strict=True))
    ratio = statistics.median(a / b for a, b in ratios)
    off = [abs(value / -0.5 - 1) for value in (energy(y[:3], y[3:6]), their_energy)]
    print(f"Kepler e={ECCENTRIC}, {orbits} orbits: gauss_radau15 dE/E {off[0]:.1e} (bar 1e-12), {done.steps} steps,")
    print(f"  {done.evaluations / done.steps:.1f} evaluations a step, {ms:.0f} ms")
    print(f"  rebound {rebound.__version__} IAS15 dE/E {off[1]:.1e}, {steps} steps, {their_ms:.0f} ms")
    print(f"  {ratio:.2f} of its time (bar 1)")


def main(parts: list[str]) -> None:
    def pleiades_error(y) -> float:
        ours = len(y) > 28
        x1, y7 = (y[0], y[19]) if ours else (y[0], y[13])
        return max(abs(x1 / X1 - 1), abs(y7 / Y7 - 1))

    end = 2 * math.pi * 10.3
    exact = np.array(kepler_at(end))
    bodies = np.concatenate([STARS.ravel(), SPEEDS.ravel()])
    planet = [0.1, 0, 0, math.sqrt(19)]
    problems = {
        "Pleiades": (pleiades(), pleiades_rate, bodies, 3.0, pleiades_error),
        f"Kepler e={ECCENTRIC}, 10.3 orbits": (
            KEPLER,
            kepler_rate,
            planet,
            end,
            lambda y: float(np.abs(y[:2] - exact).max()),
        ),
        "Arenstorf": (
            ARENSTORF,
            arenstorf_rate,
            [0.994, 0, 0, ARENSTORF_SPEED],
            PERIOD,
            lambda y: math.hypot(y[0] - 0.994, y[1]),
        ),
    }
    if "single" in parts:
        for name in list(problems)[:2]:
            against_scipy(name, *problems[name])
    if "multistep" in parts:
        for name, problem in problems.items():
            multistep(name, *problem)
    if "long" in parts:
        against_rebound(1000)


if __name__ == "__main__":
    main(sys.argv[1:] or ["single", "multistep", "long"])
