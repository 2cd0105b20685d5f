"""The first compile ever of one island, by kinds of islands: wall seconds from an empty cache up to its first instants.

    python tests/bench/bench_compile.py [ISLAND...]    all islands, or those with one of these words in their names

Every island is built and marched by a fresh process, first with an empty cache, then with what that left. Seconds of
wall time are of the whole process, the start of Python and all imports included; processor time is that of the process
and of the one that compiles beside it. Only an idle machine gives wall times that mean something.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).parents[2]
OBJECTS = {
    "plane": "plane",
    "sphere": "{sphere: {radius: 1 m}}",
    "box": "{box: {size: 2 2 2 m}}",
    "implicit": "{implicit: {field: x^4 + y^4 + z^4 - 1, unit: 1 m, bounds: {ball: 2}}}",
}
DUST = "{particles: {fill: {object: room, count: 20}, mass: 1 g, radius: 1 mm}}"
JELLY = """{mass_spring: {lattice: {count: 3 3 3, spacing: 0.1 m, center: 0 2 0 m}, mass: 3 g, stiffness: 14 N/m,
  damping: 0.1 N*s/m, radius: 9 mm}}"""
CLOTH = """{cloth: {size: 1 1 m, cells: 8 8, center: 0 1 0 m, mass: 0.15 kg/m^2, stretch: 200 N/m, shear: 50 N/m,
  bend: 2 N/m, damping: 0.1, pins: [top]}}"""
STARS = """{galaxy: {stars: 20000, heart: 1 kg, disk: 0.15 kg, constant: 1 m^3/kg/s^2, softening: 60 mm, size: 1 m,
  dispersion: 0.04, thickness: 25 mm, core: 70 mm}}"""
PENDULUM = """{equations: {start: {a: 90 deg, b: 90 deg, a': 0, b': 0}, where: {d: a - b}, rate: {
  a'': (-b'^2*sin(d) - 2*9.81*sin(a) - cos(d)*(a'^2*sin(d) - 9.81*sin(b)))/(2 - cos(d)^2),
  b'': (2*(a'^2*sin(d) - 9.81*sin(b)) + cos(d)*(b'^2*sin(d) + 2*9.81*sin(a)))/(2 - cos(d)^2)}}}"""
HEAT = "{diffusion: {of: number, coefficient: 1e-2 m^2/s, size: 1 1 m, cell: 50 mm, initial: x}}"
BALL = "{diffusion: {of: number, coefficient: 1e-2 m^2/s, domain: ball, cell: 0.2 m, initial: x}}"
PULL = "{mutual_gravity: {constant: 1 m^3/kg/s^2, softening: 60 mm}}"
SOFT = """{elastic: {block: {size: 0.4 0.4 0.4 m, center: 0 1.25 0 m, cells: [2, 2, 2]}, element: p1,
  law: {neo_hookean: {modulus: 50 kPa, poisson: 0.4}}}}"""
SOLVERS = (
    "euler", "semi_implicit_euler", "rk4", "verlet", "blanes_moan", "boris", "dopri5", "dop853", "gauss_radau15",
    "implicit_euler", "implicit_midpoint", "bdf2", "tr_bdf2", "rodas5p", "radau", "auto",
)  # fmt: skip


def scene(model: str, solver: str, forces: str = "gravity", touched: str = "", mode: str = "local") -> str:
    """A script of one island; ``touched`` may be "itself"."""
    met = [] if touched == "itself" else touched.split()
    objects = "".join(f"\n  o{k}: {OBJECTS[word]}" for k, word in enumerate(met))
    names = ", ".join(["m", *(f"o{k}" for k, _ in enumerate(met))])
    contacts = f"contacts: {{hit: {{collision: {{between: [{names}], mode: {mode}}}}}}}\n" if met else ""
    if touched == "itself":
        contacts = f"contacts: {{hit: {{mutual_collision: {{between: [m], restitution: 1, mode: {mode}}}}}}}\n"
    return (
        "clock: {end: 1 s, fps: 100}\nobjects:\n  room: {box: {size: 1 1 1 m, position: 0 3 0 m}}\n"
        f"  ball: {{sphere: {{radius: 1 m}}}}{objects}\n"
        f"models: {{m: {model}}}\nforces: [{forces}]\n{contacts}solvers: {{main: {solver}}}\n"
    )


def rigid(objects: str, models: str, more: str = "") -> str:
    """A script of an island of rigid bodies."""
    return f"clock: {{end: 1 s, fps: 100}}\nobjects: {{{objects}}}\nmodels: {{{models}}}\nforces: [gravity]\n{more}"


BLOCK, LOCAL = "box: {size: 1 1 1 m, position: 0 0.5 0 m}", "contacts: {hit: {collision: {friction: 0.3, mode: local}}}"
TWO = f"plane: plane, b: {{{BLOCK}}}, c: {{{BLOCK.replace('0 0.5', '0 1.5')}}}"

ISLANDS = {
    "rigid body that is free": rigid(f"b: {{{BLOCK}}}", "m: {rigid: {of: b, spin: 0 3 1 rad/s}}"),
    "rigid ball on a plane": rigid("plane: plane, b: {sphere: {position: 0 1 0 m}}", "m: {rigid: {of: b}}", LOCAL),
    "rigid boxes on a plane": rigid(TWO, "m: {rigid: {of: b}}, n: {rigid: {of: c}}", LOCAL),
    "rigid pendulum on a hinge": rigid(
        f"b: {{{BLOCK}}}", "m: {rigid: {of: b}}", "ties: {h: {hinge: {between: [m, world], at: 1 0.5 0 m}}}"
    ),
    "equations, dopri5": scene(PENDULUM, "dopri5", ""),
    "equations, radau": scene(PENDULUM, "radau", ""),
    **{f"particles, {word}": scene(DUST, word) for word in SOLVERS},
    "particles in air, rk4": scene(DUST, "rk4", "gravity, {turbulence: {speed: 1 m/s, size: 1 m, linear: 1 g/s}}"),
    **{f"particles on {word}, local": scene(DUST, "rk4", touched=word) for word in OBJECTS},
    **{f"particles on {word}, exact": scene(DUST, "dopri5", touched=word, mode="exact") for word in OBJECTS},
    "particles on one another, local": scene(DUST, "rk4", touched="itself"),
    "particles on one another, exact": scene(DUST, "dopri5", touched="itself", mode="exact"),
    "jelly, rk4": scene(JELLY, "rk4"),
    **{f"jelly on {word}, local": scene(JELLY, "rk4", touched=word) for word in OBJECTS},
    "jelly on implicit and plane, local": scene(JELLY, "rk4", touched="implicit plane"),
    "jelly on implicit and plane, auto": scene(JELLY, "auto", touched="implicit plane"),
    "cloth, rk4": scene(CLOTH, "rk4"),
    "cloth, implicit_euler": scene(CLOTH, "implicit_euler"),
    "cloth, bdf2": scene(CLOTH, "bdf2"),
    "cloth on sphere, rk4": scene(CLOTH, "rk4", touched="sphere"),
    "elements, bdf2": scene(SOFT, "bdf2"),
    "elements with barrier on sphere and plane, bdf2": scene(SOFT, "bdf2", touched="sphere plane", mode="barrier"),
    "heat in a square, crank_nicolson": scene(HEAT, "crank_nicolson", ""),
    "heat in a ball, implicit_euler": scene(BALL, "implicit_euler", ""),
    "stars by tree, verlet": scene(
        STARS, "{verlet: {step: 10 ms}}", "{mutual_gravity: {constant: 1 m^3/kg/s^2, softening: 60 mm}}"
    ),
}


def march(name: str) -> None:
    """Build an island and march it to its first two instants; says what was compiled in this process."""
    from sceneql.compiled.kernels import compiled
    from sceneql.pipeline import load
    from sceneql.run.run import Run

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.yaml"
        path.write_text(ISLANDS[name], encoding="utf-8")
        for _ in Run(load(path, pruned=False)).moments([0.0, 0.01]):
            pass
    print(compiled.count, compiled.seconds)


def timed(name: str, cache: str) -> tuple[float, float]:
    """Wall and processor time [s] of a process that marches an island."""
    environment = {**os.environ, "SCENEQL_CACHE": cache}
    before, started = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run([sys.executable, __file__, "--march", name], env=environment, check=True, stdout=subprocess.DEVNULL)
    wall, after = time.perf_counter() - started, resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> None:
    """Print the table."""
    if sys.argv[1:2] == ["--march"]:
        march(sys.argv[2])
        return
    print(f"{'island':38s} {'first, wall s':>14s} {'processor s':>12s} {'cached, wall s':>15s}")
    for name in ISLANDS:
        if not sys.argv[1:] or any(word in name for word in sys.argv[1:]):
            with tempfile.TemporaryDirectory() as cache:
                (first, cost), (again, _) = timed(name, cache), timed(name, cache)
            print(f"{name:38s} {first:14.2f} {cost:12.2f} {again:15.2f}", flush=True)


if __name__ == "__main__":
    main()
