"""Laws of colors, materials and lights."""

from __future__ import annotations

import math
from importlib import import_module
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moment import IDENTITY, FakeMoment, const
from sceneql.frame import PointLight, Sky, Sun
from sceneql.pipeline import load, simulate
from sceneql.quantities.diagnostic import ScriptError
from sceneql.shapes.color import PALETTE, default_color, linear
from sceneql.words.objects.plane import Plane

WORDS = ("matte", "glossy", "metal", "mirror", "checker", "glass")


def word(family, name):
    return getattr(import_module(f"sceneql.words.{family}.{name}"), name.capitalize())


def encode(c):
    """sRGB of a linear component (IEC 61966-2-1)."""
    return 12.92 * c if c <= 0.0031308 else 1.055 * c ** (1 / 2.4) - 0.055


@given(st.tuples(*[st.floats(0, 1)] * 3))
def test_linear_is_the_inverse_of_the_srgb_curve(color):
    assert [encode(c) for c in linear(color)] == pytest.approx(color, abs=1e-4)


def test_linear_has_the_known_value_of_middle_gray():
    assert linear((0.5, 0.0, 1.0)) == pytest.approx((0.21404114, 0.0, 1.0))


def test_default_colors_differ_and_repeat():
    colors = [np.array(default_color(k)) for k in range(len(PALETTE))]
    assert len(colors) >= 8
    assert min(np.abs(a - b).max() for a, b in combinations(colors, 2)) > 0.1
    assert default_color(len(PALETTE)) == default_color(0)


@pytest.mark.parametrize("name", WORDS)
def test_a_material_takes_its_own_color_or_the_one_given(name):
    material = word("materials", name)(color=const([0.5, 0.2, 1.0]))
    assert material.surface(FakeMoment(), None).color == linear((0.5, 0.2, 1.0))
    assert material.surface(FakeMoment(), (0.1, 0.9, 0.3)).color == (0.1, 0.9, 0.3)


@pytest.mark.parametrize("name", WORDS)
def test_default_surfaces_reflect_no_more_than_they_get(name):
    surface = word("materials", name)().surface(FakeMoment(), None)
    assert all(0 <= c <= 1 for c in surface.color)
    assert 0 <= surface.roughness <= 1
    assert 0 <= surface.specular < 1


def test_what_makes_each_material_itself():
    surfaces = {name: word("materials", name)().surface(FakeMoment(), None) for name in WORDS}
    assert surfaces["matte"].specular == 0
    assert surfaces["matte"].roughness == 1
    assert surfaces["metal"].metallic == surfaces["mirror"].metallic == 1
    assert surfaces["mirror"].roughness == 0
    assert surfaces["glass"].transmission == 1
    assert surfaces["glass"].specular == pytest.approx(0.04)
    assert surfaces["checker"].checker_size == 0.5
    assert surfaces["checker"].checker_color != surfaces["checker"].color
    assert word("materials", "glass")(index_of_refraction=1.0).surface(FakeMoment(), None).specular == 0


def lights(name, **fields):
    return list(word("lights", name)(**fields).lower(FakeMoment()))


@given(st.floats(-1.5, 1.5), st.floats(-3, 3))
def test_sun_stands_where_its_angles_say(elevation, azimuth):
    (sun,) = lights("sun", elevation=const(elevation), azimuth=const(azimuth))
    assert math.hypot(*sun.direction) == pytest.approx(1)
    assert math.asin(sun.direction[1]) == pytest.approx(elevation)
    assert math.atan2(sun.direction[0], sun.direction[2]) == pytest.approx(azimuth)


def test_sun_of_strength_one_makes_white_as_bright_as_its_color():
    (sun,) = lights("sun", direction=const([0, 2, 0]), strength=const(1.0), color=const([1, 0.5, 0]))
    assert sun.direction == (0, 1, 0)
    assert np.array(sun.irradiance) / math.pi == pytest.approx(linear((1, 0.5, 0)))
    with pytest.raises(ValueError, match="direction"):
        lights("sun", direction=const([0, 0, 0]))


def test_point_shines_its_power_into_the_whole_sphere():
    (lamp,) = lights("point", power=const(100.0), position=const([1, 2, 3]))
    assert isinstance(lamp, PointLight)
    assert np.array(lamp.intensity) * 4 * math.pi == pytest.approx([100, 100, 100])
    assert lamp.position == (1, 2, 3)


def test_sky_of_one_color_is_the_same_all_around():
    (sky,) = lights("sky", color=const([0.5, 0.5, 0.5]), strength=const(2.0), background=const([1, 1, 1]))
    assert sky.zenith == sky.horizon == sky.ground == pytest.approx([2 * c for c in linear((0.5, 0.5, 0.5))])
    assert sky.visible == (1, 1, 1)
    (plain,) = lights("sky")
    assert plain.visible is None
    assert plain.zenith != plain.horizon


def test_studio_has_its_key_light_upper_left_in_front_and_a_gray_cove():
    key, rim, sky = lights("studio")
    assert isinstance(key, Sun)
    assert isinstance(rim, Sun)
    assert isinstance(sky, Sky)
    assert key.direction[0] < 0 < min(key.direction[1:])
    assert rim.direction[2] < 0 < min(rim.direction[:2])
    assert [math.hypot(*sun.direction) for sun in (key, rim)] == pytest.approx([1, 1])
    assert max(sky.visible) - min(sky.visible) < 0.05
    (floor,) = Plane().lower("floor", IDENTITY, FakeMoment())
    # Irradiance on the open floor: a sky that is linear in the sine of the elevation counts 1/3 and 2/3.
    dome = (np.array(sky.horizon) + 2 * np.array(sky.zenith)) / 3
    suns = sum(np.array(sun.irradiance) * sun.direction[1] / math.pi for sun in (key, rim))
    np.testing.assert_allclose(np.array(floor.surface.color) * (suns + dome), sky.below, rtol=0.02)
    np.testing.assert_allclose(np.divide(sky.below, sky.visible), 1.9, atol=0.2)  # darker behind what stands on it
    assert sky.fade > 0.1
    turned = (np.array(sky.zenith) + np.array(sky.ground)) / 6 + 2 * np.array(sky.horizon) / 3
    lit = np.array(key.irradiance) / math.pi + turned  # a wall that faces the key light
    np.testing.assert_allclose(lit / turned, 5, rtol=0.15)  # four parts of key to one of fill
    dark, _, dome = lights("studio", key=const(0.0), fill=const(2.0))
    assert dark.irradiance == (0, 0, 0)
    assert dome.zenith == pytest.approx([2 * c for c in sky.zenith])


def test_named_metals_reflect_as_they_do_and_other_names_are_colors(tmp_path):
    """Gold by its index of refraction is warm (a red of 1, a blue of 0.3), where CSS's is a lemon without blue."""
    (tmp_path / "scene.yaml").write_text(
        "objects: {a: {sphere: {material: gold}}, b: {sphere: {material: {metal: {color: tomato}}}}}\n"
        "materials: {gold: {metal: {color: gold}}}\n"
    )
    graph = load(tmp_path / "scene.yaml")
    (moment,) = simulate(graph, [0.0])
    gold, tomato = (shape.surface.color for shape in moment.lower(["a", "b"]))
    assert gold == pytest.approx((1.0, 0.71, 0.29), abs=0.01)
    assert tomato == pytest.approx(linear([1, 99 / 255, 71 / 255]))
    (tmp_path / "scene.yaml").write_text("materials: {odd: {metal: {color: gould}}}\nobjects: {a: sphere}\n")
    with pytest.raises(ScriptError, match="did you mean 'gold'"):
        load(tmp_path / "scene.yaml")
