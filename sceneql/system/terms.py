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
    """The derivatives of one term's addition to the rate: their places in the Jacobian, and the kernel.

    The kernel has the signature of a term, ``(t, y, entries, floats, ints)``, and adds to entries[i] (its own slice
    (k,), zero before) the derivative of what the term adds to rate[rows[i]] with respect to y[columns[i]]: for forces
    N/m and N s/m, since the island multiplies by inverse masses and adds dx/dt = v. Places may repeat (their entries
    are summed) and stay the same for the run; rows of the energy taken out (Bodies.work_at) are left out. The kernel
    has a file of its own, which explicit solvers then never load.

    Derivatives through values that read the state are not the kernel's: the island takes them from differences of the
    term with respect to the floats of these values (island/value_slopes.py).

    While channels.NEWTON is above 0, the slopes serve Newton's method: a force that they contain is the one that the
    latest Newton update predicted.
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
    """(k,) int, where places share entries: e where a place adds entry e, -1 - e where it subtracts entry e."""

    blocks: bool = False
    """Whether entries are 3x3 blocks, row by row, with the first row and column of each in ``rows`` and ``columns``:
    three times as fast for forces between masses."""

    positive: str = ""
    """``"package.module:function"``: a kernel with the same integers and entries that leaves out negative stiffness,
    such as the transverse part of a compressed spring's, so that Newton's matrix is positive definite far from a
    solution, too; channels.NEWTON tells what inertia holds. It is compiled at its first use. Empty: the same slopes."""

    in_stages: bool = False
    """Whether the slopes are those of the term as it acts for implicit solvers, other than for explicit ones: within
    the stages of Newton's method (Needs.newton), or between steps for others that need slopes (channels.STAGE), which
    on small islands take differences."""

    border: int = 0
    """Unknowns m that border the linear systems of implicit stages, as the forces of ties, that depend on rates: of y
    with n entries they have the rows and columns n to n + m. What such a row holds of d(rates) stands in the row n + m
    and so on, at the columns of these rates. The rate is evaluated at the state before the kernel is called."""

    @property
    def entries(self) -> int:
        """Length of the kernel's slice."""
        count = len(self.rows)
        if self.shared is not None:
            count = int(max(self.shared.max(), -1 - self.shared.min(), -1)) + 1 if len(self.shared) else 0
        return 9 * count if self.blocks else count


@dataclass(frozen=True, slots=True, eq=False)
class Pattern:
    """The sparsity pattern of an island's Jacobian, all of the diagonal included, no place twice.

    Its values are first those of the blocks, nine for each, row by row, then the others one by one.
    """

    blocks: NDArray[int64]
    """(b, 2) first row and first column of the 3x3 blocks, ascending: rows of velocities of masses."""
    others: NDArray[int64]
    """(s, 2) row and column of each value outside blocks, ascending."""
    known: NDArray[bool_]
    """(s,) whether a value outside blocks comes from slopes; the rest are zeros on the diagonal."""
    room: int
    """Length of the array ``values`` of the jacobian kernel: the values first, then its scratch."""
    exact: bool
    """False: the Jacobian is full, found by differences of the rate."""
    tallies: NDArray[int64]
    """Entries of y without slopes, such as the energy taken out: nothing depends on them, and their own rows are left
    out."""

    @property
    def count(self) -> int:
        """Number of values."""
        return 9 * len(self.blocks) + len(self.others)

    @property
    def rows(self) -> NDArray[int64]:
        """(count,) of each value."""
        import numpy as np

        own = (self.blocks[:, :1] + np.array([0, 0, 0, 1, 1, 1, 2, 2, 2])).ravel()
        return np.concatenate([own, self.others[:, 0]])

    @property
    def columns(self) -> NDArray[int64]:
        """(count,) of each value."""
        import numpy as np

        own = (self.blocks[:, 1:] + np.array([0, 1, 2, 0, 1, 2, 0, 1, 2])).ravel()
        return np.concatenate([own, self.others[:, 1]])
