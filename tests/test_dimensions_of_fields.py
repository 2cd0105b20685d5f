"""What a field refuses by its dimension: angles and percentages elsewhere, formulas and expectations in other units."""

import math

import numpy as np
import pytest

from sceneql import pipeline
from sceneql.quantities.diagnostic import ScriptError

BALL = "objects: {ball: {sphere: {FIELDS}}}\n"
LAKE = "models: {lake: {diffusion: {of: temperature, size: 1 1 m, cell: 0.25 m, FIELDS}}}\n"
TANK = "models: {tank: {reaction_diffusion: {size: 1 1 m, cell: 0.25 m, species: {u: {FIELDS}}}}}\n"
DOTS = "models: {dots: {particles: {list: {a: {}}}}}\nforces: {shove: {FIELDS}}\n"
DEFINES = "define: {lean: 30 deg, part: 5 %, two: lean + lean, flow: 3 kg, span: 2 m, spread: 0.01 m^2/s, push: 2 N}\n"


def load(tmp_path, scene, fields):
    script = tmp_path / "scene.yaml"
    script.write_text(DEFINES + scene.replace("FIELDS", fields))
    return pipeline.load(script)


@pytest.mark.parametrize(
    ("scene", "fields"),
    [
        (BALL, "radius: 0.11 deg"),
        (BALL, "radius: 0 deg"),
        (BALL, "radius: 5 %"),
        (BALL, "radius: 1 + 5 %"),
        (BALL, "radius: lean"),
        (BALL, "radius: two"),
        (BALL, "radius: -lean"),
        (BALL, "radius: 'max(part, 1)'"),
        (BALL, "radius: 'where(time < 1 s, 1, lean)'"),
        (BALL, "radius: 'mix(lean, 1, 0.5)'"),
        (BALL, "position: [0, 0, 3 deg]"),
        (BALL, "position: {y: 3 deg}"),
        (BALL, "position: {keys: {0 s: 0 0 0 m, 1 s: 0 0 3 deg}}"),
        (BALL, "rotation: {about: z, angle: 5 %}"),
        (BALL, "rotation: {about: z, angle: 3 m}"),
        ("clock: {FIELDS}\n", "fps: 24 rad"),
        ("clock: {FIELDS}\n", "end: 5 %"),
        (LAKE, "coefficient: 0.01 kg"),
        (LAKE, "coefficient: flow"),
        (LAKE, "coefficient: 3 deg"),
        (LAKE, "coefficient: 1e-3, initial: span"),
        (LAKE, "coefficient: 1e-3, source: 3 K"),
        (LAKE, "coefficient: 1e-3, drift: {velocity: [flow, 0]}"),
        (LAKE, "coefficient: 1e-3, drift: {stream_function: 1 m/s}"),
        (LAKE, "coefficient: 1e-3, boundary: {left: {value: 3 kg}}"),
        (LAKE, "coefficient: 1e-3, boundary: {left: {flux: 3 K}}"),
        (LAKE, "coefficient: 1e-3, boundary: {left: {robin: {coefficient: 1 m/s, outside: 3 m}}}"),
        (TANK, "coefficient: 0.01 kg"),
        (TANK, "rate: 0.1 kg"),
        (TANK, "initial: 0.1 kg"),
        (DOTS, "force: {components: [flow, 0, 0]}"),
        (DOTS, "force: {potential: 3 N}"),
        (DOTS, "electric: {charge: 1 C, potential: 3 J}"),
        (DOTS, "magnetic: {charge: 1 C, formula: [0, 0, 1 V]}"),
        ("objects: {hill: {implicit: {FIELDS}}}\n", "field: 3 kg"),
        ("expect: {one: {of: 2*(1 m), because: exact, FIELDS}}\n", "value: 19.6 N/m"),
        ("expect: {one: {of: 2*(1 m), because: exact, FIELDS}}\n", "value: 2 m, tolerance: 1 %"),
        ("expect: {one: {of: 2*(1 m), because: exact, FIELDS}}\n", "below: 3 deg"),
    ],
)
def test_a_quantity_of_another_dimension_is_refused_alone_in_sums_and_by_define(scene, fields, tmp_path):
    with pytest.raises(ScriptError) as error:
        load(tmp_path, scene, fields)
    assert {one.code for one in error.value.diagnostics} == {"dimension-mismatch"}


@pytest.mark.parametrize(
    ("scene", "fields"),
    [
        (BALL, "radius: 2 rad/s*3 m/(1 m/s)*(1 m)"),
        (BALL, "radius: lean*(1 m)"),
        (BALL, "radius: 5 %*(1 m) + part*span"),
        (BALL, "radius: 1 m*sin(two) + 2 m*atan(span/(1 m))^2"),
        (BALL, "color: hue(30 %)"),
        (BALL, "rotation: {about: z, angle: two + 2*pi*time/(1 s)}"),
        (BALL, "rotation: {about: z, angle: {keys: {0 s: 0 deg, 1 s: lean}}}"),
        (BALL, "rotation: {xyz: [0, lean, 360 deg*time/(1 s)]}"),
        ("clock: {FIELDS}\n", "speed: 50 %, fps: 24 rad/(1 rad)"),
        (LAKE, "coefficient: 0.01 m^2/s, initial: 20 degC"),
        (LAKE, "coefficient: spread*(1 + x/span), initial: span - x"),
        (LAKE, "coefficient: spread, boundary: {left: {value: 3 K}, right: {flux: 2 K*m/s}}"),
        (LAKE, "coefficient: spread, source: 3 K/s, drift: {velocity: [0.5 m/s, span*y]}"),
        (TANK, "coefficient: spread, initial: flow, rate: flow - 0.1*u"),
        (TANK, "rate: 0.1 1/s"),
        (DOTS, "force: {components: [push, 3 N, span - x]}"),
        ("objects: {hill: {implicit: {FIELDS}}}\n", "field: 'sqrt(x^2 + y^2 + z^2) - span'"),
        ("models: {swing: {equations: {FIELDS}}}\n", "start: {a: 90 deg, b: flow}, rate: {a: b, b: -sin(a)}"),
        ("expect: {one: {of: 2*(1 m), because: exact, FIELDS}}\n", "value: 200 cm, tolerance: 1 mm"),
        ("expect: {one: {of: 2*(1 m), because: exact, FIELDS}}\n", "below: 3"),
    ],
)
def test_angles_and_percentages_in_products_and_formulas_in_si_are_as_in_textbooks(scene, fields, tmp_path):
    load(tmp_path, scene, fields)


def test_keys_of_a_define_are_angles_where_one_of_them_is(tmp_path):
    turn = "define: {tilt: {keys: {0 s: 0, 1 s: 90 deg}}}\n"
    script = tmp_path / "scene.yaml"
    script.write_text(turn + "objects: {ball: {sphere: {rotation: {about: z, angle: tilt}}}}\n")
    pipeline.load(script)
    script.write_text(turn + "objects: {ball: {sphere: {radius: tilt}}}\n")
    with pytest.raises(ScriptError, match=r"radius is a length \(m\), but this is an angle"):
        pipeline.load(script)


RATES = """\
clock: {end: 1 s}
models:
  dot: {particles: {list: {a: {velocity: 1 0 0 m/s}}}}
  tank: {reaction_diffusion: {size: 1 1 m, cell: 0.5 m, species: {u: {rate: dot.a.position.x - u}}}}
solvers: {main: SOLVER}
outputs: {table: {record: {of: [tank.u.mean]}}}
"""


@pytest.mark.parametrize("solver", ["{rk4: {step: 10 ms}}", "{radau: {tolerance: 1e-9}}"])
def test_a_reaction_may_read_what_is_solved_with_it(solver, tmp_path):
    """u' = t - u has the solution t - 1 + exp(-t)."""
    script = tmp_path / "scene.yaml"
    script.write_text(RATES.replace("SOLVER", solver))
    (moment,) = pipeline.simulate(pipeline.load(script), [1.0])
    np.testing.assert_allclose(moment.read("tank", "u.mean"), math.exp(-1.0), rtol=1e-8)
