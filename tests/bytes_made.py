"""Digests of what the program makes, by name: `python bytes_made.py NAME...` prints them, a line each."""

from __future__ import annotations

import hashlib
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from campaigns import LONG
from sceneql import pipeline
from sceneql.field.tape.builder import TapeBuilder
from sceneql.frame import Tape
from sceneql.mesh.cubes.polygonise import polygonise

PARTS = [[0.1, 0, 0, 0.1, 0, 0, 0.5, 1.0], [-0.3, 0, 0, 0.2, 0.3, 0, 0.4, 0.7]]
SCENE = """\
sceneql: 1
clock: {end: 1 s}
objects:
  knot: {implicit: {field: "abs(sin(3*x)*cos(4*y) + sin(5*z)) + x^2 + y^2 + z^2 - 0.8", bounds: {ball: 1}}}
  floor: plane
  ball: {sphere: {position: 1 1 0 m, radius: 0.5 m, material: {glass: {}}}}
  drops: {blobby: {points: [-1 0.5 0 m, -0.7 0.6 0.2 m, -1.2 0.8 0 m], radius: 0.4 m, color: tomato}}
OTHERS
outputs: {still: {image: {size: 96 54, time: 0 s, renderer: RENDERER}}}
"""
OTHERS = """\
  worm:
    group:
      position: -0.3 1.3 0.4 m
      rotation: {about: 1 1 0, angle: 50 deg}
      children:
        skin:
          blobby:
            kernel: gaussian
            skeleton:
              - {spline: [-0.5 0 0 m, -0.2 0.2 0 m, 0.2 -0.1 0.2 m, 0.6 0 0 m], radius: [0.2 m, 0.3 m, 0.25 m, 0.2 m]}
              - {polyline: [-0.4 0 0 m, -0.4 -0.4 0 m], radius: [0.25 m, 0.15 m]}
              - {polygon: [0.3 0 -0.3 m, 0.6 0.3 -0.3 m, 0.2 0.4 -0.2 m], radius: 0.15 m, weight: 0.8}
  quartic:
    implicit: {field: x^4 + y^4 + z^4 - x^2 - y^2 - z^2 + 0.4, bounds: {ball: 1.6}, unit: 0.4 m, position: 0 0.5 1 m}
"""
PHYSICS = """sceneql: 1
clock: {end: 0.2 s}
models:
  net: {cloth: {cells: 6 6, pins: [top_left]}}
  stars: {galaxy: {stars: 200, seed: 3, constant: 1 m^3/kg/s^2, softening: 1 cm}}
  stiff:
    equations:
      start: {a: 1, b: 0, c: 0}
      rate: {a: "-0.04*a + 1e4*b*c", b: "0.04*a - 1e4*b*c - 3e7*b^2", c: "3e7*b^2"}
objects: {floor: {plane: {height: 1.99 m}}}
forces:
  pull: {mutual_gravity: {on: [stars], constant: 1 m^3/kg/s^2, softening: 1 cm}}
  weight: {gravity: {on: [net]}}
  gusts: {turbulence: {on: [net], linear: 2 g/s}}
contacts: {lie: {collision: {between: [net, floor], friction: 0.3}}}
solvers: {a: {bdf2: {on: [net], step: 5 ms}}, b: {dopri5: {on: [stars]}}, c: {radau: {on: [stiff]}}}
outputs: {t: {record: {of: [net.positions, stars.positions, stiff.a, stiff.b], format: npz, every: frame}}}
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


def _made(script: str, name: str) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path, made = Path(folder) / "scene.yaml", Path(folder) / name
        path.write_text(script, encoding="utf-8")
        pipeline.render(pipeline.load(path), output=made)
        return made.read_bytes()


def drawn() -> Iterator[bytes]:
    """A picture of what rays hit, by packets at the usual tolerance: of its normals, by code that compiles in a third.

    In the long run it is traced, with its light and glass, has curved skeletons and a polynomial, too, and is made ray
    by ray as well, by code without lanes.
    """
    if not LONG:
        yield _made(SCENE.replace("RENDERER", "normals").replace("OTHERS", ""), "still.png")
        return
    for tolerance in ("1e-9", "1e-8"):
        renderer = f"{{trace: {{tolerance: {tolerance}}}}}"
        yield _made(SCENE.replace("RENDERER", renderer).replace("OTHERS", OTHERS), "still.png")


def physics() -> Iterator[bytes]:
    """Marched islands: a cloth in contact by an implicit method, stars, stiff equations."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "t.npz"
        path.write_bytes(_made(PHYSICS, "t.npz"))
        with np.load(path) as table:
            yield from (table[name].tobytes() for name in sorted(table.files))


MADE = {"mesh": mesh, "drawn": drawn, "physics": physics}


def digests(names: list[str]) -> list[str]:
    """One for each name."""
    return [hashlib.sha256(b"".join(MADE[name]())).hexdigest() for name in names]


if __name__ == "__main__":
    print("\n".join(digests(sys.argv[1:])))
