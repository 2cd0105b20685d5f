"""The word `march`: what fixed samples see, what they miss, and that nothing else differs from `trace`."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from moment import IDENTITY, FakeMoment, formula
from renderers.march import March
from renderers.trace import Trace
from renderers.tracing import draw as tracer
from renderers.undecided import Undecided
from sceneql import pipeline
from sceneql.words.objects.implicit import Implicit, Within
from stage import GLOW, WHITE, frame, implicit_sphere, sun, torus, view

BOX = Within(box=((-1, -1, -1), (1, 1, 1)))
SHELL = "max(abs(sqrt(x^2 + y^2 + z^2) - 0.7) - 0.0005, 0.6*x + 0.8*z - 0.2)"


def lowered(text, mode="solid"):
    (shape,) = Implicit(field=formula(text), bounds=BOX, mode=mode).lower("a", IDENTITY, FakeMoment())
    return replace(shape, surface=GLOW)


def lit(shape, side=48):
    return frame(shape, lights=(sun((0.5, 0.7, 0.6)),), seen=view(size=(side, side), half_height=0.99))


def coverage(picture):
    """Share of the picture that glows."""
    return (picture.linear > 0.5).all(axis=2).mean()


def test_with_enough_samples_it_draws_what_trace_draws():
    for shape in (implicit_sphere(WHITE, 0.8), torus(WHITE, 0.6, 0.25)):
        marched, traced = (word.draw(lit(shape)).linear for word in (March(samples=400), Trace()))
        assert np.abs(marched - traced).mean() < 1e-4
        assert np.abs(marched - traced).max() < 0.1


def test_a_sheet_that_changes_its_sign_is_seen():
    marched, traced = (
        word.draw(lit(lowered("x^2 + y^2 + z^2 - 0.49", "surface"))).linear for word in (March(samples=200), Trace())
    )
    assert np.abs(marched - traced).mean() < 1e-4


def test_it_tears_a_thin_shell_that_trace_keeps_whole():
    shell = lit(lowered(SHELL))
    whole = coverage(Trace(samples=1).draw(shell))
    # The part of the sphere's disk that is seen: the cut takes nothing from it but bares the inside.
    assert whole == pytest.approx(np.pi * 0.7005**2 / 0.99**2 / 4, abs=0.01)
    holes = [1 - coverage(March(samples=samples).draw(shell)) / whole for samples in (101, 301, 901)]
    assert holes[0] > 0.8
    assert holes[0] > holes[1] > holes[2] > 0.05


def test_it_never_sees_a_double_root():
    double = lit(lowered("(x^2 + y^2 + z^2 - 0.49)^2", "surface"))
    assert coverage(March(samples=1000).draw(double)) == 0.0
    assert coverage(Trace(samples=1).draw(double)) == pytest.approx(np.pi * 0.49 / 0.99**2 / 4, abs=0.01)


def test_the_view_of_the_undecided_shows_where_they_are():
    # Where y > 0 the field is zero but for its rounding.
    noise = "(x + 1)^4 - x^4 - 4*x^3 - 6*x^2 - 4*x - 1 - min(y, 0)"
    picture = Undecided().draw(lit(lowered(noise), 12))
    orange = (picture.linear == np.array([1.0, 0.15, 0.0], dtype=np.float32)).all(axis=2)
    assert orange.sum() == picture.undecided > 0
    assert not orange[6:].any()
    assert orange[:6].all()
    clear = Undecided().draw(lit(implicit_sphere(WHITE, 0.8)))
    assert clear.undecided == 0
    y, x = np.mgrid[:48, :48]
    assert ((clear.linear[..., 0] > 0) == ((x - 23.5) ** 2 + (y - 23.5) ** 2 < (0.8 / 0.99 * 24) ** 2)).all()


def test_undecided_pixels_are_sampled_more(monkeypatch):
    """Walls that are only touched in the middle of every pixel: what is seen there is the same all over, and wrong."""
    walls = lit(lowered("abs(z) - 0.4*cos(pi*x*48/1.98)^2"))
    assert coverage(Trace(samples=8).draw(walls)) == 0.0  # where they are more than a few, nothing is gained by it
    monkeypatch.setattr(tracer, "DOUBTED", 1.0)
    picture = Trace(samples=1).draw(walls)
    assert picture.undecided == 48 * 48
    assert coverage(picture) == 0.0
    picture = Trace(samples=8).draw(walls)
    assert picture.undecided == 48 * 48
    assert coverage(picture) == pytest.approx(1.0, abs=0.01)


SCENE = """
sceneql: 1
objects:
  a: {implicit: {field: FIELD, bounds: {ball: 0.7}, mode: surface}}
outputs: {film: {images: {size: 16 9, renderer: undecided}}}
clock: {end: 0.1 s, fps: 20}
"""


def test_the_undecided_are_counted_by_frame(tmp_path):
    path = tmp_path / "scene.yaml"
    noise = "(x + 1)^4 - x^4 - 4*x^3 - 6*x^2 - 4*x - 1 + t"
    path.write_text(SCENE.replace("FIELD", f'"{noise}"'))
    report = pipeline.render(pipeline.load(path), folder=tmp_path)
    assert report.frames == 2
    assert list(report.undecided) == ["film"]
    assert list(report.undecided["film"]) == [0]
    assert report.undecided["film"][0] > 0
