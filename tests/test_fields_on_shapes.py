"""Fields whose domains are bodies of blobs, paths of files and pictures, as they are drawn."""

from __future__ import annotations

import imageio.v3 as iio
import numpy as np
import pytest

from sceneql.grids.maps.colors import colored
from sceneql.grids.maps.iso_mesh import meshed
from sceneql.pipeline import load
from sceneql.run.run import Run

BODY = """
clock: {end: 1 s, fps: 10}
models:
  heat: {diffusion: {domain: body, cell: 0.05 m, of: number, coefficient: "1e-6", initial: 1 + x}}
objects:
  body:
    blobby:
      {points: [[-0.3 m, 0 m, 0 m], [0.3 m, 0 m, 0 m]], segments: [[0, 1]], radius: 0.6 m, threshold: 0.2, hidden: yes}
  map: {field_map: {of: heat.concentration, range: 0 2}}
  cut: {iso_surface: {of: heat.concentration, at: 1.1}}
solvers: {main: {ftcs: {step: 0.1 s}}}
outputs: {film: {image: {size: 64 32}}}
"""


def test_a_body_of_blobs_is_a_domain_and_its_field_is_seen_on_it(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(BODY, encoding="utf-8")
    (moment,) = Run(load(path)).moments([0.0])
    assert moment.read("heat", "mass") == pytest.approx(moment.read("body", "volume"), rel=5e-3)
    radius = 0.6 * np.sqrt(1 - 0.2 ** (1 / 3))
    (mesh,) = moment.lower(["map"])
    beside = np.maximum(abs(mesh.vertices[:, 0]) - 0.3, 0.0)
    assert np.sqrt(beside**2 + (mesh.vertices[:, 1:] ** 2).sum(axis=1)) == pytest.approx(radius, abs=2e-3)
    np.testing.assert_allclose(mesh.colors, colored(1 + mesh.vertices[:, 0], (0, 2), "viridis"), atol=0.02)
    (disk,) = (meshed(shape) for shape in moment.lower(["cut"]))
    assert disk.vertices[:, 0] == pytest.approx(0.1, abs=1e-4)
    assert np.hypot(*disk.vertices[:, 1:].T).max() == pytest.approx(radius, abs=4e-3)


POND = """
clock: {end: 1 s, fps: 10}
models: {pond: {diffusion: {domain: shore, cell: 0.05 m, of: number, coefficient: "1e-6", initial: x}}}
objects:
  shore: {outline: {file: FILE, width: 2 m, hidden: yes}}
  map: {field_map: {of: pond.concentration, range: 0 2, height: 0.5 m, contours: 1.5}}
solvers: {main: {ftcs: {step: 0.1 s}}}
outputs: {film: {image: {size: 64 32}}}
"""


@pytest.mark.parametrize("file", ["shape.svg", "shape.png"])
def test_fields_in_outlines_of_files_are_drawn_as_maps_hills_and_lines(tmp_path, file):
    path = tmp_path / "scene.yaml"
    circle = '<circle id="big" cx="50" cy="50" r="40"/><circle id="rock" cx="50" cy="50" r="10"/>'
    (tmp_path / "shape.svg").write_text(f'<svg xmlns="http://www.w3.org/2000/svg">{circle}</svg>', encoding="utf-8")
    y, x = np.mgrid[0:200, 0:200] - 99.5
    light = np.clip(80.5 - np.hypot(x, y), 0, 1) * np.clip(np.hypot(x, y) - 19.5, 0, 1)
    iio.imwrite(tmp_path / "shape.png", np.round(255 * light).astype(np.uint8))
    path.write_text(POND.replace("FILE", file), encoding="utf-8")
    (moment,) = Run(load(path)).moments([0.0])
    mesh, lines = moment.lower(["map"])
    away = np.hypot(mesh.vertices[:, 0] - 1, mesh.vertices[:, 1] - 1)
    assert away.max() == pytest.approx(1, abs=0.01)
    assert away.min() == pytest.approx(0.25, abs=0.01)
    inner = away < 0.95
    assert mesh.vertices[inner, 2] == pytest.approx(0.5 * mesh.vertices[inner, 0], abs=0.01)
    ends = lines.ends.reshape(-1, 3)
    assert ends[:, 0] == pytest.approx(1.5, abs=5e-3)
    assert abs(ends[:, 1] - 1).max() == pytest.approx(np.sqrt(1 - 0.5**2), abs=0.02)
