"""Implicit surfaces that cannot be, or are nowhere: each gets a message with its line, and none a crash."""

from __future__ import annotations

import pytest

from sceneql import pipeline
from sceneql.failure import LimitRefused, RunFailure
from sceneql.quantities.diagnostic import ScriptError

SCENE = """\
sceneql: 1
objects:
  a: {%s}
outputs: {still: {image: {size: 16 9, renderer: normals}}}
"""


def rendered(tmp_path, entry):
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE % entry)
    return pipeline.render(pipeline.load(path), output=tmp_path / "still.png")


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ('implicit: {field: "sqrt(-1 - x^2)"}', "defined nowhere in its bounds"),
        ('implicit: {field: "log(-1 - x^2)", mode: surface}', "defined nowhere in its bounds"),
        ('implicit: {field: "log(x - x)"}', "nowhere finite"),
        ('implicit: {field: "log(-1 - x^2 - y^2)", mode: surface}', "defined nowhere"),
        ('implicit: {field: "x + 1/0"}', "not finite"),
        ('implicit: {field: "1e400*x"}', "too large"),
        ('implicit: {field: "x", bounds: {ball: 1e308}}', "unbounded"),
        ('implicit: {field: "x", bounds: {ball: 1e300}}', "more than 1e.100 m"),
        ('implicit: {field: "x - 0.1", mode: surface, unit: 4e180 m}', "more than 1e.100 m"),
        ('implicit: {field: "x", position: 0 -2e120 0 m, unit: 1e110 m}', "more than 1e.100 m"),
        ('implicit: {field: "x^2 + y^2 + z^2 - 1", unit: 1e-200 m}', "less than 1e-100 m"),
        ("sphere: {radius: 1e160 m}", "more than 1e.100 m"),
        ("sphere: {color: 1e300 0 0}", "the numbers of a color are from 0 to 1"),
        ("sphere: {color: hue(1e308*100)}", "the numbers of a color are from 0 to 1"),
        ("box: {size: 1e-200 1e-200 1e-200 m}", "less than 1e-100 m"),
        ("torus: {radius: 1e200 m}", "more than 1e.100 m"),
        ("blobby: {points: [0 0 0 m], radius: 1e150 m}", "more than 1e.100"),
        ("blobby: {points: [1e200 0 0 m, -1e200 0 0 m]}", "more than 1e.100"),
        ("blobby: {points: [1e11 0 0 m]}", "numbers are 1.5e-05 m apart"),
        ("torus: {position: 0 1e11 0 m}", "numbers are 1.5e-05 m apart"),
        ("blobby: {skeleton: [{polyline: [0 0 0 m, 0 1e20 0 m]}]}", "radius reaches 1e.20 m away from the origin"),
        ("blobby: {skeleton: [{spline: [0 0 0 m, 1 0 0 m], radius: [1 m, 0.19 Pm]}]}", "has a radius of .* m apart"),
        ("blobby: {points: [0 0 0 m, 1 0 0 m], weight: [1e308, 1e308]}", "more than 1e.100"),
        ("blobby: {points: [0 0 0 m], threshold: 1e-300}", "at least 1e-09"),
        ("blobby: {skeleton: [{radius: 1 m}]}", "one of point, points"),
        ("blobby: {skeleton: [{point: 0 0 0 m, points: [0 0 0 m]}]}", "not point and points"),
        ("blobby: {skeleton: [{points: [0 0 0 m, 1 0 0 m, 0 1 0 m], triangles: [0 1 1.5]}]}", "a whole one"),
        ("blobby: {points: [0 0 m]}", "a list of points, not a list of vectors of 2"),
        ("blobby: {skeleton: [{segments: [[0 0 0 m]]}]}", "pairs of points, not a list of lists of 1 vectors"),
        ("union: {of: [{sphere: {radius: 1 m}}, {plane: {}}]}", "unbounded"),
        ("intersection: {of: [{plane: {}}, {plane: {position: 0 1 0}}]}", "unbounded"),
    ],
)
def test_what_cannot_be_drawn_is_refused_at_its_place(tmp_path, entry, message):
    with pytest.raises((RunFailure, ScriptError, LimitRefused), match=message) as failure:
        rendered(tmp_path, entry)
    assert "scene.yaml:3:" in str(failure.value)


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ('implicit: {field: "x^2 + y^2 + z^2 + 1"}', "nowhere negative"),
        ('implicit: {field: "x^2 + y^2 + z^2 + 1", mode: surface}', "nowhere zero"),
        ('implicit: {field: "log(x - 2) + t"}', "nowhere negative"),
        ("intersection: {of: [{sphere: {}}, {sphere: {position: 5 0 0 m}}]}", "empty whenever"),
        ("group: {children: {b: {blobby: {points: [0 0 0 m], weight: -1}}}}", "empty whenever"),
        ("blobby: {points: [0 0 0 m], weight: 0}", "empty whenever"),
        ('implicit: {field: "exp(1000*x + 2000) - 1"}', "nowhere negative"),
        ('implicit: {field: "exp(1000*x + 2000) - exp(999*x + 2000)"}', "nowhere finite"),
        ('implicit: {field: "1/(x - x)"}', "nowhere finite"),
        ('implicit: {field: "exp(exp(10 + x^2))", mode: surface}', "nowhere zero"),
        ("polygonised: {of: {sphere: {}}, cell: 10 m}", "smaller than its cells"),
        ("polygonised: {of: {blobby: {points: [0 0 0 m]}}, cell: 10 m}", "smaller than its cells"),
    ],
)
def test_what_is_nowhere_is_told_with_its_place(tmp_path, entry, message):
    (warning,) = rendered(tmp_path, entry).warnings
    assert message in warning.message
    assert warning.span is not None
    assert warning.span.line == 3


def test_what_is_drawn_as_triangles_is_there(tmp_path):
    many = "group: {children: [{implicit: {field: 'x^2 + y^2 + z^2 - 0.5'}}, {sphere: {position: 1 0 0 m}}]}"
    assert rendered(tmp_path, f"polygonised: {{of: {{{many}}}, edges: no}}").warnings == ()


@pytest.mark.parametrize("renderer", ["trace", "normals"])
@pytest.mark.parametrize(
    "formula",
    [
        "(1e200*x)^2 + (1e200*y)^2 + (1e200*z)^2 - 1e300",
        "max(x^2 + y^2 + z^2 - 0.9, (1e200*x)*(1e200*y))",
        "max(x^2 + y^2 + z^2 - 0.9, 1e160*x^2 - 1e160)",
    ],
)
def test_coefficients_that_overflow_are_no_clips(tmp_path, formula, renderer):
    path = tmp_path / "scene.yaml"
    path.write_text((SCENE % f'implicit: {{field: "{formula}"}}').replace("normals", renderer))
    assert pipeline.render(pipeline.load(path), output=tmp_path / "still.png").frames == 1


def test_values_that_overflow_in_a_part_of_the_bounds_do_no_harm(tmp_path):
    report = rendered(tmp_path, 'implicit: {field: "exp(1000*x) - exp(1000*(y - 2))"}')
    assert report.frames == 1


GROWS = """\
sceneql: 1
clock: {end: 0.3 s, fps: 10}
objects:
  a: {blobby: {points: [0 0 0 m], weight: 5*(time - 0.15 s)/(1 s)}}
outputs: {film: {images: {size: 16 9, renderer: normals}}}
"""


def test_what_comes_later_was_there(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(GROWS.replace("5*(", "20*("))
    assert pipeline.render(pipeline.load(path), folder=tmp_path).warnings == ()
    path.write_text(GROWS.replace("0.15 s", "0.5 s"))
    (warning,) = pipeline.render(pipeline.load(path), folder=tmp_path).warnings
    assert warning.code == "empty-solid"
