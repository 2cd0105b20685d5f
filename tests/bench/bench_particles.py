"""A million particles in turbulent air over a plane: particle-steps a second, and the time to draw a frame of them.

Run as ``python tests/bench/bench_particles.py [COUNT]``. Memory and compiled code are warm; the times are those of
the processor, since the machine may be shared, of the march alone and of the tracer alone.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

from sceneql import pipeline
from sceneql.pipeline import frame_of
from sceneql.simulation.run import Run

STEP, STEPS = 0.01, 6
SCENE = """
clock: {{end: 10 s}}
objects:
  cloud: {{box: {{size: 4 2 4 m, position: 0 1.6 0 m, hidden: yes}}}}
  floor: plane
models:
  dust: {{particles: {{fill: {{object: cloud, count: {count}}}, mass: 1 g, radius: 2 mm}}}}
forces: [{forces}]
solvers: {{main: {{semi_implicit_euler: {{step: {step} s}}}}}}
cameras: {{view: {{perspective: {{position: 0 2 8 m, look_at: 0 1.5 0 m}}}}}}
outputs: {{film: {{video: {{size: 640 360}}}}}}
"""
AIR = "{turbulence: {speed: 1 m/s, size: 1 m, linear: 1 g/s}}"
PLANE = "{collision: {between: [dust, floor], mode: local}}"
CASES = {"gravity": "gravity", "turbulence": AIR, "turbulence and plane": f"gravity, {AIR}, {PLANE}"}


def started(forces: str, count: int) -> Run:
    """A run whose first step is done."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.yaml"
        path.write_text(SCENE.format(count=count, forces=forces, step=STEP))
        run = Run(pipeline.load(path))
    next(iter(run.moments([STEP])))
    return run


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000
    print(f"{count} particles, steps of {STEP} s\n{'case':24s} {'ns a particle-step':>20s} {'million a second':>18s}")
    for name, forces in CASES.items():
        run = started(forces, count)
        march = run.islands[0].march
        steps, started_at = march.statistics.steps, time.process_time()
        march.advance(STEP * (steps + STEPS))
        each = (time.process_time() - started_at) / ((march.statistics.steps - steps) * count)
        print(f"{name:24s} {1e9 * each:20.1f} {1e-6 / each:18.1f}")
    from renderers.tracing.draw import draw
    from renderers.tracing.pack import pack

    (moment,) = run.moments([STEP * (steps + STEPS)])
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
