"""A stiff cloth on two pinned corners, falling for 1 s in still air: implicit solvers beside rk4 at its bound.

    python tests/bench/bench_cloth.py [masses a side] [seconds of fall] [seconds a run may take] [solver, such as bdf2]

The sheet is that of `mass_spring` as it comes: 10 m by 10 m, 1 kg, springs along the sides, along the diagonals (half
as stiff) and over two cells (a tenth), without which folds would shrink to one cell whatever their number. It lies flat
at the start, and air that holds it to 1 m/s lets it sink by 0.9 m in folds that spread from the pins. Stiffness is set
so that the fastest mode has 2.8e5 rad/s, at which rk4 is stable up to a step of 1e-5 s, whatever the size.

rk4 is timed on STEPS steps and scaled. An implicit solver's error is its largest distance, over ten instants, from the
same at a step four times smaller, as a part of the side. Times are given twice: of the processor, all threads together,
and of the clock. rk4 has one thread; factorizations, and slopes of many springs, have all. A run that takes too long,
or fails, says how far it came; ratios are then for that part.
"""

from __future__ import annotations

import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sceneql.failure import RunFailure
from sceneql.march.march import March
from sceneql.pipeline import load
from sceneql.run.run import Run

SIDE = 10.0
BOUND = 1e-5
REACH = 2.835
"""|h lambda| up to which rk4 is stable for an oscillator of three tenths of critical damping."""
INSTANTS = 10
SCRIPT = """sceneql: 1
clock: {{end: {end} s}}
models:
  cloth:
    mass_spring:
      cloth: {{size: 10 10 m, cells: {cells} {cells}}}
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
STEPS = 200
SOLVERS = (
    ("bdf2: {step: 25 ms, newton: 1e-2}", "bdf2: {step: 6.25 ms, newton: 2e-3}"),
    ("bdf2: {step: 12.5 ms, newton: 1e-2}", "bdf2: {step: 3.125 ms, newton: 2e-3}"),
)


def march(count: int, end: float, solver: str) -> March:
    """The cloth of 1 kg; springs with a third of critical damping at the highest frequency, sqrt(6 k/m).

    That is the mode in which neighbors move against each other along one side: 4 k/m by the sides, 2 k/m by diagonals.
    """
    mass = 1.0 / count**2
    frequency = REACH / BOUND
    stiffness = mass * frequency**2 / 6
    fields = {"cells": count - 1, "mass": mass, "stiffness": stiffness, "end": end, "drag": 10 * mass}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "cloth.yaml"
        damping = 0.6 * stiffness / frequency
        path.write_text(SCRIPT.format(**fields, damping=damping, solver=f"{{{solver}}}"), encoding="utf-8")
        return Run(load(path)).islands[0].march


@dataclass(frozen=True, slots=True)
class Fall:
    """A run, as far as it came."""

    processor: float
    clock: float
    places: np.ndarray
    """(instants, 3 masses) [m]."""
    march: March
    why: str
    """Why it ended early."""


def fall(count: int, end: float, solver: str, limit: float) -> Fall:
    """Let it fall, its set-up not counted."""
    found = march(count, end, solver)
    places, why = [], ""
    processor, clock = time.process_time(), time.perf_counter()
    for t in np.linspace(0.0, end, INSTANTS + 1)[1:]:
        try:
            places.append(found.advance(float(t))[0][: 3 * count**2])
        except RunFailure as failure:
            why = f"failed after {failure.time:.3g} s"
            break
        if time.process_time() - processor > limit:
            why = f"stopped at {t:.3g} s"
            break
    times = time.process_time() - processor, time.perf_counter() - clock
    return Fall(*times, np.array(places).reshape(-1, 3 * count**2), found, why)


def main() -> None:
    """Print the table."""
    given = [float(arg) for arg in sys.argv[1:4]]
    chosen = [pair for pair in SOLVERS if pair[0].startswith(tuple(sys.argv[4:] or [""]))]
    count, end, limit = (*given, *(40, 1.0, 120.0)[len(given) :])
    count = int(count)
    explicit = march(count, end, f"rk4: {{step: {BOUND} s}}")
    explicit.advance(2 * BOUND)
    processor, clock = time.process_time(), time.perf_counter()
    explicit.advance((2 + STEPS) * BOUND)
    scale = end / (STEPS * BOUND)
    processor, clock = scale * (time.process_time() - processor), scale * (time.perf_counter() - clock)
    print(f"{count} x {count} masses, {end:g} s; rk4 at {BOUND:g} s, scaled from {STEPS} steps:")
    print(f"{processor:.1f} s of the processor, {clock:.1f} s of the clock", flush=True)
    known: dict[str, Fall] = {}
    for solver, finer in chosen:
        for one in (solver, finer):
            if one not in known:
                known[one] = fall(count, end, one, limit)
        run, places, exact = known[solver], known[solver].places, known[finer].places
        both = min(len(places), len(exact))
        error = np.abs(places[:both] - exact[:both]).max() / SIDE if both else np.nan
        part = len(places) / INSTANTS
        print(
            f"{solver}: {run.march.statistics.steps} steps, {run.processor:.1f} s of the processor ("
            f"{processor * part / run.processor:.2f} x rk4), {run.clock:.1f} s of the clock "
            f"({clock * part / run.clock:.2f} x rk4), error {error:.1e} of the side up to "
            f"{both / INSTANTS * end:g} s against {finer} {run.why}",
            flush=True,
        )


if __name__ == "__main__":
    main()
