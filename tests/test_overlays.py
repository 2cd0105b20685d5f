"""What is drawn over finished pictures: legends and captions."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from campaigns import examples
from runs import complaint
from sceneql.failure import RunFailure
from sceneql.frame import View
from sceneql.grids.maps.colors import colored
from sceneql.kinds.texts import shown_unit
from sceneql.pictures.anchors import projected
from sceneql.pictures.lettering import Letterer, round_numbers
from sceneql.pipeline import Report, Tools, load, simulate
from sceneql.quantities.diagnostic import ScriptError

SCENE = """
clock: {{end: 1 s, fps: 1}}
models:
  plate: {{diffusion: {{size: 2 1 m, cell: 0.1 m, coefficient: "0.001", initial: "x"}}}}
objects:
  map: {{field_map: {{of: plate.concentration, range: 0 2 g/L}}}}
  ball: sphere
solvers: {{main: {{ftcs: {{step: 0.1 s}}}}}}
lights: {{even: {{sky: {{color: white, background: white}}}}}}
cameras: {{plan: {{orthographic: {{height: 3 m, look_at: 1 0.5 0 m}}}}}}
overlays: {overlays}
outputs: {{film: {{image: {{size: 320 180, show: [map]}}}}}}
"""
LEGEND = "{bar: {legend: {of: map, unit: mg/L, panel: 1}}}"


def picture(folder, overlays):
    path = folder / "scene.yaml"
    path.write_text(SCENE.format(overlays=overlays), encoding="utf-8")
    graph = load(path)
    (moment,) = simulate(graph, [0.0])
    return Tools(graph, "film", Report(), folder / "it").pixels(graph.tasks["film"].kind, moment)


def srgb(linear):
    """Display numbers of linear ones, as the standard has them."""
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055) * 255


def test_a_legends_bar_has_the_colors_of_the_map_from_the_high_end_down(tmp_path):
    plain, told = picture(tmp_path, "{}"), picture(tmp_path, LEGEND)
    columns = np.flatnonzero((plain != told).any(axis=(0, 2)))
    assert columns.min() > 240
    found = told[:, columns.min() + 9].astype(float)
    bar = np.flatnonzero(np.ptp(found, axis=1) > 40)
    low = bar[len(bar) // 2 :]  # darker than where the tone curve begins
    place = (bar.max() + 0.5 - low) / len(bar)
    np.testing.assert_allclose(found[low], srgb(colored(place, (0.0, 1.0), "viridis")), atol=3.5)


@pytest.mark.parametrize(
    ("of", "title"),
    [("plate.concentration", "concentration"), ("-plate.concentration", ""), ("hot.concentration", "temperature")],
)
def test_a_legend_says_what_it_shows(tmp_path, of, title):
    hot = "hot: {diffusion: {size: 1 1 m, cell: 0.5 m, of: temperature, coefficient: 1e-3 m^2/s, initial: 300 K}}"
    script = SCENE.replace("ball: sphere", f"shown: {{{{field_map: {{{{of: {of}}}}}}}}}")
    said = script.format(overlays="{bar: {legend: {of: shown}}}").replace("models:", f"models:\n  {hot}")
    (tmp_path / "scene.yaml").write_text(said.replace("[map]", "[map, shown]"), encoding="utf-8")
    graph = load(tmp_path / "scene.yaml")
    (moment,) = simulate(graph, [0.0])
    legend = graph.tasks["bar"].kind
    small, large = (Letterer(np.zeros((9 * k, 16 * k, 3), dtype=np.uint8), legend.text) for k in (20, 60))
    unit = ["K"] if title == "temperature" else ["kg/m\u00b3"]
    assert legend._told(moment, large).lines == [title] * bool(title) + unit
    assert legend._told(moment, small).lines == unit
    assert legend.model_copy(update={"title": ""})._told(moment, large).lines == unit
    assert legend.model_copy(update={"title": "What there is"})._told(moment, small).lines == ["What there is", *unit]


def test_what_is_not_covered_stays_as_it_is(tmp_path):
    plain, told = picture(tmp_path, "{}"), picture(tmp_path, "{say: {caption: {text: Hi, place: bottom right}}}")
    changed = (plain != told).any(axis=2)
    assert changed[90:, 160:].sum() > 50
    assert not changed[:90].any()
    assert not changed[:, :160].any()


def test_a_legend_of_something_else_is_refused_with_its_line(tmp_path):
    with pytest.raises(ScriptError, match=r"shows no field in colors\n(.*\n)*help: write `of: map`"):
        picture(tmp_path, "{bar: {legend: {of: ball}}}")
    with pytest.raises(RunFailure, match=r"a density .*, which kg is no unit of"):
        picture(tmp_path, "{bar: {legend: {of: map, unit: kg}}}")
    told = complaint(tmp_path, SCENE.format(overlays="{bar: {legend: {of: map, unit: mgl}}}"))
    assert "unknown-unit" in told
    assert "scene.yaml:11:" in told


@given(st.floats(-1e3, 1e3), st.floats(1e-2, 1e6), st.integers(2, 20))
@settings(max_examples=examples(200))
def test_numbers_beside_a_bar_are_round_and_not_many(low, span, count):
    high = low + span
    found = round_numbers(low, high, count)
    steps = np.diff(found)
    assert len(found) <= count + 1
    assert len(found) >= count / 2.5 - 1
    assert all(low - 1e-6 * span <= value <= high + 1e-6 * span for value in found)
    if len(steps):
        digit = f"{steps[0]:.3e}"[0]
        assert digit in "125"


def test_a_unit_is_printed_with_raised_numbers():
    assert shown_unit("kg/m^3") == "kg/m³"
    assert shown_unit("m^2*s^-1") == "m²·s⁻¹"
    assert shown_unit("mg/L") == "mg/L"
    assert shown_unit("degC") == "°C"
    letters = Letterer(np.zeros((100, 100, 3), dtype=np.uint8), 0.2).font
    missing = bytes(letters.getmask("\ue000"))
    assert all(bytes(letters.getmask(sign)) != missing for sign in "³⁻¹·°\u2212µäñλ√ж")


def test_a_point_is_where_the_camera_sees_it():
    view = View((1.0, 2.0, 9.0), np.eye(3), (200, 100), 0.5)
    assert projected((1.0, 2.0, 0.0), view) == pytest.approx((100, 50))
    assert projected((1.0, 6.5, 0.0), view) == pytest.approx((100, 0))
    assert projected((1.0, 2.0, 9.5), view) is None


def test_letters_never_vanish():
    pixels = np.zeros((20, 60, 3), dtype=np.uint8)
    letters = Letterer(pixels, 0.01)
    letters.text((2, 10), "W", ink=(255, 255, 255))
    letters.done()
    assert pixels.max() > 200
