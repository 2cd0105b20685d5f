"""The stage: what a script that says nothing of ground and light stands on, and what it takes to do without."""

from __future__ import annotations

import pytest
import yaml

from runs import watch
from sceneql.frame import Quadric
from sceneql.kinds import Light
from sceneql.pipeline import Report, Tools, load, simulate
from sceneql.quantities.diagnostic import ScriptError
from sceneql.report.explain import explain
from sceneql.report.explain import text as told
from sceneql.report.unsaid import unsaid

BALL = "ball: {sphere: {radius: 0.2 m, position: 0 2 0 m}}"
FALL = "models: {fall: {particles: {of: ball, mass: 1 kg}}}"
SPRING = """models:
  net:
    mass_spring:
      masses: {a: {position: 0 1 0 m, fixed: yes}, b: {position: 1 1 0 m}}
      springs: [{between: [a, b], stiffness: 9 N/m}]
"""


def graph_of(folder, text):
    (folder / "scene.yaml").write_text(text + "\noutputs: {still: {image: {size: 64 36, time: 0 s}}}\n")
    return load(folder / "scene.yaml")


@pytest.mark.parametrize(
    ("text", "word"),
    [
        (f"objects: {{{BALL}}}", "ground"),
        (f"objects: {{{BALL}}}\n{FALL}\nforces: [gravity]", "ground"),
        (f"objects: {{{BALL}}}\n{FALL}\nforces: [gravity, collision]", "plane"),
        (f"objects: {{{BALL}, step: box}}\n{FALL}\nforces: [gravity, collision]", "plane"),
        (f"objects: {{{BALL}}}\nlights: [studio]", "ground"),
        (f"objects: {{{BALL}}}\n{FALL}", None),
        (SPRING, None),
        ("models: {heat: {diffusion: {size: 1 1 m, cell: 0.1 m, coefficient: 0.1 m^2/s, initial: x}}}", None),
        (f"objects: {{{BALL}}}\nlights: [sun]", None),
        (f"objects: {{{BALL}}}\nbackground: black", None),
        (f"objects: {{{BALL}, floor: none}}", None),
        (f"objects: {{{BALL}, floor: none}}\n{FALL}\nforces: [gravity, collision]", None),
    ],
)
def test_there_is_a_ground_where_things_fall_or_nothing_is_simulated(tmp_path, text, word):
    floor = graph_of(tmp_path, text).tasks.get("floor")
    assert (None if floor is None else floor.word) == word


PAIR = "models: {a: {particles: {positions: [0 0 0 m, 1 0 0 m]}}}"


@pytest.mark.parametrize(
    ("text", "dark"),
    [
        (f"{PAIR}\nforces: [mutual_gravity]", True),
        (f"{PAIR}\nforces: [attractor]", True),
        (f"{PAIR}\nforces: [{{attractor: {{exponent: -1}}}}]", False),
        (f"{PAIR}\nforces: [{{electrostatic: {{charge: 1 C}}}}]", True),
        ("models: {stars: {galaxy: {stars: 10}}}", True),
        (f"{PAIR}\nobjects: {{puffs: {{sprites: {{at: a.positions}}}}}}", True),
        (f"{PAIR}\nobjects: {{puffs: {{sprites: {{at: a.positions, blend: covers, color: gray}}}}}}", True),
        (f"{PAIR}\nobjects: {{puffs: {{sprites: {{at: a.positions, blend: covers, color: black}}}}}}", False),
        ("objects: {lamp: {sphere: {material: glow}}, floor: none}", True),
        ("objects: {lamp: {sphere: {material: glow}}}", False),
        (f"{PAIR}\nforces: [mutual_gravity]\nobjects: [plane]", False),
        (f"{PAIR}\nforces: [mutual_gravity]\nbackground: gray", False),
        (f"{PAIR}\nforces: [{{force: {{components: [1 N, 0 N, 0 N]}}}}]", False),
    ],
)
def test_what_shines_or_moves_in_empty_space_is_before_the_dark(tmp_path, text, dark):
    graph = graph_of(tmp_path, text)
    assert graph.tasks["light"].kind.backdrop == ("dark" if dark else "light")
    assert ("backdrop: dark" in unsaid(graph)) == dark


def test_the_picture_before_the_dark_is_dark_and_its_bodies_are_not(tmp_path):
    text = "{a: {particles: {list: {sun: {radius: 0.5 m}}, color: white}}}\nforces: [mutual_gravity]"
    graph = graph_of(tmp_path, f"models: {text}")
    (moment,) = simulate(graph, [0.0])
    pixels = Tools(graph, "still", Report(), tmp_path / "it").pixels(graph.tasks["still"].kind, moment)
    assert pixels[:, [0, -1]].max() < 50
    assert pixels[18, 32].min() > 150


def test_a_scene_with_a_ground_of_its_own_gets_no_other(tmp_path):
    graph = graph_of(tmp_path, f"objects: {{{BALL}, meadow: {{plane: {{height: -1 m}}}}}}\n{FALL}\nforces: [collision]")
    assert "floor" not in graph.tasks


@pytest.mark.parametrize(
    ("models", "height"),
    [
        ("{a: {particles: {list: {x: {position: 0 3 0 m}, y: {position: 0 1 0 m}}}}}", 0.0),
        ("{a: {particles: {list: {x: {position: 0 -3 0 m, radius: 0.5 m}}, radius: 9 m}}}", -3.5),
        ("{a: {particles: {positions: [0 1 0 m, 0 -2 0 m], radius: 0.25 m}}}", -2.25),
        ("{a: {mass_spring: {lattice: {count: 2 3 4, spacing: 1 m, center: 0 -2 0 m}}}}", -3.0),
        (
            "{a: {mass_spring: {lattice: {count: 3 1 1, spacing: 1 m, rotation: {about: z, angle: 30 deg}}}}}",
            -0.5,
        ),
        ("{a: {mass_spring: {rope: {from: 0 1 0 m, to: 2 -1.5 0 m}, radius: 0.1 m}}}", -1.6),
        ("{a: {mass_spring: {cloth: {size: 2 3 m, center: 0 -1 0 m}}}}", -1.0),
        ("{a: {mass_spring: {cloth: {size: 2 3 m, center: 0 -1 0 m, facing: 0 0 1}}}}", -2.5),
    ],
)
def test_what_is_hit_lies_at_zero_or_under_what_starts_lower(tmp_path, models, height):
    graph = graph_of(tmp_path, f"models: {models}\nforces: [gravity, collision]")
    assert graph.tasks["floor"].kind.height.number() == pytest.approx(height, abs=1e-12)


def test_a_floor_that_is_named_and_not_written_is_the_default_one(tmp_path):
    models = "{a: {particles: {list: {x: {position: 0 -3 0 m, radius: 0.5 m}}}}}"
    graph = graph_of(tmp_path, f"models: {models}\ncontacts: {{touch: {{collision: {{between: [a, floor]}}}}}}")
    assert graph.tasks["floor"].word == "plane"
    assert graph.tasks["floor"].kind.height.number() == pytest.approx(-3.5, abs=1e-12)


def test_an_object_that_falls_from_below_zero_has_the_ground_under_it(tmp_path):
    objects = "objects: {ball: {sphere: {radius: 0.2 m, position: 0 -2 0 m}}}"
    graph = graph_of(tmp_path, f"{objects}\n{FALL}\nforces: [gravity, collision]")
    assert graph.tasks["floor"].kind.height.number() == pytest.approx(-2.2, abs=1e-12)


def test_a_body_that_starts_lower_has_the_ground_under_it(tmp_path):
    """A held block under the height 0 was said to start inside of a floor that the script does not have."""
    objects = "objects: {ground: {box: {size: 9 1 9 m, position: 0 -0.5 0 m}}, ball: {sphere: {position: 0 3 0 m}}}"
    bodies = "models: {earth: {rigid: {of: ground, fixed: yes}}, fall: {rigid: {of: ball, mass: 1 kg}}}"
    graph = graph_of(tmp_path, f"{objects}\n{bodies}\nforces: [gravity, collision]")
    assert graph.tasks["floor"].kind.height.number() == pytest.approx(-1, abs=1e-12)


@pytest.mark.parametrize(
    ("other", "height"),
    [
        ("sphere: {radius: 0.6 m, position: 3 0 0 m}", -0.6),
        ("box: {position: 3 0.2 0 m, rotation: {about: z, angle: 45 deg}}", 0.2 - 0.5**0.5),
        ("torus: {radius: 1 m, tube: 0.2 m, position: 3 -1 0 m}", -1.2),
        ("box: {position: 3 4 0 m}", 0.0),
        ("box: {position: 3 -4 0 m, hidden: yes}", 0.0),
    ],
)
def test_what_is_hit_lies_under_an_object_that_stands_lower(tmp_path, other, height):
    (tmp_path / "scene.yaml").write_text(f"""
clock: {{end: 3 s}}
objects: {{{BALL}, other: {{{other}}}}}
{FALL}
forces: [gravity, {{collision: {{restitution: 0}}}}]
outputs: {{data: {{record: {{of: [fall.position]}}}}}}
""")
    *_, end = simulate(load(tmp_path / "scene.yaml"), [0.0, 3.0])
    assert end.run.graph.tasks["floor"].kind.height.number() == pytest.approx(height, abs=1e-3)
    assert end.read("fall", "position") == pytest.approx([0, height + 0.2, 0], abs=1e-3)


def test_a_ball_comes_to_rest_beside_a_step_on_the_ground(tmp_path):
    """Not for ever downwards, as where another object took the ground's place."""
    script = f"""
clock: {{end: 3 s}}
objects: {{{BALL}, step: {{box: {{position: 5 0.5 0 m}}}}}}
{FALL}
forces: [gravity, {{collision: {{restitution: 0}}}}]
outputs: {{data: {{record: {{of: [fall.position]}}}}}}
"""
    ((place,),) = watch(tmp_path, script, [3], "fall.position")
    assert place == pytest.approx([0, 0.2, 0], abs=1e-9)


def test_a_ground_that_nothing_hits_lies_under_the_lowest_point_of_the_film(tmp_path):
    text = f"clock: {{end: 1 s}}\nobjects: {{{BALL}}}\n{FALL}\nforces: [gravity]"
    graph = graph_of(tmp_path, text)
    (moment,) = simulate(graph, [0.0])
    shapes = Tools(graph, "still", Report(), tmp_path / "it").frame(moment).shapes
    (floor,) = (shape for shape in shapes if isinstance(shape, Quadric) and shape.name == "floor")
    level = -floor.to_local[:, 3] @ floor.to_local[:, :3]  # of the point of the plane that is its own origin
    assert abs(level[1]) == pytest.approx(9.81 / 2 - 2 + 0.2, abs=1e-6)


def test_a_ground_that_takes_a_run_ahead_is_told(tmp_path):
    falls = f"objects: {{{BALL}}}\n{FALL}\nforces: [gravity]"
    said = "the physics runs once ahead of the film: camera frames all of it; floor lies under all of it"
    assert said in told(explain(graph_of(tmp_path, falls))).splitlines()
    assert "floor lies" not in told(explain(graph_of(tmp_path, falls.replace("gravity", "gravity, collision"))))
    assert "floor lies" not in told(explain(graph_of(tmp_path, f"objects: {{{BALL}}}")))


def test_only_a_default_may_be_none(tmp_path):
    with pytest.raises(ScriptError, match="'none' is no word of objects"):
        graph_of(tmp_path, "objects: {ball: none}")


@pytest.mark.parametrize(
    "text",
    [
        f"objects: {{{BALL}}}",
        f"objects: {{{BALL}, ring: {{torus: {{position: 1 0 0 m}}}}}}\n{FALL}\nforces: [gravity, collision]",
        f"objects: {{{BALL}}}\n{FALL}\nforces: [gravity]\ncameras: [orthographic]\nbackground: black",
        f"objects: {{{BALL}}}\n{FALL}\nforces: [attractor]",
    ],
)
def test_the_defaults_that_explain_prints_make_the_same_picture_when_pasted(tmp_path, text):
    def drawn(graph):
        (moment,) = simulate(graph, [0.0])
        shapes = Tools(graph, "still", Report(), tmp_path / "it").frame(moment).shapes
        lights = [task.kind.lower(moment) for task in graph.tasks.values() if isinstance(task.kind, Light)]
        view = graph.tasks[graph.cameras["still"]].kind.view((64, 36), moment)
        return sorted(map(repr, [*shapes, *(source for light in lights for source in light)])), repr(view)

    before = graph_of(tmp_path, text)
    assert load(tmp_path / "scene.yaml").tasks.keys() == before.tasks.keys()
    (tmp_path / "pasted.yaml").write_text((tmp_path / "scene.yaml").read_text() + unsaid(before))
    assert load(tmp_path / "pasted.yaml").tasks.keys() == before.tasks.keys()
    missing = yaml.safe_load(unsaid(before).replace("# ", ""))
    written = yaml.safe_load(text)
    for family, entries in missing.items():
        old = written.get(family, {})
        written[family] = (
            [*old, *({name: word} for name, word in entries.items())] if type(old) is list else {**old, **entries}
        )
    after = graph_of(tmp_path, yaml.safe_dump(written, sort_keys=False))
    assert missing.keys() >= {"solvers"} if "models" in written else {"lights"}
    assert [task.name for task in after.tasks.values() if task.span is None] == []
    assert drawn(after) == drawn(before)
