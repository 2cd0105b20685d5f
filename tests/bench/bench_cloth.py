"""A stiff cloth on two pinned corners, falling for 1 s in still air: implicit solvers beside rk4 at its bound.

    python tests/bench/bench_cloth.py [masses a side] [seconds of fall] [seconds a run may take] [solver, such as bdf2]

Stiffness is set so that rk4's stable step is 1e-5 s whatever the size. rk4 is timed on 200 steps and scaled. An
implicit solver's error is its largest distance, over ten instants, from the same at a much smaller tolerance (or a
step four times smaller), as a part of the side. Times are CPU times. A run that takes too long, or fails, says how far
it came.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from sceneql.failure import RunFailure
from sceneql.pipeline import load
from sceneql.simulation.march import March
from sceneql.simulation.run import Run

SIDE = 10.0
BOUND = 1e-5
INSTANTS = 10
SCRIPT = """sceneql: 1
clock: {{end: {end} s}}
models:
  cloth:
    mass_spring:
      cloth: {{size: 10 10 m, cells: {cells} {cells}, bend: 0}}
      mass: {mass} kg
      stiffness: {stiffness} N/m
      damping: {damping} N*s/m
      pins: [top_left, top_right]
forces: [gravity, {{drag: {{linear: {drag} N*s/m}}}}]
solvers:
  main: {solver}
outputs:
  film: {{video: {{size: 16 16}}}}
"""
SOLVERS = (
    ("rodas5p: {tolerance: 1e-2}", "rodas5p: {tolerance: 1e-4}"),
    ("rodas5p: {tolerance: 1e-3}", "rodas5p: {tolerance: 1e-4}"),
    ("bdf2: {step: 12.5 ms, newton: 3e-2}", "bdf2: {step: 3.125 ms, newton: 1e-2}"),
    ("bdf2: {step: 6.25 ms, newton: 3e-2}", "bdf2: {step: 1.5625 ms, newton: 1e-3}"),
)


def march(count: int, end: float, solver: str) -> March:
    """The cloth of 1 kg; springs with a third of critical damping at the highest frequency, sqrt(6 k/m)."""
    mass = 1.0 / count**2
    frequency = 2.4 / BOUND
    stiffness = mass * frequency**2 / 6
    fields = {"cells": count - 1, "mass": mass, "stiffness": stiffness, "end": end, "drag": 10 * mass}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "cloth.yaml"
        damping = 0.6 * stiffness / frequency
        path.write_text(SCRIPT.format(**fields, damping=damping, solver=f"{{{solver}}}"), encoding="utf-8")
        return Run(load(path)).islands[0].march


def fall(count: int, end: float, solver: str, limit: float) -> tuple[float, np.ndarray, March, str]:
    """(seconds, (instants, entries) positions, the march, why it ended early)."""
    found = march(count, end, solver)
    places, why = [], ""
    start = time.process_time()
    for t in np.linspace(0.0, end, INSTANTS + 1)[1:]:
        try:
            places.append(found.advance(float(t))[0][: 3 * count**2])
        except RunFailure as failure:
            why = f"failed after {failure.time:.3g} s"
            break
        if time.process_time() - start > limit:
            why = f"stopped at {t:.3g} s"
            break
    return time.process_time() - start, np.array(places).reshape(-1, 3 * count**2), found, why


def main() -> None:
    """Print the table."""
    given = [float(arg) for arg in sys.argv[1:4]]
    chosen = [pair for pair in SOLVERS if pair[0].startswith(tuple(sys.argv[4:] or [""]))]
    count, end, limit = (*given, *(40, 1.0, 120.0)[len(given) :])
    count = int(count)
    explicit = march(count, end, f"rk4: {{step: {BOUND} s}}")
    explicit.advance(2 * BOUND)
    start = time.process_time()
    explicit.advance(202 * BOUND)
    scaled = (time.process_time() - start) * end / (200 * BOUND)
    print(f"{count} x {count} masses, {end:g} s; rk4 at {BOUND:g} s: {scaled:.1f} s (scaled from 200 steps)")
    known: dict[str, tuple[float, np.ndarray, March, str]] = {}
    for solver, finer in chosen:
        for one in (solver, finer):
            if one not in known:
                known[one] = fall(count, end, one, limit)
        seconds, places, found, why = known[solver]
        both = min(len(places), len(known[finer][1]))
        error = np.abs(places[:both] - known[finer][1][:both]).max() / SIDE if both else np.nan
        steps = found.statistics.steps
        part = len(places) / INSTANTS
        ratio = scaled * part / seconds
        print(
            f"{solver}: {steps} steps, {seconds:.1f} s, {ratio:.2f} x rk4, error {error:.1e} of the side up to "
            f"{both / INSTANTS * end:g} s against {finer} {why}",
            flush=True,
        )


if __name__ == "__main__":
    main()
