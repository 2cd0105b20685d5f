"""Cloth and elastic solids in one collision: by the barrier, with momentum kept, weights borne and nothing crossed."""

import math

import numpy as np
import pytest

from crossing import crossings
from sceneql.pipeline import load
from sceneql.quantities.diagnostic import ScriptError
from sceneql.run.run import Run

LAW = "law: {neo_hookean: {modulus: 20 kPa, poisson: 0.3}}"
FINE = "bdf2: {step: 5 ms, newton: 1e-8}"


def run_of(tmp_path, text):
    path = tmp_path / "scene.yaml"
    path.write_text(text + "outputs: {film: {image: {size: 32 18}}}\n", encoding="utf-8")
    return Run(load(path, pruned=False)).islands[0]


def places(island, name):
    """(n, 3) [m] of the nodes or masses of a model."""
    bodies = island.bodies[name]
    return island.y[bodies.position_at :][: 3 * bodies.count].reshape(-1, 3)


def crossed(island, names):
    """How many edges of surfaces pass through triangles, all pairs tried."""
    points, triangles, first = [], [], 0
    for name in names:
        bodies = island.bodies[name]
        points.append(places(island, name))
        triangles.append((bodies.skin or bodies.springs.faces()).triangles + first)
        first += bodies.count
    return crossings(np.concatenate(points), np.concatenate(triangles))


def forces(island, t):
    """By model: the rate of momentum [N], and the weight of what moves."""
    rate, floats, found = island.march.rate(t, island.y), island.march.floats, {}
    for name, bodies in island.bodies.items():
        masses = floats[bodies.mass_at :][: bodies.count] * (floats[bodies.inverse_at :][: bodies.count] > 0.0)
        found[name] = masses @ rate[bodies.velocity_at :][: 3 * bodies.count].reshape(-1, 3), 9.81 * masses.sum()
    return found


NET = "mass_spring: {solid: {object: ball, spacing: 7 cm, density: 100 kg/m^3}, stiffness: 200 N/m}"
SHEET = "cloth: {size: 0.5 0.5 m, cells: [5, 5], center: 0 0 0 m, damping: 0.1, mass: 2 kg/m^2}"


@pytest.mark.parametrize(
    ("solver", "friction", "sheet"),
    [("bdf2: {step: 5 ms}", 0.3, SHEET), ("dopri5: {}", 0.3, SHEET), ("implicit_midpoint: {step: 5 ms}", 0.0, NET)],
)
def test_nothing_passes_at_any_step_and_momentum_is_kept(tmp_path, solver, friction, sheet):
    island = run_of(
        tmp_path,
        f"clock: {{end: 0.12 s}}\nsolvers: {{main: {{{solver}}}}}\n"
        "objects: {ball: {sphere: {radius: 0.1 m, position: 0 -0.12 0 m, hidden: yes}}}\nmodels:\n"
        "  jelly: {elastic: {block: {size: 0.2 0.2 0.2 m, cells: [1, 2, 1]}, element: p1, density: 300 kg/m^3, "
        f"position: 0 0.2 0 m, rotation: {{xyz: 20 40 20 deg}}, velocity: 0.5 -2 0 m/s, {LAW}}}}}\n"
        f"  sheet: {{{sheet}}}\n"
        f"contacts: {{touch: {{collision: {{between: [jelly, sheet], friction: {friction}}}}}}}\n",
    )
    for t in np.linspace(0, 0.12, 25):
        island.advance(t)
        assert crossed(island, ["jelly", "sheet"]) == 0
    floats, momenta = island.march.floats, {}
    for name, bodies in island.bodies.items():
        masses = floats[bodies.mass_at :][: bodies.count]
        momenta[name] = masses @ island.y[bodies.velocity_at :][: 3 * bodies.count].reshape(-1, 3)
    assert sum(momenta.values()) == pytest.approx([1.2, -4.8, 0.0], abs=1e-9)
    assert momenta["sheet"][1] < -0.4  # what has been struck moves on


def test_a_jelly_comes_to_rest_on_a_cloth_that_bears_its_weight(tmp_path):
    island = run_of(
        tmp_path,
        "clock: {end: 1.5 s}\nsolvers: {main: {bdf2: {step: 25 ms, newton: 1e-8}}}\nmodels:\n"
        "  jelly: {elastic: {block: {size: 0.3 0.3 0.3 m, cells: [1, 1, 1]}, element: p1, position: 0 1.16 0 m, "
        f"density: 100 kg/m^3, mass_damping: 8/s, {LAW}}}}}\n"
        "  sheet: {cloth: {size: 1 1 m, cells: [6, 6], center: 0 1 0 m, mass: 1 kg/m^2, "
        "pins: [left, right, top, bottom], stretch: 2000 N/m, shear: 500 N/m, damping: 1}}\n"
        "forces: [gravity, {drag: {linear: 2 N*s/m, on: [sheet]}}]\n"
        "contacts: {touch: {collision: {between: [jelly, sheet], friction: 0.3}}}\n",
    )
    island.advance(1.5)
    for force, weight in forces(island, 1.5).values():
        assert force == pytest.approx([0.0, 0.0, 0.0], abs=1e-3 * weight)
    assert places(island, "jelly")[:, 1].min() > places(island, "sheet")[:, 1].min() > 0.85
    assert crossed(island, ["jelly", "sheet"]) == 0


@pytest.mark.parametrize("friction", [0.2, 0.4, 0.6])
def test_a_cloth_on_a_tilted_solid_slides_or_sticks(tmp_path, friction):
    angle, start = math.atan(0.5), -0.1
    slope = f"{9.81 * math.sin(angle)} {-9.81 * math.cos(angle)} 0 m/s^2"
    island = run_of(
        tmp_path,
        f"clock: {{end: 0.3 s}}\nsolvers: {{main: {{{FINE}}}}}\nmodels:\n"
        "  block: {elastic: {block: {size: 1 0.1 0.3 m, cells: [3, 1, 1]}, element: p1, position: 0 -0.05 0 m, "
        f"hold: {{all: {{where: y < 1}}}}, {LAW}}}}}\n"
        f"  sheet: {{cloth: {{size: 0.2 0.2 m, cells: [3, 3], center: {start} 0.002 0 m, mass: 1 kg/m^2}}}}\n"
        f"forces: {{down: {{gravity: {{acceleration: {slope}}}}}}}\n"
        f"contacts: {{touch: {{collision: {{between: [block, sheet], friction: {friction}, gap: 2 mm}}}}}}\n",
    )
    island.advance(0.3)
    exact = max(0.0, 9.81 * 0.09 * (0.5 - friction) / math.sqrt(5))
    assert places(island, "sheet")[:, 0].mean() - start == pytest.approx(exact, abs=3e-4)


@pytest.mark.parametrize("solver", ["tr_bdf2: {step: 4 ms}", "dopri5: {}"])
def test_a_cloth_lifts_a_jelly_beside_a_crate_and_lets_go(tmp_path, solver):
    """What a pin let go stayed no unknown of the implicit stages, which found no solution from there."""
    lift = "shift: {keys: {0 s: 0 0 0 m, 0.2 s: 0 0.1 0 m}}"
    island = run_of(
        tmp_path,
        f"clock: {{end: 0.3 s}}\nsolvers: {{main: {{{solver}}}}}\n"
        "objects: {floor: plane, b: {box: {size: 0.1 0.1 0.1 m, position: 0.15 0.17 0 m}}}\nmodels:\n"
        "  jelly: {elastic: {block: {size: 0.15 0.15 0.15 m, cells: [1, 1, 1]}, element: p2, position: -0.1 0.19 0 m, "
        f"density: 300 kg/m^3, {LAW}}}}}\n"
        "  crate: {rigid: {of: b, density: 200 kg/m^3}}\n"
        "  sheet: {cloth: {size: 0.5 0.5 m, cells: [4, 4], center: 0 0.1 0 m, stretch: 1000 N/m, shear: 200 N/m, "
        f"damping: 0.3, pins: {{left: {{{lift}}}, right: {{{lift}}}, top: {{{lift}, until: 0.2 s}}}}}}}}\n"
        "forces: [gravity]\ncontacts: {touch: {collision: {between: [jelly, crate, sheet, floor], friction: 0.3}}}\n",
    )
    for t in np.linspace(0, 0.26, 14):
        island.advance(t)
        assert crossed(island, ["jelly", "sheet"]) == 0
    assert places(island, "sheet")[1:4, 1] == pytest.approx(0.2)  # where it has been led
    assert places(island, "sheet")[4::5, 1].min() < 0.19  # of what was let go
    assert min(places(island, name)[:, 1].min() for name in island.bodies) > 0.0
    assert places(island, "crate")[0, 1] > 0.1


@pytest.mark.parametrize(
    ("model", "told"),
    [
        ("mass_spring: {rope: {count: 4}}", "has no faces"),
        ("cloth: {tear: {at: 1.5}}", "tears"),
        ("particles: {list: {a: {position: 0 3 0 m}}}", "has no faces"),
    ],
)
def test_what_has_no_lasting_faces_is_refused_at_its_place(tmp_path, model, told):
    path = tmp_path / "scene.yaml"
    path.write_text(
        f"models:\n  jelly: {{elastic: {{block: {{cells: [1, 1, 1], size: 1 1 1 m}}, {LAW}}}}}\n  other: {{{model}}}\n"
        "contacts: {touch: {collision: {between: [jelly, other]}}}\noutputs: {film: {image: {size: 32 18}}}\n",
        encoding="utf-8",
    )
    with pytest.raises(ScriptError, match=f"'other' {told}, and does not collide") as found:
        load(path, pruned=False)
    assert found.value.diagnostics[0].span is not None


@pytest.mark.parametrize(("solver", "damping"), [("bdf2: {step: 10 ms}", 0), ("dopri5: {}", 0.2)])
def test_a_cloth_that_asks_for_it_falls_in_folds_without_passing_itself(tmp_path, solver, damping):
    island = run_of(
        tmp_path,
        f"clock: {{end: 0.4 s}}\nsolvers: {{main: {{{solver}}}}}\n"
        "objects: {floor: plane}\nforces: [gravity]\nmodels:\n"
        "  sheet: {cloth: {size: 0.1 0.4 m, cells: [2, 12], center: 0 0.25 0 m, facing: 0 0 1, stretch: 100 N/m, "
        f"shear: 10 N/m, bend: 0.1 N/m, damping: {damping}, rotation: {{xyz: 8 0 3 deg}}, velocity: 0 -1 0 m/s}}}}\n"
        "contacts: {fold: {mutual_collision: {between: [sheet, floor], mode: barrier, friction: 0.5, gap: 3 mm}}}\n",
    )
    for t in np.linspace(0, 0.3, 31):
        island.advance(t)
        assert crossed(island, ["sheet"]) == 0
        assert places(island, "sheet")[:, 1].min() > 0.0
    assert places(island, "sheet")[:, 1].max() < 0.15


@pytest.mark.parametrize(
    ("contacts", "told"),
    [
        ("a: {mutual_collision: {between: [sheet], mode: barrier, restitution: 0.2}}", "has no restitution"),
        ("a: {mutual_collision: {between: [sheet], gap: 1 mm}}", "spheres have no gap"),
        ("a: {mutual_collision: {between: [sheet, dust], mode: barrier}}", "'dust' has no faces"),
        (
            "a: {mutual_collision: {between: [sheet], mode: barrier}}, b: {collision: {between: [sheet]}}",
            "'b' would move",
        ),
        ("a: {collision: {between: [sheet, jelly]}}, b: {mutual_collision: {between: [sheet]}}", "'b' would move"),
        ("a: {mutual_collision: {between: [jelly, sheet], mode: barrier}}", "has a barrier in `collision`"),
    ],
)
def test_what_a_barrier_lacks_and_what_would_move_masses_past_it_is_refused(tmp_path, contacts, told):
    path = tmp_path / "scene.yaml"
    path.write_text(
        f"models:\n  jelly: {{elastic: {{block: {{cells: [1, 1, 1], size: 1 1 1 m}}, {LAW}}}}}\n"
        f"  sheet: {{cloth: {{}}}}\n  dust: {{particles: {{list: {{a: {{position: 0 3 0 m}}}}}}}}\n"
        f"contacts: {{{contacts}}}\n"
        "outputs: {film: {image: {size: 32 18}}}\n",
        encoding="utf-8",
    )
    with pytest.raises(ScriptError, match=told):
        load(path, pruned=False)
