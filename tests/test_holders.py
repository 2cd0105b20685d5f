"""What holds masses in pictures: where it is drawn, and until when."""

import numpy as np
import pytest

from sceneql.bodies.spring_look import HOLDER
from sceneql.frame import Mesh, Points, Segments
from sceneql.pipeline import load, simulate

NET = "models: {{net: {{{0}}}}}\nclock: {{end: 1 s}}\noutputs: {{p: {{image: {{size: 64 36}}}}}}\n{1}"
CLOTH = "cloth: {{size: 1 1 m, cells: 4 4, center: 0 1 0 m, pins: {0}}}"
LATTICE = "mass_spring: {lattice: {count: 3 3 3, spacing: 0.2 m}, stiffness: 1 kN/m, mass: 20 g, pins: [left]}"
SOLID = (
    "mass_spring: {solid: {object: bar, spacing: 0.2 m, density: 300 kg/m^3, modulus: 100 kPa}, "
    "pins: {glue: {where: x < -0.39}}}"
)
WALL = (
    "mass_spring: {masses: {wall: {position: 0 1 0 m, fixed: yes}, bob: {position: 0 0 0 m}}, "
    "springs: [{between: [wall, bob]}]}"
)


def shapes(tmp_path, model, time=0.0, more=""):
    script = tmp_path / "s.yaml"
    script.write_text(NET.format(model, more))
    (moment,) = simulate(load(script), [time])
    return moment.lower(["net"])


def holders(*given, **more):
    return [shape for shape in shapes(*given, **more) if shape.surface == HOLDER]


def test_a_side_that_is_held_has_a_rail_along_its_masses(tmp_path):
    (rail,) = holders(tmp_path, CLOTH.format("[left]"))
    assert isinstance(rail, Segments)
    assert rail.ends.shape == (4, 2, 3)
    np.testing.assert_allclose(rail.ends[..., 0], -0.5)
    assert ((rail.radii > 0.005) & (rail.radii < 0.02)).all()


def test_a_cloth_that_is_held_all_round_has_rails_alone(tmp_path):
    """The triangles in its corners have three held corners, and are cloth."""
    (rails,) = holders(tmp_path, CLOTH.format("[left, right, top, bottom]"))
    assert isinstance(rails, Segments)
    assert len(rails.ends) == 16


def test_corners_have_a_bead_each(tmp_path):
    (beads,) = holders(tmp_path, CLOTH.format("[top_left, top_right]"))
    assert isinstance(beads, Points)
    assert sorted(np.round(beads.centers[:, 0], 9)) == [-0.5, 0.5]


def test_masses_of_a_lattice_and_fixed_ones_have_beads(tmp_path):
    (beads,) = holders(tmp_path, LATTICE)
    assert len(beads.centers) == 9
    net = [one for one in shapes(tmp_path, LATTICE) if isinstance(one, Points)]
    assert sum(len(one.centers) for one in net) == 27  # a bead in place of the mass
    (wall,) = holders(tmp_path, WALL)
    np.testing.assert_allclose(wall.centers, [[0.0, 1.0, 0.0]])


BEAM = (
    "elastic: {{block: {{size: 0.6 0.2 0.2 m, cells: 3 1 1, center: 0 1 0 m}}, "
    "law: {{neo_hookean: {{modulus: 10 kPa}}}}, hold: {{wall: {{{0}}}}}}}"
)


@pytest.mark.parametrize(
    ("hold", "count"),
    [
        ("where: x < -0.29", 1),
        ("where: abs(x) > 0.29", 1),
        ("where: x < 0", 0),  # all around
        ("where: x < -0.29, components: x", 0),  # it may slide
        ("where: x < -0.29, shift: ['0.1 m/s*time', 0 m, 0 m]", 0),
    ],
)
def test_a_face_of_elements_that_is_held_still_has_a_plate(tmp_path, hold, count):
    found = holders(tmp_path, BEAM.format(hold))
    assert len(found) == count
    if count:
        assert found[0].vertices[:, 1].max() > 1.09
        assert np.abs(found[0].vertices[:, 0]).min() > 0.28


def test_the_face_of_a_solid_that_is_held_has_a_plate(tmp_path):
    more = "objects: {bar: {box: {size: 0.8 0.4 0.4 m, hidden: yes}}}"
    plates = [one for one in holders(tmp_path, SOLID, more=more) if isinstance(one, Mesh)]
    assert len(plates) == 1
    assert plates[0].vertices[:, 0].max() < -0.35


@pytest.mark.parametrize(("time", "held"), [(0.0, 4), (0.2, 4), (0.6, 0)])
def test_what_is_let_go_is_no_longer_held(tmp_path, time, held):
    rails = holders(tmp_path, CLOTH.format("{top: {shift: [0 m, 1 m/s*time, 0 m], until: 0.4 s}}"), time)
    assert sum(len(rail.ends) for rail in rails) == held
    for rail in rails:
        assert rail.ends[0, 0, 1] == pytest.approx(1 + time, abs=1e-9)


def test_a_net_without_pins_and_one_whose_look_is_written_have_none(tmp_path):
    assert holders(tmp_path, CLOTH.format("[]")) == []
    assert holders(tmp_path, LATTICE.replace("pins:", "look: line, pins:")) == []
