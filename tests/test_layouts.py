"""Several panels in one picture: variants side by side, cameras, graphs."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from runs import complaint
from sceneql.failure import RunFailure
from sceneql.kinds import EachVariant
from sceneql.pictures.layout import boxes
from sceneql.pipeline import Report, Tools, load, render, simulate

SCENE = """
clock: {{end: 2 s, fps: 4}}
define: {{push: 1, first: {first}}}
models: {{drop: {{particles: {{list: {{one: {{position: 0 0 0 m, mass: 1 kg}}}}}}}}}}
forces: [{{force: {{components: "[push/(1 - first*step(1, t)), 0, 0]"}}}}]
solvers: {{main: {{rk4: {{step: 0.1 s}}}}}}
objects: {{ball: {{sphere: {{position: drop.one.position, radius: 0.2 m}}}}}}
cameras:
  front: {{orthographic: {{look_along: -z, look_at: 0.5 0 0 m, height: 2 m}}}}
  side: {{orthographic: {{look_along: -x, look_at: 0 0 0 m, height: 1 m}}}}
overlays: {{go: {{graph: {{y: drop.one.position.x, each: variant}}}}}}
variants:
  slow: {{define.push: 0.5, define.first: 0}}
  breaks: {{define.first: 1{may}}}
outputs: {{film: {{image: {{size: 160 120, layout: {layout}}}}}}}
"""


def graph_of(folder, layout, may=", may_fail: yes", first=0, **more):
    path = folder / "scene.yaml"
    path.write_text(SCENE.format(layout=layout, may=may, first=first), encoding="utf-8")
    return load(path, **more)


def pictures(graph, folder, times):
    output = graph.tasks["film"].kind
    tools = Tools(graph, "film", Report(), folder / "it")
    return [tools.pixels(output, moment).copy() for moment in simulate(graph, times, [output])], tools


@given(
    st.lists(st.one_of(st.integers(1, 5), st.floats(0.2, 3)), min_size=1, max_size=4),
    st.integers(1, 9),
    st.integers(1, 4),
    st.tuples(st.integers(200, 900), st.integers(200, 900)),
)
def test_panels_fill_the_picture_and_lie_beside_each_other(rows, variants, columns, size):
    given = [
        tuple(map(str, range(row))) if isinstance(row, int) else EachVariant(each="variant", columns=columns, share=row)
        for row in rows
    ]
    found = boxes(given, [f"v{k}" for k in range(variants)], size)
    assert len(found) == sum(row if isinstance(row, int) else variants for row in rows)
    covered = np.zeros((size[1], size[0]), dtype=int)
    for _, (left, top, wide, high) in found:
        assert left >= 0
        assert top >= 0
        assert left + wide <= size[0]
        assert top + high <= size[1]
        covered[top : top + high, left : left + wide] += 1
    assert covered.max() == 1
    if all(isinstance(row, int) for row in rows):
        assert covered[:, 0].mean() > 0.8
        assert covered[0, 0] == covered[-1, -1] == 1


def test_a_panel_is_the_variants_own_picture_under_its_name(tmp_path):
    (whole,), _ = pictures(graph_of(tmp_path, "[{each: variant}]", sets=["overlays={}"]), tmp_path, [0.5])
    for k, name in enumerate(("slow", "breaks")):
        _, (left, top, wide, high) = boxes([EachVariant(each="variant")], ["slow", "breaks"], (160, 120))[k]
        alone = graph_of(tmp_path, "[]", variant=name, sets=[f"film.size={wide} {high}", "overlays={}"])
        ((own,), _) = pictures(alone, tmp_path, [0.5])
        panel = whole[top : top + high, left : left + wide]
        np.testing.assert_array_equal(panel[40:], own[40:])
        assert (panel[:40] != own[:40]).any()


def test_a_variant_that_may_fail_stays_as_it_was_under_the_message(tmp_path):
    graph = graph_of(tmp_path, "[{each: variant, columns: 1}]", sets=["overlays={}"])
    (before, last, later), tools = pictures(graph, tmp_path, [0.5, 1.5, 2.0])
    assert tools.panels["breaks"].failure.time == pytest.approx(1.0, abs=0.11)
    np.testing.assert_array_equal(last[62:], later[62:])
    np.testing.assert_array_equal(before[62:97], last[62:97])  # the ball, frozen; the message stands below
    assert (before[97:] != last[97:]).any()
    assert (last[:58] != later[:58]).any()
    with pytest.raises(RunFailure):
        pictures(graph_of(tmp_path, "[{each: variant}]", may="", sets=["overlays={}"]), tmp_path, [0.5, 1.5])


def test_a_script_that_only_its_variants_show_is_not_run(tmp_path):
    graph = graph_of(tmp_path, "[{each: variant}, [go]]", first=1)
    report = render(graph, folder=tmp_path)
    assert report.frames == 1
    assert 20 + 8 <= report.steps <= 20 + 10  # those of `slow`, and those of `breaks` until it does


def test_a_panel_of_the_script_itself_shares_the_framing_of_its_variants(tmp_path):
    """A ball that does not move is as large beside variants that fly 1 m and 8 m away as in their panels."""
    (tmp_path / "scene.yaml").write_text(
        "define: {v: 0 m/s}\n"
        "clock: {end: 1 s}\n"
        "objects: {ball: {sphere: {radius: 1 m, color: black}}}\n"
        "models: {fly: {particles: {of: ball, mass: 1 kg, velocity: [v, 0 m/s, 0 m/s]}}}\n"
        "variants: {near: {define.v: 1 m/s}, far: {define.v: 8 m/s}}\n"
        "cameras: {eye: auto}\nbackground: white\n"
        "outputs: {film: {image: {size: 300 100, layout: [{each: variant, columns: 3}, [eye, eye, eye]]}}}\n"
    )
    ((whole,), _) = pictures(load(tmp_path / "scene.yaml"), tmp_path, [0.0])
    found = boxes([EachVariant(each="variant", columns=3), ("a", "b", "c")], ["near", "far"], (300, 100))
    panels = [whole[top : top + high, left : left + wide] for _, (left, top, wide, high) in found[:3]]
    near, far, own = ((panel[14:].max(axis=2) < 90).sum() for panel in panels)
    assert near == pytest.approx(far, rel=0.5)
    assert near > 20
    assert near == pytest.approx(own, rel=0.5)  # the names take some of their panels


def test_a_row_has_panels(tmp_path):
    told = complaint(tmp_path, SCENE.format(layout="[[front], []]", may="", first=0))
    assert "this row has no panel" in told
    assert "scene.yaml:15:" in told


def test_cameras_stand_side_by_side(tmp_path):
    graph = graph_of(tmp_path, "[[front, side]]", sets=["overlays={}"])
    (whole,), _ = pictures(graph, tmp_path, [1.0])
    for camera, (_, (left, top, wide, high)) in zip(
        ("front", "side"), boxes([("a", "b")], [], (160, 120)), strict=True
    ):
        sets = [f"film.size={wide} {high}", f"film.camera={camera}"]
        (own,), _ = pictures(graph_of(tmp_path, "[]", sets=[*sets, "overlays={}"]), tmp_path, [1.0])
        panel = whole[top : top + high, left : left + wide]
        same = (panel == own).all(axis=2)
        assert same[: high // 3].all()


@pytest.mark.parametrize(
    ("section", "part", "camera"),
    [
        ("objects", "way: {trail: {of: drop.one.position, keep: 1 s, radius: 5 cm}}", "front"),
        ("objects", "ways: {trail: {of: drop.positions, keep: 0.3 s, radius: 5 cm}}", "front"),
        ("cameras", "eye: {perspective: {follow: ball, lag: 0.2 s}}", "eye"),
    ],
)
def test_a_panel_remembers_its_own_variants_past(tmp_path, section, part, camera):
    """The script itself is not run there, so nothing may be asked of it."""
    script = SCENE.format(layout="[{each: variant}]", may="", first=0).replace("{define.first: 1}", "{define.push: 1}")
    script = script.replace("size: 160 120", f"size: 160 120, camera: {camera}")
    if section == "objects":
        script = script.replace("objects: {", f"objects: {{{part}, ")
    else:
        script = script.replace("cameras:\n", f"cameras:\n  {part}\n")
    (tmp_path / "scene.yaml").write_text(script, encoding="utf-8")
    (*_, panels), _ = pictures(load(tmp_path / "scene.yaml"), tmp_path, [0.0, 0.5, 1.0])
    sets = ["film.layout=[]", "film.size=79 120"]
    (*_, single), _ = pictures(load(tmp_path / "scene.yaml", variant="slow", sets=sets), tmp_path, [0.0, 0.5, 1.0])
    below = slice(30, 90)  # the panel's name, and above the graph
    np.testing.assert_array_equal(panels[below, :79], single[below])
    assert np.ptp(single[below]) > 100
