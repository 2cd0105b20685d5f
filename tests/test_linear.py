"""Linear systems: factorizations and iterations against their own residuals."""

from __future__ import annotations

from itertools import combinations, pairwise, product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import csr_array, kron
from scipy.sparse.linalg import spsolve
from scipy.spatial import cKDTree

from sceneql.compiled.numbered_kernels import number_of
from sceneql.linear import dense_complex_kernels as dense_complex
from sceneql.linear import dense_kernels as dense
from sceneql.linear import krylov_kernels as krylov
from sceneql.linear.multifrontal import planning, systems_kernels
from sceneql.linear.multifrontal.planning import layout
from sceneql.linear.multifrontal.separators import covered
from sceneql.linear.solver_kernels import PRECONDITION
from sceneql.stepping.eigenmodes_kernels import BLOCK, solve_block

UNIT = 2.3e-16


@settings(max_examples=50)
@given(n=st.integers(1, 40), seed=st.integers(0, 2**32))
def test_dense_factors_solve_to_rounding(n, seed):
    draw = np.random.default_rng(seed)
    matrix, right = draw.standard_normal((n, n)), draw.standard_normal(n)
    a, pivots, x = matrix.ravel().copy(), np.zeros(n, dtype=np.int64), right.copy()
    assert dense.factor(a, n, pivots)
    dense.solve(a, n, pivots, x)
    residual = np.abs(matrix @ x - right).max()
    assert residual <= 100 * n * UNIT * (np.abs(matrix).sum(axis=1).max() * np.abs(x).max() + 1)


@settings(max_examples=50)
@given(n=st.integers(1, 40), seed=st.integers(0, 2**32))
def test_complex_factors_solve_to_rounding(n, seed):
    draw = np.random.default_rng(seed)
    matrix = draw.standard_normal((n, n)) + 1j * draw.standard_normal((n, n))
    right = draw.standard_normal(n) + 1j * draw.standard_normal(n)
    a, b, pivots = matrix.real.ravel().copy(), matrix.imag.ravel().copy(), np.zeros(n, dtype=np.int64)
    x, y = right.real.copy(), right.imag.copy()
    assert dense_complex.factor_complex(a, b, n, pivots)
    dense_complex.solve_complex(a, b, n, pivots, x, y)
    z = x + 1j * y
    residual = np.abs(matrix @ z - right).max()
    assert residual <= 100 * n * UNIT * (np.abs(matrix).sum(axis=1).max() * np.abs(z).max() + 1)


@pytest.mark.parametrize("matrix", [np.zeros((2, 2)), np.array([[1.0, 2.0], [2.0, 4.0]]), np.full((2, 2), np.nan)])
def test_a_singular_matrix_is_refused(matrix):
    pivots = np.zeros(2, dtype=np.int64)
    assert not dense.factor(matrix.ravel().copy(), 2, pivots)
    assert not dense_complex.factor_complex(matrix.ravel().copy(), np.zeros(4), 2, pivots)


def test_pivots_are_sought():
    a, pivots, x = np.array([0.0, 1.0, 1.0, 0.0]), np.zeros(2, dtype=np.int64), np.array([3.0, 5.0])
    assert dense.factor(a, 2, pivots)
    dense.solve(a, 2, pivots, x)
    assert x.tolist() == [5.0, 3.0]


def net(columns, rows, seed):
    """A sheet of 3 unknowns a mass, tied to its eight neighbors: a CSR pattern with random values."""
    index = np.arange(columns * rows).reshape(columns, rows)
    steps = ((0, 1), (1, 0), (1, 1), (1, -1))
    pairs = []
    for i, j in steps:
        here = index[: columns - i, max(0, -j) : rows - max(0, j)]
        there = index[i:, max(0, j) : rows + min(0, j)]
        pairs.append(np.stack([here.ravel(), there.ravel()]))
    first, second = np.concatenate(pairs, axis=1)
    own = np.arange(index.size)
    places = (np.concatenate([first, second, own]), np.concatenate([second, first, own]))
    graph = csr_array((np.ones(len(places[0])), places), shape=(index.size, index.size))
    matrix = csr_array(kron(graph, np.ones((3, 3))))
    matrix.sort_indices()
    matrix.data = np.random.default_rng(seed).standard_normal(matrix.nnz)
    return matrix


@settings(max_examples=40)
@given(
    columns=st.integers(1, 24),
    rows=st.integers(1, 14),
    seed=st.integers(0, 2**32),
    symmetric=st.booleans(),
    dissected=st.booleans(),
    bare=st.booleans(),
)
def test_fronts_solve_to_rounding(columns, rows, seed, symmetric, dissected, bare):
    pattern = net(columns, rows, seed)
    matrix = csr_array(0.5 * (pattern + pattern.T)) if symmetric else pattern.copy()
    matrix.setdiag(matrix.diagonal() + 30.0)
    places = np.stack(np.meshgrid(np.arange(columns), np.arange(rows), [0], indexing="ij"), axis=-1).reshape(-1, 3)
    points = places.repeat(3, axis=0).astype(float) if dissected else None
    plan = planning.plan(pattern, points=points, symmetric=symmetric and bare)
    factors, work, numbers = np.zeros(plan.factors), np.zeros(plan.work), plan.numbers.copy()
    right = np.random.default_rng(seed).standard_normal(matrix.shape[0])
    x = right.copy()
    assert systems_kernels.factor_system(numbers, matrix.data, factors, work, symmetric)
    systems_kernels.solve_system(numbers, matrix.data, factors, x, work, symmetric)
    assert np.abs(matrix @ x - right).max() <= 1e-12
    if symmetric and not numbers[layout.IN_SINGLE]:
        many = np.random.default_rng(seed).standard_normal((matrix.shape[0], BLOCK))
        found = many.ravel().copy()
        solve_block(numbers, factors, found, np.zeros(BLOCK * plan.work))
        assert np.abs(matrix @ found.reshape(many.shape) - many).max() <= 1e-12


@pytest.mark.parametrize("symmetric", [True, False])
@pytest.mark.parametrize("dissected", [True, False])
def test_fronts_of_blocks_solve_to_rounding(dissected, symmetric):
    """Of the same matrix given by its blocks of 3x3, row by row."""
    pattern = net(13, 11, 2)
    matrix = csr_array(0.5 * (pattern + pattern.T)) if symmetric else pattern.copy()
    matrix.setdiag(matrix.diagonal() + 30.0)
    blocks = matrix.tobsr((3, 3))
    blocks.sort_indices()
    graph = csr_array((np.ones(len(blocks.indices)), blocks.indices, blocks.indptr))
    places = np.stack(np.meshgrid(np.arange(13.0), np.arange(11.0), [0], indexing="ij"), axis=-1).reshape(-1, 3)
    plan = planning.plan(graph, points=places if dissected else None, unit=3)
    factors, work = np.zeros(plan.factors), np.zeros(plan.work)
    x = np.ones(matrix.shape[0])
    assert systems_kernels.factor_system(plan.numbers, blocks.data.ravel(), factors, work, symmetric)
    systems_kernels.solve_system(plan.numbers, blocks.data.ravel(), factors, x, work, symmetric)
    assert np.abs(matrix @ x - 1.0).max() <= 1e-12


def sheet(columns, rows, stiffness, seed=4):
    """Blocks of 1 + stiffness times a net of springs of random directions: (graph, values, whole matrix)."""
    blocks = net(columns, rows, 0).tobsr((3, 3))
    blocks.sort_indices()
    draw = np.random.default_rng(seed)
    whole = blocks.copy()
    whole.data[:] = 0.0
    graph = csr_array((np.arange(len(blocks.indices)), blocks.indices, blocks.indptr))
    for i in range(columns * rows):
        own = graph[i, i]
        whole.data[own] += np.eye(3)
        for at in range(blocks.indptr[i], blocks.indptr[i + 1]):
            j = blocks.indices[at]
            if i < j:
                u = draw.standard_normal(3)
                spring = stiffness * np.outer(u, u) / (u @ u)
                for k, sign in ((own, 1), (graph[j, j], 1), (at, -1), (graph[j, i], -1)):
                    whole.data[k] += sign * spring
    pattern = csr_array((np.ones(len(blocks.indices)), blocks.indices, blocks.indptr))
    return pattern, whole.data.ravel().copy(), csr_array(whole)


@pytest.mark.parametrize("exact", [True, False])
@pytest.mark.parametrize("stiffness", [1e-3, 1e2, 1e5])
def test_factors_in_single_precision_solve_to_rounding_when_refined(monkeypatch, stiffness, exact):
    monkeypatch.setattr(planning, "WORTH_SINGLE", 0.0)
    pattern, values, matrix = sheet(14, 11, stiffness)
    plan = planning.plan(pattern, unit=3, exact=exact)
    factors, work = np.zeros(plan.factors), np.zeros(plan.work)
    assert systems_kernels.factor_system(plan.numbers, values, factors, work, True)
    for size in (1.0, 1e-60, 1e60):
        right = size * np.random.default_rng(1).standard_normal(matrix.shape[0])
        x = right.copy()
        systems_kernels.solve_system(plan.numbers, values, factors, x, work, True)
        known = spsolve(matrix.tocsc(), right)
        wrong = np.abs(x - known).max() / np.abs(known).max()
        assert plan.numbers[layout.IN_SINGLE] > 0
        assert wrong <= (1e-14 * max(1.0, stiffness) + 1e-13 if exact else 0.02)


def test_factors_that_are_too_poor_in_single_precision_are_made_in_double(monkeypatch):
    monkeypatch.setattr(planning, "WORTH_SINGLE", 0.0)
    pattern, values, matrix = sheet(14, 11, 1e11)
    plan = planning.plan(pattern, unit=3)
    factors, work = np.zeros(plan.factors), np.zeros(plan.work)
    with np.errstate(all="ignore"):  # where kernels are not compiled, numpy would warn of poor factors
        for _ in range(3):
            assert systems_kernels.factor_system(plan.numbers, values, factors, work, True)
            x = np.ones(matrix.shape[0])
            assert systems_kernels.solve_system(plan.numbers, values, factors, x, work, True)
            assert plan.numbers[layout.IN_SINGLE] == 0
            assert np.abs(matrix @ x - 1.0).max() <= 1e-14 * np.abs(values).max()
        # After some time they are tried again.
        plan.numbers[layout.RESTING] = 0
        easy = sheet(14, 11, 1.0)[1]
        assert systems_kernels.factor_system(plan.numbers, easy, factors, work, True)
        assert systems_kernels.solve_system(plan.numbers, easy, factors, x, work, True)
    assert plan.numbers[layout.IN_SINGLE] == layout.TRIED


@pytest.mark.parametrize("single", [True, False])
@pytest.mark.parametrize("dissected", [True, False])
def test_threads_share_fronts_to_the_same_bytes(monkeypatch, dissected, single):
    monkeypatch.setattr(planning, "WORTH_THREADS", 0.0)
    monkeypatch.setattr(planning, "WORTH_SINGLE", 0.0 if single else np.inf)
    pattern = net(24, 20, 1)
    matrix = csr_array(0.5 * (pattern + pattern.T))
    matrix.setdiag(matrix.diagonal() + 30.0)
    places = np.stack(np.meshgrid(np.arange(24), np.arange(20), [0], indexing="ij"), axis=-1).reshape(-1, 3)
    made = []
    for threads in (1, 2, 3):
        monkeypatch.setenv("SCENEQL_THREADS", str(threads))
        plan = planning.plan(pattern, points=places.repeat(3, axis=0).astype(float) if dissected else None)
        factors, work = np.zeros(plan.factors), np.zeros(plan.work)
        numbers = plan.numbers.copy()
        assert numbers[layout.PIECES] >= 2
        assert systems_kernels.factor_system(numbers, matrix.data, factors, work, True)
        x = np.ones(matrix.shape[0])
        systems_kernels.solve_system(numbers, matrix.data, factors, x, work, True)
        assert np.abs(matrix @ x - 1.0).max() <= 1e-12
        made.append(x.tobytes())
        assert numbers[layout.IN_SINGLE] == (layout.TRIED if single else 0)
        assert not systems_kernels.factor_system(numbers, np.zeros(pattern.nnz), factors, work, True)
    assert made[0] == made[1] == made[2]


def test_fronts_refuse_a_singular_matrix():
    pattern = net(3, 3, 0)
    plan = planning.plan(pattern)
    factors, work = np.zeros(plan.factors), np.zeros(plan.work)
    for symmetric in (True, False):
        assert not systems_kernels.factor_system(plan.numbers, np.zeros(pattern.nnz), factors, work, symmetric)


@pytest.mark.parametrize("symmetric", [True, False])
def test_iterations_converge(symmetric):
    matrix = net(12, 12, 5)
    if symmetric:
        matrix = csr_array(0.5 * (matrix + matrix.T))
    matrix.setdiag(matrix.diagonal() + 30.0)
    n = matrix.shape[0]
    diagonal = [np.flatnonzero(matrix.indices[a:b] == i)[0] + a for i, (a, b) in enumerate(pairwise(matrix.indptr))]
    near = number_of(krylov.precondition, PRECONDITION)
    plan = np.concatenate([[n], matrix.indptr, diagonal, matrix.indices, [near]]).astype(np.int64)
    right = np.random.default_rng(1).standard_normal(n)
    factors, x = np.zeros(matrix.nnz), right.copy()
    krylov.factor_system(plan, matrix.data, factors, np.zeros(0), symmetric)
    assert krylov.solve_system(plan, matrix.data, factors, x, np.zeros(8 * n), symmetric)
    assert np.abs(matrix @ x - right).max() <= 1e-9


def test_separators_are_the_least_that_cover_what_a_plane_cuts():
    rng = np.random.default_rng(4)
    for _ in range(20):
        left, right = rng.integers(0, 7, 12), rng.integers(10, 17, 12)
        found = set(covered(left, right).tolist())
        assert all(a in found or b in found for a, b in zip(left.tolist(), right.tolist(), strict=True))
        vertices = sorted({*left.tolist(), *right.tolist()})
        fewer = [set(some) for some in combinations(vertices, len(found) - 1)]
        assert not any(all(a in s or b in s for a, b in zip(left, right, strict=True)) for s in fewer)


def test_a_dense_lattice_in_a_ball_takes_few_multiplications():
    axis = np.arange(-5, 6)
    points = np.array([p for p in product(axis, repeat=3) if sum(x * x for x in p) <= 27], dtype=float)
    pairs = cKDTree(points).query_pairs(2.3, output_type="ndarray")
    ends = np.concatenate([pairs, pairs[:, ::-1], np.repeat(np.arange(len(points)), 2).reshape(-1, 2)])
    pattern = csr_array((np.ones(len(ends)), ends.T), shape=(len(points),) * 2)
    pattern.sort_indices()
    by_planes = planning.plan(pattern, points=points).operations
    assert by_planes < 1.1 * planning.plan(pattern).operations
