"""The lowest modes of a stiffness and a mass: K s = w^2 M s, by Lanczos' method with the inverse of K + shift M."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from sceneql.frame import Floats

DENSE = 240
"""Number of unknowns up to which all modes are computed."""
SHIFT = 1e-7
"""The shift, relative to the median of K_ii/M_ii: with it K of a free body, which is singular, can be factored."""
ZERO = 1e-12
"""Squared frequencies below this fraction of the median are zero up to rounding."""
MORE = 4
"""Number of additional modes sought, so that the last of several equal frequencies are not missed."""
LOOKS = 4
"""Number of blocks between two checks of convergence."""
EXACT, ALONE = 1e-9, 1e-20
"""EXACT: relative error of shapes; ALONE: squares of vectors' lengths, relative to the largest, that count as
rounding."""


def lowest(stiffness: Any, mass: Any, count: int, points: Floats) -> tuple[Floats, Floats]:
    """Squared angular frequencies (k,) [1/s^2], ascending, and shapes (n, k) with s^T M s = 1 [kg^-1/2].

    ``stiffness`` [N/m] and ``mass`` [kg]: sparse symmetric (n, n), the latter positive definite; k is ``count`` or n.
    ``points`` (n, 3) [m]: position of each unknown. A square below 0 belongs to an unstable equilibrium. The largest
    entry of a shape is positive. Sources: Ericsson & Ruhe (1980), Math. Comp. 35, 1251-1268; Grimes, Lewis & Simon
    (1994), SIAM J. Matrix Anal. Appl. 15, 228-272.
    """
    n = mass.shape[0]
    count = min(count, n)
    if not count:
        return np.zeros(0), np.zeros((n, 0))
    scale = float(np.median(np.abs(stiffness.diagonal()) / mass.diagonal()))
    if n <= max(DENSE, 2 * (count + MORE) + 20):
        from scipy.linalg import eigh

        squares, shapes = eigh(stiffness.toarray(), mass.toarray())
    else:
        squares, shapes = _sparse(stiffness, mass, count + MORE, points, SHIFT * (scale or 1.0))
    order = np.argsort(squares, kind="stable")[:count]
    squares, shapes = squares[order], shapes[:, order]
    squares = np.where(np.abs(squares) <= ZERO * scale, 0.0, squares)
    largest = shapes[np.abs(shapes).argmax(axis=0), np.arange(count)]
    return squares, shapes * np.where(largest < 0.0, -1.0, 1.0)


def _sparse(stiffness: Any, mass: Any, count: int, points: Floats, shift: float) -> tuple[Floats, Floats]:
    """Squares and shapes by block Lanczos iteration with full reorthogonalization; blocks find multiple eigenvalues."""
    from sceneql.stepping.eigenmodes_kernels import BLOCK

    n = mass.shape[0]
    solve = _inverse(stiffness, mass, points, shift)
    block = np.random.Generator(np.random.Philox(1)).standard_normal((n, BLOCK))
    block, _ = _orthonormal(block, mass)
    rooms, whole = (np.empty((n, 4 * count)), np.empty((n, 4 * count))), 0
    projected = np.zeros((0, 0))
    while True:
        width = block.shape[1]
        whole += width
        if whole > rooms[0].shape[1]:
            rooms = np.hstack([rooms[0], np.empty_like(rooms[0])]), np.hstack([rooms[1], np.empty_like(rooms[1])])
        basis, weighed = rooms[0][:, :whole], rooms[1][:, :whole]
        basis[:, -width:], weighed[:, -width:] = block, mass @ block
        found = solve(weighed[:, -width:])
        along = weighed.T @ found
        found -= basis @ along
        again = weighed.T @ found  # second pass, against rounding errors of the first
        found -= basis @ again
        along += again
        larger = np.zeros((whole, whole))
        larger[: whole - width, : whole - width] = projected
        larger[:, whole - width :], larger[whole - width :, :] = along, along.T
        projected = larger
        block, left = _orthonormal(found, mass)
        full = not block.shape[1] or whole + block.shape[1] > n
        if not full and (whole < 2 * count or whole // BLOCK % LOOKS):
            continue
        inverses, vectors = np.linalg.eigh(projected)
        best = slice(max(0, whole - count), whole)
        errors = np.linalg.norm(left @ vectors[-width:, best], axis=0)
        done = whole >= count and (errors <= EXACT * inverses[best]).all()
        if done or full:
            return _ritz(stiffness, mass, basis @ vectors[:, best])


def _ritz(stiffness: Any, mass: Any, shapes: Floats) -> tuple[Floats, Floats]:
    """Ritz values and vectors in the span of approximate shapes.

    Errors of the squares are of second order in those of these.
    """
    from scipy.linalg import eigh

    squares, ways = eigh(shapes.T @ (stiffness @ shapes), shapes.T @ (mass @ shapes))
    return squares, shapes @ ways


def _orthonormal(block: Floats, mass: Any) -> tuple[Floats, Floats]:
    """An M-orthonormal basis of a block's columns, and the block's coordinates in it; rounding is left out."""
    whole: Floats = np.eye(block.shape[1])
    for _ in range(2):
        gram = block.T @ (mass @ block)
        squares, ways = np.linalg.eigh(0.5 * (gram + gram.T))
        kept = squares > ALONE * squares.max(initial=0.0)
        root = np.sqrt(squares[kept])
        block = block @ (ways[:, kept] / root)
        whole = (ways[:, kept] * root).T @ whole
    return block, whole


def _inverse(stiffness: Any, mass: Any, points: Floats, shift: float) -> Callable[[Floats], Floats]:
    """Function that solves (K + shift M) x = b for the columns of b (n, k), at most BLOCK of them."""
    from scipy.sparse import csr_array

    from sceneql.linear.multifrontal import planning, systems_kernels
    from sceneql.linear.multifrontal.layout import SINGLE_FACTOR
    from sceneql.stepping.eigenmodes_kernels import BLOCK, solve_block

    whole = csr_array(stiffness + shift * mass)
    whole.sum_duplicates()
    whole.sort_indices()
    plan = planning.plan(whole, points=points, symmetric=True)
    plan.numbers[SINGLE_FACTOR] = -1
    factors, work = np.zeros(plan.factors), np.zeros(plan.work)
    systems_kernels.factor_system(plan.numbers, whole.data, factors, work, True)

    room = np.zeros(BLOCK * plan.work)

    def solve(right: Floats) -> Floats:
        found = np.zeros((len(right), BLOCK))
        found[:, : right.shape[1]] = right
        solve_block(plan.numbers, factors, found.ravel(), room)
        return found[:, : right.shape[1]]

    return solve
