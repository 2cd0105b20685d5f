"""A formula of which rounding alone decides the sign: the time of a frame is bounded, and the run says why."""

import time

import pytest

from sceneql import pipeline

SCENE = """
objects:
  thing:
    implicit:
      field: "(x+1e8)^2-2e8*x-1e16+y^2+z^2-0.5"
      bounds: {ball: 1}
cameras: {eye: {orthographic: {look_along: -0.5 -0.4 -0.75, look_at: 0 0 0 m, height: 2.2 m}}}
outputs: {still: {image: {size: 96 54, renderer: tracer}}}
renderers: {tracer: {trace: {samples: 1}}}
"""
BOUND = 12.0
"""Seconds of processor time; without a budget each of some 2,000 rays takes 16 ms several times."""


@pytest.fixture
def graph(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE, encoding="utf-8")
    return pipeline.load(path)


def test_what_rounding_decides_takes_bounded_time_and_is_told_at_its_line(graph, tmp_path, monkeypatch):
    pictures = []
    for threads in ("1", "2"):
        monkeypatch.setenv("SCENEQL_THREADS", threads)
        folder = tmp_path / threads
        folder.mkdir()
        report = pipeline.render(graph, folder=folder)  # the first may compile: the second is timed
        pictures.append(next(folder.glob("*.png")).read_bytes())
    start = time.process_time()
    report = pipeline.render(graph, folder=tmp_path)
    assert time.process_time() - start < BOUND
    assert pictures[0] == pictures[1]
    (undecided,) = report.undecided["still"].values()
    assert undecided > 0
    (told,) = [one for one in report.warnings if "rounding alone" in (one.help or "")]
    assert told.span.line == 5
