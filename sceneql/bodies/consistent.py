"""Masses with a sparse mass matrix, as the consistent mass matrix of finite elements (Archer 1963)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sceneql.system import Assembly, Bodies

KERNELS = "sceneql.bodies.consistent"


def close(assembly: Assembly, bodies: Bodies, matrix: Any) -> None:
    """Add the closing term of masses with a mass matrix M, factored once: M dv/dt = F, dx/dt = v.

    ``matrix``: M, scipy sparse (3 count, 3 count) [kg], symmetric; zero in rows and columns of held components, else
    positive definite. ``bodies.inverse_at`` holds the inverses of lumped masses, for contacts.
    """
    import numpy as np
    from scipy.sparse import csr_array, diags_array

    from sceneql.system import Slopes

    size = 3 * bodies.count
    matrix = csr_array(matrix, dtype=np.float64)
    held = matrix.diagonal() == 0.0
    *floats, plan = factored(csr_array(matrix + diags_array(1.0 * held)), assembly)
    head = [bodies.position_at, bodies.velocity_at, size, *floats, assembly.floats(1.0 * held)]
    ints = np.concatenate([head, plan])
    assembly.inertia(bodies.velocity_at, bodies.inverse_at, bodies.count, matrix)
    places = np.arange(size)
    slopes = Slopes(f"{KERNELS}_slopes_kernels:close", bodies.position_at + places, bodies.velocity_at + places)
    assembly.term("close", f"{KERNELS}_kernels:close", ints, slopes, energy="")


def factored(matrix: Any, assembly: Assembly) -> tuple[int, int, int, int, Any]:
    """Factor a matrix: (offset and count of the factors, offset and count of working memory, plan as int64).

    ``matrix``: scipy sparse, symmetric, positive definite. The results are the arguments of
    multifrontal.solve_kernels.solve_symmetric. Raises ValueError for a singular matrix.
    """
    import numpy as np
    from scipy.sparse import csr_array

    from sceneql.linear.multifrontal import planning, systems_kernels
    from sceneql.linear.multifrontal.layout import SINGLE_FACTOR

    whole = csr_array(matrix, dtype=np.float64)
    whole.sum_duplicates()
    whole.sort_indices()
    plan = planning.plan(whole, symmetric=True)
    plan.numbers[SINGLE_FACTOR] = -1
    factors, work = np.zeros(plan.factors), np.zeros(plan.work)
    if not systems_kernels.factor_system(plan.numbers, whole.data, factors, work, True):
        raise ValueError("the inertia is singular")
    return assembly.floats(factors), len(factors), assembly.floats(work), len(work), plan.numbers
