"""Contacts of rigid bodies as a cone program: the plan for given pairs of bodies, and the arrays of its kernels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats


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

    from sceneql.linear import cone_rows_kernels as rows
    from sceneql.linear.cone_layout_kernels import lay_out

    contacts_at = rows.BODY * bodies
    scratch_at = contacts_at + rows.CONTACT * most
    given = np.array(pairs, dtype=np.int64).ravel()
    ints, end = lay_out(bodies, most, given, 0, contacts_at, scratch_at)
    floats, at = np.zeros(end), int(ints[rows.CONTACT_INTS_AT])
    return ConeProgram(
        ints,
        floats,
        ints[at : at + most],
        floats[:contacts_at].reshape(bodies, rows.BODY),
        floats[contacts_at:scratch_at].reshape(most, rows.CONTACT),
        floats[ints[rows.RESULT_AT] :],
    )
