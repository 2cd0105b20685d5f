"""Cubes thrown into a bin, in mode `local`: ms a step, how deep they are in one another, what still moves at the end.

    python tests/bench/bench_pile.py [EDGE [STEP [END]]]

EDGE^3 cubes (6: 216), steps of STEP ms (5), END s (2). Depths are by separating axes in numpy, at every step; ms those
of the run from a step to the next, warm, with processor time besides, since they wait on a crowded machine.
"""

from __future__ import annotations

import statistics
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from cube_pile import SIDE, deepest, script
from sceneql.pipeline import load
from sceneql.run.run import Run


def main(edge: int, step: float, end: float) -> None:
    """A line every twentieth of the run, and one of all."""
    path = Path(tempfile.mkdtemp()) / "scene.yaml"
    path.write_text(script(edge, step, end), encoding="utf-8")
    run = Run(load(path, pruned=False))
    run.at(1e-3 * step)
    island = run.islands[0]
    bodies = island.bodies["pile"]
    assert bodies is not None
    assert bodies.turning is not None
    places = slice(bodies.position_at, bodies.position_at + 3 * bodies.count)
    turns = slice(bodies.turning.rotation_at, bodies.turning.rotation_at + 4 * bodies.count)
    spent: list[float] = []
    worked: list[float] = []
    depths: list[float] = []
    steps = round(1e3 * end / step)
    print(f"{edge**3} cubes of {SIDE} m, steps of {step:g} ms")
    print(f"  {'to s':>6}{'median ms':>12}{'most ms':>12}{'cpu ms':>12}{'deepest/side':>14}{'kinetic J':>12}")
    for k in range(2, steps + 1):
        started, working = time.perf_counter(), time.process_time()
        moment = run.at(1e-3 * step * k)
        spent.append(1e3 * (time.perf_counter() - started))
        worked.append(1e3 * (time.process_time() - working))
        y = moment.state("pile").y
        depths.append(deepest(edge, y[places].reshape(-1, 3), y[turns].reshape(-1, 4)) / SIDE)
        if k % max(1, steps // 20) == 0 or k == steps:
            last = slice(None) if k == steps else slice(-max(1, steps // 20), None)
            ms, cpu = statistics.median(spent[last]), statistics.median(worked[last])
            kinetic = float(moment.read("pile", "kinetic"))
            line = f"  {1e-3 * step * k:6.3f}{ms:12.1f}{max(spent[last]):12.1f}{cpu:12.1f}"
            print(f"{line}{max(depths[last]):14.1e}{kinetic:12.1e}", flush=True)


if __name__ == "__main__":
    given = [float(one) for one in sys.argv[1:]]
    edge, step, end = given + [6, 5, 2][len(given) :]
    main(int(edge), step, end)
