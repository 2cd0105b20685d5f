"""Inertia that is a sparse matrix: a hanging bar of linear elements along its length, by explicit and implicit methods.

The bar's consistent mass matrix is [2 1; 1 2] m/6 an element of mass m, its stiffness that of springs between nodes.
"""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg
from scipy.sparse import csr_array

from sceneql.bodies import bodies as masses
from sceneql.pipeline import load
from sceneql.run.run import IslandRun

RESERVE = masses.reserve
NODES, MASS, STIFFNESS, STRETCH = 6, 0.5, 800.0, 1e-3


def matrices(held):
    """Consistent mass and stiffness of the bar's free motion along x, (n, n)."""
    mass, stiffness = np.zeros((NODES, NODES)), np.zeros((NODES, NODES))
    for k in range(NODES - 1):
        mass[k : k + 2, k : k + 2] += MASS / 6 * np.array([[2, 1], [1, 2]])
        stiffness[k : k + 2, k : k + 2] += STIFFNESS * np.array([[1, -1], [-1, 1]])
    return mass[held:, held:], stiffness[held:, held:]


def bar(folder, monkeypatch, solver, end, partly=False, more=""):
    """The march of a bar held at its first node, stretched along its lowest mode; ``partly``: held across too."""
    mass, stiffness = matrices(1)
    squares, modes = scipy.linalg.eigh(stiffness, mass)
    start = STRETCH * np.append(0, modes[:, 0] / modes[-1, 0])
    names = ", ".join(f"p{k}: {{position: {float(k + start[k])!r} 0 0 m}}" for k in range(NODES))
    ties = ", ".join(f"{{between: [p{k}, p{k + 1}], rest: 1 m, stiffness: {STIFFNESS} N/m}}" for k in range(NODES - 1))
    whole = np.kron(matrices(0)[0], np.eye(3))
    whole[:3] = whole[:, :3] = 0.0
    if partly:
        across = np.arange(1, 3 * NODES, 3)
        whole[across] = whole[:, across] = 0.0
    monkeypatch.setattr(masses, "reserve", lambda *given: RESERVE(*given, inertia=csr_array(whole)))
    path = folder / "scene.yaml"
    path.write_text(
        f"models: {{bar: {{mass_spring: {{mass: {MASS} kg, masses: {{{names}}}, springs: [{ties}]}}}}}}\n"
        f"clock: {{end: {end!r} s, fps: 10}}\nsolvers: {{main: {{{solver}}}}}\n{more}"
    )
    graph = load(path, pruned=False)
    run = IslandRun(graph, graph.islands[0])
    y, _ = run.march.advance(end)
    at = run.bodies["bar"].position_at
    return y[at : at + 3 * NODES].reshape(-1, 3) - np.arange(NODES)[:, None] * [1, 0, 0], start, np.sqrt(squares[0])


@pytest.mark.parametrize(
    ("solver", "near"),
    [
        ("rk4: {step: 2 ms}", 1e-7),
        ("verlet: {step: 1 ms}", 1e-3),
        ("dopri5: {tolerance: 1e-9}", 1e-6),
        ("bdf2: {step: 1 ms}", 5e-3),
        ("implicit_midpoint: {step: 1 ms}", 1e-3),
        ("radau: {tolerance: 1e-8}", 1e-5),
        ("rodas5p: {tolerance: 1e-8}", 1e-5),
    ],
)
def test_a_bar_of_consistent_mass_keeps_its_lowest_mode_and_period(tmp_path, monkeypatch, solver, near):
    period = float(2 * np.pi / np.sqrt(scipy.linalg.eigh(*matrices(1)[::-1])[0][0]))
    level, start, _ = bar(tmp_path, monkeypatch, solver, 1.25 * period)
    turned, *_ = bar(tmp_path, monkeypatch, solver, 1.5 * period)
    np.testing.assert_allclose(level[:, 0], 0.0, atol=near * STRETCH)
    np.testing.assert_allclose(turned[:, 0], -start, atol=near * STRETCH)


@pytest.mark.parametrize("solver", ["rk4: {step: 2 ms}", "bdf2: {step: 1 ms}", "radau: {tolerance: 1e-8}"])
def test_single_components_may_be_held(tmp_path, monkeypatch, solver):
    moved, *_ = bar(tmp_path, monkeypatch, solver, 0.2, partly=True, more="forces: [gravity]\n")
    assert np.abs(moved[:, 1]).max() == 0.0
    assert np.abs(moved[-1, 0]) > 0.1 * STRETCH
