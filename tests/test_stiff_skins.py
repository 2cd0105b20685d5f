"""Skins whose tensions are implicit: `skins: implicit` of `ark3`."""

import numpy as np
import pytest

from sceneql.failure import RunFailure
from sceneql.quantities.diagnostic import ScriptError
from skins import ELLIPSE, ballooned, deep

SHEAR = '{stream_function: "0.08*cos(2*pi*x)*cos(2*pi*y)"}'


def law_of(stretch, prestress=0.0):
    return f"law: {{springs: {{stretch: {stretch} N/m}}}}, prestress: {prestress} N/m"


def solver_of(skins, step="4 ms"):
    return f"{{ark3: {{step: {step}, skins: {skins}}}}}"


@pytest.mark.parametrize("boundary", [None, "{}"], ids=["periodic", "walls"])
def test_implicit_skins_come_to_where_explicit_ones_do(tmp_path, boundary):
    """A soft skin, swinging: the difference falls at least at order 2."""
    more = {} if boundary is None else {"boundary": boundary, "at": "0.36 0.31"}
    ends = {}
    for skins, step in (("explicit", "1 ms"), ("implicit", "8 ms"), ("implicit", "4 ms")):
        air = ballooned(tmp_path, law_of(4, 1), solver=solver_of(skins, step), end=0.16, **more).at(0.16)
        ends[skins, step] = air.read("positions", "balloon")
    off = [np.abs(ends["implicit", step] - ends["explicit", "1 ms"]).max() for step in ("8 ms", "4 ms")]
    assert off[1] < 1e-5
    assert off[0] / off[1] > 3.5


def test_stiff_skins_take_steps_that_explicit_ones_cannot(tmp_path):
    """Two that mirror each other, 1e4 times too stiff for the step."""
    eggs = [f'{{implicit: {{field: "{ELLIPSE}", position: {x} 0.5 0 m}}}}' for x in (0.5, 1.5)]
    law = law_of(1e5)
    for skins in ("explicit", "implicit"):
        air = ballooned(
            tmp_path, law, size="2 1 m", solver=solver_of(skins, "10 ms"), end=0.1, initial=SHEAR,
            boundary="{left: {periodic: yes}, bottom: {periodic: yes}}", spacing="1/32 m",
            objects=f"objects: {{egg: {eggs[0]}, other: {eggs[1]}}}\n",
            forces=f"  twin: {{membrane: {{of: other, {law}, spacing: 1/32 m}}}}\n"
            "forces: [{immersion: {on: [balloon, twin], in: air}}]\n",
        )  # fmt: skip
        if skins == "explicit":
            with pytest.raises(RunFailure):
                air.at(0.1)
    before = air.at(0.0).read("positions", "balloon"), air.read("volume", "balloon")
    air.at(0.1)
    after = air.read("positions", "balloon")
    assert np.abs(after - before[0]).max() > 0.01
    assert air.read("stretch", "balloon") == pytest.approx(1.0, abs=2e-4)
    assert air.read("volume", "balloon") == pytest.approx(before[1], rel=1e-13)
    assert air.read("positions", "twin") - after == pytest.approx(np.tile([1.0, 0.0, 0.0], (len(after), 1)), abs=1e-6)


def test_steps_that_follow_the_error_are_those_of_the_flow_once_swings_are_over(tmp_path):
    """Far fewer than explicit skins take, and to the same places."""
    found = {}
    for skins in ("explicit", "implicit"):
        solver = f"{{ark3: {{skins: {skins}}}}}"
        air = ballooned(tmp_path, law_of(1e4), solver=solver, end=0.2, initial=SHEAR, spacing="1/32 m").at(0.1)
        before = air.run.march.statistics.steps
        found[skins] = air.at(0.2).run.march.statistics.steps - before, air.read("positions", "balloon")
    assert found["implicit"][0] < found["explicit"][0] / 10
    assert found["implicit"][1] == pytest.approx(found["explicit"][1], abs=2e-4)


LAWS = {
    "tension": "law: {tension: 4 N/m}",
    "rubber": "law: {neo_hookean: {modulus: 2 N/m}}, prestress: 2 N/m",
    "skalak": "law: {skalak: {modulus: 2 N/m}}, prestress: 2 N/m",
    "bend": "law: {springs: {stretch: 4 N/m}}, bend: 0.02 J",
}


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_skins_of_any_law_come_to_where_explicit_ones_do(tmp_path, law):
    """What they pull along and across is implicit: the difference falls at least at order 2."""
    ends = {}
    for skins, step in (("explicit", "0.5 ms"), ("implicit", "8 ms"), ("implicit", "4 ms")):
        air = ballooned(tmp_path, law, solver=solver_of(skins, step), end=0.16).at(0.16)
        ends[skins, step] = air.read("positions", "balloon")
    off = [np.abs(ends["implicit", step] - ends["explicit", "0.5 ms"]).max() for step in ("8 ms", "4 ms")]
    assert off[1] < 1e-5
    assert off[0] / off[1] > 3.0


@pytest.mark.parametrize("law", ["law: {tension: 1e3 N/m}", "law: {springs: {stretch: 1 N/m}}, bend: 10 J"])
def test_tension_and_bending_bear_long_steps(tmp_path, law):
    """A skin that is round long since stays where explicit steps, ten times as many or more, have it."""
    found = {}
    for skins in ("explicit", "implicit"):
        solver, more = f"{{ark3: {{skins: {skins}}}}}", {"viscosity": "5 Pa*s", "initial": SHEAR}
        air = ballooned(tmp_path, law, solver=solver, end=0.3, spacing="1/32 m", **more).at(0.3)
        found[skins] = air.run.march.statistics.steps, air.read("deformation", "balloon")
    assert found["implicit"][0] < found["explicit"][0] / 3
    assert found["implicit"][1] == pytest.approx(found["explicit"][1], abs=1e-4)


def test_a_fixed_step_bears_the_blow_at_the_start(tmp_path):
    """A skin that hardly stretches, in a flow that would stretch it at once: updates that left out how it turns, and
    what those before had left, ended nowhere."""
    air = ballooned(
        tmp_path, law_of(1e6), solver=solver_of("implicit", "20 ms"), end=0.1, initial=SHEAR, spacing="1/32 m"
    )
    assert air.at(0.1).read("stretch", "balloon") == pytest.approx(1.0, abs=1e-3)


def test_skins_that_cannot_be_implicit_are_told(tmp_path):
    more = {"cells": 10, "solver": solver_of("implicit")}
    with pytest.raises(ScriptError, match=r"no flat skin.*\n(.*\n)*.*write `skins: explicit`"):
        deep(tmp_path, law_of(4), "x^2 + y^2 + z^2 - 0.3^2", **more).at(0.01)


def test_the_step_of_implicit_skins_is_told_to_be_stable(tmp_path):
    """By the spectrum of the island, as `explain` has it, and by `check` before."""
    stable = {}
    for skins in ("explicit", "implicit"):
        air = ballooned(tmp_path, law_of(1e5), solver=solver_of(skins, "10 ms"), spacing="1/32 m")
        turn = np.array([[0.0, 2e4], [-2e4, -1.0]])
        stable[skins] = air.tasks["main"].kind.growth(turn, None, 0.01) <= 1.0, not list(air.graph.warnings)
    assert stable == {"explicit": (False, False), "implicit": (True, True)}


def test_skins_are_implicit_beyond_what_they_bear_where_that_is_worth_it(tmp_path):
    """Those of `auto`: a stiff skin takes far fewer steps to the same places, a soft one the explicit steps."""
    found = {}
    for stretch in (4, 1e5):
        for solver in ("{ark3: {skins: explicit}}", "{auto: {}}"):
            air = ballooned(tmp_path, law_of(stretch), solver=solver, end=0.4, initial=SHEAR, spacing="1/32 m").at(0.4)
            found[stretch, solver[1:5]] = air.run.march.statistics.steps, air.read("positions", "balloon")
    assert found[4, "auto"][0] == found[4, "ark3"][0]
    assert found[1e5, "auto"][0] < found[1e5, "ark3"][0] / 2
    assert found[1e5, "auto"][1] == pytest.approx(found[1e5, "ark3"][1], abs=2e-4)


def test_a_fixed_step_beyond_the_bound_has_implicit_skins(tmp_path):
    for step, way in (("0.1 ms", "within"), ("10 ms", "beyond")):
        air = ballooned(tmp_path, law_of(1e4), solver=f"{{ark3: {{step: {step}}}}}", spacing="1/32 m")
        assert not list(air.graph.warnings)
        assert way in air.run.methods.remark
    air.at(0.02)
    assert air.read("stretch", "balloon") == pytest.approx(1.0, abs=1e-3)
