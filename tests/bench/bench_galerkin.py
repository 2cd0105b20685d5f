"""A diffusing field by finite elements beside cut cells, on a disk and in a torus: error against processor time.

Run: python tests/bench/bench_galerkin.py [disk] [torus]. The field is exp(-t) f with the sources and the boundary's
values of the exact solution, by tr_bdf2 in 100 steps. Times are of the second run, in which nothing is compiled: all
of the set-up (meshing, cutting, factors), and the steps. The ratios are of all time to that of cells at equal error.
"""

from __future__ import annotations

import math
import sys
import tempfile
import time
from itertools import pairwise
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from element_heat import Heat
from sceneql.bodies.elements import filled

END = 0.2
SOLVER = "{tr_bdf2: {step: 2 ms}}"
CASES = {
    "disk": (
        {"objects": "ball: {sphere: {radius: 1 m}}", "domain": "ball", "flat": "yes"},
        ("sin(2*x)*cos(y)", "4*sin(2*x)*cos(y)"),
        lambda x, y, z: np.sin(2 * x) * np.cos(y),
        {"cells": (0.1, 0.05, 0.025, 0.0125), "p1": (0.1, 0.05, 0.025), "p2": (0.4, 0.2, 0.1)},
    ),
    "torus": (
        {"objects": "ball: {torus: {radius: 1 m, tube: 0.4 m}}", "domain": "ball"},
        ("sin(2*x)*cos(y) + z^3", "4*sin(2*x)*cos(y) - z^3 - 6*z"),
        lambda x, y, z: np.sin(2 * x) * np.cos(y) + z**3,
        {"cells": (0.2, 0.1, 0.05, 0.025), "p1": (0.2, 0.14, 0.1), "p2": (0.4, 0.28, 0.2)},
    ),
}


def measured(folder: Path, case: str, method: str, cell: float) -> tuple[float, float, float]:
    """Error, seconds of set-up and of steps."""
    place, (field, source), exact, _ = CASES[case]
    how = {"method": "cells"} if method == "cells" else {"element": method}
    values = {"initial": f'"{field}"', "source": f'"({source})*exp(-t)"'}
    values["boundary"] = f'{{rest: {{value: "({field})*exp(-t)"}}}}'
    for _ in range(2):
        filled._kept.clear()  # meshes are kept for variants of a scene, which a first run has not
        begun = time.process_time()
        heat = Heat(folder, SOLVER, END, cell=f"{cell} m", **place, **how, **values)
        made = time.process_time()
        heat.at(END)
        done = time.process_time()
    return heat.error(lambda places: exact(*places.T) * math.exp(-END)), made - begun, done - made


def at_error(runs: list[tuple[float, float]], error: float) -> float:
    """Seconds at an error, by interpolation between (error, seconds) of runs, continued beyond them."""
    pairs = list(pairwise(runs))
    one, two = next((pair for pair in pairs if pair[1][0] <= error), pairs[-1])
    part = math.log(error / one[0]) / math.log(two[0] / one[0])
    return math.exp((1 - part) * math.log(one[1]) + part * math.log(two[1]))


def main() -> None:
    """Print all."""
    with tempfile.TemporaryDirectory() as name:
        for case in sys.argv[1:] or CASES:
            cells: list[tuple[float, float]] = []
            for method, spacings in CASES[case][3].items():
                before = None
                for cell in spacings:
                    error, made, marched = measured(Path(name), case, method, cell)
                    told = f"{case}, {method:<5} cell {cell:<7} error {error:.2e}"
                    told += f"  set-up {made:.2f} s  steps {marched:.3f} s"
                    if before is not None:
                        told += f"  order {math.log(before[0] / error) / math.log(before[1] / cell):.2f}"
                    if method == "cells":
                        cells.append((error, made + marched))
                    else:
                        told += f"  {(made + marched) / at_error(cells, error):.2f} of cells' time"
                    print(told, flush=True)
                    before = error, cell


if __name__ == "__main__":
    main()
