"""`bench` of implicit surfaces: true distances of meshes, errors that fall, and what fixed samples miss."""

from __future__ import annotations

import csv
import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sceneql import pipeline
from sceneql.failure import RunFailure, Unsuitable
from sceneql.mesh.distance import distances, hausdorff, to_triangles
from sceneql.report import surface_measures
from sceneql.report.bench import bench

NUMBERS = st.floats(-2.0, 2.0).map(lambda number: round(number, 3))
POINTS = st.tuples(NUMBERS, NUMBERS, NUMBERS).map(np.array)


@settings(max_examples=60)
@given(POINTS, POINTS, POINTS, POINTS)
def test_the_distance_to_a_triangle_is_the_least_of_all_its_points(point, a, b, c):
    found = to_triangles(point, np.stack([a, b, c]))
    u, v = (grid.ravel() for grid in np.meshgrid(*[np.linspace(0.0, 1.0, 41)] * 2))
    u, v = u[u + v <= 1.0], v[u + v <= 1.0]
    sampled = np.linalg.norm(a + u[:, None] * (b - a) + v[:, None] * (c - a) - point, axis=1).min()
    reach = max(np.linalg.norm(b - a), np.linalg.norm(c - a)) / 40
    assert sampled - 2.0 * reach <= found <= sampled + 1e-9


def square(height=0.0, side=1.0, count=8):
    """A mesh of a horizontal square."""
    ticks = np.linspace(0.0, side, count + 1)
    x, y = np.meshgrid(ticks, ticks, indexing="ij")
    vertices = np.stack([x, y, np.full_like(x, height)], axis=-1).reshape(-1, 3)
    first = (np.arange(count)[:, None] * (count + 1) + np.arange(count)).ravel()
    quads = np.stack([first, first + count + 1, first + count + 2, first, first + count + 2, first + 1], axis=1)
    return vertices, quads.reshape(-1, 3)


def test_hausdorff_distances_of_squares():
    assert hausdorff(square(), square(count=5)) == pytest.approx(0.0, abs=1e-15)
    assert hausdorff(square(), square(0.3)) == pytest.approx(0.3)
    assert hausdorff(square(), square(side=2.0)) == pytest.approx(2**0.5)
    assert hausdorff(square(), (np.empty((0, 3)), np.empty((0, 3), dtype=int))) == np.inf
    assert distances(np.array([[0.5, 0.5, 2.0]]), *square())[0] == pytest.approx(2.0)


SCENE = """\
sceneql: 1
objects:
  torus: {torus: {radius: 0.5 m, tube: 0.2 m}}
  shell: {implicit: {field: "abs(sqrt(x^2 + y^2 + z^2) - 0.3) - 0.002", bounds: {ball: 0.4}, position: 1.2 0 0}}
  sheet: {implicit: {field: "(x^2 + y^2 + z^2 - 0.09)^2", bounds: {ball: 0.4}, mode: surface, position: -1.2 0 0}}
outputs: {still: {image: {size: 64 36}}}
"""


def rows(path):
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


@pytest.mark.long
def test_rays_and_meshes_are_measured(tmp_path, monkeypatch):
    monkeypatch.setattr(surface_measures, "SIZES", (576, 2_304, 60_000))
    monkeypatch.setattr(surface_measures, "CELLS", (32, 64, 128))
    monkeypatch.setattr(surface_measures, "SAMPLES", (16, 64, 256))
    monkeypatch.setattr(surface_measures, "REPEATS", 1)
    (tmp_path / "scene.yaml").write_text(SCENE)
    text = bench(pipeline.load(tmp_path / "scene.yaml"), tmp_path)
    rays, meshes = rows(tmp_path / "scene.bench.rays.csv"), rows(tmp_path / "scene.bench.meshes.csv")
    traced = [run for run in rays if run["renderer"] == "trace" and float(run["setting"]) <= 1e-7]
    assert len(traced) == 6
    assert all(int(run["wrong"]) == 0 and float(run["largest_depth_error"]) < 1e-9 for run in traced)
    assert list(dict.fromkeys((run["width"], run["height"]) for run in rays)) == [("32", "18"), ("64", "36")]
    for width in ("32", "64"):
        # March never sees the sheet, which is a third of the picture, and tears the shell.
        marched = [run for run in rays if run["renderer"] == "march" and run["width"] == width]
        wrong = [int(run["wrong"]) for run in marched]
        assert wrong == sorted(wrong, reverse=True)
        assert wrong[-1] > 0.1 * int(marched[0]["pixels"])
    assert {run["name"] for run in meshes} == {"torus", "shell"}
    torus = [run for run in meshes if run["name"] == "torus"]
    assert [int(run["euler"]) for run in torus] == [0, 0, 0]
    volume = 2 * np.pi**2 * 0.5 * 0.2**2
    errors = [abs(float(run["volume"]) / volume - 1.0) for run in torus]
    assert np.diff(np.log2(errors)) == pytest.approx(-2.0, abs=0.1)
    assert [float(run["volume_error"]) for run in torus] == pytest.approx(errors, rel=0.05)
    gaps = [float(run["hausdorff"]) for run in torus]
    assert gaps[0] > 2.0 * gaps[1] > 0.0
    assert np.isnan(gaps[2])
    found = json.loads((tmp_path / "scene.bench.json").read_text())["surfaces"]
    assert (len(found["rays"]), len(found["meshes"])) == (len(rays), len(meshes))
    page = (tmp_path / "scene.bench.html").read_text()
    assert "Implicit surfaces" in page
    assert "<h2>Meshes</h2>" in page
    assert "wrong pixels" in text


def test_a_scene_of_neither_has_nothing_to_measure(tmp_path):
    (tmp_path / "scene.yaml").write_text("sceneql: 1\nobjects: {ball: sphere}\n")
    with pytest.raises(Unsuitable, match="nothing to measure"):
        bench(pipeline.load(tmp_path / "scene.yaml"), tmp_path)


def test_what_is_nowhere_is_told_at_its_line_and_not_measured(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text("""sceneql: 1
objects:
  none: {implicit: {field: x^2 + 1}}
outputs: {still: {image: {size: 16 9}}}
""")
    with pytest.raises(RunFailure, match="nothing of it is there to measure: its field is nowhere negative") as failure:
        bench(pipeline.load(path), tmp_path)
    assert "scene.yaml:3:3" in str(failure.value)
