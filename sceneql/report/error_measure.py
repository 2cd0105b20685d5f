"""The error of a run's end against a reference: by kinds of quantities, each relative to its range over the run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy import bool_, int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.run.run import IslandRun

LATE = 0.75
"""Fraction of the run after which motion counts as late."""
LEAST = 1e-3
"""Least scale of an entry, relative to the largest range of its kind: an entry kept at zero by symmetry has no
range."""
MOVING, DAMPED = 0.05, 0.1
"""A kind moves late where the reference's late range is at least MOVING times its whole range; a run damps it where its
late range is below DAMPED times the reference's."""


@dataclass(frozen=True, slots=True, eq=False)
class ErrorMeasure:
    """The error scales of a state's entries. Positions, velocities and cells of a model are kinds.

    Other states are their own.
    """

    kinds: NDArray[int64]
    """(entries,) the kind of each entry; -1: not a model's."""
    scales: Floats
    """(entries,) the scale of each entry's error."""
    late: Floats
    """(kinds,) largest late range of an entry of each kind; 0 where it hardly moves then."""

    @classmethod
    def of(cls, island: IslandRun, own: NDArray[bool_], looks: Sequence[tuple[float, Floats]]) -> ErrorMeasure:
        """The measure by a reference's states over its run: (time [s], (entries,)) at each look, the start first.

        ``own`` (entries,) bool: entries of models.
        """
        import numpy as np

        from sceneql.stepping.error_scales import error_scales
        from sceneql.stepping.error_scales_kernels import GROUP_OF

        plan, _ = error_scales(island.march.system)
        kinds = np.where(own, plan[GROUP_OF:], -1)
        count = int(plan[0])
        states = np.array([y for _, y in looks])
        ranges = np.ptp(states, axis=0)
        widest = _largest(ranges, kinds, count)
        sizes = _largest(np.abs(states).max(axis=0), kinds, count)
        least = np.where(widest > 0.0, LEAST * widest, np.where(sizes > 0.0, sizes, 1.0))
        scales = np.maximum(ranges, np.where(kinds < 0, 1.0, least[kinds]))
        late = _largest(_late(looks), kinds, count)
        return cls(kinds, scales, np.where(late > MOVING * widest, late, 0.0))

    def error(self, y: Floats, reference: Floats) -> tuple[float, int]:
        """The largest error of an entry relative to its scale, and the entry."""
        import numpy as np

        errors = np.where(self.kinds < 0, 0.0, np.abs(y - reference) / self.scales)
        worst = int(np.argmax(errors)) if len(errors) else 0
        return float(errors[worst]) if len(errors) else 0.0, worst

    def damped(self, looks: Sequence[tuple[float, Floats]]) -> tuple[float, int] | None:
        """The kind that a run has damped most: the fraction of late motion left, and an entry.

        None where none is damped.
        """
        import numpy as np

        moved = _late(looks)
        left = _largest(moved, self.kinds, len(self.late))
        parts = np.divide(left, self.late, out=np.ones_like(left), where=self.late > 0.0)
        if not len(parts) or parts.min() >= DAMPED:
            return None
        kind = int(np.argmin(parts))
        return float(parts[kind]), int(np.flatnonzero(self.kinds == kind)[0])


def name_of(island: IslandRun, entry: int) -> str:
    """Description of an entry of the state for a reader."""
    system = island.march.system
    part = system.origin(entry).part
    for velocity_at, _, count in system.masses:
        for what, at in (("velocity", velocity_at), ("position", _position_at(system.partner, velocity_at))):
            if at <= entry < at + 3 * count:
                return f"the {what} of mass {(entry - at) // 3} of '{part}'"
    name = system.name(entry)
    return f"{name} of '{part}'" if name else f"'{part}'"


def _position_at(partner: NDArray[int64], velocity_at: int) -> int:
    import numpy as np

    found = np.flatnonzero(partner == velocity_at)
    return int(found[0]) if len(found) else -1


def _late(looks: Sequence[tuple[float, Floats]]) -> Floats:
    import numpy as np

    end = looks[-1][0]
    range_of: Floats = np.ptp(np.array([y for t, y in looks if t >= LATE * end]), axis=0)
    return range_of


def _largest(values: Floats, kinds: NDArray[int64], count: int) -> Floats:
    """(count,) the largest value of each kind; 0 where there is none."""
    import numpy as np

    found = np.zeros(count)
    inside = kinds >= 0
    np.maximum.at(found, kinds[inside], values[inside])
    return found
