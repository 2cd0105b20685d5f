"""`mode: surface`: sheets where a formula reaches its level, also where it only touches it."""

from __future__ import annotations

import numpy as np
import pytest

from moment import IDENTITY, FakeMoment, const, formula
from renderers.tracing.normals import draw_normals
from sceneql import pipeline
from sceneql.field.tape.emptiness import proved_rootless
from sceneql.frame import Implicit as Shape
from sceneql.words.objects.implicit import Implicit, Within
from stage import frame, view

SQUARED = "(x^2 + y^2 + z^2 - 0.49)^2"
FORMS = {
    "simple": "x^2 + y^2 + z^2 - 0.49",
    "double": SQUARED,
    "expanded": "(x^2 + y^2 + z^2)^2 - 0.98*(x^2 + y^2 + z^2) + 0.2401",
    "triple": "(x^2 + y^2 + z^2 - 0.49)^3",
    "below": f"-{SQUARED}",
}
SIZE = (64, 64)
BOX = Within(box=((-1, -1, -1), (1, 1, 1)))


def sheet(text, bounds=BOX, **more):
    (shape,) = Implicit(field=formula(text), bounds=bounds, mode="surface", **more).lower("a", IDENTITY, FakeMoment())
    return shape


def seen(shape):
    """(which pixels show something, the normals there, undecided pixels) by an orthographic view along -z, 2 m high."""
    picture = draw_normals(frame(shape, seen=view(size=SIZE, half_height=1.0)))
    shown = picture.linear.any(axis=2)
    return shown, 2.0 * picture.linear[shown].astype(float) - 1.0, picture.undecided


def places():
    """x and y of pixel centers."""
    u = 2.0 * (np.arange(SIZE[0]) + 0.5) / SIZE[0] - 1.0
    return np.meshgrid(u, -u)


@pytest.mark.parametrize("form", FORMS)
def test_every_pixel_of_a_root_of_any_multiplicity_is_seen_with_its_normal(form):
    shown, normals, undecided = seen(sheet(FORMS[form]))
    x, y = places()
    inside = x**2 + y**2 < 0.49
    assert (shown == inside).all()
    assert undecided == 0
    radial = np.stack([x, y, np.sqrt(np.maximum(0.49 - x**2 - y**2, 0))], axis=-1)[inside] / 0.7
    assert normals == pytest.approx(radial, abs=2e-4)


def test_a_double_root_is_nothing_as_a_solid():
    (solid,) = Implicit(field=formula(SQUARED), bounds=BOX).lower("a", IDENTITY, FakeMoment())
    assert solid.within is None
    shown, _, undecided = seen(solid)
    assert not shown.any()
    assert undecided == 0


def test_a_sheet_is_open_where_its_bounds_cut_it():
    """From the open side one looks at the inner side of a ball's lower half; a solid would be capped there."""
    x, y = places()
    half = Within(box=((-1, -1, -1), (1, 1, 0.1)))
    shown, normals, _ = seen(sheet(SQUARED, half))
    inside = x**2 + y**2 < 0.49
    assert (shown == inside).all()
    radial = np.stack([-x, -y, np.sqrt(np.maximum(0.49 - x**2 - y**2, 0))], axis=-1)[inside] / 0.7
    beyond = radial[:, 2] * 0.7 > 0.1  # else the ray meets the ring between the cut and the equator first
    assert normals[beyond] == pytest.approx(radial[beyond], abs=2e-4)


def test_a_sheet_ends_where_its_ball_does():
    shown, _, _ = seen(sheet("(z - 0.2*x)^2", Within(ball=0.5)))
    x, y = places()
    assert (shown == (x**2 + y**2 + (0.2 * x) ** 2 < 0.25)).all()


def test_a_sheet_goes_where_its_object_is_put():
    put = sheet(SQUARED, unit=0.5, position=const([0.3, -0.2, 0.1]))
    shown, _, _ = seen(put)
    x, y = places()
    assert (shown == ((x - 0.3) ** 2 + (y + 0.2) ** 2 < 0.35**2)).all()
    assert isinstance(put, Shape)


@pytest.mark.parametrize(("text", "none"), [("x^2 + 0.01", True), ("-x^2 - 0.01", True), ("x^2", False), ("x", False)])
def test_what_reaches_its_level_nowhere_is_told(text, none):
    shape = sheet(text)
    assert proved_rootless(shape.tape, shape.low, shape.high) == none


SCENE = """
sceneql: 1
objects:
  a: {implicit: {field: FIELD, bounds: {ball: 0.7}, mode: surface}}
cameras: {front: {orthographic: {look_along: 0 0 -1, height: 1.5 m}}}
outputs: {still: {image: {size: 48 27, renderer: PLAIN}}}
"""


def rendered(tmp_path, field, renderer="normals"):
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE.replace("FIELD", f'"{field}"').replace("PLAIN", renderer))
    return pipeline.render(pipeline.load(path), output=tmp_path / "still.png")


def test_a_surface_that_is_nowhere_is_warned_of(tmp_path):
    (warning,) = rendered(tmp_path, "x^2 + y^2 + z^2 + 1").warnings
    assert warning.code == "empty-solid"
    assert "nowhere zero" in warning.message
    assert rendered(tmp_path, "(x^2 + y^2 + z^2 - 0.1)^2").warnings == ()
