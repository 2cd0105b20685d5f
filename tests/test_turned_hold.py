"""A part of an elastic solid that follows an object, which turns."""

import numpy as np
import pytest

from runs import complaint, watch
from sceneql.pipeline import load
from sceneql.quantities.diagnostic import ScriptError
from sceneql.run.run import Run

ANGLE = '"2 * smoothstep(0, 1, time/(0.3 s)) * 1 rad"'
HANDLE = f"handle: {{box: {{size: 1 1 1 m, position: 0.5 0.1 0 m, rotation: {{about: z, angle: {ANGLE}}}}}}}"


def scene(element, solver, hold="follows: handle"):
    return (
        f"clock: {{end: 0.4 s}}\nsolvers: {{main: {{{solver}}}}}\nobjects: {{{HANDLE}}}\n"
        f"models: {{bar: {{elastic: {{block: {{size: 1 0.2 0.2 m, cells: [4, 1, 1]}}, element: {element}, "
        f"law: {{neo_hookean: {{modulus: 50 kPa, poisson: 0.3}}}}, hold: {{end: {{where: x > 0.49, {hold}}}}}}}}}}}\n"
        "outputs: {film: {image: {size: 32 18}}}\n"
    )


def places(island):
    body = island.bodies["bar"]
    return island.y[body.position_at :][: 3 * body.count].reshape(-1, 3).copy()


@pytest.mark.parametrize("element", ["p1", "p2"])
@pytest.mark.parametrize("solver", ["dop853: {tolerance: 1e-9}", "bdf2: {step: 5 ms}", "verlet: {step: 0.1 ms}"])
def test_what_follows_an_object_stands_where_it_turns(tmp_path, element, solver):
    path = tmp_path / "scene.yaml"
    path.write_text(scene(element, solver), encoding="utf-8")
    island = Run(load(path, pruned=False)).islands[0]
    island.advance(0.0)
    start = places(island)
    led = np.flatnonzero(start[:, 0] > 0.49)
    for time in (0.1, 0.25, 0.4):
        island.advance(time)
        part = min(time / 0.3, 1.0)
        angle = 2.0 * part * part * (3.0 - 2.0 * part)
        turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
        about = np.array([0.5, 0.1, 0.0])
        assert places(island)[led] == pytest.approx(about + (start[led] - about) @ turn.T, abs=1e-6)


@pytest.mark.parametrize("element", ["p1", "p2"])
def test_the_work_that_turns_a_hold_is_all_that_the_solid_gains(tmp_path, element):
    times = [0.0, 0.15, 0.4]
    script = scene(element, "dop853: {tolerance: 1e-9}")
    kinetic, energy = zip(*watch(tmp_path, script, times, "bar.kinetic", "bar.energy", pruned=False), strict=True)
    assert kinetic[1] > 1.0
    assert energy == pytest.approx([energy[0]] * 3, abs=1e-4 * kinetic[1])


@pytest.mark.parametrize(
    "motion", ["position: ['0.1 m/s * time', 0 m, 0 m]", "rotation: {about: x, angle: 1 rad}", "scale: 2"]
)
def test_a_hold_does_not_follow_a_member_of_a_group_that_stands_elsewhere(tmp_path, motion):
    path, arm = tmp_path / "scene.yaml", f"arm: {{group: {{children: [handle], {motion}}}}}"
    path.write_text(scene("p1", "rk4: {step: 1 ms}").replace(HANDLE, f"{HANDLE}, {arm}"), encoding="utf-8")
    with pytest.raises(ScriptError) as raised:
        Run(load(path, pruned=False))
    assert "'handle' is a member of 'arm'" in str(raised.value)


def test_a_hold_has_one_motion(tmp_path):
    told = complaint(tmp_path, scene("p1", "rk4: {step: 1 ms}", "follows: handle, shift: 1 0 0 m"))
    assert "either has a shift or follows an object" in told


@pytest.mark.parametrize(
    ("handle", "more", "said"),
    [
        ("box: {size: 1 1 1 m}", "stone: {rigid: {of: handle, mass: 1 kg}}", "functions of time: stone.origin is not"),
        ('plane: {height: "0.1 m/s * time"}', "", "the height of 'handle' varies, by which a hold does not follow it"),
        ('tube: {through: [["0.1 m/s * time", 0 m, 0 m], 1 0 0 m]}', "", "'handle' has no position of its own"),
    ],
)
def test_a_hold_does_not_follow_what_it_cannot_see_move(tmp_path, handle, more, said):
    script = scene("p1", "rk4: {step: 1 ms}").replace(HANDLE, f"handle: {{{handle}}}")
    if more:
        script = script.replace("models: {", f"models: {{{more}, ")
    path = tmp_path / "scene.yaml"
    path.write_text(script, encoding="utf-8")
    with pytest.raises(ScriptError) as raised:
        Run(load(path, pruned=False))
    assert said in str(raised.value)
