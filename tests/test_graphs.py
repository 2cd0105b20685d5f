"""Graphs in pictures: what is drawn where, and when."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from campaigns import examples
from runs import complaint
from sceneql.pictures.plotting import Scale, scale_for
from sceneql.pipeline import Report, Tools, load, simulate

SCENE = """
clock: {{end: 4 s, fps: 5}}
define: {{a: 1}}
objects: {{far: {{sphere: {{position: 0 0 -50 m}}}}}}
cameras: {{plan: {{orthographic: {{look_along: -z, look_at: 0 0 0 m, height: 3 m}}}}}}
background: black
overlays: {{plot: {{graph: {{{fields}, size: 1 1, panel: 1}}}}}}
variants:
  slow: {{define.a: 0.5}}
  fast: {{define.a: 2}}
outputs: {{film: {{image: {{size: 480 270, show: [far]}}}}}}
"""
FALL = """
clock: {end: 2 s}
models: {drop: {particles: {list: {one: {position: 0 5 0 m, mass: 1 kg}}}}}
forces: [gravity]
solvers: {main: {rk4: {step: 0.1 s}}}
cameras: {plan: {orthographic: {look_along: -z, look_at: 0 0 0 m, height: 3 m}}}
overlays:
  plot: {graph: {y: {rise: drop.center.y - initial(drop.center.y), high: drop.center.y}}}
outputs: {film: {image: {size: 64 36}}}
"""


def picture(folder, fields, time):
    path = folder / "scene.yaml"
    path.write_text(SCENE.format(fields=fields), encoding="utf-8")
    graph = load(path)
    (moment,) = simulate(graph, [time])
    return Tools(graph, "film", Report(), folder / "it").pixels(graph.tasks["film"].kind, moment)


def curve(pixels, channel=0):
    """Columns (n,) where a red (0) or green (1) curve is, and the middle of its rows there (n,)."""
    others = np.delete(pixels.astype(int), channel, axis=2).max(axis=2)
    near = pixels[..., channel] - others > 80
    columns = np.flatnonzero(near.any(axis=0))
    return columns, np.array([np.flatnonzero(near[:, c]).mean() for c in columns])


@pytest.mark.parametrize(("y", "log"), [("1 + 2*time/(1 s)", ""), ("exp(3*time/(1 s))", ", log: y")])
def test_what_is_straight_on_its_axes_is_drawn_so(tmp_path, y, log):
    columns, rows = curve(picture(tmp_path, f"y: {y}, colors: [red], title: T{log}", 4.0))
    inner = (columns > columns.min() + 12) & (columns < columns.max() - 16)
    slope, offset = np.polyfit(columns[inner], rows[inner], 1)
    assert slope < -0.3
    np.testing.assert_allclose(rows[inner], slope * columns[inner] + offset, atol=0.8)


def test_a_curve_grows_with_the_film_on_axes_that_stay(tmp_path):
    fields = "y: sin(3*time/(1 s)), colors: [red], title: T"
    whole, half = (curve(picture(tmp_path, fields, t)) for t in (4.0, 2.0))
    length = whole[0].max() - whole[0].min()
    assert half[0].max() - half[0].min() == pytest.approx(length / 2, rel=0.03)
    known = [c for c in half[0] if c < half[0].max() - 12]
    np.testing.assert_array_equal(half[1][: len(known)], whole[1][: len(known)])


def test_every_variant_has_its_curve(tmp_path):
    plain = picture(tmp_path, "y: a*time/(1 s), colors: [red, lime], title: T, range: 0 8, each: variant", 4.0)
    slow, fast = curve(plain), curve(plain, 1)
    at = 300  # right of the words above
    down = curve(picture(tmp_path, "y: 0, colors: [red], title: T, range: 0 8", 4.0))[1][-1]
    # Numbers and words beside the axes take the same room, so that heights over the foot compare.
    rise = [down - rows[columns == at][0] for columns, rows in (slow, fast)]
    assert rise[1] / rise[0] == pytest.approx(4, rel=0.06)


def test_the_course_of_a_value_is_what_the_run_has(tmp_path):
    path = tmp_path / "fall.yaml"
    path.write_text(FALL, encoding="utf-8")
    graph = load(path)
    rise, high = graph.tasks["plot"].kind.courses()
    (moment,) = simulate(graph, [1.0])
    times, values = moment.course(high)
    np.testing.assert_allclose(values, 5 - 9.81 / 2 * times**2, atol=1e-9)
    assert (times[0], times[-1]) == (0.0, 2.0)
    np.testing.assert_allclose(moment.course(rise)[1], values - 5, atol=1e-12)
    assert moment.course(rise, until=1.0)[0][-1] == 1.0


def test_lists_are_reduced_at_each_instant_and_single_values_over_time(tmp_path):
    two = "{one: {position: 0 5 0 m, mass: 1 kg}, two: {position: 0 3 0 m, velocity: 0 1 0 m/s, mass: 1 kg}}"
    text = FALL.replace("{one: {position: 0 5 0 m, mass: 1 kg}}", two)
    lines = "{apart: norm(drop.positions - mean(drop.positions)), least: min(drop.center.y + 0*initial(drop.center.y))}"
    text = text.replace("{rise: drop.center.y - initial(drop.center.y), high: drop.center.y}", lines)
    path = tmp_path / "fall.yaml"
    path.write_text(text, encoding="utf-8")
    graph = load(path)
    apart, least = graph.tasks["plot"].kind.courses()
    (moment,) = simulate(graph, [1.0])
    times, values = moment.course(apart)
    np.testing.assert_allclose(values, abs(2 - times) / np.sqrt(2), atol=1e-9)
    lowest = 4 + 0.5 * 2 - 9.81 / 2 * 4
    np.testing.assert_allclose(moment.course(least)[1], np.full(len(times), lowest), atol=1e-9)


def test_a_run_that_fails_has_its_course_up_to_there(tmp_path):
    text = FALL.replace("gravity", "{force: {components: '[1/(1 - step(1, t)), 0, 0]', on: drop}}")
    path = tmp_path / "fall.yaml"
    path.write_text(text, encoding="utf-8")
    graph = load(path)
    (moment,) = simulate(graph, [0.0])
    times, _ = moment.course(graph.tasks["plot"].kind.courses()[0])
    assert 0.8 < times[-1] < 1.05


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ("y: time, unit: kg", "which kg is no unit of"),
        ("y: time, unit: kgg", "unknown-unit"),
        ("y: {a: time, b: 3}", "of one quantity"),
        ("y: time, log: y, range: 0 1", "begins above 0"),
        ("y: time, range: 2 1", "no larger value"),
        ("y: [[1, 2, 3], [3, 4, 5]]", "a list of vectors"),
        ("y: time, x: '[1, 2, 3]'", "one number at each time"),
        ("y: {}", "nothing to draw"),
        ("y: []", "no curve"),
        ("y: {a: tine}", "did you mean 'time'"),
    ],
)
def test_what_cannot_be_drawn_is_refused_where_it_stands(tmp_path, fields, said):
    told = complaint(tmp_path, SCENE.format(fields=fields))
    assert said in told
    assert "scene.yaml:7:" in told


@given(st.floats(-1e6, 1e6), st.floats(1e-6, 1e6), st.booleans(), st.integers(2, 12))
@settings(max_examples=examples(150))
def test_ticks_lie_on_the_axis_and_say_their_values(low, span, log, count):
    low = 10 ** (low / 1e5) if log else low
    high = low * (1 + span) if log else low + max(span, abs(low) * 1e-6)
    scale = Scale(low, high, log)
    ticks = scale.ticks(count)
    places = scale.place([value for value, _ in ticks])
    assert np.all((places > -1e-4) & (places < 1 + 1e-4))
    plain = [(value, text) for value, text in ticks if text[:2] != "10" or text.isdecimal()]
    for value, text in plain:
        assert float(text.replace("\u2212", "-")) == pytest.approx(value, rel=1e-6, abs=1e-6 * (high - low))


@given(st.lists(st.floats(-1e9, 1e9), min_size=1, max_size=9), st.booleans())
@example([1e9, 999999999.9999999], False)
@example([5.0, 5.000000000000001], False)
@settings(max_examples=examples(150))
def test_an_axis_shows_all_that_it_can(values, log):
    scale = scale_for([np.array(values)], log, None)
    places = scale.place(values)
    shown = [place for place, value in zip(places, values, strict=True) if value >= 1e-200 or not log]
    assert all(0 < place < 1 for place in shown)
    assert scale.low < scale.high


@given(st.floats(-1e6, 1e6), st.floats(1e-6, 1e6), st.booleans(), st.integers(3, 6))
@settings(max_examples=examples(150))
def test_an_axis_has_at_least_three_ticks(low, span, log, count):
    low = 10 ** (low / 1e5) if log else low
    high = low * (1 + span) if log else low + max(span, abs(low) * 1e-6)
    assert 3 <= len(Scale(low, high, log).ticks(count)) <= 10


@pytest.mark.parametrize(
    ("y", "names"),
    [
        ("[drop.kinetic, drop.potential]", ["kinetic", "potential"]),
        ("[drop.center.x, drop.center.y]", ["x", "y"]),
        ("drop.center", ["x", "y", "z"]),
        ("[drop.kinetic, 2*drop.potential]", ["x", "y"]),
    ],
)
def test_curves_of_listed_outputs_have_their_names(tmp_path, y, names):
    """They were called x and y, as if the list were a vector."""
    (tmp_path / "scene.yaml").write_text(
        FALL.replace("{rise: drop.center.y - initial(drop.center.y), high: drop.center.y}", y)
    )
    graph = load(tmp_path / "scene.yaml")
    (moment,) = simulate(graph, [0.5])
    assert [curve.name for curve in graph.tasks["plot"].kind._curves(moment)] == names
