"""Islands marched in blocks of their bodies: the same motion as in one piece, whatever the number of threads."""

import numpy as np
import pytest

from runs import watch
from sceneql.failure import RunFailure
from sceneql.march import assembled
from sceneql.march.march_blocks import BlockMarch
from sceneql.pipeline import load
from sceneql.run.run import Run
from sceneql.words.contacts import collision

SCENE = """
clock: {{end: 2 s}}
objects:
  cloud: {{box: {{size: 1 0.6 1 m, position: 0 0.5 0 m, hidden: yes}}}}
  puff: {{sphere: {{radius: 0.4 m, position: 0 2 0 m, hidden: yes}}}}
  ball: {{sphere: {{radius: 0.15 m, position: 0.2 0 0.3 m}}}}
  floor: plane
models:
  dust: {{particles: {{fill: {{object: cloud, count: {count}}}, mass: 1 g, radius: 2 mm}}}}
  smoke: {{particles: {{fill: {{object: puff, count: 90}}, mass: 2 g, velocity: 0 -1 0 m/s}}}}
forces:
  - gravity
  - {{turbulence: {{speed: 1 m/s, size: 0.5 m, linear: 1 g/s, lifetime: 2 s}}}}
  - {{wind: {{velocity: [sin(3 rad/s * time) * 1 m/s, 0 m/s, 0 m/s], linear: 0.5 g/s}}}}
  - {{force: {{components: "[0.001*cos(t + x), 0, -0.001*vz]"}}}}
contacts:
  bounce: {{collision: {{between: [dust, smoke, floor, ball], restitution: 0.5, friction: 0.3, mode: local}}}}
solvers: {{main: {{{solver}: {{step: {step}}}}}}}
"""
OUTPUTS = (
    *("dust.positions", "dust.velocities", "dust.accelerations", "smoke.positions"),
    *("dust.energy", "smoke.dissipated", "bounce.hits.count", "bounce.hits.first.time", "bounce.hits.last.time"),
)


def run(tmp_path, monkeypatch, block=assembled.BLOCK, threads=1, solver="semi_implicit_euler", times=(0, 0.305, 0.8)):
    """So many that no step is cut at an impact."""
    monkeypatch.setattr(assembled, "BLOCK", block)
    monkeypatch.setenv("SCENEQL_THREADS", str(threads))
    return watch(tmp_path, SCENE.format(count=9300, solver=solver, step="10 ms"), times, *OUTPUTS)


@pytest.mark.parametrize("solver", ["semi_implicit_euler", "rk4", "verlet"])
def test_blocks_move_as_the_whole_does(tmp_path, monkeypatch, solver):
    whole = run(tmp_path, monkeypatch, 10**6, solver=solver)
    parts = run(tmp_path, monkeypatch, solver=solver)
    assert whole[-1][OUTPUTS.index("bounce.hits.count")] > 50
    for one, other in zip(whole, parts, strict=True):
        for name, a, b in zip(OUTPUTS, one, other, strict=True):
            if name.endswith(("energy", "dissipated")):  # sums, in another order
                np.testing.assert_allclose(a, b, rtol=1e-9)
            else:
                np.testing.assert_array_equal(a, b)


def test_threads_do_not_change_a_bit_of_blocks(tmp_path, monkeypatch):
    for one, other in zip(*(run(tmp_path, monkeypatch, threads=threads) for threads in (1, 3)), strict=True):
        for a, b in zip(one, other, strict=True):
            np.testing.assert_array_equal(a, b)


def test_instants_read_between_do_not_change_blocks(tmp_path, monkeypatch):
    (one,), (*_, other) = (run(tmp_path, monkeypatch, times=times) for times in ([0.8], [0.2, 0.404, 0.7, 0.8]))
    for a, b in zip(one, other, strict=True):
        np.testing.assert_array_equal(a, b)


def kind_of_march(tmp_path, monkeypatch, script):
    monkeypatch.setattr(assembled, "BLOCK", 40)
    path = tmp_path / "scene.yaml"
    path.write_text(script, encoding="utf-8")
    return type(Run(load(path)).islands[0].march)


def test_bodies_that_feel_one_another_are_not_divided(tmp_path, monkeypatch):
    script = SCENE.format(count=300, solver="rk4", step="10 ms")
    assert kind_of_march(tmp_path, monkeypatch, script) is BlockMarch
    tied = script.replace("  - gravity\n", "  - gravity\n  - {repulsion: {strength: 1 N, range: 1 cm}}\n")
    assert kind_of_march(tmp_path, monkeypatch, tied) is not BlockMarch
    chosen = SCENE.format(count=300, solver="dopri5", step="10 ms").replace("step:", "tolerance: 1e-3 #")
    assert kind_of_march(tmp_path, monkeypatch, chosen.replace("#", "}}}\n#")) is not BlockMarch


def test_a_block_that_fails_says_so_at_the_earliest_time(tmp_path, monkeypatch):
    monkeypatch.setattr(assembled, "BLOCK", 40)
    script = """
clock: {end: 30 s}
objects: {cloud: {box: {size: 1 1 1 m, hidden: yes}}}
models: {dust: {particles: {fill: {object: cloud, count: 200}, mass: 1 g}}}
forces: [{attractor: {position: 9 9 9 m, exponent: -1, strength: -9 m^3/s^2}}]
solvers: {main: {euler: {step: 10 ms}}}
"""
    with pytest.raises(RunFailure, match="grown beyond") as failure:
        watch(tmp_path, script, [30], "dust.positions")
    assert failure.value.part == "dust"
    assert 5 < failure.value.time < 15


SHOWER = """
clock: {{end: 2 s}}
objects: {{ring: {{torus: {{radius: 0.5 m, tube: 5 cm, position: 0 1 0 m, hidden: yes}}}}, floor: plane}}
models:
  spray:
    particles:
      emit: {{rate: 300 Hz, from: [0 m, "0.1 m * time/1 s", 0 m], within: ring, spread: 20 deg, variation: 0.2,
        lifetime: 0.7 s{more}}}
      mass: 1 g
forces: [gravity, {{drag: {{linear: 0.5 g/s}}}}]
contacts: {{bounce: {{collision: {{between: [spray, floor], restitution: 0.5, mode: local}}}}}}
solvers: {{main: {{{solver}: {{step: 7 ms}}}}}}
"""
OF_THE_SHOWER = (
    *("spray.positions", "spray.velocities", "spray.ages", "spray.radii", "spray.count"),
    *("spray.energy", "bounce.hits.count"),
)


@pytest.mark.parametrize("more", ["", ", most: 100", ", count: 250", ", start: 0.1 s, until: 0.5 s"])
@pytest.mark.parametrize("solver", ["rk4", "semi_implicit_euler"])
def test_births_and_deaths_in_blocks_are_those_of_the_whole(tmp_path, monkeypatch, solver, more):
    """As if they were so many that no step is cut at an impact."""
    monkeypatch.setattr(collision, "MOST_CUT", 0)
    script = SHOWER.format(solver=solver, more=more)

    def moments(block):
        monkeypatch.setattr(assembled, "BLOCK", block)
        return watch(tmp_path, script, [0.1, 0.301, 0.9, 1.2], *OF_THE_SHOWER)

    assert kind_of_march(tmp_path, monkeypatch, script) is BlockMarch
    for one, other in zip(moments(10**6), moments(30), strict=True):
        for name, a, b in zip(OF_THE_SHOWER, one, other, strict=True):
            if name.endswith("energy"):
                np.testing.assert_allclose(a, b, rtol=1e-9)
            else:
                np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_a_plane_that_never_moves_is_the_same_as_one_that_might(tmp_path, monkeypatch, friction):
    """Two ways through the kernels: the short one of a still plane, and that of any object."""
    monkeypatch.setattr(collision, "MOST_CUT", 0)
    script = f"""
clock: {{end: 2 s}}
objects:
  cloud: {{box: {{size: 1 0.3 1 m, position: 0 0.2 0 m, hidden: yes}}}}
  floor: {{plane: {{position: 0 0 0 m}}}}
models: {{dust: {{particles: {{fill: {{object: cloud, count: 300}}, mass: 1 g, radius: 2 mm, velocity: 0.4 0 0 m/s}}}}}}
forces: [gravity, {{wind: {{velocity: 1 0 0.5 m/s, linear: 1 g/s}}}}]
contacts:
  bounce: {{collision: {{between: [dust, floor], restitution: 0.4, friction: {friction}, mode: local}}}}
solvers: {{main: {{semi_implicit_euler: {{step: 5 ms}}}}}}
"""
    moving = script.replace("position: 0 0 0 m}", "position: [0 m, 0 m * time / 1 s, 0 m]}")
    assert moving != script
    outputs = ("dust.positions", "dust.velocities", "bounce.hits.count", "dust.dissipated")
    for one, other in zip(*(watch(tmp_path, text, [0.5, 1.1, 2], *outputs) for text in (script, moving)), strict=True):
        for a, b in zip(one, other, strict=True):
            np.testing.assert_allclose(a, b, rtol=1e-9, atol=1e-12)
