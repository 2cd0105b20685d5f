"""Terms of an island's rate: their stages, their derivatives (slopes), and the Jacobian's sparsity pattern."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from numpy import bool_, int64
    from numpy.typing import NDArray

Stage = Literal["velocity", "internal", "force", "tie", "close", "constrain"]


@dataclass(frozen=True, slots=True, eq=False)
class Slopes:
    """The derivatives of one term of the rate: rows and columns in the Jacobian, and the kernel that computes them.

    The kernel has the signature of a term, ``(t, y, entries, floats, ints)``. It adds to entries[i] (its own slice
    (k,), zero before) the derivative with respect to y[columns[i]] of what the term adds to rate[rows[i]]: for forces
    N/m and N s/m, since the island multiplies by inverse masses and adds dx/dt = v. Places may repeat (their entries
    are summed) and stay the same for the run; rows of the dissipated energy (Bodies.work_at) are left out. The kernel
    has a file of its own, which explicit solvers then never load.

    Derivatives through values that read the state are not the kernel's: the island takes them from differences of the
    term with respect to the floats of these values (island/value_slopes.py).

    While channels.NEWTON is above 0, the slopes serve Newton's method: where they contain the force itself, the kernel
    uses the force that the latest Newton update predicted.
    """

    kernel: str
    """``"package.module:function"``."""
    rows: Any
    """(k,) int; empty where the term does not depend on y."""
    columns: Any
    """(k,) int."""
    ints: Any = None
    """The kernel's integers; None: those of the term."""
    shared: Any = None
    """(k,) int, where places share entries: e where entry e is added at a place, -1 - e where it is subtracted."""

    blocks: bool = False
    """Whether entries are 3x3 blocks, row by row, with the first row and column of each in ``rows`` and ``columns``:
    three times as fast for forces between masses."""

    positive: str = ""
    """``"package.module:function"``: a kernel with the same integers and entries that leaves out negative stiffness,
    such as the transverse stiffness of a compressed spring, so that Newton's matrix is positive definite far from a
    solution, too; channels.NEWTON gives the a^2 by which inertia counts. It is compiled at its first use. Empty: the
    same slopes."""

    in_stages: bool = False
    """Whether the slopes hold only where the term acts as for implicit solvers: within the stages of Newton's method
    (Needs.newton), or between steps for others that need slopes (channels.STAGE); the latter take differences on small
    islands."""

    border: int = 0
    """Number m of further unknowns that depend on rates, as constraint forces of ties do, in the linear systems of
    implicit stages. With n entries of y they have the rows and columns n to n + m. Coefficients of d(rates) in such a
    row stand in the rows n + m and beyond, at the columns of these rates. The rate is evaluated at the state before the
    kernel is called."""

    @property
    def entries(self) -> int:
        """Length of the kernel's slice."""
        count = len(self.rows)
        if self.shared is not None:
            count = int(max(self.shared.max(), -1 - self.shared.min(), -1)) + 1 if len(self.shared) else 0
        return 9 * count if self.blocks else count


@dataclass(frozen=True, slots=True, eq=False)
class Pattern:
    """The sparsity pattern of an island's Jacobian, without duplicates and with the whole diagonal.

    The values are ordered as those of the blocks, nine for each, row by row, then all others one by one.
    """

    blocks: NDArray[int64]
    """(b, 2) first row and first column of the 3x3 blocks, ascending; the rows are velocities of masses."""
    others: NDArray[int64]
    """(s, 2) row and column of each value outside blocks, ascending."""
    known: NDArray[bool_]
    """(s,) bool: whether a value outside blocks comes from slopes; the others are zeros on the diagonal."""
    room: int
    """Length of the array ``values`` of the jacobian kernel: the values first, then its scratch."""
    exact: bool
    """Whether it comes from slopes; False: the Jacobian is full, found by differences of the rate."""
    tallies: NDArray[int64]
    """Entries of y without slopes, such as dissipated energies: nothing depends on them, and their rows are left
    out."""

    @property
    def count(self) -> int:
        """Number of values."""
        return 9 * len(self.blocks) + len(self.others)

    @property
    def rows(self) -> NDArray[int64]:
        """(count,) row of each value."""
        import numpy as np

        own = (self.blocks[:, :1] + np.array([0, 0, 0, 1, 1, 1, 2, 2, 2])).ravel()
        return np.concatenate([own, self.others[:, 0]])

    @property
    def columns(self) -> NDArray[int64]:
        """(count,) column of each value."""
        import numpy as np

        own = (self.blocks[:, 1:] + np.array([0, 1, 2, 0, 1, 2, 0, 1, 2])).ravel()
        return np.concatenate([own, self.others[:, 1]])
