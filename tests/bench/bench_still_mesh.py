"""A mesh of 100,000 triangles that holds still, in a film of 20 frames: processor time of a frame after the first.

Run as ``python tests/bench/bench_still_mesh.py [RENDERER]``, `trace` or `raster`. The camera stands, or goes around;
the mesh stands, or is moved, so that all is made anew for every frame. Compiled code is warm. Prints the least and
the median of the frames.
"""

from __future__ import annotations

import statistics
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from sceneql import pipeline
from sceneql.run.run import Run

FRAMES, STEPS = 20, 159
SCENE = """
clock: {{end: 1 s, fps: 20}}
cameras: {{eye: {camera}}}
objects:
  ball: {{mesh: {{file: ball.obj, position: {position}}}}}
  floor: {{plane: {{position: 0 -1.2 0 m}}}}
  other: {{sphere: {{radius: 0.3 m, position: [1.2 m, 0 m, 1 m - time*(2 m/s)]}}}}
outputs: {{film: {{video: {{size: 640 360, renderer: {renderer}}}}}}}
"""
STANDING = "{perspective: {position: 0 2 5 m, look_at: 0 0 0 m}}"
TURNING = "{perspective: {position: [5 m*sin(time*(1 rad/s)), 2 m, 5 m*cos(time*(1 rad/s))], look_at: 0 0 0 m}}"
MOVED = "[0.1 m*sin(time*(6 rad/s)), 0 m, 0 m]"
CASES = {
    "still": (STANDING, "0 0 0 m"),
    "still, the camera moves": (TURNING, "0 0 0 m"),
    "moved": (STANDING, MOVED),
}


def ball(path: Path) -> int:
    """Write a bumpy sphere; the number of its triangles."""
    theta, phi = np.meshgrid(
        np.linspace(0, np.pi, STEPS + 1), np.linspace(0, 2 * np.pi, 2 * STEPS, endpoint=False), indexing="ij"
    )
    r = 1 + 0.03 * np.sin(20 * theta) * np.sin(20 * phi) * np.sin(theta)
    places = np.stack([r * np.sin(theta) * np.cos(phi), r * np.cos(theta), -r * np.sin(theta) * np.sin(phi)], axis=-1)
    row = 2 * STEPS
    i, j = (index.ravel() for index in np.meshgrid(np.arange(STEPS), np.arange(row), indexing="ij"))
    a, b = row * i + j, row * i + (j + 1) % row
    faces = np.concatenate([np.stack([a, a + row, b + row], axis=1), np.stack([a, b + row, b], axis=1)]) + 1
    rows = [f"v {x!r} {y!r} {z!r}" for x, y, z in places.reshape(-1, 3).tolist()]
    path.write_text("\n".join([*rows, *(f"f {p} {q} {r}" for p, q, r in faces.tolist())]))
    return len(faces)


def main() -> None:
    renderer = sys.argv[1] if len(sys.argv) > 1 else "trace"
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.yaml"
        print(f"{ball(path.with_name('ball.obj'))} triangles, {FRAMES} frames of 640x360 by {renderer}")
        for case, (camera, position) in CASES.items():
            path.write_text(SCENE.format(camera=camera, position=position, renderer=renderer))
            graph = pipeline.load(path)
            tools = pipeline.Tools(graph, "film", pipeline.Report(), path)
            times = []
            for moment in Run(graph).moments([k / FRAMES for k in range(FRAMES)]):
                started = time.process_time()
                tools.pixels(graph.tasks["film"].kind, moment)
                times.append(time.process_time() - started)
            print(f"{case:24s} least {min(times[1:]):.3f} s, median {statistics.median(times[1:]):.3f} s", flush=True)


if __name__ == "__main__":
    main()
