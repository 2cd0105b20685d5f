"""Gray and Scott's equations beside py-pde: the same cells, the same steps of the explicit Euler method.

Run: python tests/bench/bench_reaction.py [cells along a side] [steps]. The rate of both is compiled; the time is that
of the steps alone, the best of three runs after one that compiles. What differs is the largest of u at the end.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from sceneql.pipeline import load
from sceneql.run.run import IslandRun

FEED, KILL, LENGTH = 0.037, 0.06, 2.5
SCRIPT = """
clock: {{end: {steps} s}}
define: {{F: 0.037, k: 0.06}}
models:
  dish:
    reaction_diffusion:
      size: 2.5 2.5 m
      cell: 2.5/{n} m
      where: {{drop: exp(-80*((x - 1.25)^2 + (y - 1)^2)), eaten: u*v^2}}
      species:
        u: {{coefficient: 2e-5, initial: 1 - drop/2, rate: -eaten + F*(1 - u)}}
        v: {{coefficient: 1e-5, initial: drop/4, rate: eaten - (F + k)*v}}
      boundary: {{left: {{periodic: yes}}, bottom: {{periodic: yes}}}}
solvers: {{main: {{euler: {{step: 0.5 s}}}}}}
"""
STEP, RUNS = 0.5, 3


def ours(n: int, steps: int) -> tuple[float, np.ndarray]:
    """Seconds and u (n, n), y first."""
    best = np.inf
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.yaml"
        path.write_text(SCRIPT.format(n=n, steps=STEP * steps), encoding="utf-8")
        for _ in range(RUNS + 1):
            graph = load(path, pruned=False)
            run = IslandRun(graph, graph.islands[0])
            run.advance(STEP)
            start = time.perf_counter()
            run.advance(STEP * steps)
            best = min(best, time.perf_counter() - start)
        u = graph.tasks["dish"].kind.read("u", run.state("dish"))  # type: ignore[attr-defined]
    return best, np.reshape(u, (n, n))


def py_pde(n: int, steps: int) -> tuple[float, np.ndarray]:
    """Seconds and u (n, n), y first."""
    from pde import PDE, CartesianGrid, EulerSolver, FieldCollection, ScalarField

    grid = CartesianGrid([[0, LENGTH], [0, LENGTH]], n, periodic=True)
    drop = "exp(-80*((x - 1.25)**2 + (y - 1)**2))"
    state = FieldCollection(
        [ScalarField.from_expression(grid, f"1 - {drop}/2"), ScalarField.from_expression(grid, f"{drop}/4")],
        labels=["u", "v"],
    )
    equations = PDE(
        {
            "u": f"2e-5*laplace(u) - u*v**2 + {FEED}*(1 - u)",
            "v": f"1e-5*laplace(v) + u*v**2 - {FEED + KILL}*v",
        }
    )
    advance = EulerSolver(equations).make_stepper(state, dt=STEP)
    advance(state.copy(), 0.0, STEP)
    best = np.inf
    for _ in range(RUNS):
        field = state.copy()
        start = time.perf_counter()
        advance(field, 0.0, STEP * steps)
        best = min(best, time.perf_counter() - start)
    return best, field[0].data.T


def main() -> None:
    """Print a table."""
    given = [int(text) for text in sys.argv[1:3]]
    n, steps = (*given, *(256, 400)[len(given) :])
    mine, u = ours(n, steps)
    print(f"sceneql  {1e3 * mine / steps:8.3f} ms a step of {n} x {n} cells")
    theirs, other = py_pde(n, steps)
    print(f"py-pde   {1e3 * theirs / steps:8.3f} ms a step, {theirs / mine:.2f} times as long")
    print(f"largest difference of u after {steps} steps: {np.abs(u - other).max():.1e}")


if __name__ == "__main__":
    main()
