"""Solids squeezed, twisted and stacked: nothing crosses at any step, by a test of all edges against all triangles."""

import numpy as np
import pytest

from campaigns import LONG
from test_barrier import crossings, run_of, skins

SOFT = "law: {neo_hookean: {modulus: 20 kPa, poisson: 0.4}}"
STIFF = "law: {neo_hookean: {modulus: 100 kPa, poisson: 0.3}}"
STEPS = "solvers: {main: {bdf2: {step: 20 ms, newton: 1e-7}}}\n"


def test_a_ball_is_squeezed_through_a_ring_of_six_tenths_of_its_width(tmp_path):
    island = run_of(
        tmp_path,
        f"clock: {{end: 2 s}}\n{STEPS}objects: {{ring: {{torus: {{radius: 0.3 m, tube: 0.12 m}}}}, "
        "shape: {sphere: {radius: 0.3 m, hidden: yes}}}\nmodels:\n"
        "  ball: {elastic: {of: shape, spacing: 0.2 m, element: p1, position: 0 0.35 0 m, velocity: 0 -2 0 m/s, "
        f"{SOFT}, loads: {{push: {{where: x < 9, traction: 0 -6 0 kPa}}}}}}}}\n"
        "contacts: {touch: {collision: {between: [ball, ring], friction: 0.1}}}\n",
    )
    for t in np.arange(1, 51 if LONG else 21) * 0.02:
        island.advance(t)
        places, triangles = skins(island)
        assert np.hypot(np.hypot(places[:, 0], places[:, 2]) - 0.3, places[:, 1]).min() > 0.12
        assert crossings(places, triangles) == 0
    assert places[:, 1].max() < -0.12  # it is all below the ring
    assert island.march.statistics.rejected == 0


def test_a_soft_light_cube_carries_one_of_a_thousand_times_its_density(tmp_path):
    cube = "elastic: {block: {size: 1 1 1 m, cells: [2, 2, 2]}, element: p1"
    island = run_of(
        tmp_path,
        f"clock: {{end: 1 s}}\n{STEPS}objects: {{floor: plane}}\nforces: [gravity]\nmodels:\n"
        f"  light: {{{cube}, density: 1 kg/m^3, position: 0 0.55 0 m, {STIFF}}}}}\n"
        f"  heavy: {{{cube.replace('1 1 1', '0.9 0.9 0.9')}, density: 1000 kg/m^3, position: 0.02 1.57 0.03 m, "
        f"{STIFF}}}}}\ncontacts: {{touch: {{collision: {{between: [light, heavy, floor], friction: 0.5}}}}}}\n",
    )
    for t in np.arange(1, 51 if LONG else 16) * 0.02:
        island.advance(t)
        places, triangles = skins(island)
        assert places[:, 1].min() > 0
        assert crossings(places, triangles) == 0
    assert island.march.statistics.rejected == 0


@pytest.mark.skipif(not LONG, reason="half a minute")
def test_a_column_is_twisted_by_two_turns(tmp_path):
    turned = "rotation: {about: y, angle: '%g * pi * smoothstep(0, 2, time/(1 s)) * 1 rad'}, hidden: yes"
    island = run_of(
        tmp_path,
        f"clock: {{end: 2 s}}\n{STEPS}objects: {{one: {{sphere: {{radius: 0.1 m, {turned % 2}}}}}, "
        f"other: {{sphere: {{radius: 0.1 m, {turned % -2}}}}}}}\nmodels:\n"
        f"  column: {{elastic: {{block: {{size: 0.3 1.2 0.3 m, cells: [2, 8, 2]}}, element: p1, {SOFT}, hold: "
        "{top: {where: y > 0.599, follows: one}, bottom: {where: y < -0.599, follows: other}}}}\n"
        "contacts: {touch: {collision: {between: [column]}}}\n",
    )
    for t in np.arange(1, 101) * 0.02:
        island.advance(t)
        assert crossings(*skins(island)) == 0
