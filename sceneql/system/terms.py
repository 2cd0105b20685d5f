"""Terms of an island's rate: their stages, their slopes, and the pattern of the Jacobian that slopes make."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from numpy import bool_, int64
    from numpy.typing import NDArray

Stage = Literal["internal", "force", "close", "constrain"]


@dataclass(frozen=True, slots=True, eq=False)
class Slopes:
    """The derivatives of one term's addition to the rate: where they stand, and the kernel that computes them.

    The kernel has the signature of a term, ``(t, y, entries, floats, ints)``, and adds to entries[i] (its own slice
    (k,), zero before) the derivative of what the term adds to rate[rows[i]] with respect to y[columns[i]]: for forces
    newtons per meter and per m/s, since the island multiplies by inverse masses and adds dx/dt = v. Places may repeat
    (their entries are summed) and stay the same for the run; rows of the energy taken out (Bodies.work_at) are left
    out. It stands in a kernel file of its own, which explicit solvers then never load.

    What it adds by values that read the state is not asked for: the island has it from differences of the term itself
    by the floats of these values (island/value_slopes.py).

    While channels.DEFINITE is above 0, Newton's method asks for what serves it best: the force itself, where slopes
    contain it, is that which the latest change foresaw, and where DEFINITE is finite, a kernel that can leaves out what
    pushes masses away, such as the part of a spring's compression across it.
    """

    kernel: str
    """``"package.module:function"``."""
    rows: Any
    """(k,) int; empty where nothing that the term adds depends on y."""
    columns: Any
    """(k,) int."""
    ints: Any = None
    """The kernel's integers; None: those of the term."""
    shared: Any = None
    """(k,) int, where several places have the same entry: which one each place adds, e, or takes away, -1 - e."""

    blocks: bool = False
    """Places and entries are blocks of 3x3, of which ``rows`` and ``columns`` give the first row and column; the nine
    numbers of an entry follow one another, row by row. Thrice as quick, where masses act on masses."""

    in_stages: bool = False
    """They are known where the term acts in another way than it does for explicit methods: within stages of Newton's
    method (Stepper.newton), or between steps for others that ask for slopes (channels.STAGE); for these, slopes of
    small islands are found by differences."""

    @property
    def entries(self) -> int:
        """Length of the kernel's slice."""
        count = len(self.rows)
        if self.shared is not None:
            count = int(max(self.shared.max(), -1 - self.shared.min(), -1)) + 1 if len(self.shared) else 0
        return 9 * count if self.blocks else count


@dataclass(frozen=True, slots=True, eq=False)
class Pattern:
    """Where an island's Jacobian may differ from zero, all of the diagonal included: no place twice.

    Its values are first those of the blocks, nine for each, row by row, then the others one by one.
    """

    blocks: NDArray[int64]
    """(b, 2) first row and first column of the blocks of 3x3, rising: rows of velocities of masses."""
    others: NDArray[int64]
    """(s, 2) row and column of each value outside blocks, rising."""
    known: NDArray[bool_]
    """(s,) which of those come from slopes; the rest are zeros on the diagonal."""
    room: int
    """Length of the array ``values`` that the jacobian is called with: the values first, then scratch of its own."""
    exact: bool
    """False: by differences of the rate, the pattern is full."""
    tallies: NDArray[int64]
    """Entries of y that have no slopes at all, such as the energy taken out: nothing depends on them, and what they
    depend on is left out."""

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
