"""Contacts: energy of the jelly of first.yaml, cost of many particles over surfaces, of balls in a box.

Run it as ``python tests/bench/bench_contacts.py``; compile first by running it twice. Times are of the compiled steps.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

from sceneql.pipeline import load
from sceneql.run.run import Run

ROOT = Path(__file__).parents[2]
MANY = """
clock: {{end: 1 s}}
models: {{b: {{particles: {{fill: {{object: room, count: {count}}}, radius: 1 mm}}}}}}
forces: [gravity]
contacts: {{hit: {{collision: {{between: [b, floor], restitution: 0.6, mode: local}}}}}}
objects: {{floor: {floor}, room: {{box: {{size: 4 2 4 m, position: 0 2.5 0 m}}}}}}
solvers: {{main: {{rk4: {{step: 10 ms}}}}}}
"""
FLOORS = {
    "plane": "plane",
    "box": "{box: {size: 9 1 9 m, position: 0 -0.5 0 m}}",
    "torus": "{torus: {radius: 1.5 m, tube: 0.5 m}}",
    "quartic": "{implicit: {field: (x^2 + y^2 + z^2 + 2)^2 - 9*(x^2 + z^2), bounds: {ball: 3}}}",
}
WALLS = ", ".join(
    f"w{k}{'nm'[s > 0]}: {{plane: {{normal: {' '.join(str(s * (c == k)) for c in range(3))}, height: -1 m}}}}"
    for k in range(3)
    for s in (1, -1)
)
BALLS = """
clock: {{end: 1 s}}
models: {{b: {{particles: {{fill: {{object: room, pattern: grid, spacing: {spacing} m}}, radius: {radius} m}}}}}}
forces: [gravity]
contacts:
  walls: {{collision: {{restitution: 1, mode: local, between: [b, {walls}]}}}}
  hit: {{mutual_collision: {{restitution: 1, mode: local}}}}
objects: {{{objects}, room: {{box: {{size: 1.6 1.6 1.6 m}}}}}}
solvers: {{main: {{rk4: {{step: 1 ms}}}}}}
"""


def march(script: str, folder: Path, times: list[float]) -> tuple[Run, list[float]]:
    """The run of a script, and the energies of its first model."""
    path = folder / "scene.yaml"
    path.write_text(script, encoding="utf-8")
    run = Run(load(path))
    model = run.islands[0].island.models[0]
    return run, [float(moment.read(model, "energy")) for moment in run.moments(times)]


def main() -> None:
    """Print all tables."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        first = (ROOT / "scenes" / "first.yaml").read_text(encoding="utf-8")
        print("jelly of first.yaml, rk4, local contacts: largest relative change of its energy, losses counted")
        for step in ("2 ms", "1 ms", "0.5 ms"):
            run, energies = march(first.replace("step: 1 ms", f"step: {step}"), folder, list(np.linspace(0, 4, 81)))
            drift = np.abs(np.array(energies) / energies[0] - 1.0).max()
            print(f"  {step:>7}  {drift:.1e}  {run.islands[0].march.statistics.steps} steps")
        print("particles falling on a surface, rk4 at 10 ms, local")
        for shape, floor in FLOORS.items():
            count = 20_000 if shape in ("plane", "box") else 2_000
            run, _ = march(MANY.format(count=count, floor=floor), folder, [0.0, 1.0])
            done = run.islands[0].march.statistics
            print(f"  {shape:>7}  {count:>6}  {1e6 * done.seconds / done.steps / count:.3f} us a particle and step")
        print("elastic balls in a box under gravity, rk4 at 1 ms, local")
        for spacing, radius in ((0.25, 0.06), (0.12, 0.03)):
            names = ", ".join(f"w{k}{'nm'[s > 0]}" for k in range(3) for s in (1, -1))
            numbers = {"spacing": spacing, "radius": radius, "walls": names, "objects": WALLS}
            run, energies = march(BALLS.format(**numbers), folder, [0.0, 1.0])
            done = run.islands[0].march.statistics
            count = (len(run.islands[0].march.system.y) - 1) // 6
            drift = abs(energies[1] - energies[0]) / (9.81 * count)
            cost = 1e6 * done.seconds / done.steps / count
            print(f"  {count:>6} balls  {cost:.3f} us a ball and step, energy {drift:.1e} of 1 m's fall")


if __name__ == "__main__":
    main()
