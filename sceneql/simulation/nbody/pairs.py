"""Forces of 1/r^2 between all masses of an island, as the words mutual_gravity and electrostatic add them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.simulation.together import first_of, layout

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sceneql.frame import Floats
    from sceneql.quantities.span import Span
    from sceneql.system import Assembly, Bodies, ModelState


@dataclass(frozen=True)
class Pairs:
    """F_i = sign c w_i sum_j w_j d_ij / (r^2 + softening^2)^(3/2) between all bodies, d_ij from i to j."""

    sign: int
    constant_at: int
    softening: float
    weights: Sequence[tuple[int, int]]
    """For every model offset and step of its weights in the floats."""

    def add(self, assembly: Assembly, everyone: Sequence[Bodies], span: Span | None) -> None:
        """Add the term, and remember what `potential` needs.

        Raises ScriptError where bodies stand at one place at the start and no softening keeps the force finite.
        """
        import numpy as np

        from sceneql.simulation.nbody.direct_kernels import LANES, direct_tile
        from sceneql.simulation.threads_kernels import threads, tile_address

        if self.softening == 0:
            apart(assembly.start(), everyone, span)
        bodies = layout(everyone)
        room = -(-bodies[0] // LANES) * LANES
        ints = (
            *(self.constant_at, self.sign, assembly.floats([self.softening])),
            *(assembly.floats(np.zeros(3 * room)), assembly.floats(np.zeros(room)), room),
            *(*threads(), tile_address(direct_tile), *bodies),
            *(number for weight in self.weights for number in weight),
        )
        assembly.term("force", "sceneql.simulation.nbody.direct_kernels:direct", ints)
        assembly.remember(*ints)


def apart(start: Floats, everyone: Sequence[Bodies], span: Span | None) -> None:
    """Raise ScriptError when two bodies stand at one place."""
    import numpy as np

    places = np.concatenate([start[b.position_at : b.position_at + 3 * b.count].reshape(-1, 3) for b in everyone])
    order = np.lexsort(places.T)
    same = np.flatnonzero(np.all(places[order[1:]] == places[order[:-1]], axis=1))
    if not len(same):
        return
    names = [f"{b.model} {k}" for b in everyone for k in range(b.count)]
    pair = sorted(int(k) for k in order[same[0] : same[0] + 2])
    text = f"{names[pair[0]]} and {names[pair[1]]} (counted from 0) start at one place, where 1/r^2 has no value"
    raise ScriptError([Diagnostic("coincident", text, span, "move one of them, or give the force a `softening`")])


def energy(bodies: Bodies, state: ModelState) -> float:
    """The model's share of the potential energy [J]: half of each pair's for each of its bodies."""
    import numpy as np

    from sceneql.simulation.nbody import direct_kernels as kernels

    ints = np.array(state.ints, dtype=np.int64)
    n = int(ints[kernels.BODIES])
    found = np.zeros(n)
    kernels.potentials(state.y, state.floats, ints, found)
    first = first_of(bodies, state.ints[kernels.BODIES :])
    own = slice(first, first + bodies.count)
    weights_at = int(ints[kernels.WEIGHTS])
    constant = float(ints[kernels.SIGN] * state.floats[ints[kernels.CONSTANT]])
    return -0.5 * constant * float(state.floats[weights_at : weights_at + n][own] @ found[own])
