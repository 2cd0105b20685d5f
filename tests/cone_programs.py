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
    """The integers and floats of a program (layout: cone_layout_kernels), and where what is given and found stands."""

    ints: NDArray[int64]
    floats: Floats
    pairs: NDArray[int64]
    """Number of the pair of each contact, to be written: a view of ``ints``."""
    bodies: Floats
    """(bodies, BODY) view of ``floats``."""
    contacts: Floats
    """(most, CONTACT) view of ``floats``."""
    row_pairs: NDArray[int64]
    """Number of the pair of each bounded row, to be written: a view of ``ints``."""
    rows: Floats
    """(rows, ROW) view of ``floats`` (bounded_rows_kernels)."""
    result: Floats
    """(RESULT,) view of ``floats``."""


def cone_program(bodies: int, pairs: Sequence[tuple[int, int]], most: int, bounded: int = 0) -> ConeProgram:
    """The program of bodies that move, for at most so many contacts of these pairs (-1: what is fixed or led).

    ``bounded``: the number of bounded rows, all of which are there: those that do not act have both bounds 0.

    Which contacts there are, and of which pairs, is written before each solution: pairs without contacts cost little.
    Every pair has a body that moves, and there is at least one.
    """
    import numpy as np

    from sceneql.linear.cones import cone_layout_kernels as rows
    from sceneql.linear.cones.cone_layout_kernels import ROW

    contacts_at = rows.BODY * bodies
    rows_at = contacts_at + rows.CONTACT * most
    scratch_at = rows_at + ROW * bounded
    given = np.array(pairs, dtype=np.int64).ravel()
    ints, end = rows.lay_out(bodies, most, bounded, given, 0, contacts_at, rows_at, scratch_at)
    floats, at, row_at = np.zeros(end), int(ints[rows.CONTACT_INTS_AT]), int(ints[rows.ROW_INTS_AT])
    return ConeProgram(
        ints,
        floats,
        ints[at : at + most],
        floats[:contacts_at].reshape(bodies, rows.BODY),
        floats[contacts_at:rows_at].reshape(most, rows.CONTACT),
        ints[row_at : row_at + bounded],
        floats[rows_at:scratch_at].reshape(bounded, ROW),
        floats[ints[rows.RESULT_AT] :],
    )
