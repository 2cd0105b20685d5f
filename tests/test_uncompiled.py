"""What Python makes of the kernels as they are written is what their compiled code makes, to the last bit.

Python tells an index behind the end of an array, which compiled code does not, and raises where it has no value.
"""

import os
import subprocess
import sys

import numpy as np
import pytest

PHYSICS = """\
clock: {end: 40 ms, fps: 50}
objects:
  floor: {plane: {height: 1.99 m}}
  lump: {implicit: {field: x^4 + y^4 + z^4 - 1, unit: 0.3 m, bounds: {ball: 2}, position: 5 0 0 m}}
  shot: {sphere: {radius: 5 cm, position: 5 0.36 0 m}}
models:
  net: {cloth: {cells: 3 3, pins: [top_left]}}
  held: {cloth: {cells: 3 3, pins: [top_left], center: 9 2 0 m}}
  ball: {particles: {of: shot, mass: 1 kg, velocity: 0 -1 0 m/s}}
  gas:
    particles:
      list: {a: {velocity: 1 0 0 m/s, position: 0 9 0 m}, b: {velocity: -1 0 0 m/s, position: 0.09 9 0 m}}
      radius: 1 cm
  dust: {particles: {positions: [[20 m, 9 m, 0 m], [21 m, 9 m, 0 m]], mass: 1 g, radius: 1 cm}}
  stiff:
    equations:
      start: {a: 1, b: 0, c: 0}
      rate: {a: "-0.04*a + 1e4*b*c", b: "0.04*a - 1e4*b*c - 3e7*b^2", c: "3e7*b^2"}
  heat: {diffusion: {of: number, coefficient: 1e-2 m^2/s, size: 1 1 m, cell: 0.2 m, initial: x}}
forces:
  weight: {gravity: {on: [net, held, ball]}}
  gusts: {turbulence: {on: [dust], linear: 2 g/s}}
contacts:
  lie: {collision: {between: [net, floor], friction: 0.3, mode: local}}
  hit: {collision: {between: [ball, lump], mode: exact}}
  meet: {mutual_collision: {between: [gas], mode: local}}
solvers:
  explicit: {rk4: {on: [net], step: 2 ms}}
  implicit: {bdf2: {on: [held], step: 10 ms}}
  adaptive: {dopri5: {on: [ball, dust]}}
  symplectic: {verlet: {on: [gas], step: 5 ms}}
  strong: {radau: {on: [stiff]}}
  trapezoidal: {crank_nicolson: {on: [heat], step: 10 ms}}
outputs:
  numbers:
    record:
      of: [net.positions, held.positions, ball.positions, gas.positions, dust.positions, stiff.a, heat.max]
      format: npz
"""
PICTURE = """\
objects:
  knot:
    implicit:
      field: "abs(sin(3*x)*cos(4*y) + sin(5*z)) + x^2 + y^2 + z^2 - 0.8"
      unit: 0.4 m
      bounds: {ball: 1}
      position: 0 1 0 m
  sheet:
    implicit: {field: (x^2 + y^2 + z^2 - 0.49)^2, mode: surface, unit: 0.4 m, bounds: {ball: 1}, position: -1 1 0 m}
  ball: {sphere: {position: 1 1 0 m, radius: 0.5 m, material: {glass: {}}}}
  drops: {blobby: {points: [-1 0.5 0 m, -0.7 0.6 0.2 m, -1.2 0.8 0 m], radius: 0.4 m, color: tomato}}
  ring: {torus: {radius: 0.4 m, tube: 0.1 m, position: 0 0.2 1 m}}
  form: {implicit: {field: x^4 + y^4 + z^4 - 1, unit: 0.2 m, bounds: {ball: 1.6}, position: 1 0.3 1 m, hidden: yes}}
  brick: {polygonised: {of: form, cell: 0.2 m, edges: no}}
  floor: plane
cameras: {view: {perspective: {position: 2.1 2.2 4.2 m, look_at: 0 0.8 0.1 m, field_of_view: 38 deg}}}
outputs: {still: {image: {size: 9 6, time: 0 s, renderer: {trace: {tolerance: TOLERANCE, samples: 1}}}}}
"""


def rendered(folder, script, name, **environment):
    """The bytes that a script's output has, made by a process of its own."""
    folder.mkdir()
    (folder / "scene.yaml").write_text(script)
    command = [sys.executable, "-W", "ignore", "-m", "sceneql", "render", "scene.yaml", "-o", name]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), **environment}
    run = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    assert run.returncode == 0, run.stdout + run.stderr
    return folder / name


def test_islands_of_many_kinds(tmp_path):
    compiled = np.load(rendered(tmp_path / "compiled", PHYSICS, "numbers.npz"))
    written = np.load(rendered(tmp_path / "written", PHYSICS, "numbers.npz", NUMBA_DISABLE_JIT="1"))
    assert len(compiled) == 8
    for name in compiled:
        np.testing.assert_array_equal(compiled[name], written[name], err_msg=name)


@pytest.mark.long
@pytest.mark.parametrize("tolerance", ["1e-9", "1e-8"], ids=["in packets", "one by one"])
def test_pictures(tmp_path, tolerance):
    script = PICTURE.replace("TOLERANCE", tolerance)
    compiled = rendered(tmp_path / "compiled", script, "still.png")
    written = rendered(tmp_path / "written", script, "still.png", NUMBA_DISABLE_JIT="1")
    assert compiled.read_bytes() == written.read_bytes()
