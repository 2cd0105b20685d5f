"""Block elimination: many symmetric unknowns and a border of few, which need not be symmetric, nor have a diagonal."""

import numpy as np
import pytest
from scipy.sparse import csr_array

from sceneql.linear import bordered, bordered_kernels
from sceneql.linear.multifrontal import planning


@pytest.mark.parametrize("symmetric", [True, False])
def test_a_border_is_eliminated(symmetric):
    random = np.random.default_rng(1)
    points = np.stack(np.meshgrid(*[np.arange(7.0)] * 3), axis=-1).reshape(-1, 3)
    near = np.linalg.norm(points[:, None] - points[None], axis=2) < 1.1
    many = len(points)
    full = np.zeros((many + 5, many + 5))
    full[:many, :many] = near * random.uniform(-1, 1, near.shape)
    if symmetric:
        full = 0.5 * (full + full.T)
    full[:many, :many] += 8 * np.eye(many)
    full[many:, :40] = random.uniform(-1, 1, (5, 40))
    full[:40, many:] = random.uniform(-1, 1, (40, 5))
    full[many + 4, many] = full[many, many + 4] = 3.0
    order = random.permutation(many + 5)
    full = full[order][:, order]
    places = np.concatenate([points, np.full((5, 3), np.nan)])[order]
    pattern = csr_array((full != 0) | (full != 0).T | np.eye(many + 5, dtype=bool)).astype(float)
    pattern.sort_indices()
    chosen = bordered.split(places)
    assert chosen is not None
    assert chosen.sum() == many
    plan = planning.plan(bordered.within(pattern, chosen), None, places[chosen])
    whole = bordered.bordered(pattern, chosen, plan.numbers, plan.factors, plan.work)
    rows = np.repeat(np.arange(many + 5), np.diff(pattern.indptr))
    values, factors, work = full[rows, pattern.indices], np.zeros(whole.factors), np.zeros(whole.work)
    right = random.uniform(-1, 1, many + 5)
    found = right.copy()
    assert bordered_kernels.factor_system(whole.numbers, values, factors, work, False)
    assert bordered_kernels.solve_system(whole.numbers, values, factors, found, work, False)
    assert np.abs(full @ found - right).max() < 1e-11
    assert whole.numbers[bordered_kernels.SYMMETRIC] == symmetric


def test_a_border_of_many_or_beside_few_is_none():
    assert bordered.split(np.zeros((400, 3))) is None
    assert bordered.split(np.concatenate([np.zeros((400, 3)), np.full((80, 3), np.nan)])) is None
    assert bordered.split(np.concatenate([np.zeros((200, 3)), np.full((4, 3), np.nan)])) is None
