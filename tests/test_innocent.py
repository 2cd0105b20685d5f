"""Scenes that look like a mistake, and are right: their check says nothing."""

import pytest

from sceneql import pipeline

BALL = "ball: {sphere: {radius: 0.3 m, position: 0 0.3 0 m}}"
EYE = "{perspective: {position: 0 -1 4 m, look_at: 0 %s 0 m}}"
CHARGES = """
models:
  gas: {particles: {list: {a: {mass: 1 kg, position: 1 0 0 m}, b: {mass: 1 kg, position: -1 0 0 m}}}}
forces: {repel: {electrostatic: {charge: 10 uC}}, pull: mutual_gravity}
clock: {end: 1 s}
"""
FALLING = """
objects:
  floor: plane
  leg: {box: {size: 0.1 1 0.1 m, position: 0 0.5 0 m}}
  top: {box: {size: 1 0.1 1 m, position: 0 1.05 0 m}}
  table: {union: {of: [leg, top], position: 0 0 2 m}}
models: {falls: {rigid: {of: table, density: 500 kg/m^3}}}
forces: [gravity]
contacts: [collision]
clock: {end: 0.1 s}
"""
VARIED = """
define: {k: 10 N/m, c: 0.1 s}
objects: {ball: {sphere: {radius: 0.2 m, position: 0 2 0 m}}}
models: {fall: {particles: {of: ball, mass: 1 kg}}}
forces: {weight: gravity, air: {drag: {linear: k*c}}}
variants:
  vacuum: {forces: {weight: gravity}}
  thick: {define: {k: 2 N*s/m}, forces: {weight: gravity, air: {drag: {linear: k}}}}
clock: {end: 0.1 s}
"""
BURNER = """
models:
  heat:
    diffusion: {size: 1 1 m, cell: 1/24 m, of: temperature, coefficient: 0.02 m^2/s, initial: 300,
      boundary: {rest: {value: 300}}, source: "where(hypot(x - 0.5, y - 0.2) < 0.1, 200, 0)"}
clock: {end: 1 s}
"""
OVAL = """
models:
  air: {flow: {size: 3 3 m, cell: 3/32 m, density: 1 kg/m^3, viscosity: 0.1 Pa*s}}
  balloon: {membrane: {of: egg, law: {springs: {stretch: 10 N/m}}, prestress: 2 N/m}}
forces: [{immersion: {on: [balloon], in: air}}]
objects: {egg: {implicit: {field: "x^2/0.75^2 + y^2/0.5^2 - 1", position: 1.5 1.5 0 m}}}
clock: {end: 1 s}
"""
TINTED = """
materials: {tinted: {glass: {color: 1 0.5 0.5}}}
objects: {other: {sphere: {position: 3 0.5 0.5 m, material: tinted}}, blob: {sphere: {radius: 0.2 m, hidden: yes}}}
models:
  drop: {membrane: {of: blob, material: glass, law: {tension: 1 N/m}}}
  water: {flow: {size: 1 1 1 m, corner: -0.5 -0.5 -0.5 m, cell: 0.2 m, density: 1 kg/m^3, viscosity: 0.1 Pa*s}}
forces: {carried: {immersion: {on: [drop], in: water}}}
clock: {end: 1 ms, speed: 1e-4}
"""
RESTING = f"""
objects: {{floor: plane, {BALL}, mark: {{box: {{size: 1 0.02 1 m, position: 0 0.01 0 m}}}}}}
models: {{fall: {{rigid: {{of: ball, mass: 1 kg}}}}}}
forces: [gravity]
contacts: {{hit: {{collision: {{between: [fall, floor]}}}}}}
clock: {{end: 0.1 s}}
"""
THROUGH = """
objects: {ball: {sphere: {radius: 0.2 m, position: 0 3 0 m}}, floor: plane, other: {box: {%s}}}
models: {fall: {particles: {of: ball, mass: 1 kg}}}
forces: [gravity]
contacts: {touch: {collision: {between: [fall, %s]}}}
clock: {end: 1.5 s}
"""
BESIDE = """
objects: {bob: {box: {size: 1 0.2 0.2 m, position: 0 1 0 m}}}
models: {swing: {rigid: {of: bob, mass: 1 kg}}}
ties: {string: {rod: {between: [swing, world], from: 0.5 1 0 m, to: 0 2 0 m}}}
forces: [gravity]
clock: {end: 1 s}
"""
DOWNWARDS = """
objects: {ball: {sphere: {radius: 0.2 m, position: 0 2 0 m}}}
models: {fall: {particles: {of: ball, mass: 1 kg}}}
forces: {weight: {gravity: {acceleration: 0 9.81 0 m/s^2}}}
cameras: {eye: {perspective: {position: 0 1 6 m, look_at: 0 2 0 m, up: 0 -1 0}}}
clock: {end: 0.1 s}
"""
SCENES = {
    "a ball on a hidden table": THROUGH % ("size: 4 0.2 4 m, position: 0 1 0 m, hidden: yes", "other"),
    "a ball that a gate lets pass": THROUGH % ("size: 1 0.5 1 m, position: [4 m/s*time, 1 m, 0 m]", "floor"),
    "a box that a rod holds by its side": BESIDE,
    "a scene with y downwards": DOWNWARDS,
    "a ball that rests on the floor before it is in a mark on it": RESTING,
    "a camera under a table of glass": f"objects: {{table: {{plane: {{material: glass}}}}, {BALL}}}\n"
    f"cameras: {{eye: {EYE % 0.3}}}\nlights: {{lamp: {{point: {{position: 1 -1 1 m}}}}}}\n",
    "a camera that sees what is underground": "objects: {floor: plane, root: {sphere: {position: 0 -1 0 m}}}\n"
    f"cameras: {{eye: {EYE % -1}}}\n",
    "charges, which weigh, too": CHARGES,
    "a group of parts above its place": FALLING,
    "variants that leave a force out, and a name that nothing uses then": VARIED,
    "a plain material beside a tinted one": TINTED,
    "heat that comes in at one place alone": BURNER,
    "a flat skin of a formula without z": OVAL,
    "TeX with the number of a character": 'overlays: {a: {formula: {tex: "\\u03b1 = 1"}}}\nobjects: {ball: sphere}\n',
}


@pytest.mark.parametrize("scene", SCENES)
def test_no_warning_of_what_is_right(scene, tmp_path):
    script = tmp_path / "scene.yaml"
    script.write_text(SCENES[scene].lstrip())
    assert not [str(one) for one in pipeline.load(str(script)).warnings]
