"""Soft objects on scripts: skeletons that follow models, colors, joints, paths, and triangles to draw."""

import math
from dataclasses import replace

import numpy as np
import pytest

from moment import IDENTITY, FakeMoment, const, link
from sceneql.failure import RunFailure
from sceneql.field.tape.tape_solid import field_values, paint_values
from sceneql.frame import Implicit, Mesh, Segments
from sceneql.mesh.measures import edge_counts, euler_characteristic, pieces
from sceneql.pipeline import load
from sceneql.quantities.arrays import evaluate_arrays
from sceneql.quantities.diagnostic import ScriptError
from sceneql.quantities.expression import Key, Keys, Number, Symbol, Type
from sceneql.run.run import Run
from sceneql.shapes.ears import ears
from sceneql.shapes.skeleton_parts import Part
from sceneql.words.objects.blobby import Blobby


def moments(folder, script, times):
    path = folder / "scene.yaml"
    path.write_text(script)
    return Run(load(path)).moments(times)


PATH = [[0, 0, 0], [1, 0.5, 0], [2, 0, 1], [1, 0, 2], [-0.5, 0.3, 1], [0, 0, 0]]
RIDE = f"""
clock: {{end: 2 s}}
models:
  ride: {{motion: {{along: {PATH}, progress: time/(1 s), even: yes, heading: 1 mm}}}}
  twin: {{motion: {{along: {PATH}, progress: time/(1 s)}}}}
objects:
  a: {{sphere: {{position: ride.position}}}}
  b: {{sphere: {{position: twin.position}}}}
  c: {{box: {{rotation: ride.rotation}}}}
"""


def test_an_even_path_is_gone_at_one_speed_and_headed_along(tmp_path):
    times = np.linspace(0.0, 1.0, 201)
    found = [(m.read("ride", "position"), m.read("twin", "position")) for m in moments(tmp_path, RIDE, times)]
    even, other = np.array(found).transpose(1, 0, 2)
    steps = np.linalg.norm(np.diff(even, axis=0), axis=1)
    assert steps.max() / steps.min() < 1.02
    rough = np.linalg.norm(np.diff(other, axis=0), axis=1)
    assert rough.max() / rough.min() > 1.1
    # Both go along the same curve: no place of one is off the other's.
    assert max(np.linalg.norm(other - place, axis=1).min() for place in even[::10]) < 2e-2
    for k, moment in enumerate(moments(tmp_path, RIDE, times[1:-1:20])):
        w, x, y, z = moment.read("ride", "rotation")
        ahead = np.array([1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)])
        way = even[2 + 20 * k] - even[20 * k]
        assert ahead == pytest.approx(way / np.linalg.norm(way), abs=2e-2)
        assert 2 * (y * z - w * x) == pytest.approx(0.0, abs=1e-12)  # its z axis keeps level


ARM = """
clock: {end: 2 s}
models:
  arm:
    joints:
      joints:
        shoulder: {at: 0 1 0 m, turn: {about: z, angle: 90 deg*time/(1 s)}}
        elbow: {of: shoulder, at: 1 0 0 m, turn: {about: x, angle: 90 deg}}
        hand: {of: elbow, at: 0 0.5 0 m}
objects:
  limb: {tube: {through: [arm.shoulder.position, arm.elbow.position, arm.hand.position]}}
  glove: {box: {rotation: arm.hand.rotation}}
"""


def test_joints_turn_all_that_hangs_on_them(tmp_path):
    for moment in moments(tmp_path, ARM, [0.0, 0.3, 1.0]):
        angle = 0.5 * math.pi * moment.time
        elbow = [math.cos(angle), 1 + math.sin(angle), 0]
        assert moment.read("arm", "elbow.position") == pytest.approx(elbow)
        assert moment.read("arm", "hand.position") == pytest.approx([*elbow[:2], 0.5])
        w, x, y, z = moment.read("arm", "hand.rotation")
        assert math.hypot(w, x, y, z) == pytest.approx(1.0)


def test_a_joint_hangs_on_one_before_it(tmp_path):
    with pytest.raises(ScriptError, match="not listed before it"):
        list(moments(tmp_path, ARM.replace("of: elbow", "of: foot"), [0.0]))


SOFT = """
clock: {end: 1 s}
models:
  puffs: {particles: {emit: {rate: 10 Hz, velocity: 0 1 0 m/s, lifetime: 0.35 s}, mass: 1 g}}
  net: {mass_spring: {lattice: {count: 2 2 2, spacing: 1 m}, pins: [0]}}
objects:
  smoke:
    blobby:
      skeleton: [{points: puffs.positions, radius: 0.1 m + 1 m/s*puffs.ages, weight: 1 - puffs.ages/(0.4 s)}]
  bars: {blobby: {kernel: metaball, skeleton: [{segments: net.springs, radius: 0.2 m}]}}
"""


def test_parts_come_and_go_with_a_model(tmp_path):
    counts = []
    for moment in moments(tmp_path, SOFT, [0.05, 0.15, 0.95]):
        blobby = moment.run.graph.tasks["smoke"].kind
        skeleton = blobby.parts(moment)
        counts.append(len(skeleton.weights))
        ages = moment.read("puffs", "ages")
        assert skeleton.radii[:, 0] == pytest.approx(0.1 + ages)
        assert skeleton.weights == pytest.approx(1 - ages / 0.4)
        bars = moment.run.graph.tasks["bars"].kind.parts(moment)
        assert bars.corners[:, :2] == pytest.approx(moment.read("net", "springs"))
        assert (bars.corners[:, 2] == bars.corners[:, 0]).all()
    assert counts == [1, 2, 3]


def pair(**more):
    left = Part(point=const([-0.4, 0, 0]), radius=const(0.8), color=const([1, 0, 0]))
    right = Part(point=const([0.4, 0, 0]), radius=const(0.8), color=const([0, 0, 1]), **more)
    return Blobby(skeleton=(left, right))


def test_colors_are_mixed_by_the_densities():
    (shape,) = pair().lower("pair", IDENTITY, FakeMoment())
    assert isinstance(shape, Implicit)
    places = np.array([[0.0, 0.3, 0.1], [-0.9, 0.1, 0.0], [0.9, 0.1, 0.0], [-0.2, 0.1, 0.0]])
    colors = paint_values(shape.paint, places)
    assert colors[0] == pytest.approx([0.5, 0, 0.5])
    assert colors[1] == pytest.approx([1, 0, 0])
    assert colors[2] == pytest.approx([0, 0, 1])
    near, far = (max(0, 1 - ((x + 0.2) ** 2 + 0.01) / 0.64) ** 3 for x in (-0.4, 0.4))
    assert colors[3] == pytest.approx([near / (near + far), 0, far / (near + far)])


def test_what_hollows_out_gives_no_color():
    (shape,) = pair(weight=const(-0.5)).lower("pair", IDENTITY, FakeMoment())
    assert paint_values(shape.paint, np.array([[-0.3, 0.1, 0.0]]))[0] == pytest.approx([1, 0, 0])


def test_an_object_as_triangles_keeps_its_surface_and_colors(tmp_path):
    script = """
objects:
  soft:
    polygonised:
      cell: 60 mm
      of:
        blobby:
          skeleton:
            - {point: -0.3 0 0 m, radius: 0.6 m, color: red}
            - {polyline: [0.3 0 0 m, 0.9 0.4 0 m], color: blue}
  round: {polygonised: {of: {sphere: {radius: 0.5 m, position: 3 0 0 m}}, cell: 0.1 m, edges: no}}
"""
    (moment,) = moments(tmp_path, script, [0.0])
    mesh, edges = moment.lower(["soft"])
    assert isinstance(mesh, Mesh)
    assert isinstance(edges, Segments)
    assert len(edges.ends) == edge_counts(mesh.triangles)[0] == 3 * len(mesh.triangles) // 2
    assert euler_characteristic(mesh.triangles) == 2
    assert mesh.colors[np.argmin(mesh.vertices[:, 0])] == pytest.approx([1, 0, 0])
    assert mesh.colors[np.argmax(mesh.vertices[:, 0])] == pytest.approx([0, 0, 1])
    (solid,) = moment.object(moment.run.graph.tasks["soft"].kind.of).lower("soft", IDENTITY, moment)
    assert np.abs(field_values(solid.tape, mesh.vertices)).max() < 1e-8
    (ball,) = moment.lower(["round"])
    assert np.linalg.norm(ball.vertices - [3, 0, 0], axis=1) == pytest.approx(0.5)


def test_a_sheet_as_triangles_is_its_solid(tmp_path):
    script = """
objects:
  sheet: {polygonised: {of: {implicit: {field: "x - 0.1*y", bounds: {ball: 0.5}, mode: surface}}, cell: 0.1 m}}
  solid: {polygonised: {of: {implicit: {field: "x - 0.1*y", bounds: {ball: 0.5}}}, cell: 0.1 m}}
"""
    (moment,) = moments(tmp_path, script, [0.0])
    sheet, solid = (moment.lower([name])[0] for name in ("sheet", "solid"))
    assert np.linalg.norm(sheet.vertices, axis=1).max() < 0.5 + 1e-9
    assert (sheet.vertices == solid.vertices).all()
    assert (sheet.triangles == solid.triangles).all()


@pytest.mark.parametrize(
    ("kind", "points", "match"),
    [
        ("polyline", [[0, 0, 0]], "too few"),
        ("polygon", [[0, 0, 0], [1, 0, 0]], "too few"),
        ("spline", [[0, 0, 0], [0, 0, 0], [1, 0, 0]], "are the same"),
    ],
)
def test_a_part_says_what_it_lacks(kind, points, match):
    with pytest.raises(RunFailure, match=match):
        Part(**{kind: const(points)}).now(FakeMoment())


def test_a_part_is_one_thing():
    with pytest.raises(ValueError, match="not point and points"):
        Part(point=const([0, 0, 0]), points=const([[0, 0, 0]]))
    with pytest.raises(ValueError, match="one of point"):
        Part(radius=const(1.0))


def test_a_million_parts_are_refused_where_they_are_told():
    part = Part(points=link("dust", "positions", (None, 3)))
    moment = FakeMoment(given={("dust", "positions"): np.zeros((1_000_000, 3))})
    with pytest.raises(RunFailure, match="at most 200,000 parts, not 1,000,000"):
        Blobby(skeleton=(part,)).lower("dust", IDENTITY, moment).__next__()


def test_a_polygon_is_filled_once():
    star = np.array([[r * math.cos(a), 0.2, r * math.sin(a)] for k in range(10) for a in [k * math.pi / 5] for r in
                     [1.0 if k % 2 else 0.4]])  # fmt: skip
    for corners in (star, star[::-1]):
        a, b, c = corners[ears(corners)].transpose(1, 0, 2)
        areas = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
        assert areas.sum() == pytest.approx(10 * 0.5 * 0.4 * math.sin(math.pi / 5))
        middles = (a + b + c) / 3
        assert len(middles) == 8
        radii, angles = np.hypot(middles[:, 0], middles[:, 2]), np.arctan2(middles[:, 2], middles[:, 0])
        assert (radii * np.cos((angles + math.pi) % (2 * math.pi / 5) - math.pi / 5) < 0.99).all()


def test_pieces_are_counted_by_what_hangs_together():
    ring = np.array([[k, (k + 1) % 40, 40] for k in range(40)], dtype=np.int32)
    assert pieces(ring) == 1
    assert pieces(np.concatenate([ring, ring + 41, ring + 82])) == 3
    assert pieces(np.zeros((0, 3), dtype=np.int32)) == 0


@pytest.mark.parametrize("curve", ["step", "linear", "smooth", "cubic"])
def test_keys_that_never_change_give_one_time_what_they_give_many(curve):
    values = [(0.0, 2.0), (0.5, -1.0), (1.2, 0.5), (2.0, 2.0)]
    keys = Keys(Symbol("time", Type()), tuple(Key(Number(t), Number(v)) for t, v in values), curve, Number(2.0))
    moving = replace(keys, keys=(*keys.keys[:1], Key(Number(0.5), Symbol("height", Type())), *keys.keys[2:]))
    times = np.linspace(-1.0, 5.0, 77)
    for expr, height in ((keys, -1.0), (moving, -1.0), (moving, 3.0), (keys, 3.0)):
        many = evaluate_arrays(expr, lambda node, h=height: times if node.name == "time" else h)
        single = [evaluate_arrays(expr, lambda node, t=t, h=height: t if node.name == "time" else h) for t in times]
        assert single == pytest.approx(many, abs=1e-14)


SPRAYED = """
clock: {end: 0.2 s, fps: 10}
models:
  spray: {particles: {emit: {rate: 30 Hz, spread: 30 deg, lifetime: 1 s, seed: 3}}}
objects:
  goo: {blobby: {skeleton: [{spline: spray.positions, radius: 0.1 m}, {point: 0 0 0 m}]}}
outputs: {film: {images: {size: 16 9, renderer: normals}}}
"""


def test_a_line_through_points_that_are_not_yet_there_comes_with_them(tmp_path):
    (goo,) = (task.kind for task in load_text(tmp_path, SPRAYED).tasks.values() if task.name == "goo")
    counts = [len(goo.parts(moment).weights) for moment in moments(tmp_path, SPRAYED, [0.0, 0.02, 0.19])]
    assert counts[0] == counts[1] == 1
    assert counts[2] > 3


def load_text(folder, script):
    path = folder / "scene.yaml"
    path.write_text(script)
    return load(path)
