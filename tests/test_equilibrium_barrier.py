"""Rest under `equilibrium` where a barrier keeps surfaces apart."""

import numpy as np
import pytest

from campaigns import LONG
from crossing import crossings
from sceneql.linear import newton_kernels
from sceneql.pipeline import load
from sceneql.run.run import Run
from test_barrier import run_of, skins

LAW = "law: {linear: {modulus: 1 MPa, poisson: 0}}"
HELD = "hold: {top: {where: y > 0.0999, shift: '[0 m, -0.01 m/s*time, 0 m]'}}"


@pytest.mark.parametrize(("law", "deep"), [("linear", 1e-7), ("neo_hookean", 1e-4), ("neo_hookean", 1e-6)])
def test_a_ball_that_begins_a_hair_within_the_gap_comes_to_rest(tmp_path, law, deep):
    """Its potential is rounding, so that a search for less of it alone had no end."""
    hold = "top: {where: y > 0.6, shift: '[0 m, -0.01 m/s*time, 0 m]'}"
    island = run_of(
        tmp_path,
        "clock: {end: 1 s}\nsolvers: {main: equilibrium}\nobjects: {floor: plane, "
        f"ball: {{sphere: {{radius: 0.5 m, position: 0 {0.5 + 0.01 * (1 - deep)} 0 m}}}}}}\n"
        "models: {body: {elastic: {of: ball, spacing: 0.3 m, element: p1, "
        f"law: {{{law}: {{modulus: 1 MPa, poisson: 0.3}}}}, hold: {{{hold}}}}}}}}}\n"
        "contacts: {touch: {collision: {between: [body, floor], gap: 1 cm}}}\n",
    )
    island.advance(0.0)
    assert island.march._settings[newton_kernels.ITERATIONS] <= 80


def test_a_block_is_pressed_on_a_floor_as_its_strain_says(tmp_path):
    clearance = 0.01 * (1 - 1e-12)
    path = tmp_path / "scene.yaml"
    path.write_text(
        "clock: {end: 1 s}\nsolvers: {main: equilibrium}\nobjects: {floor: plane}\nmodels:\n"
        "  body: {elastic: {block: {size: 0.2 0.2 0.2 m, cells: [2, 2, 2]}, element: p1, "
        f"position: 0 {0.1 + clearance} 0 m, {LAW}, {HELD}}}}}"
        "\ncontacts: {touch: {collision: {between: [body, floor], gap: 1 cm}}}\n"
        "outputs: {table: {record: {of: [body.top.force]}}}\n",
        encoding="utf-8",
    )
    run = Run(load(path))
    (moment,) = run.moments([1.0])
    body = run.islands[0].bodies["body"]
    places = run.islands[0].y[body.position_at :][: 3 * body.count].reshape(-1, 3)
    under = body.skin.triangles[places[body.skin.triangles, 1].max(axis=1) < 0.05]
    # Each section bears the same force, E A times its mean strain where Poisson's ratio is 0.
    shortening = 0.2 - (0.2 + clearance - 0.01 - places[under, 1].mean())
    assert abs(moment.read("body", "top.force")[1]) == pytest.approx(1e6 * 0.04 * shortening / 0.2, rel=1e-6)
    assert 0.005 < shortening < 0.01


def test_a_ball_is_pressed_into_a_slab_in_few_steps(tmp_path):
    """Each pair that meets bends the path: along its tangents alone it was followed in steps of a ten-thousandth."""
    ball = "block: {size: 0.2 0.2 0.2 m, cells: [2, 2, 2]}, rotation: {xyz: 20 30 10 deg}, position: 0 0.28 0 m"
    slab = "block: {size: 0.5 0.1 0.5 m, cells: [5, 2, 5]}, position: 0 0.05 0 m"
    law = "law: {neo_hookean: {modulus: 1 MPa, poisson: 0.3}}"
    island = run_of(
        tmp_path,
        "clock: {end: 1 s}\nsolvers: {main: equilibrium}\nmodels:\n"
        f"  ball: {{elastic: {{{ball}, element: p1, {law}, hold: {{top: {{where: y > 0.05, "
        "shift: '[0 m, -0.12 m/s*time, 0 m]'}}}}\n"
        f"  slab: {{elastic: {{{slab}, element: p1, {law}, hold: {{bottom: {{where: y < -0.0499}}}}}}}}\n"
        "contacts: {touch: {collision: {between: [ball, slab]}}}\n",
    )
    island.advance(1.0)
    assert island.march.statistics.steps <= 40
    assert crossings(*skins(island)) == 0
    slab = island.bodies["slab"]
    places = island.y[slab.position_at :][: 3 * slab.count].reshape(-1, 3)
    assert places[:, 1].max() < 0.11
    assert places[np.linalg.norm(places[:, [0, 2]], axis=1) < 0.12, 1].max() < 0.099


@pytest.mark.skipif(not LONG, reason="27 s of processor time")
def test_a_ball_is_pressed_on_a_plane_by_hertz_law(tmp_path):
    """F = 4/3 E/(1 - nu^2) sqrt(R) d^(3/2) (Hertz 1882): a quarter of a lower half, a contact of 0.015 radii."""
    d, radius = 0.015**2, 0.015
    gap = 0.05 * d
    cuts = "{box: {size: 3 3 3 m, position: 0 1.5 0 m}}, {box: {size: 3 4 4 m, position: -1.5 0 0 m}}, "
    cuts += "{box: {size: 4 4 3 m, position: 0 0 -1.5 m}}"
    hold = f"top: {{where: y > {1 + gap - 1e-6}, shift: '[0 m, {-d} m/s*time, 0 m]'}}, "
    hold += "x: {where: x < 1e-6, components: x}, z: {where: z < 1e-6, components: z}"
    finer = f"pole: {{near: 0 {gap} 0 m, within: {1.3 * radius} m, spacing: {0.5 * radius} m}}"
    path = tmp_path / "scene.yaml"
    path.write_text(
        "clock: {end: 1 s}\nsolvers: {main: equilibrium}\nobjects:\n  floor: plane\n"
        f"  part: {{difference: {{of: [{{sphere: {{radius: 1 m}}}}, {cuts}], position: 0 {1 + gap} 0 m}}}}\n"
        f"models:\n  ball: {{elastic: {{of: part, spacing: 0.3 m, finer: {{{finer}}}, element: p2, "
        f"law: {{linear: {{modulus: 1 MPa, poisson: 0.3}}}}, hold: {{{hold}}}}}}}\n"
        f"contacts: {{touch: {{collision: {{between: [ball, floor], gap: {gap} m}}}}}}\n"
        "outputs: {table: {record: {of: [ball.top.force]}}}\n",
        encoding="utf-8",
    )
    (moment,) = Run(load(path)).moments([1.0])
    force = 4.0 * abs(moment.read("ball", "top.force")[1])
    assert force == pytest.approx(4 / 3 * 1e6 / (1 - 0.3**2) * d**1.5, rel=0.02)
