"""Finite elements: energy, forces and stiffness of every law and element, patch test, rotation, loads, holds."""

import numpy as np
import pytest
from numpy.random import Generator, Philox

from sceneql.bodies.elements.element import elements
from sceneql.bodies.elements.laws.law import Laws
from solids import Solid

LAWS, ELEMENTS = list(Laws.model_fields), list(elements())
FIELDS = (
    "{{block: {{size: 2 1 1 m, cells: [2, 1, 1]{cut}}}, element: {element}, "
    "law: {{{law}: {{modulus: 1 kPa, poisson: {poisson}}}}}{more}}}"
)
BENT = "corners: [0 0 0 m, 2 0.2 0 m, 1.9 1.1 0.1 m, 0 1 0 m, 0 0.1 1 m, 2.1 0 1.2 m, 2 1 1 m, 0 1 1.1 m]"


def made(folder, law="neo_hookean", element="p2", poisson=0.3, more="", cut=""):
    return Solid(folder, FIELDS.format(law=law, element=element, poisson=poisson, more=more, cut=cut))


def shaken(solid, size=0.15, seed=3):
    return solid.places + size * Generator(Philox(seed)).standard_normal(solid.places.shape)


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("law", LAWS)
def test_forces_are_the_slope_of_the_energy_and_stiffness_that_of_forces(tmp_path, law, element):
    solid = made(tmp_path, law, element)
    places, h = shaken(solid), 1e-5
    ways = Generator(Philox(4)).standard_normal((4, *places.shape))
    stiffness, forces = solid.stiffness(places), solid.forces(places)
    assert np.abs(stiffness - stiffness.T).max() < 1e-11 * np.abs(stiffness).max()
    for way in ways:
        energies = [solid.read("potential", places + side * h * way) for side in (1, -1)]
        assert (energies[1] - energies[0]) / (2 * h) == pytest.approx(np.sum(forces * way), rel=1e-7, abs=1e-6)
        change = (solid.forces(places + h * way) - solid.forces(places - h * way)) / (2 * h)
        np.testing.assert_allclose(
            -stiffness @ way.ravel(), change.ravel(), rtol=1e-5, atol=1e-5 * np.abs(change).max()
        )


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("law", LAWS)
def test_definite_stiffness_has_no_negative_part(tmp_path, law, element):
    solid = made(tmp_path, law, element)
    places = shaken(solid) * [1.0, 0.4, 0.5]
    plain, definite = (np.linalg.eigvalsh(solid.stiffness(places, positive=p).toarray()) for p in (False, True))
    assert definite.min() > -1e-11 * definite.max()
    assert law == "linear" or plain.min() < -1e-3 * plain.max()
    still = solid.stiffness(solid.places)
    assert np.abs(solid.stiffness(solid.places, positive=True) - still).max() < 1e-11 * np.abs(still).max()


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("law", LAWS)
def test_an_even_strain_makes_even_stress(tmp_path, law, element):
    """The patch test: nodes inside feel no force, whatever the elements' shapes."""
    fields = f"{{block: {{{BENT}, cells: [3, 2, 2]}}, element: {element}, law: {{{law}: {{modulus: 1 kPa}}}}}}"
    solid = Solid(tmp_path, fields)
    places = solid.places @ (np.eye(3) + 0.2 * Generator(Philox(5)).standard_normal((3, 3))).T
    forces = solid.forces(places)
    inner = np.setdiff1d(np.arange(len(places)), np.unique(solid.mesh.faces))
    assert len(inner) >= 2
    assert np.abs(forces[inner]).max() < 1e-12 * np.abs(forces).max()
    stress = solid.read("stress", places)
    assert np.abs(stress - stress[0]).max() < 1e-12 * np.abs(stress).max()


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("law", LAWS)
def test_rotation_makes_no_force_but_by_the_linear_law(tmp_path, law, element):
    solid = made(tmp_path, law, element)
    size = 1e3  # the modulus times an area
    for seed in range(4):
        turn = np.linalg.qr(Generator(Philox(seed)).standard_normal((3, 3)))[0]
        turn *= np.sign(np.linalg.det(turn))
        forces = solid.forces(solid.places @ turn.T + [5.0, 2.0, 1.0])
        if law == "linear":
            assert np.abs(forces).max() > 0.01 * size
        else:
            assert np.abs(forces).max() < 1e-12 * size
