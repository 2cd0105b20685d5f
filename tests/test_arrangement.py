"""Where overlays, labels and panels stand: free of what matters, alike beside one another, large enough to read."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from moment import FakeMoment, const
from sceneql import tools as tools_file
from sceneql.frame import View
from sceneql.kinds.texts import Text
from sceneql.pictures.anchors import outline
from sceneql.pictures.callouts import UP, lead, meet, stand
from sceneql.pictures.framing import axes_towards, corners, inner
from sceneql.pictures.layout import Panel
from sceneql.pictures.lettering import Letterer
from sceneql.pictures.plot import Axis, Curve, _head, draw_plot
from sceneql.pipeline import Report, Tools, load, render, simulate
from sceneql.report.explain import explain
from sceneql.shapes.outlines import DIRECTIONS
from sceneql.words.cameras.auto import Auto
from sceneql.words.objects.arrow import Arrow
from sceneql.words.overlays.labels import label_boxes

FALL = """
objects: {{ball: {{sphere: {{radius: 0.2 m, position: 0 2 0 m}}}}}}
models: {{fall: {{particles: {{of: ball, mass: 1 kg}}}}}}
forces: [gravity, collision]
overlays: {overlays}
cameras: {{eye: {{auto: {{window: 0 s}}}}}}
outputs: {{film: {{video: {{size: {size}}}}}}}
"""
WIDE = """
models:
  bar: {{diffusion: {{size: 1 0.4 m, cell: 0.1 m, coefficient: 3e-4 m^2/s, initial: x}}}}
objects: {{plate: {{field_map: {{of: bar.concentration, range: 0 1 g/L}}}}}}
overlays: {overlays}
outputs: {{film: {{video: {{size: {size}}}}}}}
"""
TITLES = (
    "{title: {caption: {text: Free fall, place: top, size: 0.12, show: time < 1 s}}, "
    'law: {formula: {tex: "m = F", place: top right}}, '
    'value: {caption: {text: "v = {length(fall.velocity):.1f m/s}", place: bottom, show: time > 1 s}}}'
)
MANY = "{a: {caption: {text: one}}, b: {caption: {text: two}}, c: {formula: {tex: x}}, d: {graph: {y: time}}}"
VARIANTS = """
clock: {{end: 2 s}}
define: {{far: 1 m}}
models:
  swing:
    mass_spring:
      masses: {{wall: {{position: 0 0 0 m, fixed: yes}}, bob: {{position: [far, 0 m, 0 m], mass: 1 kg}}}}
      springs: [{{between: [wall, bob], rest: 0 m, stiffness: 10 N/m}}]
solvers: {{main: {{rk4: {{step: 0.05 s}}}}}}
objects: {{ball: {{sphere: {{radius: 0.1 m, position: swing.bob.position}}}}}}
variants: {{near: {{define.far: 0.5 m}}, far: {{define.far: 4 m}}, middle: {{define.far: 2 m{fails}}}}}
outputs: {{film: {{image: {{size: 301 100, time: 0.5 s, layout: [{{each: variant}}]}}}}}}
"""


def arranged(folder, text):
    """The picture's size, its moment, its Arrangement and its view."""
    (folder / "scene.yaml").write_text(text)
    graph = load(folder / "scene.yaml")
    output = graph.tasks["film"].kind
    (moment,) = simulate(graph, [0.0])
    found = Tools(graph, "film", Report(), folder / "it")._arrangement(output, moment, None, tools_file.WHOLE)
    then = replace(moment, room=found.room)
    return output.pixels, then, found, graph.tasks[graph.cameras["film"]].kind.view(output.pixels, then)


@pytest.mark.parametrize("size", ["480 270", "320 180", "400 300", "1280 720"])
@pytest.mark.parametrize(
    ("scene", "overlays"),
    [
        (FALL, TITLES),
        (FALL, MANY),
        (WIDE, "{key: {legend: {of: plate}}}"),
        (WIDE, "{key: {legend: {of: plate}}, said: {caption: {text: Heat, size: 0.1}}, go: {graph: {y: time}}}"),
    ],
)
def test_overlays_lie_neither_on_the_subject_of_the_film_nor_on_one_another(tmp_path, scene, overlays, size):
    pixels, moment, found, view = arranged(tmp_path, scene.format(overlays=overlays, size=size))
    boxes = [kind.box(kind.place, pixels, moment, 1.0) for kind in found.overlays.values()]
    subject = [outline(corners(*box), view) for name, box in moment.run.boxes().items() if name != "floor"]
    assert subject
    for k, box in enumerate(boxes):
        assert 0 <= box[0] < box[2] <= pixels[0]
        assert 0 <= box[1] < box[3] <= pixels[1]
        assert not any(meet(box, other) for other in boxes[:k])
        assert not any(meet(box, thing) for thing in subject)
    places = np.array(subject)
    assert places[:, :2].min() >= 0
    assert (places[:, 2:].max(axis=0) <= pixels).all()


def test_without_overlays_on_it_the_subject_is_framed_as_ever(tmp_path):
    for overlays in ("{}", "{said: {caption: {text: Hi, place: top left}}}", "{said: {caption: {text: Hi}}}"):
        assert arranged(tmp_path, FALL.format(overlays=overlays, size="480 270"))[2].room == (0, 0, 0, 0)


@pytest.mark.parametrize("size", ["480 270", "640 360"])
def test_a_subject_between_overlays_fills_what_they_leave(tmp_path, size):
    pixels, moment, found, view = arranged(tmp_path, FALL.format(overlays=TITLES, size=size))
    top = found.overlays["title"].box("top", pixels, moment, 1.0)[3]
    bottom = found.overlays["value"].box("bottom", pixels, moment, 1.0)[1]
    low, high = moment.run.boxes()["ball"]
    _, above, _, below = outline(corners(low, high), view)
    assert top < above < below < bottom
    assert below - above > 0.85 * (bottom - top)


def test_what_a_camera_follows_stays_clear_of_overlays(tmp_path):
    text = FALL.format(overlays=TITLES, size="640 360").replace("window: 0 s", "")
    (tmp_path / "scene.yaml").write_text(text)
    graph = load(tmp_path / "scene.yaml")
    eye, output = graph.tasks[graph.cameras["film"]].kind, graph.tasks["film"].kind
    tools, heights, distances = Tools(graph, "film", Report(), tmp_path / "it"), [], []
    for moment in simulate(graph, [0.0, 0.4, 0.6, 0.9, 1.5, 2.0, 3.0, 4.0]):
        found = tools._arrangement(output, moment, None, tools_file.WHOLE)
        view = eye.view(output.pixels, replace(moment, room=found.room, rooms=found.rooms))
        center = moment.read("fall", "position")
        ball = outline(center + 0.2 * DIRECTIONS, view)
        shown = [kind for kind in found.overlays.values() if kind.show is None or moment.at(kind.show)]
        assert len(shown) > 1
        assert not any(meet(kind.box(kind.place, output.pixels, moment, 1.0), ball) for kind in shown)
        assert 0 < ball[0] < ball[2] < 640
        heights.append((ball[3] - ball[1]) / 360)
        distances.append(np.linalg.norm(view.origin))
    assert heights[0] < 0.15
    assert heights[-1] > 0.4
    assert np.diff(distances).max() < 1e-12  # but for rounding, at rest


def test_a_camera_that_moves_leaves_overlays_the_room_with_which_the_film_is_largest(tmp_path):
    """At the start of a throw room at the left is as good as below; the way is wide."""
    text = FALL.format(overlays="{speed: {graph: {y: length(fall.velocity)}}}", size="640 360")
    text = text.replace("window: 0 s", "").replace("mass: 1 kg", "mass: 1 kg, velocity: 6 6 0 m/s")
    _, _, found, _ = arranged(tmp_path, text)
    assert found.room[0] == 0.0
    assert found.room[3] > 0.2


def test_a_title_that_has_gone_takes_no_room_from_a_camera_that_moves(tmp_path):
    text = FALL.format(overlays=TITLES, size="640 360").replace("window: 0 s", "")
    (tmp_path / "scene.yaml").write_text(text)
    graph = load(tmp_path / "scene.yaml")
    eye, output = graph.tasks[graph.cameras["film"]].kind, graph.tasks["film"].kind
    nearer = []
    for moment in simulate(graph, [0.0, 2.0]):
        found = Tools(graph, "film", Report(), tmp_path / "it")._arrangement(output, moment, None, tools_file.WHOLE)
        always, then = (
            np.linalg.norm(eye.view(output.pixels, replace(moment, room=found.room, rooms=rooms)).origin)
            for rooms in ((), found.rooms)
        )
        nearer.append(always / then)
    assert nearer[0] == pytest.approx(1.0, abs=1e-3)
    assert nearer[1] > 1.05


def test_room_for_overlays_makes_nothing_smaller_than_margins_inside_of_it_would():
    for margin, size in product((0.0, 0.12, 0.5, 0.95), ((640, 360), (100, 900))):
        for room in product((0.0, 0.05, 0.37), repeat=4):
            slopes, middle = inner(0.5, size, margin, room)
            halves = 0.5 * size[0] / size[1], 0.5
            for k, half in enumerate(halves):
                assert 0 < (1 - margin) * (1 - room[k] - room[k + 2]) <= slopes[k] / half + 1e-12
                off = middle[k] / half * (1, -1)[k]
                assert off - slopes[k] / half >= 2 * room[k] - 1 - 1e-12
                assert off + slopes[k] / half <= 1 - 2 * room[k + 2] + 1e-12


def test_an_overlay_takes_the_side_that_a_written_camera_leaves_free(tmp_path):
    cameras = "cameras: {{plan: {{orthographic: {{look_at: {x} 0.2 0 m, height: 0.6 m}}}}}}"
    for x, side in ((0.2, "left"), (0.8, "right")):
        text = WIDE.format(overlays="{key: {legend: {of: plate}}}", size="480 270") + cameras.format(x=x)
        assert arranged(tmp_path, text)[2].overlays["key"].place == side


def test_an_overlay_keeps_its_place_over_the_film(tmp_path):
    said = '{said: {caption: {text: "{time:.1f s} {ball.position.y:.3f m}"}}}'
    (tmp_path / "scene.yaml").write_text(FALL.format(overlays=said, size="320 180"))
    graph = load(tmp_path / "scene.yaml")
    tools = Tools(graph, "film", Report(), tmp_path / "it")
    first, *more = (
        tools._arrangement(graph.tasks["film"].kind, moment, None, tools_file.WHOLE)
        for moment in simulate(graph, [0.0, 1.0, 3.0])
    )
    assert all(one is first for one in more)


@pytest.mark.parametrize("fails", ["", ", may_fail: yes"])
def test_panels_of_variants_share_one_view(tmp_path, monkeypatch, fails):
    script = VARIANTS.format(fails=fails).replace("end: 2 s", "end: 8 s")  # what swings once alone is gone along with
    (tmp_path / "scene.yaml").write_text(script)
    graph = load(tmp_path / "scene.yaml")
    views = []

    def spy(*given):
        frame = frame_of(*given)
        views.append(frame.view)
        return frame

    frame_of = tools_file.frame_of
    monkeypatch.setattr(tools_file, "frame_of", spy)
    tools = Tools(graph, "film", Report(), tmp_path / "it")
    for moment in simulate(graph, [0.5], [graph.tasks["film"].kind]):
        tools.pixels(graph.tasks["film"].kind, moment)
    assert len(views) == 3
    assert len({(view.origin, view.size, view.half_height, view.axes.tobytes()) for view in views}) == 1
    for x in (-4.1, 4.1):  # the farthest of all is in the picture
        left, top, right, bottom = outline(np.array([[x, 0.0, 0.0]]), views[0])
        assert 0 < left <= right < views[0].size[0]
        assert 0 < top <= bottom < views[0].size[1]


@given(st.integers(20, 4000), st.floats(1e-4, 0.3), st.floats(1, 8))
def test_letters_are_of_eleven_pixels_and_a_fortieth_of_the_picture_at_least(height, text, scale):
    letters = Letterer(np.zeros((height, 8, 3), dtype=np.uint8), text, scale=scale)
    assert letters.em >= letters.least >= 11
    assert letters.least >= 0.025 * (height * scale - 1)


@pytest.mark.parametrize("height", [120, 270, 1080])
def test_numbers_beside_axes_are_as_large(monkeypatch, height):
    asked = []
    from sceneql.pictures import plot

    monkeypatch.setattr(plot, "font", lambda size: asked.append(size) or font(size))
    from sceneql.pictures.lettering import LIGHT, font

    times = np.linspace(0, 4, 9)
    curve = Curve("one", times, times, times**2, (200, 0, 0), 4.0)
    pixels = np.zeros((height // 2, height, 3), dtype=np.uint8)
    draw_plot(pixels, [curve], Axis("up", ""), Axis("time", "s"), 1.0, 0.05, 2.0, LIGHT, True)
    assert min(asked) >= max(11, 0.025 * height)


@given(st.tuples(*[st.floats(-1, 1)] * 3), st.floats(0.01, 0.1), st.text("aFvx", min_size=1, max_size=4))
def test_a_label_stands_beside_the_head_of_its_arrow(vector, radius, text):
    assume(np.linalg.norm(vector) > 0.05)
    arrow = Arrow(vector=const(vector), radius=const(radius), label=Text((text,)))
    view = View((1.0, 2.0, 8.0), axes_towards((1.0, 2.0, 8.0)), (640, 360), 0.3)
    letters = Letterer(np.zeros((360, 640, 3), dtype=np.uint8), 0.035)
    moment = FakeMoment()
    (shape,) = arrow.lower("it", np.eye(3, 4), moment)
    tip = outline(shape.vertices[np.linalg.norm(shape.vertices - vector, axis=1) < 1e-9], view)
    ((thing, box, _),) = label_boxes(letters, view, arrow.labels("it", moment))
    assert thing[0] - 1e-6 <= tip[0] <= tip[2] <= thing[2] + 1e-6
    assert not meet(thing, box)
    away = max(box[0] - thing[2], thing[0] - box[2], box[1] - thing[3], thing[1] - box[3])
    assert away < letters.em


def test_labels_that_meet_stand_apart_with_a_line_to_what_they_name():
    thing, block = (150.0, 100.0, 150.0, 100.0), (60, 20)
    first = stand(thing, UP, block, (320, 180), 0.0, 14, [])
    assert first == (120, 80, 180, 100)
    second = stand(thing, UP, block, (320, 180), 0.0, 14, [first])
    assert not meet(first, second)
    letters = Letterer(np.full((180, 320, 3), 128, dtype=np.uint8), 0.08)
    lead(letters, thing, first)
    assert np.ptp(np.asarray(letters._image)) == 0
    lead(letters, thing, second)
    marked = np.argwhere((np.asarray(letters._image) != 128).any(axis=2))[:, ::-1]
    for end in (thing[:2], (min(max(150, second[0]), second[2]), second[3])):
        assert np.linalg.norm(marked - end, axis=1).min() < 3


def test_a_label_stays_in_the_picture_and_off_its_thing():
    box = stand((150.0, 2.0, 170.0, 20.0), UP, (60, 20), (320, 180), 3.0, 14, [])
    assert box[1] >= 0
    assert not meet(box, (150, 2, 170, 20))


def test_a_curve_that_is_never_shown_has_no_name():
    from sceneql.pictures.lettering import LIGHT

    times = np.linspace(0, 4, 9)
    curves = [
        Curve("in", times, times, times, (255, 0, 0), 4.0),
        Curve("out", times, times, times + 99, (0, 255, 0), 4.0),
    ]
    pixels = np.zeros((270, 480, 3), dtype=np.uint8)
    draw_plot(pixels, curves, Axis("up", "", limits=(0.0, 5.0)), Axis("time", "s"), 1.0, 0.05, 1.0, LIGHT, True)
    assert (pixels[..., 0].astype(int) - pixels[..., 1] > 150).any()
    assert not (pixels[..., 1].astype(int) - pixels[..., 0] > 50).any()


def test_a_title_that_is_too_long_for_its_panel_takes_two_lines_before_it_is_cut():
    letters = Letterer(np.zeros((300, 220, 3), dtype=np.uint8), 0.05)
    words = "spread of the upper angles, rad"
    assert letters.extent(words)[0] > 220
    _, found = _head(letters, 200, words, [])
    assert " ".join(text for *_, text in found) == words
    assert len({row for _, row, *_ in found}) == 2
    assert max(letters.extent(text)[0] for *_, text in found) <= 220
    _, found = _head(letters, 200, 3 * words, [])
    assert len(found) == 2
    assert found[-1][3].endswith("…")
    assert letters.extent(found[-1][3])[0] <= 220
    assert letters.wrapped(words, 1e4, 2) == [words]
    assert letters.wrapped("", 200, 2) == []


def test_names_of_curves_are_spread_evenly_over_lines():
    letters = Letterer(np.zeros((270, 480, 3), dtype=np.uint8), 0.05)
    names = ("Euler", "the notes' loop", "midpoint", "RK4")
    none = np.zeros(1)
    _, words = _head(letters, 420, "energy", [Curve(name, none, none, none, (0, 0, 0), 0.0) for name in names])
    rows = [row for _, row, *_ in words]
    assert len(set(rows)) == 2
    assert rows.count(max(rows)) == 2


def test_an_overlay_in_the_center_comes_and_goes_softly(tmp_path):
    script = """
clock: {{end: 4 s}}
objects: {{far: {{sphere: {{position: 0 0 -50 m}}}}}}
cameras: {{plan: {{orthographic: {{look_along: -z, look_at: 0 0 0 m, height: 3 m}}}}}}
background: black
overlays: {overlays}
outputs: {{film: {{image: {{size: 240 135, show: [far]}}}}}}
"""
    said = "{said: {caption: {text: Title, place: center, panel: 1, show: (time > 1 s)*(time < 3 s), fade: 0.8 s}}}"

    def at(time, overlays):
        (tmp_path / "scene.yaml").write_text(script.format(overlays=overlays))
        graph = load(tmp_path / "scene.yaml")
        (moment,) = simulate(graph, [time])
        return Tools(graph, "film", Report(), tmp_path / "it").pixels(graph.tasks["film"].kind, moment).astype(float)

    plain, full = at(0.0, "{}"), at(2.0, said)
    rows, columns = np.nonzero((plain != full).any(axis=2))
    assert abs(rows.min() + rows.max() + 1 - 135) <= 2
    assert abs(columns.min() + columns.max() + 1 - 240) <= 2
    assert (at(0.9, said) == plain).all()
    assert (at(3.0, said) == plain).all()
    for time, part in ((1.4, 0.5), (1.2, 0.25), (2.8, 0.25), (1.9, 1.0)):
        assert np.mean(at(time, said) - plain) == pytest.approx(part * np.mean(full - plain), rel=0.04)


def test_explain_tells_which_overlays_look_at_the_whole_run(tmp_path):
    overlays = "{seeks: {caption: {text: Hi}}, stands: {caption: {text: Hi, place: top}}}"
    (tmp_path / "scene.yaml").write_text(FALL.format(overlays=overlays, size="480 270"))
    assert explain(load(tmp_path / "scene.yaml"))["ahead_overlays"] == ["seeks"]


def test_labels_of_neighbors_spare_one_another_and_what_they_name():
    near = (180.0, 110.0, 200.0, 130.0)
    box = stand((150.0, 130.0, 170.0, 150.0), UP, (80, 20), (320, 180), 4.0, 14, [], [near])
    assert not meet(box, near)


def test_a_variant_that_bursts_does_not_make_the_others_vanish(tmp_path):
    (tmp_path / "scene.yaml").write_text(VARIANTS.format(fails="").replace("far: 4 m", "far: 4 km"))
    graph = load(tmp_path / "scene.yaml")
    near, far, middle = (Panel(graph.variant(name)) for name in ("near", "far", "middle"))
    moment = replace(near.at(0.0), beside=(far, middle))
    assert moment.bounds(())[1][0] == pytest.approx(2.1)


@pytest.mark.parametrize(
    ("end", "mass", "told"), [(2, 1, "is seen from farther away"), (9, 1, "leaves its panel"), (2, 2, "")]
)
def test_of_a_variant_that_diverges_by_its_solver_alone_the_camera_goes_back(tmp_path, end, mass, told):
    """If it bursts it leaves the picture. Of swings with another mass, too, the large one is no error of a solver."""
    text = VARIANTS.format(fails="").replace("301 100", "120 40").replace("mass: 1 kg", "mass: heavy")
    text = text.replace("end: 2", f"end: {end}")
    before, _, after = text.partition("variants:")
    exact, euler = "honest: {}", f"wrong: {{solvers.main: {{euler: {{step: 0.2 s}}}}, define.heavy: {mass} kg}}"
    tail = after[after.index("\n") :]
    text = before.replace("define: {far: 1 m}", "define: {far: 1 m, heavy: 1 kg}") + f"variants: {{{exact}, {euler}}}"
    (tmp_path / "scene.yaml").write_text(text + tail)
    graph = load(tmp_path / "scene.yaml")
    found = [one for one in render(graph, folder=tmp_path, draft=True).warnings if one.code == "diverges"]
    assert len(found) == bool(told)
    for one in found:
        assert f"'wrong' {told}, from 0." in one.message
        assert "as 'honest', which differs in its solver alone" in one.message
        assert one.span is not None
        assert one.span.line == next(k for k, line in enumerate(text.splitlines(), 1) if "euler" in line)
    honest, wrong = (Panel(graph.variant(name)) for name in ("honest", "wrong"))
    for time in (0.0, float(end)):
        moment = replace(wrong.at(time), beside=(honest,))
        view = Auto().view((64, 36), moment)
        assert bool(wrong.told(moment)) == bool(told and time)
        seen = outline(moment.read("swing", "positions"), view)
        inside = seen is not None and 0 <= seen[0] <= seen[2] <= 64
        assert inside == (told != "leaves its panel" or not time)
    if told:
        assert wrong.told(moment).startswith("from 0.")
        assert ("it leaves the picture" in wrong.told(moment)) == (told == "leaves its panel")


@pytest.mark.parametrize("far", [1e308, math.inf, -math.inf, math.nan])
def test_a_label_of_a_place_beyond_all_numbers_stands_inside_the_picture(far):
    left, top, right, bottom = stand((far, 5.0, far, 5.0), UP, (30, 10), (64, 36), 2.0, 10)
    assert 0 <= left <= right <= 64
    assert 0 <= top <= bottom <= 36
