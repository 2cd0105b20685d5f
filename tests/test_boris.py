"""boris: what its steps keep in magnetic fields, and its order where they vary."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from runs import watch
from sceneql.words.solvers.boris import Boris

SCENE = """
clock: {{end: {end} s}}
models: {{ion: {{particles: {{list: {{a: {{mass: 2 kg, position: {x} m, velocity: {v} m/s}}}}}}}}}}
forces:
  b: {{magnetic: {{charge: 4 C, {field}}}}}
{more}
solvers: {{main: {{{solver}}}}}
"""
UNIFORM = "field: 1 2 -2 T"
"""Of 3 T: an angular velocity of -6/s about (1, 2, -2)/3."""
BOTTLE = 'formula: ["-x*y/4", "1 + y^2/4", "-z*y/4"]'


def end(folder: Path, field: str, x, v, solver: str, end: float = 2.0, more: str = "") -> tuple[np.ndarray, np.ndarray]:
    """Position and velocity at the end."""
    text = SCENE.format(
        end=end, x=" ".join(map(repr, x)), v=" ".join(map(repr, v)), field=field, more=more, solver=solver
    )
    ((position, velocity),) = watch(folder, text, [end], "ion.a.position", "ion.a.velocity")
    return np.asarray(position), np.asarray(velocity)


def rotated(v, angle: float) -> np.ndarray:
    """About (1, 2, -2)/3."""
    axis, v = np.array([1, 2, -2]) / 3, np.asarray(v)
    along = axis * (axis @ v)
    return along + math.cos(angle) * (v - along) + math.sin(angle) * np.cross(axis, v)


@pytest.mark.parametrize("step", [0.01, 0.05, 0.2])
def test_speed_and_phase_keep_in_a_uniform_field(tmp_path, step):
    start, time = (0.3, -0.5, 0.7), 1e5 * step
    _, v = end(tmp_path, UNIFORM, (0.0, 0.0, 0.0), start, f"boris: {{step: {step} s}}", time)
    assert np.linalg.norm(v) == pytest.approx(np.linalg.norm(start), rel=1e-12)
    # The grid's own instants k h are rounded: the angle is known to some 1e-16 of itself.
    np.testing.assert_allclose(v, rotated(start, -6 * time), rtol=0, atol=1e-11 + 1e-14 * 6 * time)


@pytest.mark.parametrize("step", [0.01, 0.25])
def test_the_drift_across_an_electric_field_is_the_one_stated(tmp_path, step):
    angle = 2 * 3 * step  # q B/m = 6/s
    drift = 2 / 3 * (angle / 2) / math.tan(angle / 2)
    electric = "  e: {electric: {charge: 4 C, field: 0 2 0 V/m}}"
    x, v = end(
        tmp_path, "field: 0 0 3 T", (0.0, 0.0, 0.0), (drift, 0.0, 0.0), f"boris: {{step: {step} s}}", 2.0, electric
    )
    np.testing.assert_allclose(v, (drift, 0, 0), rtol=0, atol=1e-12)
    np.testing.assert_allclose(x, (2 * drift, 0, 0), rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    "more",
    ["", "  d: {drag: {linear: 0.6 N*s/m, quadratic: 0.2 kg/m}}\n  e: {electric: {charge: 4 C, field: 0 1 0 V/m}}"],
)
def test_its_order_is_two_where_the_field_varies(tmp_path, more):
    at = ((0.5, 0.1, 0.2), (0.9, 0.3, -0.2))
    exact = np.concatenate(end(tmp_path, BOTTLE, *at, "dop853: {tolerance: 1e-12}", more=more))
    errors = [
        np.abs(np.concatenate(end(tmp_path, BOTTLE, *at, f"boris: {{step: {2 / n} s}}", more=more)) - exact).max()
        for n in (200, 400, 800)
    ]
    assert math.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.05)
    assert math.log2(errors[1] / errors[2]) == pytest.approx(2, abs=0.02)


def test_it_finds_its_way_back_in_the_field_reversed(tmp_path):
    electric = '  e: {electric: {charge: 4 C, potential: "x^2 - y*z"}}'
    start = (0.5, 0.1, 0.2), (0.9, 0.3, -0.2)
    x, v = end(tmp_path, BOTTLE, *start, "boris: {step: 50 ms}", more=electric)
    back = 'formula: ["x*y/4", "-1 - y^2/4", "z*y/4"]'
    x, v = end(tmp_path, back, x.tolist(), (-v).tolist(), "boris: {step: 50 ms}", more=electric)
    np.testing.assert_allclose((x, -v), start, rtol=0, atol=1e-12)


def test_speed_keeps_where_the_field_varies(tmp_path):
    start = (0.9, 0.3, -0.2)
    _, v = end(tmp_path, BOTTLE, (0.5, 0.1, 0.2), start, "boris: {step: 50 ms}", 500.0)
    assert np.linalg.norm(v) == pytest.approx(np.linalg.norm(start), rel=1e-12)


@pytest.mark.parametrize("step", [0.05, 0.4])
def test_growth_is_that_of_its_steps_on_a_charge_in_a_trap(tmp_path, step):
    trap = '  t: {force: {potential: "x^2 + 2*y^2 + 3*z^2"}}\n  d: {drag: {linear: 0.4 N*s/m}}'
    spin = -2 * np.array([[0, 2, 2], [-2, 0, -1], [-2, 1, 0]])  # of the field's vector product
    jacobian = np.zeros((6, 6))
    jacobian[:3, 3:] = np.eye(3)
    jacobian[3:, :3] = -np.diag([1.0, 2.0, 3.0])
    jacobian[3:, 3:] = spin - 0.2 * np.eye(3)
    columns = []
    for k in range(6):
        unit = np.eye(6)[k]
        columns.append(
            np.concatenate(
                end(tmp_path, UNIFORM, unit[:3].tolist(), unit[3:].tolist(), f"boris: {{step: {step} s}}", step, trap)
            )
        )
    found = np.abs(np.linalg.eigvals(np.column_stack(columns))).max()
    partner = np.array([3, 4, 5, -1, -1, -1])
    assert Boris().growth(jacobian, partner, step) == pytest.approx(found, rel=1e-10)
