"""The exact march of fields on boxes: against the exponential of their own rate, and against exact solutions."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from sceneql.failure import LimitRefused
from sceneql.march.exact_march import ExactMarch
from sceneql.pipeline import load
from sceneql.quantities.diagnostic import ScriptError
from sceneql.report.explain import explain, text
from test_diffusion import Field

SIDES = ("left", "right", "bottom", "top", "back", "front")
ENDS = ("{value: 1.5}", "{flux: -0.7}", "{robin: {coefficient: 2 m/s, outside: 3}}", "")


def by_exponential(march, t):
    """y at t by the exponential of the affine rate's matrix, made of its columns."""
    y = march.system.y
    n = len(y)
    fixed = march.rate(0.0, np.zeros(n))
    whole = np.zeros((n + 1, n + 1))
    whole[:n, n] = fixed
    for k in range(n):
        whole[:n, k] = march.rate(0.0, np.eye(n)[k]) - fixed
    return (expm(t * whole) @ np.append(y, 1.0))[:n]


@given(st.lists(st.sampled_from(range(4)), min_size=6, max_size=6), st.lists(st.booleans(), min_size=3, max_size=3),
       st.booleans(), st.floats(1e-3, 3))  # fmt: skip
@settings(max_examples=30)
def test_it_is_the_exponential_of_the_rate(tmp_path_factory, ends, periodic, deep, t):
    sides = {}
    for axis in range(3 if deep else 2):
        if periodic[axis]:
            sides[SIDES[2 * axis]] = "{periodic: yes}"
        else:
            sides |= {SIDES[2 * axis + k]: ENDS[ends[2 * axis + k]] for k in (0, 1)}
    boundary = ", ".join(f"{name}: {part}" for name, part in sides.items() if part)
    size, cell = ("1 0.7 0.5 m", "0.2 m") if deep else ("1 0.6 m", "0.1 m")
    field = Field(tmp_path_factory.mktemp("box"), "exact", 3.0, size=size, cell=cell, coefficient="0.3",
                  initial="sin(7*x)+cos(5*y)+x*y", source="x-y", boundary=f"{{{boundary}}}")  # fmt: skip
    wanted = by_exponential(field.run.march, t)
    found, _ = field.run.march.advance(t)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-12 * max(1.0, np.abs(wanted).max()))


def test_it_does_not_know_the_frame_rate(tmp_path):
    ends = []
    for frames in (3, 7):
        march = Field(tmp_path, "exact", 1.0, size="1 0.6 m", cell="0.1 m", initial="x").run.march
        for frame in range(1, frames + 1):
            state, _ = march.advance(frame / frames)
        ends.append((state.tobytes(), march.statistics.steps))
    assert ends[0] == ends[1]


@pytest.mark.parametrize("n", [16, 33])
def test_a_mode_decays_as_it_should(tmp_path, n):
    """sin(pi x) cos(2 pi y) on cells decays by the eigenvalues 4 n^2 sin^2(pi/2n) and 4 n^2 sin^2(pi/n)."""
    field = Field(tmp_path, "exact", 0.1, cell=f"1/{n} m", initial="sin(pi*x)*cos(2*pi*y)",
                  boundary="{left: {value: 0}, right: {value: 0}}").at(0.1)  # fmt: skip
    x, y, _ = field.centers.T
    rate = 4 * n * n * (math.sin(math.pi / 2 / n) ** 2 + math.sin(math.pi / n) ** 2)
    exact = np.sin(np.pi * x) * np.cos(2 * np.pi * y) * math.exp(-0.1 * rate)
    assert np.abs(field.values - exact).max() < 1e-14


def test_what_is_there_and_what_came_in_agree(tmp_path):
    sides = "{left: {value: 2}, top: {flux: 0.5}, right: {robin: {coefficient: 3 m/s}}}"
    field = Field(tmp_path, "exact", 5.0, initial="exp(-x)", boundary=sides, source="y")
    start = field.at(0.0).read("mass")
    slow = Field(tmp_path, "{tr_bdf2: {tolerance: 1e-8}}", 5.0, initial="exp(-x)", boundary=sides, source="y")
    for t in (0.01, 0.3, 5.0):
        assert field.at(t).read("mass") - field.read("inflow") == pytest.approx(start, abs=1e-12)
        assert field.read("inflow") == pytest.approx(slow.at(t).read("inflow"), abs=1e-6)


def test_a_closed_box_keeps_its_mass(tmp_path):
    field = Field(tmp_path, "exact", 100.0, cell="1/31 m", initial="exp(-20*((x-0.3)^2+(y-0.6)^2))")
    start = field.at(0.0).read("mass")
    assert field.at(100.0).read("mass") == pytest.approx(start, rel=1e-14)
    assert np.ptp(field.values) < 1e-14


def test_auto_takes_it_where_it_applies(tmp_path):
    assert isinstance(Field(tmp_path, "auto").run.march, ExactMarch)
    for other in ({"coefficient": "1+x"}, {"boundary": "{left: {value: y}, top: {value: t}}"}, {"source": "c"},
                  {"boundary": "{low: {value: 1, where: 0.5-x}}"}):  # fmt: skip
        field = Field(tmp_path, "auto", **other)
        assert not isinstance(field.run.march, ExactMarch)
        with pytest.raises(LimitRefused, match="let auto march it"):
            Field(tmp_path, "exact", **other)


def test_it_marches_fields_alone(tmp_path):
    path = tmp_path / "ball.yaml"
    path.write_text(
        "models: {ball: {particles: {positions: [0 0 0 m], mass: 1 kg}}}\nforces: [gravity]\nsolvers: {main: exact}\n"
        "outputs: {table: {record: {of: [ball.positions]}}}\n",
        encoding="utf-8",
    )
    with pytest.raises(ScriptError, match="exact marches a field on a grid"):
        explain(load(path))


def test_it_is_explained(tmp_path):
    Field(tmp_path, "exact", boundary="{left: {value: 0}}")
    said = text(explain(load(tmp_path / "scene.yaml", pruned=False)))
    assert "cosines along y, quarter sines along x" in said
    assert "any step is stable" in said
