"""The default camera holds still unless it pays, and says of what it hardly shows; with a `window` it goes along."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from sceneql.pictures.following import NEARER, Follower, with_feet
from sceneql.pictures.framing import axes_towards, fitted
from sceneql.pipeline import load, render, simulate
from sceneql.words.cameras.auto import Auto

THROWN = """
models: {{ball: {{particles: {{list: {{a: {{position: 0 1 0 m, velocity: 12 9 0 m/s, radius: {0} m}}}}}}}}}}
forces: [gravity]
contacts: {{c: {{collision: {{restitution: 0.8}}}}}}
clock: {{end: 6 s}}
{1}
outputs: {{p: {{image: {{size: 64 36}}}}}}
"""
CAMERA = "cameras: {near: {auto: {window: 1 s}}}"
TIMES = np.linspace(0.0, 6.0, 97)
SIZE = (640, 360)


def views(tmp_path, script, count=None):
    """Views and places of the ball in the picture, -1 to 1 from edge to edge, and its radius over half the height."""
    (tmp_path / "s.yaml").write_text(script)
    graph = load(tmp_path / "s.yaml")
    (name,) = set(graph.cameras.values())
    found = []
    for moment in simulate(graph, TIMES[:count]):
        view = graph.tasks[name].kind.view(SIZE, moment)
        x, y, z = view.axes @ (moment.read("ball", "positions")[0] - np.array(view.origin))
        half = view.half_height * -z
        found.append((np.array(view.origin), x / half * SIZE[1] / SIZE[0], y / half, 0.2 / half))
    return found


def test_without_a_window_it_holds_still(tmp_path):
    origins = {tuple(origin) for origin, *_ in views(tmp_path, THROWN.format(0.2, ""), 9)}
    assert len(origins) == 1


SETTLED = """
models: {{ball: {{particles: {{list: {{a: {{position: 0 2 0 m, radius: 0.2 m}}}}}}}}}}
forces: [gravity]
contacts: {{c: {{collision: {{restitution: {0}}}}}}}
clock: {{end: 6 s}}
{1}
outputs: {{p: {{image: {{size: 64 36}}}}}}
"""


def test_what_lies_long_after_a_fall_is_gone_to_and_the_fall_is_seen_whole(tmp_path):
    found = views(tmp_path, SETTLED.format(0.3, ""))
    for _, x, y, radius in found:
        assert abs(x) + radius * SIZE[1] / SIZE[0] < 1
        assert abs(y) + radius < 1
    assert found[0][3] < 0.2
    assert 2.5 * found[0][3] < found[-1][3] < 1.2 * NEARER * found[0][3]
    heights = np.diff([origin[1] for origin, *_ in found])
    assert heights.clip(0.0).sum() < 0.01 * -heights.sum()  # it goes down alone, by more than a metre
    assert heights.sum() < -1.0
    assert np.abs(heights).max() < 0.16  # a step of 1/16 s, of a window of 1.5 s


@pytest.mark.parametrize(("restitution", "camera"), [(1, ""), (0.3, "cameras: {near: {auto: {window: 0 s}}}")])
def test_what_bounces_on_is_seen_from_one_place_as_is_all_with_a_window_of_no_time(tmp_path, restitution, camera):
    origins = {tuple(origin) for origin, *_ in views(tmp_path, SETTLED.format(restitution, camera))}
    assert len(origins) == 1


def test_with_a_window_what_moves_is_larger_and_always_in_the_picture(tmp_path):
    still, along = views(tmp_path, THROWN.format(0.2, ""), 1), views(tmp_path, THROWN.format(0.2, CAMERA))
    for _, x, y, radius in along:
        assert abs(x) + radius * SIZE[1] / SIZE[0] < 1
        assert abs(y) + radius < 1
        assert radius > 2.5 * still[0][3]


def test_it_goes_along_softly(tmp_path):
    """Its acceleration is no more than that of what turns by its own speed within the window."""
    origins = np.array([origin for origin, *_ in views(tmp_path, THROWN.format(0.2, CAMERA))])
    step = TIMES[1] - TIMES[0]
    speeds = np.diff(origins, axis=0) / step
    jumps = np.linalg.norm(np.diff(speeds, axis=0), axis=1) / step
    assert np.linalg.norm(speeds, axis=1).max() < 40
    assert jumps.max() < 60


def test_with_a_window_and_nothing_that_moves_it_frames_all(tmp_path):
    script = "objects: [sphere]\noutputs: {p: {image: {size: 64 36}}}\n"
    (tmp_path / "a.yaml").write_text(script)
    (tmp_path / "b.yaml").write_text(f"{CAMERA}\n{script}")
    seen = []
    for name in ("a", "b"):
        graph = load(tmp_path / f"{name}.yaml")
        (moment,) = simulate(graph, [0.0])
        (camera,) = set(graph.cameras.values())
        seen.append(graph.tasks[camera].kind.view(SIZE, moment).origin)
    assert seen[0] == seen[1]


def test_two_panels_go_along_together(tmp_path):
    text = THROWN.format(
        0.2, f"{CAMERA}\nvariants: {{a: {{}}, b: {{models.ball.particles.list.a.velocity: 12 2 0 m/s}}}}"
    )
    (tmp_path / "s.yaml").write_text(text)
    graph = load(tmp_path / "s.yaml")
    from sceneql.pictures.layout import Panel

    panels = [Panel(graph.variant(name)) for name in ("a", "b")]
    seen = []
    for one, other in (panels, panels[::-1]):
        moment = one.at(3.0)
        moment.beside = (other,)
        seen.append(Auto(window=1.0).view(SIZE, moment).origin)
    np.testing.assert_allclose(seen[0], seen[1], rtol=1e-12)


@pytest.mark.parametrize(("radius", "camera", "told"), [(0.2, "", True), (4.0, "", False), (0.2, CAMERA, False)])
def test_what_is_hardly_seen_is_told(tmp_path, radius, camera, told):
    (tmp_path / "s.yaml").write_text(THROWN.format(radius, camera))
    warnings = render(load(tmp_path / "s.yaml"), folder=tmp_path, draft=True).warnings
    found = [one for one in warnings if one.code == "hardly-seen"]
    assert len(found) == told
    for one in found:
        assert "'ball'" in one.message
        assert "window" in one.help
        assert one.span is not None


def test_nothing_is_told_of_a_camera_that_is_written(tmp_path):
    (tmp_path / "s.yaml").write_text(
        THROWN.format(0.2, "cameras: {eye: {perspective: {position: 30 5 60 m, look_at: 30 0 0 m}}}")
    )
    warnings = render(load(tmp_path / "s.yaml"), folder=tmp_path, draft=True).warnings
    assert "hardly-seen" not in [one.code for one in warnings]


def test_a_wide_cloth_is_gone_to_when_the_ball_that_hit_it_has_come_to_rest():
    """The ground under all of it would keep the camera away."""
    cloth = np.array([[x, 1.0, z] for x in (-1.0, 1.0) for z in (-1.0, 1.0)])
    times = np.linspace(0.0, 1.0, 25)
    high = np.where(times < 0.4, 3.0, 1.0)
    rows = np.concatenate([[(t, *p) for p in (*cloth, (0.0, h, 0.0))] for t, h in zip(times, high, strict=True)])
    fit = partial(fitted, axes=axes_towards((0.55, 0.38, 1.0)), slopes=(0.4, 0.22))
    whole, _ = fit(np.concatenate([rows[:, 1:], [[0.0, 0.5, 0.0]]]))
    back = axes_towards((0.55, 0.38, 1.0))[2]
    follower = Follower(with_feet(rows, 0.5), rows[:0, 1:], lambda seen, span: fit(seen), back, 0.25)
    assert follower.pays(whole)
    assert np.linalg.norm(follower.at(1.0)) < np.linalg.norm(whole) / 1.3


@pytest.mark.parametrize(("towards", "goes"), [((0.0, 0.1, 1.0), True), ((0.0, 1.0, 0.12), False)])
def test_a_camera_that_looks_down_goes_along_for_more_alone(towards, goes):
    """Nothing in the picture of planets tells that it is the camera that moves."""
    axes = axes_towards(towards)
    times = np.linspace(0.0, 1.0, 25)
    sides = 1.0 + 0.5 * np.abs(2.0 * times - 1.0)
    rows = np.array([(t, *(s * (x * axes[0] + y * axes[1]))) for t, s in zip(times, sides, strict=True)
                     for x in (-1.0, 1.0) for y in (-1.0, 1.0)])  # fmt: skip
    fit = partial(fitted, axes=axes, slopes=(0.4, 0.4))
    still, _ = fit(rows[:, 1:])
    assert Follower(rows, rows[:0, 1:], lambda seen, span: fit(seen), axes[2], 0.1).pays(still) is goes
