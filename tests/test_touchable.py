"""What contacts touch that name nothing."""

import pytest

from runs import watch
from sceneql.pipeline import load
from test_contacts import DOPRI5, ball

RING = "{ring: {torus: {radius: 1 m, tube: 0.4 m}}}"
START = "position: 1 1.5 0 m, radius: 0.1 m"


def touched(folder, objects):
    path = folder / "scene.yaml"
    path.write_text(ball("{}", objects, "position: 0 9 0 m", 0.1, DOPRI5), encoding="utf-8")
    graph = load(path)
    ((_, _, others),) = graph.islands[0].contacts
    return others, [warning.message for warning in graph.warnings if warning.code == "not-touched"]


@pytest.mark.parametrize(
    "ring",
    [
        RING,
        "{ring: {implicit: {field: (sqrt(x^2 + z^2) - 1)^2 + y^2 - 0.16, bounds: {ball: 2}}}}",
        "{ring: {group: {children: [part]}}, part: {torus: {radius: 1 m, tube: 0.4 m}}}",
    ],
)
@pytest.mark.parametrize("mode", ["exact", "local"])
def test_a_ball_lands_on_an_object_that_is_not_named(tmp_path, ring, mode):
    script = ball(f"{{restitution: 0, mode: {mode}}}", ring, START, 1, "{rk4: {step: 1 ms}}")
    ((place,),) = watch(tmp_path, script, [1], "ball.a.position")
    assert place[1] == pytest.approx(0.5, abs=1e-6)


@pytest.mark.parametrize(
    ("objects", "names"),
    [
        (RING, ("ring", "floor")),
        ("{floor: plane, ring: torus}", ("floor", "ring")),
        ("{whole: {union: {of: [a, b]}}, a: torus, b: box}", ("whole", "floor")),
        ("{dot: {sphere: {radius: 0.1 m + 0.01 m/s*time}}}", ("dot", "floor")),
        ("{slider: {torus: {position: {x: 1 m/s*time, y: 0 m, z: 0 m}}}}", ("slider", "floor")),
        ("{wall: {box: {hidden: yes}}}", ("wall", "floor")),
        ("{floor: none, wall: box}", ("wall",)),
        ("{floor: plane, path: {trail: {of: ball.a.position}}}", ("floor",)),
        ("{floor: plane, drop: {blobby: {points: [ball.a.position], radius: 1 m}}}", ("floor",)),
    ],
)
def test_objects_with_an_inside_are_touched_and_decoration_is_not(tmp_path, objects, names):
    assert touched(tmp_path, objects) == (names, [])


@pytest.mark.parametrize(
    ("other", "reason"),
    [
        ("{torus: {tube: 0.1 m + 0.01 m/s*time}}", "it changes its shape in time"),
        ("{implicit: {field: 'x^2 + y^2 + z^2 - t'}}", "it changes its shape in time"),
        ("{sphere: {position: ball.a.position}}", "it follows 'ball', which is solved"),
        ("{group: {children: [part]}}, part: {mesh: {file: sheet.obj}}", "a part of it has no inside"),
    ],
)
def test_an_object_that_cannot_be_touched_is_left_out_with_a_warning(tmp_path, other, reason):
    (tmp_path / "sheet.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    assert touched(tmp_path, f"{{floor: plane, it: {other}}}") == (
        ("floor",),
        [f"contacts leave out 'it': {reason}"],
    )


def test_a_hidden_object_that_is_filled_is_no_wall(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(
        """
clock: {end: 1 s}
models: {dust: {particles: {fill: {object: cloud, count: 10}}}}
contacts: {hit: collision}
objects: {cloud: {torus: {hidden: yes, position: 0 3 0 m}}, floor: plane}
""",
        encoding="utf-8",
    )
    ((_, _, others),) = load(path).islands[0].contacts
    assert others == ("floor",)
