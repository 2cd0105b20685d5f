"""What a step of radau costs beside one of dopri5, and what `auto` makes of it: chains, nets and lattices of springs.

    python tests/bench/bench_stiff_steps.py [chain|net|lattice...]

Processor time of a whole run of 50 ms, divided by the steps tried. Errors are those of positions at the end beside a
run of radau at a tolerance of 1e-7.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from sceneql.pipeline import load
from sceneql.run.run import IslandRun

END = 0.05
TOLERANCE = 1e-4
KINDS = {
    "chain": (
        (60, 200, 800),
        "{{mass_spring: {{rope: {{from: 0 0 0 m, to: 3 0 0 m, count: {n}}}, mass: 1 g, stiffness: 1e7 N/m, "
        "damping: 1 N*s/m, pins: [start]}}}}",
    ),
    "net": (
        (6, 11, 20),
        "{{cloth: {{size: 1 1 m, cells: {n} {n}, center: 0 1 0 m, mass: 0.15 kg/m^2, stretch: 1e7 N/m, shear: 1e6 N/m, "
        "bend: 2 N/m, damping: 0.1, pins: [top]}}}}",
    ),
    "lattice": (
        (3, 5, 7),
        "{{mass_spring: {{lattice: {{count: {n} {n} {n}, spacing: 0.1 m, center: 0 2 0 m}}, mass: 3 g, "
        "stiffness: 1e7 N/m, damping: 1 N*s/m}}}}",
    ),
}


def run(model: str, solver: str) -> tuple[np.ndarray, float, IslandRun]:
    """The end, the processor time [s], the run."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.yaml"
        path.write_text(
            f"clock: {{end: {END} s}}\nmodels: {{m: {model}}}\nsolvers: {{main: {{{solver}}}}}\nforces: [gravity, "
            "attractor: {strength: 1 m^3/s^2, exponent: 2, softening: 0.2 m, position: 0 0 1 m}]\n",
            encoding="utf-8",
        )
        graph = load(path, pruned=False)
    island = IslandRun(graph, graph.islands[0])
    island.march.advance(1e-6)
    started = time.process_time()
    y, _ = island.march.advance(END)
    return y, time.process_time() - started, island


def main(kinds: list[str]) -> None:
    """Print a line for each solver."""
    for kind in kinds or KINDS:
        sizes, model = KINDS[kind]
        for n in sizes:
            text = model.format(n=n)
            exact, _, _ = run(text, "radau: {tolerance: 1e-7}")
            steps = {}
            for word in ("dopri5", "tr_bdf2", "radau", "auto"):
                y, seconds, island = run(text, f"{word}: {{tolerance: {TOLERANCE}}}")
                march = island.march
                done = march.statistics
                steps[word] = seconds / (done.steps + done.rejected)
                places = march.system.partner >= 0
                error = np.abs(y - exact)[places].max()
                chosen = "; ".join(f"{t:.2g} s {why}" for t, why in march.choices())
                print(
                    f"{kind} {n}: {word} error {error:.1e} m, {done.steps}+{done.rejected} steps, {seconds:.3f} s "
                    f"{chosen or march.prepared_text}",
                    flush=True,
                )
            unknowns = int((island.march.system.partner < 0).sum())
            ratio = steps["radau"] / steps["dopri5"]
            print(f"{kind} {n}: {unknowns} unknowns, a step of radau costs {ratio:.0f} of dopri5")


if __name__ == "__main__":
    main(sys.argv[1:])
