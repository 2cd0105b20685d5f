"""Masses that a flow carries beside exact values: what sinks slowly in a periodic row of its like.

    python tests/bench/bench_immersed.py disc 16 32 64     a stiff disc in a flat flow, by cells a side
    python tests/bench/bench_immersed.py ball 12 18 24     a stiff ball of tetrahedra, twice as heavy as the fluid

Each is told as how much slower it is than a rigid one of its radius, and by how many cells a rigid one as slow would be
wider. Sources: Hasimoto (1959), J. Fluid Mech. 5, 317-328; for cylinders also Sangani & Acrivos (1982), Int. J.
Multiphase Flow 8, 193-206.
"""

from __future__ import annotations

import math
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from sceneql.pipeline import load
from sceneql.run.run import IslandRun

FOLDER = Path(tempfile.mkdtemp())
WAVES = "left: {periodic: yes}, bottom: {periodic: yes}"


def drag_of_disc(radius: Any) -> Any:
    """Force by viscosity, speed and length, in a square row of side 1."""
    part = np.pi * radius**2
    return 4 * np.pi / (-0.5 * np.log(part) - 0.738 + part - 0.887 * part**2 + 2.038 * part**3)


def drag_of_ball(radius: Any) -> Any:
    """Force by viscosity and speed, in a cubic row of side 1."""
    part = 4 / 3 * np.pi * radius**3
    return 6 * np.pi * radius / (1 - 1.7601 * part ** (1 / 3) + part - 1.5593 * part**2)


def begun(size: str, sides: str, cells: int, net: str, more: str, push: str) -> tuple[Any, IslandRun]:
    """A model `net` in a flow of viscosity and density 1, whose body force balances its weight."""
    flow = f"size: {size} m, cell: 1/{cells} m, density: 1 kg/m^3, viscosity: 1 Pa*s, boundary: {{{sides}}}"
    text = f'models:\n  air: {{flow: {{{flow}, force: "{push}"}}}}\n  net: {{mass_spring: {{{net}}}}}\n'
    text += "clock: {end: 0.4 s}\nforces: [{immersion: {on: [net], in: air}}, {gravity: {acceleration: 1 0 0 m/s^2}}]\n"
    path = FOLDER / "scene.yaml"
    path.write_text(text + more, encoding="utf-8")
    graph = load(path, pruned=False)
    return graph, IslandRun(graph, graph.islands[0])


def told(what: str, cells: int, graph: Any, run: IslandRun, radius: float, drag: Any, start: float) -> None:
    """Print how fast it sinks past the fluid in the mean."""
    run.advance(0.4)
    net, air = (graph.tasks[name].kind for name in ("net", "air"))
    state = run.state("net")
    at = state.bodies.weighed_at
    weight = state.floats[at : at + state.bodies.count].sum()
    speed = net.read("velocities", state)[:, 0].mean()
    past = speed - (air.read("momentum", run.state("air"))[0] - weight * speed)
    radii = np.linspace(radius, 1.8 * radius, 4001)
    wider = (np.interp(weight / past, drag(radii), radii) - radius) * cells
    slower = 1.0 - past * drag(radius) / weight
    stretch = net.read("stretch", state)
    print(f"{what} {cells:3d} cells: {100 * slower:.2f} % slower, as one wider by {wider:.3f} cells", end="")
    print(f" (stretch {100 * stretch:.2f} %), {time.process_time() - start:.1f} s", flush=True)


def disc(*sizes: str) -> None:
    """Rings of masses, near ones tied."""
    radius, mass = 0.15, 1.0
    for cells in map(int, sizes):
        start, rings = time.process_time(), cells * 3 // 10
        points = [(0.0, 0.0)]
        for k in range(1, rings + 1):
            count = round(2 * np.pi * k)
            turns = 2 * np.pi * (np.arange(count) / count + 0.05 * k)
            points += [(radius * k / rings * math.cos(turn), radius * k / rings * math.sin(turn)) for turn in turns]
        places = np.array(points)
        pairs = np.argwhere(np.triu(np.linalg.norm(places[:, None] - places, axis=2) < 1.6 * radius / rings, 1))
        listed = ", ".join(f"m{k}: {{position: {x + 0.5:.12f} {y + 0.5:.12f} 0 m}}" for k, (x, y) in enumerate(points))
        springs = ", ".join(f"{{between: [m{a}, m{b}]}}" for a, b in pairs)
        net = f"mass: {mass / len(points)!r} kg, stiffness: 1000 N/m, masses: {{{listed}}}, springs: [{springs}]"
        graph, run = begun("1 1", WAVES, cells, net, "", f"[{-mass!r}, 0]")
        told("disc", cells, graph, run, radius, drag_of_disc, start)


def ball(*sizes: str) -> None:
    """A solid of tetrahedra nine tenths of a cell wide."""
    radius = 0.2
    volume = 4 / 3 * math.pi * radius**3
    for cells in map(int, sizes):
        start = time.process_time()
        net = f"solid: {{object: egg, spacing: {0.9 / cells!r} m, density: 2 kg/m^3, modulus: 1000 Pa}}"
        egg = f"objects: {{egg: {{sphere: {{radius: {radius} m, position: 0.5 0.5 0.5 m}}}}}}\n"
        sides = f"{WAVES}, back: {{periodic: yes}}"
        graph, run = begun("1 1 1", sides, cells, net, egg, f"[{-volume!r}, 0, 0]")
        told("ball", cells, graph, run, radius, drag_of_ball, start)


if __name__ == "__main__":
    if len(sys.argv) > 1:
        {"disc": disc, "ball": ball}[sys.argv[1]](*sys.argv[2:])
    else:
        disc("16", "32", "64")
        ball("12", "18", "24")
