"""The lowest six frequencies of a drum and of a square against the exact ones, by cells; the energy over 100 periods.

Run: python tests/bench/bench_waves.py. Frequencies are those of the rate that a run has; orders are of the largest
error of the six, from one cell to half of it.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from test_waves import DRUM, HELD, SQUARE, frequencies, wave

DISK = "objects: {disk: {sphere: {radius: 1 m}}}\n"
CELLS = (1 / 16, 1 / 32, 1 / 64, 1 / 128)
STARTED = f"size: 1 1 m, cell: 1/16 m, speed: 1, initial: exp(-20*((x-0.4)^2 + (y-0.3)^2)), {HELD}"


def main() -> None:
    """Print all."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for what, exact, place, objects in (
            ("square", SQUARE, "size: 1 1 m", ""),
            ("drum", DRUM, "domain: disk, flat: yes", DISK),
        ):
            before = 0.0
            for cell in CELLS:
                found = frequencies(folder, f"{place}, cell: {cell} m, speed: 1, {HELD}", objects)
                error = float(np.abs(found / exact - 1).max())
                order = f"  order {np.log2(before / error):.2f}" if before else ""
                print(f"{what}, 1/{round(1 / cell)} m: {error:.2e} of a frequency at most{order}")
                before = error
        for solver in ("{implicit_midpoint: {step: 10 ms}}", "{verlet: {step: 10 ms}}"):
            made = wave(folder, STARTED, solver, end=142)
            first, worst = made.read("energy"), 0.0
            for time in np.linspace(0, 141.6, 60).round(2):
                made.run.advance(time)
                worst = max(worst, abs(made.read("energy") / first - 1))
            print(f"energy over 100 periods by {solver}: off by {worst:.1e} at most")


if __name__ == "__main__":
    main()
