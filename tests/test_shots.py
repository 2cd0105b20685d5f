"""Films in shots, and cameras that stay behind what they follow."""

from __future__ import annotations

import numpy as np
import pytest

from runs import complaint
from sceneql.pictures.framing import behind
from sceneql.pipeline import Report, Tools, load, simulate

SCENE = """
clock: {{end: 3 s, fps: 10}}
objects:
  ball: {{sphere: {{position: ["{way}", 0 m, 0 m], radius: 0.2 m}}}}
cameras:
  wide: {{perspective: {{position: 0 0 9 m, look_at: 0 0 0 m}}}}
  near: {{perspective: {{follow: ball, from: 0 0 3 m, lag: {lag}}}}}
outputs:
  film: {{video: {{size: 64 36, camera: wide, shots: {shots}}}}}
"""
MOVE = "0.5 m/s*time"


def graph_of(folder, shots="[]", lag="0 s", way=MOVE, **more):
    path = folder / "scene.yaml"
    path.write_text(SCENE.format(shots=shots, lag=lag, way=way), encoding="utf-8")
    return load(path, **more)


def test_shots_have_their_speeds_and_their_cameras(tmp_path):
    graph = graph_of(tmp_path, "[{until: 1 s}, {camera: near, until: 1.5 s, speed: 1/8}, {speed: 2}]")
    video = graph.tasks["film"].kind
    times = video.times(graph.settings.clock)
    np.testing.assert_allclose(times[:10], np.arange(10) / 10)
    np.testing.assert_allclose(times[10:50], 1 + np.arange(40) / 80)
    np.testing.assert_allclose(times[50:], 1.5 + np.arange(8) / 5)
    assert [getattr(video.seen_from(t), "name", None) for t in (0.9, 1.0, 1.49, 1.5)] == [None, "near", "near", None]
    assert {"wide", "near"} <= graph.tasks.keys()


def test_a_film_without_shots_has_the_clocks_frames(tmp_path):
    graph = graph_of(tmp_path, sets=["clock.speed=0.3", "clock.end=1.01 s", "clock.fps=24"])
    clock = graph.settings.clock
    assert graph.tasks["film"].kind.times(clock) == clock.frames(24)


@pytest.mark.parametrize(("end", "told"), [(1000, []), (3600, ["36,000 frames", "10 h"])])
def test_a_film_of_many_frames_is_told_before_it_is_drawn(tmp_path, end, told):
    warnings = graph_of(tmp_path, sets=[f"clock.end={end} s"]).warnings
    assert [one.code for one in warnings] == ["long-film"] * bool(told)
    assert all(text in one.message for one in warnings for text in told)


def test_a_shot_is_what_its_camera_sees(tmp_path):
    cut = graph_of(tmp_path, "[{until: 1 s}, {camera: near}]")
    plain = graph_of(tmp_path, sets=["film.camera=near"])
    seen = []
    for graph in (cut, plain):
        tools = Tools(graph, "film", Report(), tmp_path / "it")
        seen.append([tools.pixels(graph.tasks["film"].kind, m) for m in simulate(graph, [0.5, 2.0])])
    np.testing.assert_array_equal(seen[0][1], seen[1][1])
    assert (seen[0][0] != seen[1][0]).any()


def test_shots_come_one_after_the_other(tmp_path):
    told = complaint(tmp_path, SCENE.format(shots="[{until: 2 s}, {until: 1 s}]", lag="0 s", way=MOVE))
    assert "begins at 2 s and ends no later" in told
    told = complaint(tmp_path, SCENE.format(shots="[{camera: near}, {camera: wide}]", lag="0 s", way=MOVE))
    assert "none can follow" in told


def test_a_shutter_gathers_light_while_it_is_open(tmp_path):
    graph = graph_of(tmp_path, way="2 m/s*time", sets=["film.shutter=180 deg", "film.exposures=4", "clock.end=0.95 s"])
    video = graph.tasks["film"].kind
    times = video.times(graph.settings.clock)
    assert len(times) == 10 * 4
    assert times == sorted(set(times))
    np.testing.assert_allclose(times[:5], [0, 0.0125, 0.025, 0.0375, 0.1])
    np.testing.assert_allclose(times[-4:], [0.9, 0.9125, 0.925, 0.9375])
    tools = Tools(graph, "film", Report(), tmp_path / "it")
    moments = simulate(graph, times[4:8])
    *before, blurred = [tools.pixels(video, moment, k, 4) for k, moment in enumerate(moments)]
    assert before == [None] * 3
    alone = [Tools(graph, "film", Report(), tmp_path / "it") for _ in range(4)]
    moments = simulate(graph, times[4:8])
    sharp = [tool.pixels(video, moment).astype(int) for tool, moment in zip(alone, moments, strict=True)]
    columns = [np.flatnonzero(np.ptp(one[18].astype(int), axis=1) > 12) for one in (*sharp, blurred)]
    assert abs(columns[-1].min() - min(c.min() for c in columns[:-1])) <= 1
    assert abs(columns[-1].max() - max(c.max() for c in columns[:-1])) <= 1
    still = np.all([one == sharp[0] for one in sharp], axis=0)
    assert np.abs(blurred.astype(int) - sharp[0])[still].max() <= 2
    np.testing.assert_allclose(blurred.mean(), np.mean(sharp), atol=1)


def test_panels_have_no_shutter(tmp_path):
    told = complaint(tmp_path, SCENE.format(shots="[], shutter: 90 deg, layout: [[wide, near]]", lag="0 s", way=MOVE))
    assert "has no shutter" in told


@pytest.mark.parametrize("fps", [7, 30])
def test_a_follower_lags_as_its_equation_says(tmp_path, fps):
    """Behind x = v t by p' = (x - p)/lag stands p = v (t - lag + lag exp(-t/lag)), at any frame rate."""
    graph = graph_of(tmp_path, lag="0.4 s", sets=["film.camera=near"])
    camera = graph.tasks["near"].kind
    times = [k / fps for k in range(2 * fps)] + [2.0]
    for time, moment in zip(times, simulate(graph, times), strict=True):
        origin = camera.view((64, 36), moment).origin
        expected = 0.5 * (time - 0.4 + 0.4 * np.exp(-time / 0.4))
        np.testing.assert_allclose(origin, (expected, 0, 3), atol=2e-5)


def test_a_follower_of_a_swinging_part_is_smooth():
    lag, now = 0.3, 4.0
    times = np.linspace(0, now, 2001)
    place = behind([(t, np.sin(3 * t)) for t in times[:-1]], now, np.sin(3 * now), lag)
    # The way between two places is straight: by at most w^2 h^2/8 off.
    z = 1 / (1 + 3j * lag)  # the steady answer, and what is left of the start
    start = -np.imag(z)
    off = 3**2 * (now / 2000) ** 2 / 8
    assert place == pytest.approx(np.imag(z * np.exp(3j * now)) + start * np.exp(-now / lag), abs=off)
