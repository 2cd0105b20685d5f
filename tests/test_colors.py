"""Colors as scripts write them, against an imaging library's table."""

import pytest
from PIL import ImageColor

from sceneql.compiler.css_colors import NAMED, css_color
from sceneql.pipeline import load
from sceneql.run.paints import painted
from sceneql.shapes.color import linear


def test_the_names_are_those_of_css():
    assert set(NAMED) == set(ImageColor.colormap)
    for name in NAMED:
        assert css_color(name) == pytest.approx([c / 255 for c in ImageColor.getrgb(name)], abs=1e-12)
        assert css_color(name.upper()) == css_color(name)


@pytest.mark.parametrize("text", ["#f80", "#ff8800", "#FF8800", "#09aF0c"])
def test_numbers_are_read_in_base_sixteen(text):
    assert css_color(text) == pytest.approx([c / 255 for c in ImageColor.getrgb(text)], abs=1e-12)


@pytest.mark.parametrize("text", ["", "#", "#ff", "#ff88", "#ff880080", "#gg0000", "#+1+1+1", "tomatoe", "rgb(1,2,3)"])
def test_anything_else_is_no_color(text):
    assert css_color(text) is None


def test_a_surface_gives_back_no_more_light_than_it_gets():
    assert linear([3, -1, 0.5]) == linear([1, 0, 0.5])


def test_colors_by_age_are_not_watched_by_the_time_of_the_film(tmp_path):
    (tmp_path / "scene.yaml").write_text("""
models:
  sparks: {particles: {emit: {rate: 5 Hz, lifetime: 0.5 s}, aging: {color: ["2*time/(1 s)", 0, 0]}, mass: 1 g}}
objects: {ball: {sphere: {color: ["2*time/(1 s)", 0, 0], position: 1 0 0 m}}}
""")
    assert [(one.part, one.field) for one in painted(load(tmp_path / "scene.yaml"))] == [("ball", "color")]
