"""How models draw themselves: what the script says of their look holds, whatever else shows them."""

from __future__ import annotations

import pytest

from sceneql.frame import Points
from sceneql.pipeline import load, simulate
from sceneql.shapes.color import default_color, linear

NET = """
models:
  net:
    mass_spring:
      LOOK
      masses: {hook: {position: 0 1 0 m, fixed: yes}, bob: {position: 1 1 0 m}}
      springs: [{between: [hook, bob], stiffness: 20 N/m}]
objects: {OBJECT}
outputs: {still: {image: {time: 0 s}}}
"""


COIL = "coil: {coil: {from: 0 1 0 m, to: net.bob.position}}"
CUBE = "cube: {box: {position: 0.5*(net.hook.position + net.bob.position)}}"


@pytest.mark.parametrize("shown", [COIL, CUBE])
@pytest.mark.parametrize(("look", "drawn"), [("", 1), ("look: auto", 1), ("look: coil", 2), ("look: line", 2)])
def test_a_written_look_is_drawn_beside_an_object_that_shows_the_model(tmp_path, shown, look, drawn):
    (tmp_path / "scene.yaml").write_text(NET.replace("LOOK", look).replace("OBJECT", shown))
    assert load(tmp_path / "scene.yaml").drawn["still"] == (shown.partition(":")[0], "net")[:drawn]


def test_an_object_at_one_mass_hides_no_spring(tmp_path):
    ball = "ball: {sphere: {position: net.bob.position}}"
    net = NET.replace("LOOK", "").replace("OBJECT", ball)
    (tmp_path / "scene.yaml").write_text(net)
    assert load(tmp_path / "scene.yaml").drawn["still"] == ("ball", "net")
    (tmp_path / "scene.yaml").write_text(net.replace(ball, f"{ball}, {COIL}"))
    assert load(tmp_path / "scene.yaml").drawn["still"] == ("ball", "coil")
    (tmp_path / "scene.yaml").write_text(
        net.replace("springs: [{between: [hook, bob], stiffness: 20 N/m}]", "radius: 1 cm")
    )
    assert load(tmp_path / "scene.yaml").drawn["still"] == ("ball",)


def test_listed_particles_have_colors_of_their_own(tmp_path):
    (tmp_path / "scene.yaml").write_text(
        "models: {them: {particles: {list: {a: {color: red, position: 1 0 0 m}, b: {position: 2 0 0 m}, "
        "c: {color: lime, position: 3 0 0 m}, d: {position: 4 0 0 m}}}}}\n"
    )
    (moment,) = simulate(load(tmp_path / "scene.yaml"), [0.0])
    (points,) = (shape for shape in moment.lower(["them"]) if isinstance(shape, Points))
    colors = {float(x): tuple(color) for x, color in zip(points.centers[:, 0], points.colors, strict=True)}
    assert colors == {1: linear([1, 0, 0]), 2: default_color(0), 3: linear([0, 1, 0]), 4: default_color(0)}


@pytest.mark.parametrize("names", ["a", "ab"])
def test_listed_particles_of_one_color_have_it(tmp_path, names):
    listed = ", ".join(f"{name}: {{color: lime, position: {k} 0 0 m}}" for k, name in enumerate(names))
    (tmp_path / "scene.yaml").write_text(f"models: {{them: {{particles: {{list: {{{listed}}}}}}}}}\n")
    (moment,) = simulate(load(tmp_path / "scene.yaml"), [0.0])
    (points,) = (shape for shape in moment.lower(["them"]) if isinstance(shape, Points))
    assert [tuple(color) for color in points.colors] == [linear([0, 1, 0])] * len(names)


@pytest.mark.parametrize(("more", "count"), [("", 3), ("color: red", 1), ("material: {matte: {}}", 1)])
def test_listed_particles_that_have_no_color_are_told_apart(tmp_path, more, count):
    """A sun and its planets, of which a script says nothing, are not all red."""
    listed = "list: {sun: {}, earth: {position: 1 0 0 m}, moon: {position: 2 0 0 m}}"
    (tmp_path / "scene.yaml").write_text(f"models: {{them: {{particles: {{{listed}, {more}}}}}}}")
    (moment,) = simulate(load(tmp_path / "scene.yaml"), [0.0])
    (points,) = (shape for shape in moment.lower(["them"]) if isinstance(shape, Points))
    colors = [points.surface.color] if points.colors is None else [tuple(color) for color in points.colors]
    assert len(set(colors)) == count
