"""Texts with values inside, labels, formulas: words in pictures."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from runs import complaint
from sceneql.kinds.texts import written
from sceneql.pipeline import Report, Tools, load, simulate
from sceneql.quantities.diagnostic import ScriptError

SCENE = """
clock: {{end: 4 s, fps: 5}}
objects:
  ball: {{sphere: {{position: 0.5 0.25 0 m, radius: 0.2 m, material: {{glow: {{color: red}}}}}}}}
  up: {{arrow: {{at: -0.5 0 0 m, vector: 0 0.5 0, material: {{glow: {{color: red}}}}{arrow}}}}}
cameras: {{plan: {{orthographic: {{look_along: -z, look_at: 0 0 0 m, height: 2 m}}}}}}
background: black
overlays: {overlays}
outputs: {{film: {{image: {{size: 320 180}}}}}}
"""


def loaded(folder, overlays="{}", arrow=""):
    path = folder / "scene.yaml"
    path.write_text(SCENE.format(overlays=overlays, arrow=arrow), encoding="utf-8")
    return load(path)


def picture(graph, folder, time=1.0):
    (moment,) = simulate(graph, [time])
    return Tools(graph, "film", Report(), folder / "it").pixels(graph.tasks["film"].kind, moment).astype(int)


def said(folder, text, time=1.0):
    graph = loaded(folder, f"{{say: {{caption: {{text: {text}}}}}}}")
    (moment,) = simulate(graph, [time])
    return graph.tasks["say"].kind.text.at(moment)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("Hello", "Hello"),
        ('"t = {time:.2f s}"', "t = 1.00 s"),
        ('"{time:.0f ms}, {2*time}"', "1000 ms, 2 s"),
        ('"{ball.position.x:.1f cm}!"', "50.0 cm!"),
        ('"{{x}} = {3}"', "{x} = 3"),
        ('"{1e-13*time/(1 s):.0e}"', "1·10⁻¹³"),
        ('"{0 - time:.1f s}"', "−1.0 s"),
        ('"{0/0}"', "–"),
        ('"{final(time):.2f s} of it"', "1.00 s of it"),
        ('"\\"{time:.1f s}\\" \\u03b1"', '"1.0 s" α'),
    ],
)
def test_a_text_tells_its_values(tmp_path, text, expected):
    assert said(tmp_path, text) == expected


@pytest.mark.parametrize("text", ["a {} b", "a { } b", "a {   } b", "{  :.2f}", "{ : s}"])
def test_a_value_that_is_missing_in_a_text_has_its_place_between_the_braces(tmp_path, text):
    with pytest.raises(ScriptError) as error:
        said(tmp_path, f'"{text}"')
    (told,) = error.value.diagnostics
    source = told.span.source.text
    assert told.code == "missing-value"
    assert told.span.start == told.span.end
    assert source.index(text) + text.index("{") < told.span.start <= source.index(text) + text.index("}")


@given(st.floats(-1e12, 1e12), st.sampled_from([".12g", ".9e", ".3f", "+.10g"]))
def test_a_number_is_read_back_from_what_is_written(number, form):
    text = written(number, form, None).replace("\u2212", "-").replace("·10", "e")
    text = text.translate(str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-"))
    assert float(text) == pytest.approx(number, rel=1e-8, abs=6e-4 if form == ".3f" else 1e-300)


@pytest.mark.parametrize(
    ("text", "message", "column"),
    [
        ('"a {tine:.2f s}"', "did you mean 'time'", 38),
        ('"a {time:.2f kg}"', "which kg is no unit of", 47),
        ('"a {time:.2f sq}"', "unknown-unit", 47),
        ('"a {time"', "has no partner", 37),
        ('"a } b"', "has no partner", 37),
        ('"a {ball.position}"', "single values", 38),
        ('"a {}"', "a value is missing", 38),
    ],
)
def test_what_cannot_be_told_is_refused_where_it_stands(tmp_path, text, message, column):
    told = complaint(tmp_path, SCENE.format(overlays=f"{{say: {{caption: {{text: {text}}}}}}}", arrow=""))
    assert message in told
    assert f"scene.yaml:8:{column}" in told


def test_an_overlay_may_be_there_for_a_while(tmp_path):
    graph = loaded(tmp_path, "{say: {caption: {text: Hi, show: abs(time - 2 s) < 0.5 s}}}")
    plain = loaded(tmp_path)
    for time, there in ((1.0, False), (1.6, True), (2.4, True), (2.6, False)):
        assert (picture(graph, tmp_path, time) != picture(plain, tmp_path, time)).any() == there


def test_a_label_stands_over_its_part_and_a_tip_has_its_own(tmp_path):
    plain = picture(loaded(tmp_path), tmp_path)
    told = picture(loaded(tmp_path, "{names: {labels: {of: {ball: a ball}, panel: 1}}}"), tmp_path)
    rows, columns = np.nonzero((plain != told).any(axis=2))
    assert columns.mean() == pytest.approx(160 + 45, abs=2)  # 90 pixels are a meter
    assert 35 < rows.max() < 90 - 0.45 * 90  # above the ball's top
    below = picture(loaded(tmp_path, "{names: {labels: {of: {ball: a ball}, place: below}}}"), tmp_path)
    assert np.nonzero((plain != below).any(axis=2))[0].min() >= 90 - 0.05 * 90
    tip = picture(loaded(tmp_path, arrow=", label: v"), tmp_path)
    rows, columns = np.nonzero((plain != tip).any(axis=2))
    assert columns.mean() == pytest.approx(160 - 45, abs=2)
    assert rows.mean() == pytest.approx(90 - 45 - 4, abs=4)


def test_a_label_of_nothing_is_refused(tmp_path):
    told = complaint(tmp_path, SCENE.format(overlays="{names: {labels: {of: {bal: a ball}}}}", arrow=""))
    assert "did you mean 'ball'" in told
    assert "scene.yaml:8:" in told


def test_a_formula_is_printed_and_one_that_is_none_is_refused(tmp_path):
    plain = picture(loaded(tmp_path), tmp_path)
    told = picture(loaded(tmp_path, r"{law: {formula: {tex: 'a = \frac{m}{r^2}', panel: 0}}}"), tmp_path)
    assert (plain != told).any(axis=2)[:60, :120].sum() > 60
    with pytest.raises(ScriptError, match="expected '}'"):
        loaded(tmp_path, r"{law: {formula: {tex: '\frak{'}}}")


def test_a_label_stands_over_the_surface_of_an_implicit_object_and_not_over_its_bounds(tmp_path):
    blob = "implicit: {{field: x^2 + y^2 + z^2 - 0.04, bounds: {{ball: 0.8}}}}"
    (tmp_path / "scene.yaml").write_text(
        SCENE.replace(
            "sphere: {{position: 0.5 0.25 0 m, radius: 0.2 m, material: {{glow: {{color: red}}}}}}", blob
        ).format(overlays="{names: {labels: {of: {ball: a ball}, panel: 1, show: time > 1 s}}}", arrow="")
    )
    plain, told = (picture(load(tmp_path / "scene.yaml"), tmp_path, time) for time in (1.0, 2.0))
    rows, _ = np.nonzero((plain != told).any(axis=2))
    assert 90 - 0.5 * 90 < rows.max() < 90 - 0.2 * 90
