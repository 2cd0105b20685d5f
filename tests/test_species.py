"""The multigrid over cells of several species: how it contracts, and what it solves, beside factors."""

from __future__ import annotations

from math import prod
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.sparse import block_array, csr_array, diags_array, eye_array, kron

from sceneql.linear import species, species_kernels
from sceneql.linear.stage import _iterated
from sceneql.system import Cells, Grid
from test_reaction_diffusion import Fields


def line(n, periodic):
    """What the ties of n cells in a row pull."""
    ones = np.ones(n - 1)
    found = diags_array([ones, ones], offsets=[-1, 1], shape=(n, n)).tolil()
    if periodic:
        found[0, n - 1] = found[n - 1, 0] = 1.0
    found = csr_array(found)
    return found - diags_array(found.sum(axis=1))


def system(shape, stiffness, periodic=False, rates=((-0.3, 2.0), (-1.5, 0.4))):
    """(1 - a J) of two species of which the second spreads at half the pace, and its plan."""
    n = prod(shape)
    spread = csr_array((n, n))
    for axis in range(3):
        parts = [line(shape[k], periodic) if k == axis and shape[k] > 1 else eye_array(shape[k]) for k in range(3)]
        if shape[axis] > 1:
            spread = spread + kron(parts[2], kron(parts[1], parts[0]))
    own = [eye_array(n) * (float(p == q) - rates[p][q]) for p in range(2) for q in range(2)]
    blocks = [[own[0] - stiffness * spread, own[1]], [own[2], own[3] - 0.5 * stiffness * spread]]
    matrix = csr_array(block_array(blocks))
    matrix.sort_indices()
    ways = (periodic,) * 3
    cells = Cells(shape, ways, np.zeros(n, dtype=bool), 0, 0)
    grids = tuple(Grid(cells, k * n, 0, 0, (0, 0, 0), False, -1, False) for k in range(2))
    made = SimpleNamespace(grids=grids, y=np.zeros(2 * n), floats=np.ones(n))
    own, floats, _ = species.plan(made, np.arange(2 * n), matrix)
    return matrix, np.concatenate([_iterated(matrix, species_kernels), own]), np.zeros(floats)


@pytest.mark.parametrize(
    ("shape", "periodic"),
    [((16, 16, 1), False), ((64, 64, 1), False), ((64, 32, 1), True), ((37, 50, 1), False), ((12, 16, 8), False)],
)
@pytest.mark.parametrize("stiffness", [0.1, 10.0, 1e4])
def test_a_cycle_contracts_alike_on_all_grids(shape, periodic, stiffness):
    matrix, plan, factors = system(shape, stiffness, periodic)
    assert species_kernels.factor_system(plan, matrix.data, factors, np.zeros(0), False)
    right = np.random.default_rng(0).standard_normal(matrix.shape[0])
    x, change, sizes = np.zeros(len(right)), np.zeros(len(right)), []
    for _ in range(8):
        left = right - matrix @ x
        sizes.append(np.linalg.norm(left))
        species_kernels.precondition(plan, factors, left, change)
        x += change
    assert (sizes[-1] / sizes[2]) ** 0.2 < 0.55


@pytest.mark.parametrize("shape", [(20, 24, 1), (8, 8, 6)])
def test_systems_are_solved(shape):
    matrix, plan, factors = system(shape, 50.0)
    species_kernels.factor_system(plan, matrix.data, factors, np.zeros(0), False)
    right = np.random.default_rng(1).standard_normal(matrix.shape[0])
    x = right.copy()
    assert species_kernels.solve_system(plan, matrix.data, factors, x, np.zeros(8 * len(x)), False)
    assert np.abs(matrix @ x - right).max() < 1e-9


@pytest.mark.parametrize("edges", ["cut_cell", "staircase"])
@pytest.mark.parametrize("solver", ["{implicit_euler: {step: 0.5 s}}", "{rodas5p: {tolerance: 1e-5}}"])
def test_steps_are_those_of_factors(tmp_path, monkeypatch, edges, solver):
    u = "{coefficient: 2e-2, initial: 1 + x, rate: 1 - u*v^2}"
    rates = f"{{u: {u}, v: {{coefficient: 1e-2, initial: 1 - y, rate: u*v^2 - v}}}}"
    rim = ", ".join(f"[{np.cos(a):.5f}, {np.sin(a):.5f}]" for a in np.linspace(0, 2 * np.pi, 31)[:-1])
    found = []
    for fewest in (10**9, 0):
        monkeypatch.setattr(species, "FEWEST", {2: fewest, 3: fewest})
        fields = Fields(
            tmp_path, rates, solver, 1.0, domain="shore", edges=edges, cell="1/12 m",
            before=f"objects: {{shore: {{outline: {{points: [{rim}]}}}}}}\n",
        )  # fmt: skip
        fields.at(1.0)
        found.append(np.concatenate([fields.read("u"), fields.read("v")]))
        assert ("multigrid" in fields.run.march.prepared_text) == (fewest == 0)
    assert found[1] == pytest.approx(found[0], abs=1e-8)
