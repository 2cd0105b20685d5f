"""Laws of marching cubes: closed, oriented, on the surface, of the right topology."""

import math

import numpy as np
import pytest

from meshes import (
    BALL,
    CLOSED,
    PART,
    STEINER,
    cut,
    cut_finer,
    cut_sharp,
    tape_of,
)
from sceneql.field.tape.tape_solid import field_gradients, field_values
from sceneql.mesh.cubes.polygonise import polygonise
from sceneql.mesh.measures import edge_counts, euler_characteristic, volume

KERNELS = "0.3 - max(1 - (x - {d})^2 - y^2 - z^2, 0)^3 - max(1 - (x + {d})^2 - y^2 - z^2, 0)^3"


@pytest.mark.parametrize("name", CLOSED)
def test_vertices_lie_on_the_surface_with_the_gradient_for_normal(name):
    text, half, _ = CLOSED[name]
    found = cut(text, half, 40)
    slopes = field_gradients(tape_of(text), found.vertices)
    steep = np.linalg.norm(slopes, axis=1)
    assert (np.abs(field_values(tape_of(text), found.vertices)) / steep).max() < 1e-8 * half
    assert np.abs(found.normals - slopes / steep[:, None]).max() < 1e-12


@pytest.mark.parametrize(("side", "euler"), [(-1, 2), (1, 4)])
def test_two_density_kernels_part_at_the_distance_told_by_theory(side, euler):
    parting = 1.3691905863
    assert euler_characteristic(cut(KERNELS.format(d=0.5 * (parting + 1e-3 * side)), 1.7, 80).triangles) == euler
    finer, _ = cut_finer(KERNELS.format(d=0.5 * (parting + 1e-5 * side)), 1.7, 40)
    assert euler_characteristic(finer.triangles) == euler


def test_samples_that_are_zero_make_no_holes():
    # Planes of nodes lie on the faces of the box |x|, |y|, |z| < 1, and Steiner's double lines on the axes.
    for text in ("max(abs(x), abs(y), abs(z)) - 1", STEINER, "x*y*z + 0*x", "abs(x) + abs(y) + abs(z) - 1"):
        found = polygonise(tape_of(text), (-1.5625,) * 3, (1.4375,) * 3, 0.25)
        assert len(found.triangles)
        assert edge_counts(found.triangles)[1:] == (0, 0)


def test_a_solid_that_leaves_its_box_is_capped_there():
    found = polygonise(tape_of("x - y/2"), (-1.0, -1.0, -1.0), (1.0, 1.0, 1.0), 1 / 16)
    assert edge_counts(found.triangles)[1:] == (0, 0)
    assert euler_characteristic(found.triangles) == 2
    assert np.abs(found.vertices).max() <= 1.0 + 1e-9
    assert volume(found.vertices, found.triangles) == pytest.approx(4.0, rel=0.01)


def test_undefined_places_are_outside():
    found = polygonise(tape_of("x^2 + y^2 + z^2 - 1 + 0*sqrt(x)"), (-1.2,) * 3, (1.2,) * 3, 0.05)
    assert edge_counts(found.triangles)[1:] == (0, 0)
    assert found.vertices[:, 0].min() == pytest.approx(0.0, abs=1e-6)
    assert volume(found.vertices, found.triangles) == pytest.approx(2 * math.pi / 3, rel=0.02)


def test_nothing_where_nothing_is():
    assert len(cut("x^2 + y^2 + z^2 + 1", 1.0, 16).triangles) == 0
    assert len(cut_sharp("x^2 + y^2 + z^2 + 1", 1.0, 16).triangles) == 0


def test_same_bytes_for_one_and_two_threads(monkeypatch):
    meshes = []
    for threads in ("1", "2"):
        monkeypatch.setenv("SCENEQL_THREADS", threads)
        gyroid = "abs(sin(9*x)*cos(9*y) + sin(9*y)*cos(9*z) + sin(9*z)*cos(9*x)) - 0.3"
        made = cut(gyroid, 1.0, 50), cut_sharp(gyroid, 1.0, 16), cut_finer(PART, 1.0, 10)[0]
        meshes.append([a.tobytes() for found in made for a in (found.vertices, found.triangles, found.normals)])
    assert meshes[0] == meshes[1]


def test_grids_that_are_too_fine_are_refused():
    with pytest.raises(ValueError, match="too many"):
        polygonise(tape_of(BALL), (-1.0,) * 3, (1.0,) * 3, 1e-6)
    with pytest.raises(ValueError, match="above 0"):
        polygonise(tape_of(BALL), (-1.0,) * 3, (1.0,) * 3, 0.0)


@pytest.mark.parametrize("count", [20, 33])
def test_where_a_field_is_zero_on_one_side_the_surface_is_where_it_ceases_to_be_negative(count):
    """As floor is from a whole number on: not where a node behind it happens to stand."""
    mesh = cut("max(floor(3*x - 0.1), max(abs(x), abs(y), abs(z)) - 0.7)", 1.0, count)
    middle = mesh.vertices[(np.abs(mesh.vertices) < [0.2, 0.5, 0.5]).all(axis=1)]
    assert len(middle) > 50
    assert middle[:, 0] == pytest.approx(1 / 30, abs=1e-9)
