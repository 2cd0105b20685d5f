"""Fields and masses that act on one another: sources that move, what masses give, forces along gradients."""

from __future__ import annotations

import numpy as np
import pytest

from runs import complaint, watch

POND = """
clock: {{end: 2 s}}
models:
  pond:
    diffusion: {{size: 4 3 m, cell: 0.1 m, of: number, coefficient: {coefficient}, initial: {initial}, {more}}}
  boats:
    particles:
      list:
        a: {{position: 1 1 0 m, velocity: 0.5 0.25 0 m/s, mass: 2 kg}}
        b: {{position: 2.93 0.04 0 m, mass: 2 kg}}
forces: {{it: {force}}}
solvers: {{main: {solver}}}
outputs: {{table: {{record: {{of: [pond.mass, boats.energy]}}}}}}
"""


def pond(force="{drag: {linear: 0 N*s/m}}", coefficient="0.01", initial="0", more="", solver="{rk4: {step: 10 ms}}"):
    return POND.format(force=force, coefficient=coefficient, initial=initial, more=more, solver=solver)


@pytest.mark.parametrize("place", ["boats.a.position", "ferry.position"])
def test_a_source_moves_with_what_it_is_tied_to(tmp_path, place):
    source = f"source: 0.3/(2*pi*0.01)*exp(-((x-{place}.x)^2 + (y-{place}.y)^2)/0.02)"
    script = pond(more=source).replace(
        "  boats:", "  ferry: {motion: {position: '[1 m + 0.5 m/s*time, 1 m + 0.25 m/s*time, 0 m]'}}\n  boats:"
    )
    ((mass, inflow, field, centers),) = watch(
        tmp_path, script, [2], "pond.mass", "pond.inflow", "pond.concentration", "pond.centers"
    )
    assert mass == pytest.approx(0.6, abs=1e-8)  # sums of a smooth bump over cells are integrals
    assert inflow == pytest.approx(mass, abs=1e-12)
    assert field @ centers / field.sum() == pytest.approx([1.5, 1.25, 0], abs=2e-3)


def test_all_that_masses_give_comes_in_where_they_are(tmp_path):
    script = pond("{emission: {into: pond.concentration, rate: 0.5 m^3/s}}", coefficient="0")
    ((mass, inflow, field, centers),) = watch(
        tmp_path, script, [2], "pond.mass", "pond.inflow", "pond.concentration", "pond.centers"
    )
    assert mass == pytest.approx(2.0, abs=1e-12)
    assert inflow == pytest.approx(2.0, abs=1e-12)
    left = centers[:, 0] < 2.5
    middle = field[left] @ centers[left] / field[left].sum()
    assert middle == pytest.approx([1.5, 1.25, 0], abs=1e-3)
    right = field[~left] @ centers[~left] / field[~left].sum()
    assert right[0] == pytest.approx(2.93, abs=1e-9)
    assert right[1] == pytest.approx(0.05, abs=1e-9)  # beside the shore all goes to the row of cells there


def test_what_particles_give_ends_with_their_lives(tmp_path):
    script = pond("{emission: {into: pond.concentration, rate: 0.5 m^3/s}}", coefficient="0.01")
    a, b = script.index("      list:"), script.index("forces:")
    emit = "{rate: 10 Hz, from: 1 1 0 m, velocity: 1 0.5 0 m/s, lifetime: 0.35 s}"
    script = f"{script[:a]}      emit: {emit}\n      mass: 1 g\n{script[b:]}"
    ((mass, inflow),) = watch(tmp_path, script, [1], "pond.mass", "pond.inflow")
    lives = [min(0.35, 1 - j / 10) for j in range(10)]
    assert mass == pytest.approx(0.5 * sum(lives), rel=2e-2)  # by steps of 10 ms, in which they are born and die
    assert inflow == pytest.approx(mass, abs=1e-12)


def test_a_linear_field_pulls_evenly(tmp_path):
    script = pond("{field_gradient: {of: pond.concentration, factor: 3 J}}", coefficient="0", initial="2*x - y")
    script = script.replace("2.93 0.04", "1.5 2")
    ((a, b, v, energy),) = watch(
        tmp_path, script, [1], "boats.a.position", "boats.b.position", "boats.b.velocity", "boats.energy"
    )
    pull = np.array([3.0, -1.5, 0.0])  # 3 J * (2, -1)/m over 2 kg
    assert a == pytest.approx([1.5, 1.25, 0] + pull / 2, abs=1e-6)
    start = 0.5 * 2 * (0.5**2 + 0.25**2)
    assert energy == pytest.approx(start, abs=1e-9)  # once the work is counted
    assert v[0] == pytest.approx(pull[0], abs=1e-6)
    assert b == pytest.approx([1.5, 2, 0] + pull / 2, abs=1e-6)


def test_outside_its_domain_a_field_does_nothing(tmp_path):
    force = "{field_gradient: {of: pond.concentration, factor: 3 J}}"
    script = pond(force, coefficient="0", initial="2*x").replace("position: 1 1 0 m", "position: 9 9 0 m")
    ((a,),) = watch(tmp_path, script, [1], "boats.a.velocity")
    assert a == pytest.approx([0.5, 0.25, 0], abs=1e-14)


def test_masses_climb_what_they_give(tmp_path):
    two = """{field_gradient: {of: pond.concentration, factor: 0.4 J}}
  that: {emission: {into: pond.concentration, rate: 0.2 m^3/s}}
  halt: {drag: {linear: 2 N*s/m}}"""
    script = pond(two, coefficient="0.2").replace("forces: {it: ", "forces:\n  it: ").replace("N*s/m}}}", "N*s/m}}")
    script = script.replace("velocity: 0.5 0.25 0 m/s", "velocity: 0 0 0 m/s").replace("2.93 0.04", "1.8 1.0")
    first, last = watch(tmp_path, script, [0, 2], "boats.a.position", "boats.b.position")
    assert last[1][0] - last[0][0] < first[1][0] - first[0][0] - 0.01


def test_a_field_drives_a_spring_and_what_is_drawn(tmp_path):
    script = """
clock: {end: 1 s}
models:
  plate:
    diffusion:
      {size: 1 1 m, cell: 0.25 m, of: number, coefficient: 0, initial: x, source: "2", probes: {here: 0.6 0.3 m}}
  swing:
    mass_spring:
      masses: {bob: {position: 1 0 0 m, mass: 1 kg}, wall: {position: 0 0 0 m, fixed: yes}}
      springs: []
forces: {pull: {spring: {from: swing.bob.position, to: 0 0 0 m, stiffness: 4 N/m*plate.here, rest: 0 m}}}
objects:
  ball: {sphere: {radius: 0.1 m*plate.here}}
  blob: {blobby: {points: swing.positions, radius: 0.1 m*plate.here, threshold: 0.2}}
solvers: {main: {dop853: {tolerance: 1e-10}}}
"""
    ((here, x, volume),) = watch(tmp_path, script, [1], "plate.here", "swing.bob.position", "blob.volume")
    assert volume == pytest.approx(2 * 4 / 3 * np.pi * (0.1 * here) ** 3 * (1 - 0.2 ** (1 / 3)) ** 1.5, rel=2e-3)
    assert here == pytest.approx(0.625 + 2)  # the center of its cell is at 0.625 m
    from scipy.integrate import solve_ivp

    exact = solve_ivp(lambda t, y: [y[1], -4 * (0.625 + 2 * t) * y[0]], [0, 1], [1, 0], rtol=1e-11, atol=1e-12)
    assert x[0] == pytest.approx(exact.y[0, -1], abs=1e-7)


def test_a_probe_outside_is_told(tmp_path):
    from sceneql.quantities.diagnostic import ScriptError

    with pytest.raises(ScriptError, match="the probe 'far' stands outside"):
        watch(tmp_path, pond(more="probes: {far: 9 9 m}"), [0], "pond.mass")


@pytest.mark.parametrize(
    ("force", "said"),
    [
        ("{emission: {into: 2*pond.concentration, rate: 1}}", "the field of a model itself"),
        ("{emission: {into: pond.concentration, rate: 1 kg}}", "the rate is"),
        ("{field_gradient: {of: pond.concentration, factor: 1 N}}", "the factor is"),
    ],
)
def test_what_is_wrong_is_told(tmp_path, force, said):
    assert said in complaint(tmp_path, pond(force))
