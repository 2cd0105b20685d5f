"""Colors as scripts write them, against an imaging library's table."""

import pytest
from PIL import ImageColor

from sceneql.compiler.css_colors import NAMED, css_color


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
