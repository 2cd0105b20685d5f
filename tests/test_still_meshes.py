"""Meshes that hold still: their arrays stay the same, and what is made of them is never that of other ones."""

from __future__ import annotations

import gc
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from renderers.rastering.draw import draw as raster
from renderers.rastering.offscreen import canvas
from renderers.tracing.draw import draw
from renderers.tracing.solids import triangles as packed
from renderers.tracing.solids.hierarchy import Tree, hierarchy
from sceneql import pipeline
from sceneql.frame import Mesh, held, is_held
from sceneql.run.run import Run
from sceneql.shapes.held_arrays import OfHeld
from stage import GLOW, WHITE, floor, frame, round_mesh, sphere, sun, view

SCENE = """
clock: {{end: 1 s, fps: 4}}
cameras: {{eye: {camera}}}
define: {{size: 1}}
variants: {{small: {{define.size: 0.5}}}}
objects:
  ball: {{mesh: {{file: ball.obj, scale: size, {ball}}}}}
  floor: {{plane: {{position: 0 -1.2 0 m}}}}
{rest}
outputs: {{film: {{video: {{size: 32 18}}}}}}
"""
STILL = "{perspective: {position: 0 2 5 m, look_at: 0 0 0 m}}"
TURNING = "{turntable: {around: ball, seconds: 2 s, distance: 5 m}}"
CLOTH = """
models: {sheet: {mass_spring: {cloth: {cells: 9 9, size: 2 2 m}, mass: 0.01 kg, stiffness: 10 N/m, pins: [top]}}}
forces: [gravity]
"""
BESIDE = "  other: {sphere: {radius: 0.3 m, position: [1.2 m, 0 m, 1 m - time*(2 m/s)]}}"
CASES = {
    "still": (STILL, "", ""),
    "still, seen from all around": (TURNING, "", BESIDE),
    "moved": (STILL, "position: [time*(1 m/s), 0 m, 0 m]", BESIDE),
    "turned": (STILL, "rotation: {about: y, angle: time*(1 rad/s)}", ""),
    "moved away and back again": (STILL, "position: [abs(time - 0.5 s)*(1 m/s), 0 m, 0 m]", ""),
    "of a color that changes": (TURNING, "color: [time/(1 s), 0.5, 0.2]", BESIDE),
    "beside a cloth": (STILL, "position: 0 0 -1 m", CLOTH),
    "twice": (STILL, "position: 1 0 0 m", "  twin: {mesh: {file: ball.obj, position: -1 0 0 m, scale: [1, 0.7, 1]}}"),
}
TIMES = [0.0, 0.25, 0.5, 0.75, 1.0]
each_case = pytest.mark.parametrize("case", CASES)


@pytest.fixture
def load(tmp_path):
    """Scenes with a mesh of 9,120 triangles."""
    mesh = round_mesh(WHITE)
    rows = [f"v {x!r} {y!r} {z!r}" for x, y, z in mesh.vertices.tolist()]
    rows += [f"f {a} {b} {c}" for a, b, c in (mesh.triangles + 1).tolist()]
    (tmp_path / "ball.obj").write_text("\n".join(rows))

    def load(case, **options):
        camera, ball, rest = CASES[case]
        (tmp_path / "scene.yaml").write_text(SCENE.format(camera=camera, ball=ball, rest=rest))
        return pipeline.load(tmp_path / "scene.yaml", **options)

    return load


def frames(graph, times=TIMES):
    """Frames of one run."""
    return [pipeline.frame_of(graph, "film", (32, 18), moment, 0) for moment in Run(graph).moments(times)]


def anew(graph, time):
    """The picture of a frame by a run of its own, of which nothing was made before."""
    packed._trees, packed._rows = OfHeld(), OfHeld()
    return draw(frames(graph, [time])[0], samples=1).linear


@each_case
def test_frames_of_a_film_are_those_that_are_drawn_one_by_one(load, case):
    graph = load(case)
    alone = [anew(graph, time) for time in TIMES]
    film = [
        draw(pipeline.frame_of(graph, "film", (32, 18), moment, 0), samples=1) for moment in Run(graph).moments(TIMES)
    ]
    for one, other in zip(film, alone, strict=True):
        np.testing.assert_array_equal(one.linear, other)


@each_case
def test_frames_drawn_out_of_order_and_of_several_variants_are_the_same(load, case):
    graphs = load(case), load(case, variant="small")
    alone = [[anew(graph, time) for time in TIMES] for graph in graphs]
    made = [frames(graph) for graph in graphs]
    for which, k in [(0, 4), (1, 4), (0, 1), (0, 4), (1, 0), (0, 2), (1, 2), (0, 0), (1, 0)]:
        np.testing.assert_array_equal(draw(made[which][k], samples=1).linear, alone[which][k])


def test_the_light_of_an_open_shutter_is_that_of_its_instants(load):
    graph = load("moved", sets=["outputs.film.video.shutter=180 deg", "outputs.film.video.exposures=4"])
    kind = graph.tasks["film"].kind
    times = kind.times(graph.settings.clock)[:8]

    def gathered(moments):
        tools = pipeline.Tools(graph, "film", pipeline.Report(), None)
        return [tools.pixels(kind, moment, k % 4, 4) for k, moment in enumerate(moments)][3::4]

    one_run = gathered(Run(graph).moments(times))
    own_runs = gathered(next(Run(graph).moments([time])) for time in times)
    np.testing.assert_array_equal(one_run, own_runs)


def test_arrays_are_the_same_for_as_long_as_nothing_moves(load):
    def same(case):
        made = [next(shape for shape in one.shapes if isinstance(shape, Mesh)) for one in frames(load(case))]
        assert all(is_held(array) for mesh in made for array in (mesh.vertices, mesh.triangles, mesh.normals))
        return {len({id(getattr(mesh, part)) for mesh in made}) for part in ("vertices", "triangles", "normals")}

    assert same("still") == same("of a color that changes") == {1}
    moved = [next(shape for shape in one.shapes if isinstance(shape, Mesh)) for one in frames(load("moved"))]
    assert len({id(mesh.vertices) for mesh in moved}) == len(TIMES)
    with pytest.raises(ValueError, match="read-only"):
        moved[0].vertices[0, 0] = 0.0


def test_what_moves_by_forces_holds_nothing(load):
    sheets = [one.shapes[-1] for one in frames(load("beside a cloth"))]
    assert {sheet.name for sheet in sheets} == {"sheet"}
    assert not any(is_held(sheet.vertices) for sheet in sheets)


@each_case
def test_what_was_made_of_a_mesh_goes_with_it(load, case):
    packed._trees, packed._rows = OfHeld(), OfHeld()
    graph = load(case)
    most = 0
    for moment in Run(graph).moments(TIMES):
        draw(pipeline.frame_of(graph, "film", (32, 18), moment, 0), samples=1)
        most = max(most, len(packed._trees), len(packed._rows))
    assert most == (2 if case == "twice" else 1)
    del moment
    gc.collect()
    assert len(packed._trees) == len(packed._rows) == 0


def test_a_mesh_that_is_held_is_made_ready_once(load, monkeypatch):
    asked = []
    monkeypatch.setattr(packed, "Tree", lambda boxes: asked.append(len(boxes)) or Tree(boxes))
    packed._trees = OfHeld()
    for one in frames(load("of a color that changes")):
        draw(one, samples=1)
    assert asked == [9120]  # those at the poles have no area


def test_a_held_mesh_looks_as_any_other():
    mesh = round_mesh(WHITE)
    for normals in (mesh.normals, None):
        plain = replace(mesh, normals=normals)
        still = replace(plain, vertices=held(mesh.vertices.copy()), triangles=held(mesh.triangles.copy()))
        beside = floor(height=-1.0), sphere(GLOW, (0.7, 0.0, 1.0), 0.4), sphere(WHITE, (-1.0, 0.5, 0.5), 0.3)
        seen = view((1.3, 0.9, 5.0), (0.1, 0.0, 0.0))
        one, other = (
            draw(frame(beside[0], shape, *beside[1:], lights=(sun((1, 2, 3)),), seen=seen), samples=4).linear
            for shape in (plain, still)
        )
        np.testing.assert_allclose(one, other, atol=1e-6)


def test_a_held_mesh_is_drawn_in_the_colors_and_normals_that_it_has_now():
    mesh = round_mesh(WHITE)
    mesh = replace(mesh, vertices=held(mesh.vertices.copy()), triangles=held(mesh.triangles.copy()))
    shades = np.random.default_rng(1).random((3, len(mesh.vertices), 3))
    made = [
        replace(mesh, colors=held(shades[0])),
        replace(mesh, colors=held(shades[1])),
        replace(mesh, colors=shades[2]),
    ]
    made += [replace(made[0], normals=held(-mesh.normals)), made[0]]
    scene = {"lights": (sun((1, 2, 3)),), "seen": view((1.3, 0.9, 5.0), (0.1, 0.0, 0.0))}
    pictures = [draw(frame(one, **scene), samples=1).linear for one in made]
    for picture, one in zip(pictures, made, strict=True):
        free = replace(one, vertices=one.vertices.copy(), triangles=one.triangles.copy())
        np.testing.assert_allclose(picture, draw(frame(free, **scene), samples=1).linear, atol=1e-6)
    assert not np.allclose(pictures[0], pictures[1])


@pytest.mark.parametrize("far", [np.inf, -np.inf, np.nan, 1.7e308])
def test_a_held_mesh_with_a_vertex_beyond_numbers_is_drawn_as_any_other(far):
    mesh = round_mesh(WHITE)
    vertices = np.array(mesh.vertices)
    vertices[7, 0] = far
    free = replace(mesh, vertices=vertices)
    still = replace(mesh, vertices=held(vertices.copy()), triangles=held(mesh.triangles.copy()))
    one, other = (draw(frame(shape, seen=view((1.3, 0.9, 5.0))), samples=1).linear for shape in (free, still))
    np.testing.assert_array_equal(one, other)


def test_a_view_of_what_may_be_written_to_is_not_held():
    array = np.zeros((5, 3))
    part = array[1:]
    part.flags.writeable = False
    assert not is_held(part)
    assert not is_held(np.broadcast_to(np.zeros(3), (5, 3)))
    assert is_held(held(part))
    assert is_held(array)


def test_an_array_is_never_taken_for_another_at_its_place_in_memory():
    made = OfHeld()
    for k in range(50):
        array = held(np.full(3, float(k)))
        assert made.get((array, None), None, array.sum) == 3.0 * k
        del array
    assert len(made) == 0


boxes = st.lists(st.tuples(*[st.floats(-2, 2)] * 3, *[st.floats(0, 1)] * 3), min_size=1, max_size=40).map(
    lambda rows: np.array([(*row[:3], *np.add(row[:3], row[3:])) for row in rows])
)
eyes = st.tuples(*[st.floats(-4, 4)] * 3).map(np.array)


@settings(max_examples=50)
@given(boxes, st.lists(eyes, min_size=1, max_size=4))
def test_a_tree_for_one_eye_after_another_is_that_of_a_new_one(made, several):
    tree = Tree(made)
    for eye in several:
        for old, new in zip(tree.seen_from(eye), Tree(made).seen_from(eye), strict=True):
            np.testing.assert_array_equal(old, new)
        for old, new in zip(tree.seen_from(eye), hierarchy(made, eye), strict=True):
            np.testing.assert_array_equal(old, new)


def test_items_whose_middles_differ_by_the_least_number_are_in_one_hierarchy():
    made = np.zeros((9, 6))
    made[1::2, 3:] = 5e-324
    made[2::3, 3] = 1e-310
    order, nodes, links = hierarchy(made, np.ones(3))
    assert sorted(order) == list(range(9))
    assert links[:, 2].sum() == 9
    np.testing.assert_array_equal(nodes[0, 3:], made[:, 3:].max(axis=0))


@settings(max_examples=50)
@given(st.one_of(boxes, st.just(np.empty((0, 6)))), st.lists(boxes, max_size=3), eyes)
def test_a_hierarchy_with_trees_has_every_item_once_inside_of_its_nodes(loose, own, eye):
    order, nodes, links = hierarchy(loose, eye, [Tree(one) for one in own])
    every = np.concatenate([loose, *own])
    assert sorted(order) == list(range(len(every)))
    seen = []

    def walk(node, end, box):
        """Meet all items below nodes up to an end, inside a box."""
        while node < end:
            assert (nodes[node, :3] >= box[:3]).all()
            assert (nodes[node, 3:] <= box[3:]).all()
            after, first, count = links[node]
            assert node < after <= end
            for item in order[first : first + count]:
                assert (every[item, :3] >= nodes[node, :3]).all()
                assert (every[item, 3:] <= nodes[node, 3:]).all()
                seen.append(item)
            walk(node + 1, after, nodes[node])
            node = after

    walk(0, len(nodes), np.repeat([-np.inf, np.inf], 3))
    assert sorted(seen) == list(range(len(every)))


@each_case
def test_raster_draws_a_film_as_its_frames_one_by_one(load, case):
    try:
        canvas(16, 16)
    except ValueError as why:
        pytest.skip(f"this machine has no OpenGL that draws off-screen: {why}")
    graph = load(case)

    def drawn(one):
        return raster(one, 8, False, 1, True, 2.0).linear

    made = frames(graph)
    film = [drawn(one) for one in made]
    again = [drawn(one) for one in reversed(made)]
    alone = [drawn(frames(graph, [time])[0]) for time in TIMES]
    np.testing.assert_array_equal(film, alone)
    np.testing.assert_array_equal(again[::-1], alone)


def test_of_arrays_that_may_change_nothing_is_kept():
    made, array = OfHeld(), np.zeros(3)
    assert made.get((array,), None, array.sum) == 0.0
    array += 1.0
    assert made.get((array,), None, array.sum) == 3.0
    assert len(made) == 0
