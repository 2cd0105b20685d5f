"""What `auto` chooses beside dopri5, dop853, gauss_radau15 and radau, each asked for by name.

    python tests/bench/bench_auto.py [problem ...]

The ratio is that of its time to the least in which one of the four comes to the same error, by straight lines through
(log error, log time) of their runs at a tolerance a decade; where the error is that of the reference, to the least of
those at the same tolerance or less. Times are the least processor time of the march from its first step on; those with
its set-up are told too, to which the laying out for a method belongs, also where `auto` does it later. Errors of the
stiff problems are relative to each state, else to the largest position or state.
"""

from __future__ import annotations

import math
import sys
import tempfile
import time
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from bench_ode import PROBLEMS, STIFFNESS
from bench_orbits import KEPLER, pleiades

from sceneql.failure import RunFailure
from sceneql.kinds import Solver
from sceneql.march.march import March
from sceneql.pipeline import load
from sceneql.run.run import IslandRun
from sceneql.system import Stepper
from sceneql.words.solvers.auto import Auto
from sceneql.words.solvers.dop853 import Dop853
from sceneql.words.solvers.dopri5 import Dopri5
from sceneql.words.solvers.gauss_radau15 import GaussRadau15
from sceneql.words.solvers.radau import Radau

BAR = 1.5
REPEATS = 40
"""Marches of half a millisecond differ by half of it on a busy machine."""
ENOUGH = 1000.0
"""Milliseconds of a run, or of all its repeats, after which no more are made."""
FLOOR = 1e-12
"""Error of the references and rounding of some thousand steps: below it runs cannot be told apart."""
ASKED = (1e-4, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12)
TOLERANCES = [10.0**-k for k in range(2, 14)]
WORDS = {"dopri5": Dopri5, "dop853": Dop853, "gauss_radau15": GaussRadau15, "radau": Radau}


def equations(start: str, rate: str, where: str = "") -> str:
    return f"models: {{m: {{equations: {{start: {{{start}}}, where: {{{where}}}, rate: {{{rate}}}}}}}}}\n"


def masses(bodies: str) -> str:
    return f"models: {{bodies: {{particles: {{list: {{{bodies}}}}}}}}}\n"


SWING = (
    "{{swing: {{mass_spring: {{masses: {{hold: {{position: 0 0 0 m, fixed: yes}}, bob: {{position: 1 0 0 m, "
    "mass: 1 kg}}}}, springs: [{{between: [hold, bob], stiffness: {:g} N/m}}]}}}}}}"
)
EIGHT = (
    "a: {position: 0.97000436 -0.24308753 0 m, velocity: 0.466203685 0.43236573 0 m/s}, "
    "b: {position: -0.97000436 0.24308753 0 m, velocity: 0.466203685 0.43236573 0 m/s}, "
    "c: {position: 0 0 0 m, velocity: -0.93240737 -0.86473146 0 m/s}"
)
DOUBLE = (
    "a'': (-b'^2*sin(d) - 2*g*sin(a) - cos(d)*(a'^2*sin(d) - g*sin(b)))/(2 - cos(d)^2), "
    "b'': (2*(a'^2*sin(d) - g*sin(b)) + cos(d)*(b'^2*sin(d) + 2*g*sin(a)))/(2 - cos(d)^2)"
)
SCENES = {
    "pleiades": (pleiades(), 3.0),
    "kepler 0.9": (KEPLER, 2 * math.pi * 10.3),
    "kepler 0.99": (
        masses("planet: {position: 0.01 0 0 m, velocity: [0, 199^0.5, 0]}") + "forces: [attractor]\n",
        2 * math.pi * 10.3,
    ),
    "three bodies": (masses(EIGHT) + "forces: {pull: {mutual_gravity: {constant: 1}}}\n", 20.0),
    "spring": (equations("a: 1, a': 0", "a'': -a"), 50.0),
    "double pendulum": (equations("a: 2, b: 2, a': 0, b': 0", DOUBLE, "d: a - b, g: 9.81"), 4.0),
    "lorenz": (equations("x: 1, y: 1, z: 20", "x: 10*(y-x), y: x*(28-z)-y, z: x*y-8/3*z"), 8.0),
    "lotka volterra": (equations("x: 1, y: 3", "x: x*(1.5-y), y: y*(x-3)"), 20.0),
    "brusselator": (equations("x: 1.5, y: 3", "x: 1+x^2*y-4*x, y: 3*x-x^2*y"), 20.0),
    "rigid body": (equations("x: 1, y: 0.1, z: 0.9", "x: -2*y*z, y: 1.25*x*z, z: -0.5*x*y"), 20.0),
    "mild van der pol": (equations("y: 2, z: 0", "y: z, z: ((1 - y^2)*z - y)/0.2"), 20.0),
    "spring pendulum": (f"models: {SWING.format(100)}\nforces: [gravity]\n", 10.0),
    "stiff pendulum": (f"models: {SWING.format(STIFFNESS)}\nforces: [gravity]\n", 2.0),
}
for name, problem in PROBLEMS.items():
    first = ", ".join(f"{state}: {value}" for state, value in problem.start.items())
    SCENES[name] = equations(first, ", ".join(f'{state}: "{row}"' for state, row in problem.rate.items())), problem.end


def built(script: str, end: float, solver: str = "auto") -> IslandRun:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.yaml"
        clock = f"clock: {{end: {end:.17g} s, speed: {end:.17g}}}\n"
        path.write_text(f"{clock}{script}solvers: {{main: {solver}}}\n", encoding="utf-8")
        graph = load(path, pruned=False)
        return IslandRun(graph, graph.islands[0])


@dataclass(frozen=True)
class Timed:
    """A run: its tolerance and error, the milliseconds of its march and of its set-up."""

    tolerance: float
    error: float
    march: float
    setup: float


class TimedMarch(March):
    """A march that counts the seconds of its layings out."""

    laying = 0.0

    def _engage(self, stepper: Stepper) -> None:
        began = time.process_time()
        super()._engage(stepper)
        self.laying += time.process_time() - began


def timed(script: str, end: float, solver: Solver) -> tuple[np.ndarray, float, float, March]:
    """The end, the least milliseconds of the march and of what comes before it, the last march. Raises RunFailure."""
    word = type(solver).__module__.rpartition(".")[2]
    island = built(script, end, f"{{{word}: {{tolerance: {solver.tolerance:.17g}}}}}")
    methods, times, before = island.methods, [], []
    while len(times) < REPEATS and sum(times) < ENOUGH:
        began = time.process_time()
        march = TimedMarch(
            island.assembly.finish(methods.first.needs.jacobian),
            methods.first,
            end,
            stiff=methods.stiff,
            with_jacobian=None if methods.stiff is None else lambda: island.assembly.finish(jacobian=True),
        )
        march.advance(0.0)
        started, laid_out = time.process_time(), march.laying
        y, _ = march.advance(end)
        later = march.laying - laid_out
        times.append(1e3 * (time.process_time() - started - later))
        before.append(1e3 * (started - began + later))
    return y, min(times), min(before), march


def error_of(name: str, script: str, end: float):
    """The error of a state at the end."""
    if name in PROBLEMS:
        exact = np.array(PROBLEMS[name].exact)
        return lambda y: float(np.abs(y / exact - 1).max())
    orbits = script.startswith("models: {bodies")
    solver = (
        GaussRadau15(tolerance=1e-8)
        if orbits
        else Radau(tolerance=1e-13)
        if "stiff" in name
        else Dop853(tolerance=1e-14)
    )
    exact, _, _, march = timed(script, end, solver)
    partner = march.system.partner
    seen = partner >= 0 if (partner >= 0).any() else np.ones(len(exact), dtype=bool)
    return lambda y: float(np.abs(y - exact)[seen].max() / np.abs(exact[seen]).max())


def least(runs: list[Timed], error: float, tolerance: float, setup: float = 0.0) -> float:
    """Least milliseconds in which runs come to an error, with a part of their set-up; infinite where none does."""
    if error <= FLOOR:
        exact = (r for r in runs if r.error <= FLOOR and r.tolerance <= tolerance)
        return min((r.march + setup * r.setup for r in exact), default=math.inf)
    curve = [(max(r.error, FLOOR), r.march + setup * r.setup) for r in runs]
    found = [ms for off, ms in curve if off <= error]
    for a, b in pairwise(curve):
        low, high = sorted((a, b))
        if low[0] <= error < high[0]:
            part = math.log(error / high[0]) / math.log(low[0] / high[0])
            found.append(math.exp((1 - part) * math.log(high[1]) + part * math.log(low[1])))
    return min(found, default=math.inf)


def main(names: list[str]) -> None:
    worst = 0.0
    for name in names or SCENES:
        script, end = SCENES[name]
        off = error_of(name, script, end)
        known: dict[str, list[Timed]] = {}
        for word, kind in WORDS.items():
            known[word] = []
            for tolerance in TOLERANCES:
                if ("stiff" in name or name in PROBLEMS) and word != "radau":
                    break
                try:
                    y, ms, before, _ = timed(script, end, kind(tolerance=tolerance))
                except RunFailure:
                    continue
                known[word].append(Timed(tolerance, off(y), ms, before))
                if ms > ENOUGH:
                    break
        for tolerance in ASKED:
            y, ms, before, march = timed(script, end, Auto(tolerance=tolerance))
            error = max(off(y), FLOOR)
            alone, word = min((least(runs, error, tolerance), word) for word, runs in known.items())
            whole = min(least(runs, error, tolerance, 1.0) for runs in known.values())
            chosen = ", ".join(why.partition(":")[0] for _, why in march.choices()) or "gauss_radau15"
            worst = max(worst, ms / alone)
            print(
                f"{name} at {tolerance:g}: error {error:.0e} in {ms:.2f} ms by {chosen}: {ms / alone:.2f} of {word} "
                f"({ms - alone:.2f} ms more); with set-up of {before:.2f} ms {(ms + before) / whole:.2f}",
                flush=True,
            )
    print(f"at most {worst:.2f} of the cheapest (bar {BAR})")


if __name__ == "__main__":
    main(sys.argv[1:])
