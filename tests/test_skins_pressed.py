"""Skins in flows under what presses far harder than they pull: heavy bodies, heavy fillings, heavier skins."""

import numpy as np
import pytest

from sceneql.failure import RunFailure
from sceneql.pipeline import load
from sceneql.run.run import IslandRun

FLOOR = 0.08
GAP = 1 / 20
"""A cell."""


class Pressed:
    """Skins over a floor, on their way."""

    def __init__(self, folder, skins, objects, more="", weighs="", between=""):
        names = ", ".join(skins)
        (folder / "scene.yaml").write_text(
            "clock: {end: 2 s, fps: 10}\n"
            "models:\n  air: {flow: {size: 1 1 m, cell: 1/20 m, density: 1 kg/m^3, viscosity: 0.01 Pa*s}}\n"
            + "".join(f"  {name}: {{membrane: {{of: {name}_, {one}}}}}\n" for name, one in skins.items())
            + more
            + f"forces: [gravity: {weighs or '{}'}, immersion: {{on: [{names}], in: air}}]\n"
            f"contacts: {{land: {{collision: {{between: [{names}{between}, ledge]}}}}}}\n"
            f"objects:\n  ledge: {{plane: {{height: {FLOOR} m}}}}\n{objects}",
            encoding="utf-8",
        )
        graph = load(folder / "scene.yaml", pruned=False)
        self.tasks, self.run = graph.tasks, IslandRun(graph, graph.islands[0])

    def read(self, name, output):
        return self.tasks[name].kind.read(output, self.run.state(name))


def egg(name, a, b, high):
    field = f'"(x/{a})^2 + (y/{b})^2 - 1"'
    return f"  {name}_: {{implicit: {{bounds: {{ball: 1}}, position: 0.5 {high} 0 m, field: {field}}}}}\n"


@pytest.mark.parametrize("mass", [0.02, 2, 20])
def test_a_brick_rides_on_a_weak_skin_and_does_not_crush_it(tmp_path, mass):
    """Its weight by area is 0.1 to 100 times the pressure by which its skin keeps off, and it comes with 2 m/s."""
    brick = f"  brick: {{rigid: {{of: box, mass: {mass} kg, velocity: 0 -2 0 m/s}}}}\n"
    objects = egg("low", 0.3, 0.12, 0.25) + "  box: {box: {size: 0.2 0.1 0.1 m, position: 0.5 0.46 0 m}}\n"
    law = "law: {springs: {stretch: 2 N/m}}, prestress: 0.4 N/m"
    scene = Pressed(tmp_path, {"low": law}, objects, brick, "{on: [brick]}", ", brick")
    for time in np.arange(0.0, 0.36, 0.02):
        scene.run.advance(time)
        state = scene.run.state("brick")
        center, turn = state.y[state.bodies.position_at :][:2], state.y[state.bodies.turning.rotation_at :][:4]
        angle = 2.0 * np.arctan2(turn[3], turn[0])
        across = abs(0.1 * np.sin(angle)) + abs(0.05 * np.cos(angle))
        assert center[1] - across > FLOOR + 0.2 * GAP  # both sheets of the skin are between it and the floor
        x, y = (scene.read("low", "positions")[:, :2] - center).T
        along, off = x * np.cos(angle) + y * np.sin(angle), y * np.cos(angle) - x * np.sin(angle)
        assert ((np.abs(along) > 0.1) | (np.abs(off) > 0.05)).all()


@pytest.mark.parametrize("stretch", [4e3, 4e2, 4.0, 4e-2])
def test_a_bag_of_heavy_fluid_keeps_a_part_of_the_gap_however_weak_its_skin(tmp_path, stretch):
    """Its weight by area is 0.1 to 1e4 times the pressure by which its skin keeps off."""
    filling = "filling: {density: 1000 kg/m^3, viscosity: 80 Pa*s}"
    law = f"law: {{springs: {{stretch: {stretch} N/m}}}}, {filling}"
    scene = Pressed(tmp_path, {"bag": law}, egg("bag", 0.2, 0.12, FLOOR + 0.18))
    least = np.inf
    for time in (0.1, 0.15, 0.2, 0.25, 0.3):
        scene.run.advance(time)
        least = min(least, scene.read("bag", "positions")[:, 1].min() - FLOOR)
    assert 0.05 * GAP < least < GAP


@pytest.mark.parametrize("stretch", [400.0, 4.0, 0.4])
def test_a_heavy_skin_falls_on_one_of_other_stiffness(tmp_path, stretch):
    skins = {
        "low": f"law: {{springs: {{stretch: {stretch} N/m}}}}",
        "high": "law: {springs: {stretch: 400 N/m}}, filling: {density: 100 kg/m^3, viscosity: 8 Pa*s}",
    }
    scene = Pressed(tmp_path, skins, egg("low", 0.25, 0.14, 0.25) + egg("high", 0.12, 0.12, 0.54))
    for time in np.arange(0.0, 0.41, 0.04):
        scene.run.advance(time)
        low, high = (scene.read(name, "positions") for name in ("low", "high"))
        assert not scene.tasks["low"].kind.made.encloses(high, low).any()
        assert not scene.tasks["high"].kind.made.encloses(low, high).any()
        assert min(low[:, 1].min(), high[:, 1].min()) > FLOOR
    assert high[:, 1].min() > FLOOR + 0.2 * GAP


def test_a_run_that_fails_says_that_a_skin_has_stretched_too_far(tmp_path):
    (tmp_path / "scene.yaml").write_text(
        "clock: {end: 1 s}\nmodels:\n"
        "  air: {flow: {size: 1 1 m, cell: 5 cm, density: 1 kg/m^3, viscosity: 1e-3 Pa*s, force: '[0, x/(0.11 - t)^2]',"
        " initial: {stream_function: '0.5*sin(2*pi*x)*sin(2*pi*y)'}}}\n"
        "  balloon: {membrane: {of: ball, law: {tension: 0.01 N/m}}}\n"
        "forces: [{immersion: {on: [balloon], in: air}}]\n"
        "objects: {ball: {sphere: {position: 0.5 0.5 0 m, radius: 0.2 m}}}\n",
        encoding="utf-8",
    )
    graph = load(tmp_path / "scene.yaml", pruned=False)
    with pytest.raises(RunFailure) as found:
        IslandRun(graph, graph.islands[0]).advance(0.2)
    assert found.value.time == pytest.approx(0.11)
    assert found.value.help.startswith("'balloon': the vertices of its skin are 1.")
    assert found.value.help.endswith("; take a smaller `spacing`, or a law that stretches less")
