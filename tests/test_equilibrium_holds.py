"""The solver `equilibrium` and what is led: its forces are those of rests, without what its motion would add."""

from __future__ import annotations

import numpy as np
import pytest

from runs import watch
from sceneql.failure import RunFailure
from sceneql.pipeline import load
from sceneql.run.run import Run

MOTION = "0.05 m*sin(40 rad/s*time)"
"""Of the led end of the bar: up to 80 m/s^2, by which its mass would pull with hundreds of newtons."""


def told(folder, hold, times, more="", damping=""):
    """(forces of the led end and of the other one (3,), energy) at each time [N, J], of a bar that is held at both."""
    script = (
        f"clock: {{end: 1 s}}\nsolvers: {{main: equilibrium}}\n{more}\n"
        f"models: {{bar: {{elastic: {{block: {{size: 1 0.2 0.2 m, cells: [4, 1, 1]}}, element: p1, {damping}"
        "law: {neo_hookean: {modulus: 50 kPa, poisson: 0.3}}, "
        f"hold: {{end: {{where: x > 0.49, {hold}}}, other: {{where: x < -0.49}}}}}}}}}}\n"
    )
    return watch(folder, script, times, "bar.end.force", "bar.other.force", "bar.energy")


def along(shift):
    return f"shift: [{shift}, 0 m, 0 m]"


def rest(folder, shift):
    """What it tells where nothing but a constant load of its end is: of a shift [m] that grew slowly."""
    return told(folder, along(f"{shift:.17g} m*time/(1 s)"), [1.0])[0]


@pytest.mark.parametrize("damping", ["", "mass_damping: 3 Hz, ", "retardation: 0.1 s, "])
@pytest.mark.parametrize("follows", [False, True])
def test_forces_of_what_is_led_have_no_inertia_and_no_damping(tmp_path, damping, follows):
    sphere = f"objects: {{handle: {{sphere: {{radius: 0.1 m, position: [{MOTION!r}, 0 m, 0 m]}}}}}}"
    hold, more = ("follows: handle", sphere) if follows else (along(repr(MOTION)), "")
    times = [0.05, 0.1, 0.7]
    for t, (end, other, energy) in zip(times, told(tmp_path, hold, times, more, damping), strict=True):
        np.testing.assert_allclose(end, -np.asarray(other), atol=1e-8)
        slow_end, _, slow_energy = rest(tmp_path, 0.05 * np.sin(40 * t))
        np.testing.assert_allclose(end, slow_end, rtol=1e-7, atol=1e-7)
        assert energy == pytest.approx(slow_energy, rel=1e-7)


@pytest.mark.parametrize("follows", [False, True])
def test_what_starts_away_from_its_place_or_leaps_is_at_rest_there_at_once(tmp_path, follows):
    """At 0.3 s, with which the new place begins."""
    leap = "where(time < 0.3 s, 0.02 m, 0.04 m)"
    sphere = f"objects: {{handle: {{sphere: {{radius: 0.1 m, position: ['{leap} - 0.02 m', 0 m, 0 m]}}}}}}"
    hold, more = ("follows: handle", sphere) if follows else (along(repr(leap)), "")
    moved = (0.0, 0.02) if follows else (0.02, 0.04)
    times = [0.0, 0.05, 0.3, 0.55]
    rests = [rest(tmp_path, moved[0]), rest(tmp_path, moved[1])]
    for t, (end, other, energy) in zip(times, told(tmp_path, hold, times, more), strict=True):
        wanted, _, wanted_energy = rests[t >= 0.3]
        np.testing.assert_allclose(end, -np.asarray(other), atol=1e-8)
        np.testing.assert_allclose(end, wanted, rtol=1e-7, atol=1e-7)
        assert energy == pytest.approx(wanted_energy, rel=1e-7, abs=1e-12)


def test_a_pin_that_leaps_takes_along_what_hangs_on_it_at_once(tmp_path):
    springs = ", ".join(f"{{between: [{ends}], rest: 0.5 m, stiffness: 100 N/m}}" for ends in ("a, b", "b, c"))
    script = (
        "clock: {end: 1 s}\nsolvers: {main: equilibrium}\nmodels: {m: {mass_spring: {mass: 1 kg, masses: "
        "{a: {position: 0 0 0 m}, b: {position: 1 0 0 m}, c: {position: 2 0 0 m}}, "
        f"springs: [{springs}], pins: {{a: {{}}, c: {{{along(repr('where(time < 0.2 s, 0.5 m, 1 m)'))}}}}}}}}}}}\n"
    )
    for shift, (found,) in zip(
        (0.5, 0.5, 1, 1), watch(tmp_path, script, [0, 0.1, 0.2, 0.3], "m.positions"), strict=True
    ):
        np.testing.assert_allclose(np.asarray(found)[:, 0], [0, 1 + shift / 2, 2 + shift], rtol=1e-14)


def test_a_column_that_pins_alone_press_together_ends_where_it_buckles(tmp_path):
    """Where springs aside, of 20 N/m together, no longer hold its middle: 2 P = 20 N/m (1 m - u/2), P = 50 N/m u."""
    ends = "a: {position: 0 0 0 m}, b: {position: 1 0 0 m}, c: {position: 2 0 0 m}"
    aside = {"d": "1 1 0", "e": "1 -1 0", "f": "1 0 1", "g": "1 0 -1"}
    masses = ", ".join([ends, *(f"{name}: {{position: {at} m, fixed: yes}}" for name, at in aside.items())])
    springs = [f"{{between: [{pair}], rest: 1 m, stiffness: 100 N/m}}" for pair in ("a, b", "b, c")]
    springs += [f"{{between: [b, {name}], rest: 1 m, stiffness: 10 N/m}}" for name in aside]
    path = tmp_path / "scene.yaml"
    path.write_text(
        "clock: {end: 1 s}\nsolvers: {main: equilibrium}\nmodels: {m: {mass_spring: {mass: 1 kg, masses: "
        f"{{{masses}}}, springs: [{', '.join(springs)}], pins: {{a: {{}}, c: {{{along('-1 m/s*time')}}}}}}}}}}}\n"
    )
    run = Run(load(path, pruned=False))
    with pytest.raises(RunFailure, match="unstable, as of a column that buckles") as told:
        list(run.moments([0.0, 1.0]))
    assert told.value.time == pytest.approx(20 / 110, rel=0.02)
    assert run.islands[0].march.statistics.steps < 150
