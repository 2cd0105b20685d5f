"""Solids that have nothing in their bounds: proved, never guessed, and told with their line."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshes import tape_of as plain_tape
from moment import IDENTITY, FakeMoment, const, formula
from sceneql import pipeline
from sceneql.failure import RunFailure
from sceneql.field.tape.emptiness import nowhere_defined, proved_empty, why_empty
from sceneql.field.tape.tape_solid import field_values
from sceneql.shapes.solid import traced
from sceneql.words.objects.implicit import Implicit, Within

LEVEL = st.floats(-2.0, 2.0)


def tape_of(text, bounds=None):
    (shape,) = traced(Implicit(field=formula(text), bounds=bounds or Within(ball=1.0)), "a", IDENTITY, FakeMoment())
    return shape.tape, shape.low, shape.high


@settings(max_examples=60)
@given(LEVEL, st.floats(0.3, 3.0), st.floats(0.3, 3.0), st.booleans())
def test_what_is_proved_empty_has_no_point_inside(level, a, b, pole):
    text = f"sin({a}*x)*cos({b}*y) + z^2/2 + {level}" + (f" + sqrt(x + {a} - 1)" if pole else "")
    tape, low, high = tape_of(text)
    points = np.random.default_rng(7).uniform(low, high, (2000, 3))
    values = field_values(tape, points)
    if proved_empty(tape, low, high):
        assert not (values < -1e-12).any()
    if nowhere_defined(tape, low, high):
        assert np.isnan(values).all()


@settings(max_examples=40)
@given(st.tuples(*[st.floats(-0.5, 0.5)] * 3), st.floats(0.01, 0.4))
def test_a_small_ball_anywhere_is_not_empty(center, radius):
    x, y, z = center
    tape, low, high = tape_of(f"(x - ({x}))^2 + (y - ({y}))^2 + (z - ({z}))^2 - {radius}^2")
    assert not proved_empty(tape, low, high)
    assert not nowhere_defined(tape, low, high)


@pytest.mark.parametrize("text", ["x^2 + y^2 + z^2 + 0.01", "x^2 + y^2 + z^2", "max(x, -x) + 1e-6", "sqrt(x - 1.1)"])
def test_what_is_nowhere_negative_is_proved_empty(text):
    assert proved_empty(*tape_of(text))


@pytest.mark.parametrize("power", [-250, -100, -20, 0, 20, 100, 290])
def test_how_large_a_field_is_proves_nothing(power):
    box = (-1.1,) * 3, (1.1,) * 3
    assert not proved_empty(plain_tape(f"1e{power}*(x^4 + y^4 + z^4 - 0.1)"), *box)
    assert proved_empty(plain_tape(f"1e{power}*(x^4 + y^4 + z^4 + 0.1)"), *box)
    assert not proved_empty(plain_tape("exp(x^2 + y^2 + z^2) - 1.001"), (-20.0,) * 3, (20.0,) * 3)


def test_bounds_beside_the_solid_hold_nothing():
    text = "x^2 + y^2 + z^2 - 1"
    assert proved_empty(*tape_of(text, Within(box=((0.8, 0.8, 0.8), (2.0, 2.0, 2.0)))))
    assert not proved_empty(*tape_of(text, Within(box=((0.5, 0.5, 0.5), (2.0, 2.0, 2.0)))))


@pytest.mark.parametrize("text", ["sqrt(-1 - x^2)", "log(x - 2)", "x + sqrt(y - 3)"])
def test_a_formula_that_is_defined_nowhere_cannot_be_drawn(text):
    with pytest.raises(RunFailure, match="defined nowhere in its bounds"):
        list(Implicit(field=formula(text)).lower("a", IDENTITY, FakeMoment()))


def test_a_formula_that_will_be_defined_later_can():
    later = Implicit(field=formula("sqrt(t - 1 - x^2) - 2"))
    assert len(list(later.lower("a", IDENTITY, FakeMoment()))) == 1
    assert (
        len(list(Implicit(field=formula("sqrt(x) - 2"), position=const((9, 0, 0))).lower("a", IDENTITY, FakeMoment())))
        == 1
    )


SCENE = """
clock: {end: 0.2 s, fps: 10}
objects:
  grows: {implicit: {field: x^2 + y^2 + z^2 - (t - 0.05)}}
  nothing:
    implicit: {field: x^2 + 1}
  pair: {group: {children: {apart: {intersection: {of: {
    a: {sphere: {radius: 0.2 m}}, b: {sphere: {radius: 0.2 m, position: 0.35 0.2 0 m}}}}}}}}
cameras: {front: {perspective: {position: 0 0 4 m, look_at: 0 0 0 m}}}
outputs: {film: {images: {size: 16 9, renderer: normals}}}
"""


def test_a_film_warns_of_solids_that_it_never_shows(tmp_path):
    (tmp_path / "s.yaml").write_text(SCENE)
    report = pipeline.render(pipeline.load(tmp_path / "s.yaml"), folder=tmp_path)
    assert report.frames == 2
    assert [(w.code, w.severity, w.message.split("'")[1]) for w in report.warnings] == [
        ("empty-solid", "warning", "nothing"),
        ("empty-solid", "warning", "apart"),
    ]
    assert "s.yaml:5:" in str(report.warnings[0])


def test_a_formula_that_is_defined_nowhere_fails_at_its_own_place(tmp_path):
    scene = SCENE.replace("field: x^2 + 1", "field: sqrt(-1 - x^2)")
    (tmp_path / "s.yaml").write_text(scene)
    with pytest.raises(RunFailure) as failure:
        pipeline.render(pipeline.load(tmp_path / "s.yaml"), folder=tmp_path)
    assert failure.value.part == "nothing.field"
    assert failure.value.span.text == "sqrt(-1 - x^2)"


THIN = "(x^2 + y^2 + z^2 - 0.5)^2 - 1e-14"


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (THIN, ""),
        ("(x^2 + y^2 + z^2 - 0.5)^2", "nowhere negative"),
        ("x^2 + y^2 + z^2 - 1e-14", "shallower than 8e-13 wherever it is negative"),
        ("x^2 + y^2 + z^2 - 0.5", ""),
    ],
)
def test_a_solid_that_rays_meet_is_never_told_to_be_empty(text, told):
    assert why_empty(*tape_of(text)) == told


def test_a_shell_thinner_than_its_rounding_is_drawn_without_a_word(tmp_path):
    (tmp_path / "s.yaml").write_text(SCENE.replace("x^2 + 1", THIN))
    report = pipeline.render(pipeline.load(tmp_path / "s.yaml"), folder=tmp_path)
    assert [w.message.split("'")[1] for w in report.warnings] == ["apart"]
