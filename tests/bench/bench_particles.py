"""A million particles in turbulent air over a plane: particle-steps a second, and the time to draw a frame of them.

Run as ``python tests/bench/bench_particles.py [COUNT [CASE...]]``; with cases nothing is drawn. Memory and compiled
code are warm; the best of REPEATS, in wall time and in processor time (the machine may be shared), of the march alone
and of the tracer alone. In the last cases particles meet the plane: they bounce high, or all lie on it and are moved
along by the air.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

from sceneql import pipeline
from sceneql.pipeline import frame_of
from sceneql.run.run import Run

STEP, STEPS, REPEATS = 0.01, 10, 4
SCENE = """
clock: {{end: 60 s}}
objects:
  cloud: {{box: {{size: 4 {height} 4 m, position: 0 {middle} 0 m, hidden: yes}}}}
  floor: plane
models:
  dust: {{particles: {{fill: {{object: cloud, count: {count}}}, mass: {mass}, radius: 2 mm}}}}
forces: [{forces}]
solvers: {{main: {{semi_implicit_euler: {{step: {step} s}}}}}}
cameras: {{view: {{perspective: {{position: 0 2 8 m, look_at: 0 1.5 0 m}}}}}}
outputs: {{film: {{video: {{size: 640 360}}}}}}
"""
THIN = "{turbulence: {speed: 1 m/s, size: 1 m, linear: 0.1 g/s}}"
AIR = "{turbulence: {speed: 1 m/s, size: 1 m, linear: 1 g/s}}"
BOUNCY = "{collision: {between: [dust, floor], restitution: 0.9, mode: local}}"
PLANE = "{collision: {between: [dust, floor], mode: local}}"
CASES = {
    "gravity": ("gravity", "1 g", 0.0),
    "turbulence": (AIR, "1 g", 0.0),
    "turbulence and plane": (f"gravity, {AIR}, {PLANE}", "1 g", 0.0),
    "bouncing": (f"gravity, {THIN}, {BOUNCY}", "1 g", 0.8),
    "lying": (f"gravity, {AIR}, {PLANE}", "1 g", 2.5),
}
"""Forces, mass, and the time at which the count begins."""


def started(case: str, count: int) -> Run:
    """A run at the time at which the count begins."""
    forces, mass, start = CASES[case]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.yaml"
        height = 2.0
        middle = height / 2 + (0.6 if start == 0 else 0.01)
        path.write_text(SCENE.format(count=count, forces=forces, mass=mass, step=STEP, height=height, middle=middle))
        run = Run(pipeline.load(path))
    for _ in run.moments([STEP, start or 2 * STEP]):
        pass
    return run


def hits_of(run: Run, case: str) -> float:
    """How often particles have hit the plane so far."""
    (name,) = [name for name, _, _ in run.islands[0].island.contacts] or [""]
    return run.graph.tasks[name].kind.read("hits.count", run.islands[0].state(name)) if name else 0.0


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000
    print(f"{count} particles, {STEPS} steps of {STEP} s a call")
    print(f"{'case':24s} {'million a second':>18s} {'ns a particle-step':>20s} {'hits a step':>12s}")
    for case in sys.argv[2:] or CASES:
        run = started(case, count)
        march = run.islands[0].march
        walls, cpus, hits = [], [], hits_of(run, case)
        for _ in range(REPEATS):
            before, wall, cpu = march.statistics.steps, time.perf_counter(), time.process_time()
            march.advance(STEP * (before + STEPS))
            done = (march.statistics.steps - before) * count
            walls.append((time.perf_counter() - wall) / done)
            cpus.append((time.process_time() - cpu) / done)
        run.islands[0].advance(STEP * march.statistics.steps)
        hits = (hits_of(run, case) - hits) / (REPEATS * STEPS * count)
        print(f"{case:24s} {1e-6 / min(walls):18.1f} {1e9 * min(cpus):20.1f} {hits:12.2%}", flush=True)
    if len(sys.argv) <= 2:
        draw_one(run)


def draw_one(run: Run) -> None:
    """The time to draw a frame."""
    steps = run.islands[0].march.statistics.steps
    from renderers.tracing.draw import draw
    from renderers.tracing.pack import pack

    (moment,) = run.moments([STEP * (steps + 1)])
    frame = frame_of(run.graph, "film", (640, 360), moment, 0)
    pack(frame)
    times = [time.process_time()]
    pack(frame)
    times.append(time.process_time())
    draw(frame)
    times.append(time.process_time())
    packing, both = times[1] - times[0], times[2] - times[1]
    print(f"drawing at 640x360, processor time: packing {packing:.2f} s, packing and tracing {both:.2f} s")


if __name__ == "__main__":
    main()
