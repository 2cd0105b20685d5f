"""Contacts of rigid bodies as a cone program: the plan for given pairs of bodies, and the arrays of its kernels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats

TRIES = 4
"""Factorizations that are tried from the guess, by default."""


@dataclass(frozen=True, slots=True, eq=False)
class ConeProgram:
    """The integers and floats of a program (layout: cone_rows_kernels), and where what is given and found stands."""

    ints: NDArray[int64]
    floats: Floats
    pairs: NDArray[int64]
    """Number of the pair of each contact, to be written: a view of ``ints``."""
    bodies: Floats
    """(bodies, BODY) view of ``floats``."""
    contacts: Floats
    """(most, CONTACT) view of ``floats``."""
    result: Floats
    """(RESULT,) view of ``floats``."""


def cone_program(bodies: int, pairs: Sequence[tuple[int, int]], most: int) -> ConeProgram:
    """The program of bodies that move, for at most so many contacts of these pairs (-1: what is fixed or led).

    Which contacts there are, and of which pairs, is written before each solution: pairs without contacts cost little.
    Every pair has a body that moves, and there is at least one.
    """
    import numpy as np
    from scipy.sparse import csr_array

    from sceneql.linear import cone_rows_kernels as rows
    from sceneql.linear.multifrontal import plan

    both = np.array([pair for pair in pairs if min(pair) >= 0], dtype=np.int64).reshape(-1, 2)
    own = np.arange(bodies)
    places = (np.concatenate([both[:, 0], both[:, 1], own]), np.concatenate([both[:, 1], both[:, 0], own]))
    pattern = csr_array((np.ones(len(places[0])), places), shape=(bodies, bodies))
    pattern.sum_duplicates()
    pattern.sort_indices()
    starts, columns = pattern.indptr, pattern.indices

    def place(row: int, column: int) -> int:
        if min(row, column) < 0:
            return -1
        return 36 * int(starts[row] + np.searchsorted(columns[starts[row] : starts[row + 1]], column))

    planned = plan(pattern, unit=6)
    lists = [
        np.array([(a, b, place(a, b), place(b, a)) for a, b in pairs], dtype=np.int64).ravel(),
        np.zeros(most, dtype=np.int64),
        np.array([place(k, k) for k in range(bodies)], dtype=np.int64),
        planned.numbers,
    ]
    pairs_at, contact_ints_at, diagonal_at, plan_at = np.cumsum([rows.HEAD, *(len(some) for some in lists[:-1])])
    values = 36 * len(columns)
    sizes = [rows.BODY * bodies, rows.CONTACT * most, values, planned.factors, planned.work, 6 * bodies, rows.RESULT]
    bodies_at, contacts_at, values_at, factors_at, work_at, right_at, result_at, end = np.cumsum([0, *sizes])
    head = [bodies, 0, pairs_at, contact_ints_at, diagonal_at, plan_at, len(planned.numbers), bodies_at, contacts_at]
    head += [values_at, values, factors_at, planned.factors, work_at, planned.work, right_at, result_at, TRIES, 0, 0]
    ints, floats = np.concatenate([np.array(head, dtype=np.int64), *lists]), np.zeros(end)
    return ConeProgram(
        ints,
        floats,
        ints[contact_ints_at : contact_ints_at + most],
        floats[:contacts_at].reshape(bodies, rows.BODY),
        floats[contacts_at:values_at].reshape(most, rows.CONTACT),
        floats[result_at:],
    )
