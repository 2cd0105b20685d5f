"""Digests of what the program makes, by name: `python bytes_made.py NAME...` prints them, a line each."""

from __future__ import annotations

import hashlib
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from sceneql import pipeline
from sceneql.field.builder import TapeBuilder
from sceneql.frame import Tape
from sceneql.mesh.polygonise import polygonise

PARTS = [[0.1, 0, 0, 0.1, 0, 0, 0.5, 1.0], [-0.3, 0, 0, 0.2, 0.3, 0, 0.4, 0.7]]
SCENE = """\
sceneql: 1
clock: {end: 1 s}
objects:
  knot: {implicit: {field: "abs(sin(3*x)*cos(4*y) + sin(5*z)) + x^2 + y^2 + z^2 - 0.8", bounds: {ball: 1}}}
  floor: plane
  ball: {sphere: {position: 1 1 0 m, radius: 0.5 m, material: {glass: {}}}}
outputs: {still: {image: {size: 96 54, time: 0 s}}}
"""


def tape() -> Tape:
    """A field of many operations."""
    build = TapeBuilder()
    x, y, z = build.x, build.y, build.z
    waves = build.op("add", build.op("sin", build.op("mul", x, build.constant(7.0))), build.op("cos", y))
    curved = build.op("sqrt", build.op("add", build.op("square", x), build.op("exp", z)))
    parted = build.op("div", build.op("min", waves, curved), build.op("add", build.op("abs", y), build.constant(1.5)))
    return build.finish(build.op("sub", parted, build.density(np.array(PARTS), x, y, z)))


def mesh() -> Iterator[bytes]:
    """Triangles."""
    made = polygonise(tape(), (-1.0,) * 3, (1.0,) * 3, 0.05)
    yield from (array.tobytes() for array in (made.vertices, made.triangles, made.normals))


def trace() -> Iterator[bytes]:
    """A traced picture."""
    with tempfile.TemporaryDirectory() as folder:
        script, still = Path(folder) / "scene.yaml", Path(folder) / "still.png"
        script.write_text(SCENE, encoding="utf-8")
        pipeline.render(pipeline.load(script), output=still)
        yield still.read_bytes()


MADE = {"mesh": mesh, "trace": trace}


def digests(names: list[str]) -> list[str]:
    """One for each name."""
    return [hashlib.sha256(b"".join(MADE[name]())).hexdigest() for name in names]


if __name__ == "__main__":
    print("\n".join(digests(sys.argv[1:])))
