"""The model elastic as scripts write it: what is held, loads, damping, starts, outputs."""

import math

import numpy as np
import pytest
from numpy.random import Generator, Philox

import sceneql.system.channels as channels
from runs import watch
from sceneql.bodies.elements.filled import bounded_by
from sceneql.kinds import Exceeds
from sceneql.pipeline import load as load_graph
from sceneql.run.run import Run
from solids import Solid

BAR = "block: {size: 1 0.2 0.2 m, cells: [4, 1, 1]}, law: {neo_hookean: {modulus: 20 kPa, poisson: 0.3}}"
WEIGHT = "forces: [gravity]\n"
RING = "objects: {ring: {torus: {radius: 0.3 m, tube: 0.12 m, hidden: yes}}}\n"


def test_what_holds_a_solid_carries_its_weight(tmp_path):
    solid = Solid(tmp_path, f"{{{BAR}, density: 20 kg/m^3, element: p2, hold: {{wall: {{where: x < -0.49}}}}}}", WEIGHT)
    places, _ = solid.rest()
    assert solid.read("wall.force", places) == pytest.approx([0.0, 20 * 0.04 * 9.81, 0.0], abs=1e-6)


def test_a_part_held_across_slides_along(tmp_path):
    low = {"x": -0.49, "y": -0.09, "z": -0.09}
    holds = ", ".join(f"{axis}: {{where: {axis} < {end}, components: {axis}}}" for axis, end in low.items())
    solid = Solid(
        tmp_path,
        f"{{{BAR}, element: p1, hold: {{{holds}}}, loads: {{pull: {{where: x > 0.49, traction: 2 0 0 kPa}}}}}}",
    )
    places, _ = solid.rest()
    stretch = np.ptp(places, axis=0) / [1.0, 0.2, 0.2]
    stress = solid.read("stress", places)
    assert stress[:, 0, 0] == pytest.approx(2e3 / stretch[1] ** 2)
    assert np.abs(stress - stress[:, :1, :1] * np.eye(3)[0][:, None] * np.eye(3)[0]).max() < 1e-6
    assert solid.read("von_mises", places) == pytest.approx(stress[:, 0, 0])
    assert solid.read("principal", places)[:, 0] == pytest.approx(stress[:, 0, 0])
    assert solid.read("J", places) == pytest.approx(stretch.prod())
    assert solid.read("volume", places) == pytest.approx(0.04 * stretch.prod())
    assert solid.read("strain", places)[:, 1, 1] == pytest.approx(0.5 * (stretch[1] ** 2 - 1))
    assert solid.read("x.force", places) == pytest.approx([-2e3 * 0.04, 0.0, 0.0], abs=1e-6)


def test_a_pressure_all_around_pushes_nowhere_and_its_slopes_are_its_derivative(tmp_path):
    law, loads = "{neo_hookean: {modulus: 1 mPa}}", "{water: {where: x < 9, pressure: 1 kPa}}"
    fields = f"{{of: ring, spacing: 0.2 m, element: p2, law: {law}, loads: {loads}}}"
    solid = Solid(tmp_path, fields, RING)
    places = solid.places + 0.01 * Generator(Philox(1)).standard_normal(solid.places.shape)
    forces = solid.forces(places)
    size = np.abs(forces).sum()
    assert np.abs(forces.sum(axis=0)).max() < 1e-14 * size
    assert np.abs(np.cross(places, forces).sum(axis=0)).max() < 1e-14 * size
    way, h = Generator(Philox(2)).standard_normal(places.shape), 1e-6
    change = (solid.forces(places + h * way) - solid.forces(places - h * way)) / (2 * h)
    np.testing.assert_allclose(-solid.stiffness(places) @ way.ravel(), change.ravel(), atol=1e-6 * np.abs(change).max())


def test_a_load_adds_up_to_what_is_said_of_it(tmp_path):
    loads = {
        "where: x > 0.49, traction: 0 3 0 kPa": [0, 3e3 * 0.04, 0],
        "where: x > 0.49, pressure: 3 kPa": [-3e3 * 0.04, 0, 0],
        "where: x > 0.49, force: 0 3 1 N": [0, 3, 1],
        "near: 0.5 0 0 m, within: 0.1 m, force: 1 0 0 N": [1, 0, 0],
        "near: 0.5 0 0 m, within: 0.1 m, traction: 1 0 0 kPa": [1e3 * math.pi * 0.01, 0, 0],
        "near: 0.53 0.02 0.01 m, force: 0 0 2 N": [0, 0, 2],
    }
    for load, whole in loads.items():
        for element in ("p1", "p2"):
            solid = Solid(tmp_path, f"{{{BAR}, element: {element}, loads: {{one: {{{load}}}}}}}")
            forces = solid.forces(solid.places)
            assert forces.sum(axis=0) == pytest.approx(
                whole, rel=0.03 if "within" in load and "trac" in load else 1e-12, abs=1e-12
            )
            if load.startswith("near: 0.53"):  # at the nearest place of the surface
                moment = np.cross(solid.places, forces).sum(axis=0)
                assert moment == pytest.approx(np.cross([0.5, 0.02, 0.01], whole))


@pytest.mark.parametrize("element", ["p1", "p2", "p2_mean"])
def test_viscosity_resists_strain_alone_and_its_loss_is_counted(tmp_path, element):
    solid = Solid(tmp_path, f"{{{BAR}, element: {element}, retardation: 20 ms}}")
    still = Solid(tmp_path, f"{{{BAR}, element: {element}}}")
    places = solid.places + 0.02 * Generator(Philox(1)).standard_normal(solid.places.shape)
    speeds, h = Generator(Philox(2)).standard_normal(places.shape), 1e-6
    force = solid.forces(places, speeds) - still.forces(places)
    rate = solid.march.rate(0.0, solid.state(places, speeds))
    assert rate[solid.bodies.work_at] == pytest.approx(-np.sum(force * speeds), rel=1e-10)
    turning = np.array([4.0, 5.0, 6.0]) + np.cross([1.0, 2.0, 3.0], places)
    assert np.abs(solid.forces(places, turning) - still.forces(places)).max() < 1e-12 * np.abs(force).max()
    way = Generator(Philox(3)).standard_normal(places.shape)
    for by, ends in (
        ("position", [solid.forces(places + side * h * way, speeds) for side in (1, -1)]),
        ("velocity", [solid.forces(places, speeds + side * h * way) for side in (1, -1)]),
    ):
        change = (ends[0] - ends[1]) / (2 * h)
        found = -solid.stiffness(places, speeds, by=by) @ way.ravel()
        np.testing.assert_allclose(found, change.ravel(), atol=1e-6 * np.abs(change).max())


FLIGHT = """
clock: {{end: 2 s}}
{ring}models:
  body: {{elastic: {{of: ring, spacing: 0.2 m, element: {element},
    law: {{neo_hookean: {{modulus: 20 kPa, poisson: {poisson}}}}},
    velocity: 1 2 0.5 m/s, spin: 3 5 -4 rad/s, position: 1 2 3 m, rotation: {{about: x, angle: 40 deg}}}}}}
solvers: {{main: {{implicit_midpoint: {{step: {step} ms, newton: 1e-13}}}}}}
"""


@pytest.mark.parametrize(
    ("element", "poisson", "step", "times", "within"),
    [("p1", 0.3, 2, [0, 0.1, 0.5, 1, 1.5, 2], 1e-4), ("p2_mean", 0.48, 5, [0, 0.1, 0.5], 3e-4)],  # p1: 1,000 steps
)
def test_a_tumbling_solid_keeps_momentum_angular_momentum_and_energy(tmp_path, element, poisson, step, times, within):
    script = FLIGHT.format(ring=RING, element=element, poisson=poisson, step=step)
    names = ("momentum", "angular_momentum", "energy", "potential")
    start, *later = watch(tmp_path, script, times, *(f"body.{name}" for name in names))
    assert start[3] == 0.0
    for row in later:
        np.testing.assert_allclose(row[0], start[0], rtol=1e-12)
        np.testing.assert_allclose(row[1], start[1], rtol=1e-12)
        assert row[2] == pytest.approx(start[2], rel=within)
        assert row[3] > 0.03 * start[2]


def test_a_solid_starts_where_and_how_it_is_told(tmp_path):
    script = FLIGHT.format(ring=RING, element="p1", poisson=0.3, step=5)
    (row,) = watch(tmp_path, script, [0], "body.center", "body.positions", "body.velocities", "body.angular_momentum")
    center, places, speeds, _ = row
    assert center == pytest.approx([1, 2, 3])
    assert speeds == pytest.approx(np.array([1, 2, 0.5]) + np.cross([3, 5, -4], places - center))
    spread = np.linalg.eigvalsh(np.cov(places.T))
    assert spread[0] < 0.3 * spread[1]
    axis = np.linalg.eigh(np.cov(places.T))[1][:, 0]  # that of the torus, y, turned about x
    assert abs(axis @ [0, math.cos(math.radians(40)), math.sin(math.radians(40))]) == pytest.approx(1, abs=1e-3)


LED = f"""
clock: {{end: 0.4 s}}
models:
  bar:
    elastic:
      {{{BAR}, element: p1, probes: {{tip: 0.5 0 0 m}},
       hold: {{wall: {{where: x < -0.49}},
              pull: {{where: x > 0.49, components: {{}}, shift: [0.1 m * sin(5*time/(1 s)), 0 m, 0 m]}}}}}}
solvers: {{main: {{rk4: {{step: 0.5 ms}}}}}}
"""


@pytest.mark.parametrize("components", ["xyz", "x"])
def test_what_is_held_is_led_and_the_work_of_leading_is_counted(tmp_path, components):
    script = LED.replace("{}", components)
    names = ("tip.position", "tip.velocity", "energy", "potential", "pull.force", "wall.force", "accelerations")
    masses = Solid(tmp_path, f"{{{BAR}, element: p1}}").masses[::3]
    rows = watch(tmp_path, script, [0, 0.2, 0.4], *(f"bar.{name}" for name in names))
    for time, (place, speed, *_) in zip((0, 0.2, 0.4), rows, strict=True):
        assert place[0] == pytest.approx(0.5 + 0.1 * math.sin(5 * time), abs=1e-9)
        assert speed[0] == pytest.approx(0.5 * math.cos(5 * time), abs=1e-6)
    energies = [row[2] for row in rows]
    assert max(energies) - min(energies) < 2e-3 * rows[-1][3]
    for *_, pull, wall, accelerations in rows:  # there are no other forces from outside
        assert pull + wall == pytest.approx(masses @ accelerations, rel=1e-9, abs=1e-6)


def test_probes_follow_the_material(tmp_path):
    solid = Solid(tmp_path, f"{{{BAR}, element: p2, probes: {{inner: 0.13 0.04 -0.06 m}}}}")
    gradient = np.eye(3) + 0.1 * Generator(Philox(8)).standard_normal((3, 3))
    places = solid.places @ gradient.T
    assert solid.read("inner.position", places) == pytest.approx(gradient @ [0.13, 0.04, -0.06])
    assert solid.read("inner.displacement", places) == pytest.approx((gradient - np.eye(3)) @ [0.13, 0.04, -0.06])
    assert solid.read("inner.stress", places) == pytest.approx(solid.read("stress", places)[0])


def test_numbers_by_formula_are_those_of_the_material_before_it_moves(tmp_path):
    block, law = "{size: 1 1 1 m, cells: [4, 1, 1]}", "{linear: {modulus: 1000*(2 + x), poisson: 0}}"
    fields = f"{{block: {block}, element: p1, density: 1000 + 500*x, law: {law}, position: 7 7 7 m}}"
    solid = Solid(tmp_path, fields)
    assert solid.masses.sum() / 3 == pytest.approx(1000)
    assert solid.mesh.points.mean(axis=0) == pytest.approx([0, 0, 0], abs=1e-12)
    assert np.average(solid.places, axis=0, weights=solid.masses[::3]) == pytest.approx([7, 7, 7])
    places = solid.places * [1.01, 1, 1]
    assert solid.read("potential", places) == pytest.approx(0.5 * 2000 * 0.01**2)


def test_the_element_follows_from_the_poisson_ratio(tmp_path):
    from sceneql.bodies.elements.element import elements

    for poisson, element in (("0.3", "p2"), ("0.45", "p2_mean"), ("0.2 + x*0", "p2_mean")):
        fields = (
            f"{{block: {{size: 1 1 1 m, cells: [1, 1, 1]}}, law: {{linear: {{modulus: 1 kPa, poisson: {poisson}}}}}}}"
        )
        assert Solid(tmp_path, fields).mesh.element is elements()[element]


@pytest.mark.parametrize("cut", ["six", "five"])
def test_a_block_is_cut_into_upright_tetrahedra_that_fit(tmp_path, cut):
    from sceneql.bodies.filling.tetrahedra import volumes
    from sceneql.mesh.measures import edge_counts

    fields = (
        f"{{block: {{size: 1 2 3 m, cells: [3, 2, 4], cut: {cut}}}, element: p2, law: {{linear: {{modulus: 1 kPa}}}}}}"
    )
    mesh = Solid(tmp_path, fields).mesh
    held = volumes(mesh.points, mesh.cells[:, :4])
    assert held.min() > 0
    assert held.sum() == pytest.approx(6)
    assert len(held) == 24 * {"six": 6, "five": 5}[cut]
    assert edge_counts(mesh.faces[:, :3])[1:] == (0, 0)


def test_outer_edges_of_p2_lie_on_the_object(tmp_path):
    """The volume of a ball is then right to the fourth order, not to the second."""
    errors = {}
    for element in ("p1", "p2"):
        fields = f"{{of: ball, spacing: 0.4 m, element: {element}, law: {{linear: {{modulus: 1 kPa}}}}}}"
        solid = Solid(tmp_path, fields, "objects: {ball: {sphere: {radius: 1 m, hidden: yes}}}")
        outer = solid.mesh.points[np.unique(solid.mesh.faces)]
        assert np.abs(np.linalg.norm(outer, axis=1) - 1).max() < 1e-9
        errors[element] = 1 - solid.masses.sum() / 3e3 / (4 / 3 * math.pi)
    assert errors["p1"] > 0.02
    assert abs(errors["p2"]) < 5e-4


def test_a_solid_at_rest_has_no_force_and_no_energy_to_the_last_bit(tmp_path):
    for law in ("linear", "corotated", "saint_venant", "neo_hookean", "mooney_rivlin"):
        numbers, turn = "{modulus: 1 MPa, poisson: 0.2}", "{about: x, angle: 1 rad}"
        fields = f"{{of: ring, spacing: 0.2 m, law: {{{law}: {numbers}}}, rotation: {turn}}}"
        solid = Solid(tmp_path, fields, RING)
        assert not solid.forces(solid.places).any()
        assert solid.read("energy", solid.places) == 0.0


def test_what_is_turned_inside_out_comes_back(tmp_path):
    """But by the laws that say they cannot: `linear` and `saint_venant`."""
    solid = Solid(tmp_path, f"{{{BAR}, element: p1}}")
    mirrored = solid.places * [1.0, 1.0, -0.1]
    assert solid.read("inverted", mirrored) == len(solid.mesh.cells)
    assert np.sum(solid.forces(mirrored) * (solid.places - mirrored)) > 0


def test_equilibrium_follows_a_load_that_grows(tmp_path):
    """Though a load's work, which is counted with the state, is no part of a rest."""
    loads = "loads: {tip: {where: x > 0.49, force: [0 N, time * 1 N/s, 0 N]}}"
    fields = f"{{{BAR}, element: p2, hold: {{wall: {{where: x < -0.49}}}}, {loads}}}"
    path = tmp_path / "scene.yaml"
    path.write_text(f"clock: {{end: 1 s}}\nmodels: {{body: {{elastic: {fields}}}}}\nsolvers: {{main: equilibrium}}\n")
    run = Run(load_graph(path, pruned=False))
    *_, last = run.moments([0, 0.5, 1])
    solid = Solid(tmp_path, fields, time=1.0)
    places, _ = solid.rest(last.read("body", "positions"))
    assert last.read("body", "positions") == pytest.approx(places, abs=1e-8)
    assert last.read("body", "wall.force") == pytest.approx([0.0, -1.0, 0.0], abs=1e-7)
    assert np.ptp(places[:, 1]) > 0.25
    assert run.islands[0].march.floats[channels.RATES] < 2000


STRIP = """
clock: {{end: 2 s}}
models:
  body:
    elastic:
      block: {{size: 10 1 0.1 m, center: 5 0 0 m, cells: [{cells}, 1, 1]}}
      element: p2
      law: {{{law}: {{modulus: 1.2 MPa, poisson: 0}}}}
      hold: {{wall: {{where: x < 1e-9}}}}
      loads:
        tip:
          where: x > 9.9999
          force: {{x: 0 N, y: 0 N, z: {{keys: {{0 s: 0 N, 0.3 s: 0 N, 2 s: {load} N}}, curve: linear}}}}
      probes: {{end: 10 0 0 m}}
solvers: {{main: equilibrium}}
"""
"""A strip of E I / L^2 = 1 N that a load bends."""


@pytest.mark.parametrize(
    ("law", "load", "drop"), [("saint_venant", 10, 0.8106090248803), ("neo_hookean", 4, 0.66996418127767)]
)
def test_a_thin_strip_comes_to_rest_by_few_updates(tmp_path, law, load, drop):
    """Beside Euler's elastica; plain Newton's method takes more than 200."""
    from sceneql.linear.newton_kernels import ITERATIONS

    script = STRIP.format(law=law, cells=40, load=load)
    path = tmp_path / "scene.yaml"
    path.write_text(script)
    run = Run(load_graph(path, pruned=False))
    *_, last = run.moments([0, 2])
    assert last.read("body", "end.displacement")[2] / 10 == pytest.approx(drop, rel=5e-4)
    assert run.islands[0].march._settings[ITERATIONS] < 80


def test_rest_is_that_of_the_instant_that_is_asked_for(tmp_path):
    """Though keys lie before it, and a step might go far beyond."""
    rows = watch(tmp_path, STRIP.format(law="saint_venant", cells=10, load=4), [0, 0.9, 1.1, 2], "body.wall.force")
    for time, (force,) in zip((0, 0.9, 1.1, 2), rows, strict=True):
        assert force == pytest.approx([0, 0, -4 * max(0, time - 0.3) / 1.7], abs=1e-7)


def test_what_bounds_steps_is_told_with_its_place(tmp_path):
    soft = BAR.replace("modulus: 20 kPa", "modulus: 20 kPa + 30 kPa*(x + 0.5)^2").replace("cells: [4", "cells: [9")
    for element, matrix in (("p1", False), ("p2", True)):
        solid = Solid(tmp_path, f"{{{soft}, element: {element}}}")
        told = solid.kind.remark(solid.model_state(solid.places))
        assert ("explicit methods solve" in told) == matrix
        assert float(told.partition("an element at (")[2].partition(",")[0]) > 0.4


@pytest.mark.parametrize("element", ["p1", "p2", "p2_mean"])
def test_by_default_the_nodes_of_all_elements_are_as_dense(tmp_path, element):
    script = "objects: {shape: {box: {size: 1 1 1 m, hidden: yes}}}\nmodels: {body: {elastic: {of: shape, "
    script += f"element: {element}, law: {{neo_hookean: {{modulus: 20 kPa, poisson: 0.4}}}}}}}}}}\n"
    path = tmp_path / "scene.yaml"
    path.write_text(script)
    assert 2000 < Run(load_graph(path, pruned=False)).islands[0].bodies["body"].count < 4000  # p2 had 20,000


def test_a_lattice_of_more_places_than_there_are_numbers_is_told_as_too_many():
    with pytest.raises(Exceeds):
        bounded_by(1e-3)(np.zeros(3), np.full(3, 1e299))
