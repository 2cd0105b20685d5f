"""Reading of states within a step at whose end contacts have changed the state."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.island import layout

if TYPE_CHECKING:
    from numpy import bool_
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.island.system import System

JUMP = 4.0
"""Change of a velocity in a step, relative to its rate times the step, from which on the body was struck."""


class WithinContact:
    """Reads states within steps of an island with local contacts."""

    def __init__(self, system: System) -> None:
        at, count = int(system.ints[layout.TRIPLES_AT]), int(system.ints[layout.TRIPLES])
        triples = system.ints[at : at + layout.TRIPLE * count].reshape(count, layout.TRIPLE)
        self._velocities = [
            slice(int(one[layout.VELOCITY]), int(one[layout.VELOCITY] + one[layout.COUNT]))
            for one in triples
            if one[layout.COUNT] % 3 == 0
        ]
        self._momenta: NDArray[bool_] | None = None
        """(n,) bool: entries of rigid bodies that contacts change at once, neither positions nor rotations; None
        without such."""
        if system.structure.free and system.structure.local:
            self._momenta = system.partner < 0
            at = int(system.ints[layout.FREES_AT])
            for k in range(int(system.ints[layout.FREES])):
                first, count = system.ints[at + 2 * k : at + 2 * k + 2]
                self._momenta[first : first + count] = False

    def read(self, part: float, h: float, step: tuple[Any, ...], changed: NDArray[bool_], y: Floats) -> None:
        """Write into ``y``, the state at fraction ``part`` of a step, the entries that contacts have changed.

        ``step``: the arrays of the step's ends. In mode `local` a rigid body moves over the whole step with the
        velocity that it has after an impact (Moreau 1988): half way between the velocities before and after it there
        would be hardly any energy.
        """
        import numpy as np

        from sceneql.march.straightened_kernels import straightened

        line = np.empty_like(y)
        straightened(part, h, *step, line)
        y[changed] = line[changed]
        if self._momenta is not None and self._struck(h, *step[:3]):
            changed = changed & self._momenta
            y[changed] = step[2][changed]

    def _struck(self, h: float, y0: Floats, rate0: Floats, y1: Floats) -> bool:
        """Whether the velocity of a body or mass changed in a step by an impact."""
        import numpy as np

        for own in self._velocities:
            change, pushed = (one[own].reshape(-1, 3) for one in (y1 - y0, h * rate0))
            if np.any(np.linalg.norm(change, axis=1) > JUMP * np.linalg.norm(pushed, axis=1)):
                return True
        return False
