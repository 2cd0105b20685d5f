"""Trails, arrows and surfaces: what is drawn of motion."""

import numpy as np
import pytest

from runs import watch
from sceneql.failure import RunFailure
from sceneql.frame import Mesh, Points, Segments
from sceneql.pipeline import load
from sceneql.run.history import MOST
from sceneql.run.run import Run

SCENE = """
clock: {end: 2 s}
models:
  sky:
    particles:
      list: {moon: {position: 1 0 0 m, velocity: 0 2 0 m/s}, star: {position: 3 0 0 m}}
objects:
  way: {trail: {of: sky.positions, keep: 0.5 s, radius: 2 cm}}
  speed: {arrow: {at: sky.moon.position, vector: sky.moon.velocity, scale: 0.1}}
solvers: {main: {rk4: {step: 0.1 s}}}
"""


def shapes(folder, script, times, names):
    path = folder / "scene.yaml"
    path.write_text(script)
    return [(moment.time, moment.lower(names)) for moment in Run(load(path)).moments(times)]


def test_a_trail_is_the_way_of_its_points(tmp_path):
    ((_, (trail,)),) = shapes(tmp_path, SCENE, [1.7], ["way"])
    assert isinstance(trail, Segments)
    assert len(trail.ends) == 2 * 60
    moon = trail.ends[::2]
    np.testing.assert_allclose(moon[0, 0], [1, 2 * 1.2, 0], atol=1e-12)
    np.testing.assert_allclose(moon[-1, 1], [1, 2 * 1.7, 0], atol=1e-12)
    np.testing.assert_array_equal(moon[1:, 0], moon[:-1, 1])
    assert np.all(np.diff(trail.radii[::2]) > 0)
    assert trail.radii.max() < 0.02


def test_a_trail_has_more_corners_where_it_bends(tmp_path):
    """Of two points, one goes round six times a second: the other's pieces stay as long as they are."""
    script = SCENE.replace("sky.positions", "[[cos(6*a)*1 m, sin(6*a)*1 m, 0 m], [1 m/s*time, 0 m, 0 m]]")
    script = script.replace("clock:", "define: {a: 360 deg*time/(1 s)}\nclock:")
    ((_, (trail,)),) = shapes(tmp_path, script, [1.7], ["way"])
    straight = (trail.ends[..., 1] == 0.0).all(axis=1)
    assert straight.sum() == 60
    middles = trail.ends[~straight].mean(axis=1)
    assert len(middles) == 4 * 60
    assert np.abs(np.linalg.norm(middles, axis=1) - 1.0).max() < 1e-3


def test_a_trail_does_not_know_the_frame_rate(tmp_path):
    often = shapes(tmp_path, SCENE, [k / 30 for k in range(52)], ["way"])[-1]
    once = shapes(tmp_path, SCENE, [often[0]], ["way"])[-1]
    np.testing.assert_array_equal(often[1][0].ends, once[1][0].ends)
    np.testing.assert_array_equal(often[1][0].radii, once[1][0].radii)


def test_at_the_start_there_is_no_trail_yet(tmp_path):
    assert shapes(tmp_path, SCENE, [0.0], ["way"])[0][1] == []


def test_a_trail_of_an_item_that_is_not_there_fails_at_its_line(tmp_path):
    with pytest.raises(RunFailure, match="no item 7 in a list of 2") as caught:
        shapes(tmp_path, SCENE.replace("of: sky.positions,", 'of: "item(sky.positions, 7)",'), [1.0], ["way"])
    assert (caught.value.part, caught.value.span.line) == ("way", 8)


def test_what_decorates_hides_no_model(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE)
    graph = load(path)
    assert graph.drawn["film"] == ("way", "speed", "sky")
    assert any(isinstance(shape, Points) for shape in shapes(tmp_path, SCENE, [1.0], graph.drawn["film"])[0][1])


def test_points_that_come_and_go_leave_no_trail(tmp_path):
    script = SCENE.replace(
        "list: {moon: {position: 1 0 0 m, velocity: 0 2 0 m/s}, star: {position: 3 0 0 m}}", "emit: {}"
    )
    script = "\n".join(line for line in script.splitlines() if "arrow" not in line)
    with pytest.raises(RunFailure, match="come or gone"):
        shapes(tmp_path, script, [0.5], ["way"])


def test_an_arrow_is_as_long_as_its_vector_and_closed(tmp_path):
    ((_, (arrow,)),) = shapes(tmp_path, SCENE, [1.0], ["speed"])
    assert isinstance(arrow, Mesh)
    np.testing.assert_allclose(arrow.vertices[:, 1].min(), 2, atol=1e-12)
    np.testing.assert_allclose(arrow.vertices[:, 1].max(), 2.2, atol=1e-12)
    a, b, c = (arrow.vertices[arrow.triangles[:, k]] - [1, 2, 0] for k in range(3))
    radius, head = 0.015, 5 * 0.015
    volume = radius**2 * (0.2 - head) + (2.4 * radius) ** 2 * head / 3
    assert np.sum(a * np.cross(b, c)) / 6 == pytest.approx(np.pi * volume, rel=0.02)
    assert shapes(tmp_path, SCENE.replace("0 2 0 m/s", "0 0 0 m/s"), [0.0], ["speed"])[0][1] == []


def test_a_surface_draws_its_cloth(tmp_path):
    script = """
models: {sheet: {cloth: {cells: 4 4}}}
objects: {linen: {surface: {of: sheet, thickness: 2 cm, color: red}}}
"""
    ((_, (mesh,)),) = shapes(tmp_path, script, [0.0], ["linen"])
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    assert np.sum(a * np.cross(b, c)) / 6 == pytest.approx(2 * 2 * 0.02)
    assert load(tmp_path / "scene.yaml").drawn["film"] == ("linen",)
    assert len(watch(tmp_path, script, [0], "sheet.triangles")[0][0]) == 32
    with pytest.raises(RunFailure, match="has no surface"):
        shapes(tmp_path, script.replace("cloth: {cells: 4 4}", "particles: {positions: [[0, 0, 0]]}"), [0.0], ["linen"])


@pytest.mark.parametrize("every", ["1e-320 ms", "1 ns"])
def test_of_corners_closer_than_can_be_kept_there_are_fewer(tmp_path, every):
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE.replace("keep: 0.5 s", f"keep: 0.5 s, every: {every}"))
    assert 1000 < sum(1 for _ in Run(load(path)).history.due(0.5)) <= MOST + 1


def test_an_output_of_a_model_is_read_once_an_instant(tmp_path):
    """Hundreds of objects may read the places of one model."""
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE)
    (moment,) = Run(load(path)).moments([1.0])
    first = moment.read("sky", "positions")
    assert moment.read("sky", "positions") is first
    assert moment.asked
