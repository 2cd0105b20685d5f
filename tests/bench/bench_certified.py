"""Wrong pixels of the common scenes at 640 x 360: the tracer's search against certified intervals alone.

Run it as ``python tests/bench/bench_certified.py [SCENE ...]``. A pixel is wrong whose center disagrees on what is met,
or stays undecided; samples on a ray (`march`) stand beside it.
"""

from __future__ import annotations

import sys
import time

import numpy as np
from bench_polygonise import SCENES, register, scene_tape

from renderers.tracing.probe import probe
from sceneql.field.tape.builder import TapeBuilder
from sceneql.frame import Implicit, SeenFrame, Surface, View
from sceneql.report.surface_measures import compared

PITCH, YAW = np.radians([25.0, 35.0])
SIZE = (640, 360)


def frame_of(name: str) -> SeenFrame:
    """A common scene, seen as its file says."""
    scene = SCENES[name]
    clip = scene["clip"]
    about_x = np.array([[1, 0, 0], [0, np.cos(PITCH), -np.sin(PITCH)], [0, np.sin(PITCH), np.cos(PITCH)]])
    about_y = np.array([[np.cos(YAW), 0, np.sin(YAW)], [0, 1, 0], [-np.sin(YAW), 0, np.cos(YAW)]])
    box = (-1.001 * clip,) * 3, (1.001 * clip,) * 3
    if scene.get("mode") == "surface":
        build, ball = TapeBuilder(), TapeBuilder()
        tape = build.finish(register(build, scene["f"], {}))
        within = ball.finish(register(ball, f"sqrt(x^2 + y^2 + z^2) - {clip}", {}))
        shape = Implicit(name, Surface(), tape, *box, within=within)
    else:
        shape = Implicit(name, Surface(), scene_tape(name), *box)
    return SeenFrame(0, 0.0, (shape,), (), View((0.0, 0.0, 0.0), about_x @ about_y, SIZE, 1.05 * clip, True))


def main() -> None:
    """Print the table."""
    print(f"{'scene':<14}{'by':<14}{'met':>8}{'wrong':>8}{'undecided':>11}{'depth [m]':>11}{'largest':>10}{'s':>9}")
    for name in sys.argv[1:] or SCENES:
        frame = frame_of(name)
        started = time.perf_counter()
        truth = probe(frame, certain=True)
        print(
            f"{name:<14}{'certified':<14}{np.isfinite(truth.depth).sum():>8}{'':>8}{truth.undecided.sum():>11}", end=""
        )
        print(f"{'':>21}{time.perf_counter() - started:>9.2f}")
        for label, options in (("trace", {}), ("march, 64", {"march": 64}), ("march, 512", {"march": 512})):
            started = time.perf_counter()
            found = probe(frame, **options)
            run = compared(label, 0.0, time.perf_counter() - started, found, truth)
            print(f"{name:<14}{label:<14}{np.isfinite(found.depth).sum():>8}{run.wrong:>8}{run.undecided:>11}", end="")
            print(f"{run.depth_error:>11.1e}{run.largest_depth_error:>10.1e}{run.seconds:>9.2f}")


if __name__ == "__main__":
    main()
