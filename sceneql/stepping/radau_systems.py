"""The solver of radau's linear systems on an island: full LU factors where it is small, else sparse ones."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.island.system import System

FULL = 100
"""Number of unknowns up to which full matrices are factored: the break-even with sparse ones."""
LARGEST = 100_000
"""Number of unknowns up to which `auto` considers radau: Jacobian, factors and stages take some 10 kB for each."""


@dataclass(frozen=True, slots=True, eq=False)
class Systems:
    """A linear solver and its data for radau_systems_kernels.py."""

    kernels: tuple[int, int, int]
    """Addresses (numbers) of its kernels factor, solve and filter."""
    plan: NDArray[int64]
    rows: Floats
    store: int
    contraction: float
    """Contraction rate of Newton's iteration, given the accuracy of these solutions, below which a Jacobian is kept."""
    text: str


def radau_systems(system: System) -> Systems:
    """Choose and prepare the linear solver of an island whose Jacobian has a pattern."""
    from sceneql.stepping.eliminated_systems import elimination

    few = _unknowns(system) <= FULL and not system.inertia and not system.border
    return _full(elimination(system)) if few else _sparse(system)


def step_cost(unknowns: int) -> float:
    """Cost of a step of radau, in steps of dopri5.

    Full: 8 rates to 6, the Jacobian, a real and a complex factorization. Sparse: somewhat more than was measured on
    chains (40 to 75), nets (50 to 100 with up to 2,000 unknowns, 190 with 8,000) and lattices (tests/bench/
    bench_stiff_steps.py).
    """
    return (11.0 + 0.055 * unknowns**2) / 6.0 if unknowns <= FULL else 60.0 + 1.4 * unknowns**0.5


def likely_kernels(system: System) -> tuple[str, ...]:
    """Modules of kernels to be compiled while the island is built."""
    from sceneql.linear.stage import likely_kernels as likely

    if system.pattern is None:
        return ()
    if _unknowns(system) <= FULL and not system.inertia and not system.border:
        return ("sceneql.stepping.radau_full_kernels",)
    return ("sceneql.stepping.radau_sparse_kernels", *likely(system))


def _unknowns(system: System) -> int:
    """Number of entries of y without those that have a velocity, as positions of masses, which are eliminated."""
    return int((system.partner < 0).sum())


def _full(plan: NDArray[int64]) -> Systems:
    from sceneql.stepping import radau_full_kernels

    left = int(plan[0])
    return Systems(
        kernels=_numbers(radau_full_kernels),
        plan=np.concatenate([plan, np.zeros(2 * left, dtype=np.int64)]),
        rows=np.zeros(0),
        store=3 * left * left + 2 * left,
        contraction=1e-3,
        text=f"dense LU factorizations, a real and a complex one, of {left} unknowns",
    )


def _sparse(system: System) -> Systems:
    from sceneql.linear.stage import stage_plan
    from sceneql.stepping import radau_sparse_kernels

    plan = stage_plan(system, exact=True)
    return Systems(
        kernels=_numbers(radau_sparse_kernels),
        plan=plan.numbers,
        rows=plan.scales,
        store=4 * len(system.y) + plan.store,
        contraction=0.03,
        text=f"{plan.text}; the complex system of the stages by iterations with the same factors",
    )


def _numbers(module: object) -> tuple[int, int, int]:
    from sceneql.compiled.numbered_kernels import number_of
    from sceneql.stepping.radau_systems_kernels import FACTOR_STAGES, FILTER, SOLVE_STAGES

    names = (("factor", FACTOR_STAGES), ("solve", SOLVE_STAGES), ("solve_one", FILTER))
    first, second, third = (number_of(getattr(module, name), signature) for name, signature in names)
    return first, second, third
