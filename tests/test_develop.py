"""Laws of development: script colors come back, gray stays gray, more light is never darker, no bands."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from renderers.develop import develop


def linear(code):
    """Linear light of an sRGB code value 0..255."""
    c = np.asarray(code) / 255
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def flat(*color, size=16):
    return np.broadcast_to(np.array(color, dtype=np.float32), (size, size, 3)).copy()


@pytest.mark.parametrize("code", [0, 1, 10, 64, 128, 186, 200])
def test_a_script_color_up_to_light_tones_comes_back_as_written(code):
    pixels = develop(flat(*[linear(code)] * 3)).astype(int)
    assert np.abs(pixels - code).max() <= 1
    assert abs(pixels.mean() - code) < 0.55


def test_a_saturated_color_keeps_its_hue():
    pixels = develop(flat(*(1.5 * linear([255, 99, 71]))))[0, 0].astype(float)
    ratio = linear(pixels) / linear(pixels).max()
    assert ratio == pytest.approx(linear([255, 99, 71]), abs=0.12)


@given(st.floats(0, 1e6), st.floats(0, 1e6), st.integers(0, 2))
def test_more_light_is_never_darker(a, b, channel):
    color = [0.3, 0.2, 0.1]
    color[channel] = min(a, b)
    low = develop(flat(*color, size=1))[0, 0, channel]
    color[channel] = max(a, b)
    assert develop(flat(*color, size=1))[0, 0, channel] >= low


@given(st.floats(0, 1e4))
def test_gray_stays_gray(light):
    pixels = develop(flat(light, light, light, size=8))
    assert (pixels == pixels[..., :1]).all()


def test_dither_carries_the_part_between_two_levels():
    for part in (0.1, 0.25, 0.5, 0.9):
        light = linear(100 + part)
        assert develop(flat(light, light, light))[..., 0].mean() == pytest.approx(100 + part, abs=0.03)


def test_a_soft_gradient_has_no_bands():
    ramp = np.repeat(linear(np.linspace(100, 104, 512))[None, :, None], 3, axis=2).astype(np.float32)
    pixels = develop(np.repeat(ramp, 16, axis=0))[..., 0].astype(float)
    columns = pixels.reshape(16, 32, 16).mean(axis=(0, 2))
    assert np.abs(np.diff(columns) - 4 / 32).max() < 0.04


def test_exposure_counts_stops():
    assert np.array_equal(develop(flat(0.05, 0.1, 0.2), exposure=1.0), develop(flat(0.1, 0.2, 0.4)))


def test_what_is_no_number_is_black_and_endless_light_is_white():
    assert (develop(flat(np.nan, -1.0, -np.inf)) == 0).all()
    assert (develop(flat(np.inf, np.inf, np.inf)) == 255).all()


def test_data_is_not_developed():
    assert develop(flat(0.0, 0.5, 1.0), exposure=3.0, data=True)[0, 0].tolist() == [0, 128, 255]
