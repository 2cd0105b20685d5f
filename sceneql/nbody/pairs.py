"""Inverse-square forces between all masses of an island, for the words mutual_gravity and electrostatic."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from sceneql.nbody import layout
from sceneql.nbody.shared_masses import first_of, integers_of
from sceneql.quantities.diagnostic import Diagnostic, ScriptError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sceneql.quantities.span import Span
    from sceneql.system import Assembly, Bodies, ModelState, Slopes


SAMPLES = 64
"""Number of bodies at which the error of a tree is sampled."""
MOST_SLOPES = 400
"""Largest number of bodies with derivatives, whose matrix is dense."""
MOST_DIRECT = 4000
"""Largest number of bodies for which the sum over all pairs is faster than a tree."""


@dataclass(frozen=True)
class Pairs:
    """Forces F_i = sign c w_i sum_j w_j d_ij / (r^2 + softening^2)^(3/2) between all bodies, d_ij from i to j."""

    sign: int
    constant_at: int
    softening: float
    opening: float
    """Opening angle of the tree; 0: direct sum over all pairs."""
    weights: Sequence[tuple[int, int]]
    """Offset and stride of each model's weights in the floats."""
    fast: bool = False
    """Whether sums over every pair are in single precision."""

    def add(self, assembly: Assembly, everyone: Sequence[Bodies], span: Span | None) -> None:
        """Add the term, and remember the integers for `energy`.

        Raises ScriptError for bodies at one place at the start without softening.
        """
        if self.softening == 0:
            apart(assembly, everyone, span)
        bodies = integers_of(everyone)
        weights = tuple(number for weight in self.weights for number in weight)
        kernel, numbers = self._tree(assembly, bodies[0]) if self.opening > 0 else self._direct(assembly, bodies[0])
        ints = (*numbers, *bodies, *weights)
        count = bodies[0]
        few = self.opening == 0 and count <= MOST_SLOPES
        slopes = (lambda: blocks(everyone)) if few else None
        assembly.term("force", kernel, ints, slopes)
        assembly.remember(int(self.opening > 0), *ints)

    def _direct(self, assembly: Assembly, n: int) -> tuple[str, tuple[int, ...]]:
        """Kernel and integers up to the bodies (direct_kernels)."""
        from sceneql.compiled.threads_kernels import threads, tile_address
        from sceneql.nbody.direct_kernels import LANES, direct_tile, parts_of
        from sceneql.nbody.fast_kernels import fast_tile

        room = -(-n // LANES) * LANES
        sums = (_scratch(assembly, 3 * room * parts_of(room)), parts_of(room))
        ints = (
            *self._numbers(assembly, room),
            *sums,
            *threads(),
            tile_address(fast_tile if self.fast else direct_tile),
        )
        return "sceneql.nbody.direct_kernels:direct", ints

    def _tree(self, assembly: Assembly, n: int) -> tuple[str, tuple[int, ...]]:
        """Kernel and integers up to the bodies (tree_kernels)."""
        from sceneql.compiled.threads_kernels import threads, tile_address
        from sceneql.nbody.octree_kernels import NODE
        from sceneql.nbody.tree_kernels import tree_tile

        most = n // 2 + 64
        ints = (
            *(*self._numbers(assembly, n), assembly.floats([self.opening]), _scratch(assembly, NODE * most), most),
            *(_scratch(assembly, count) for count in (3 * n, n, n, n + 2, n)),
            *(*threads(), tile_address(tree_tile)),
        )
        return "sceneql.nbody.tree_kernels:tree", ints

    def _numbers(self, assembly: Assembly, room: int) -> tuple[int, ...]:
        """First integers of both kernels (layout)."""
        softening = assembly.floats([self.softening])
        return self.constant_at, self.sign, softening, _scratch(assembly, 3 * room), _scratch(assembly, room), room


def blocks(everyone: Sequence[Bodies]) -> Slopes:
    """Derivatives of all forces by positions: a 3x3 block for every two bodies."""
    import numpy as np

    from sceneql.system import Slopes

    rows, columns = (
        np.concatenate([at + np.arange(3 * bodies.count) for at, bodies in zip(offsets, everyone, strict=True)])
        for offsets in ([b.velocity_at for b in everyone], [b.position_at for b in everyone])
    )
    n = len(rows) // 3
    shape = (n, n, 3, 3)
    by_row = np.broadcast_to(rows.reshape(n, 1, 3, 1), shape).ravel()
    by_column = np.broadcast_to(columns.reshape(1, n, 1, 3), shape).ravel()
    return Slopes("sceneql.nbody.slopes_kernels:direct", by_row, by_column)


def _scratch(assembly: Assembly, count: int) -> int:
    """Offset of scratch floats for a kernel."""
    import numpy as np

    return assembly.floats(np.zeros(count))


def apart(assembly: Assembly, everyone: Sequence[Bodies], span: Span | None) -> None:
    """Raise ScriptError for two bodies with mass at one place at the start."""
    import numpy as np

    start, numbers = assembly.start(), assembly.numbers()
    places = np.concatenate([start[b.position_at : b.position_at + 3 * b.count].reshape(-1, 3) for b in everyone])
    alive = np.concatenate([numbers[b.mass_at : b.mass_at + b.count] > 0 for b in everyone])
    order = np.lexsort(places.T)
    order = order[alive[order]]
    same = np.flatnonzero(np.all(places[order[1:]] == places[order[:-1]], axis=1))
    if not len(same):
        return
    names = [f"{b.model} {k}" for b in everyone for k in range(b.count)]
    pair = sorted(int(k) for k in order[same[0] : same[0] + 2])
    text = f"{names[pair[0]]} and {names[pair[1]]} (counted from 0) start at one place, where 1/r^2 has no value"
    raise ScriptError([Diagnostic("coincident", text, span, "move one of them, or give the force a `softening`")])


def sampled_error(state: ModelState) -> tuple[float, float]:
    """Relative errors of the forces at a state: root mean square and largest over SAMPLES evenly chosen bodies."""
    import numpy as np

    ints = np.array(state.ints[1:], dtype=np.int64)
    rate = np.zeros_like(state.y)
    if state.ints[0]:
        from sceneql.nbody.tree_kernels import BODIES as BODIES_AT
        from sceneql.nbody.tree_kernels import tree as term
    else:
        from sceneql.nbody.direct_kernels import BODIES as BODIES_AT
        from sceneql.nbody.direct_kernels import direct as term
    term(state.t, state.y, rate, state.floats, ints)
    n, models = int(ints[BODIES_AT + layout.MASSES]), ints[BODIES_AT + layout.MODELS]
    rows = ints[BODIES_AT + layout.ROWS :][: layout.MODEL * models].reshape(-1, layout.MODEL)
    found = np.concatenate([rate[at : at + 3 * count].reshape(-1, 3) for at, count in rows[:, 1:3]])
    weights = int(ints[layout.WEIGHTS])
    places = np.concatenate([state.y[at : at + 3 * count].reshape(-1, 3) for at, count in rows[:, ::2][:, :2]]).T
    weight = state.floats[weights : weights + n]
    softening = float(state.floats[ints[layout.SOFTENING]])
    wrong = []
    for k in np.linspace(0, n - 1, SAMPLES).astype(int):
        apart = places - places[:, k : k + 1]
        square = np.sum(apart**2, axis=0)
        pull = np.where(square > 0, weight / np.maximum(square + softening**2, 1e-300) ** 1.5, 0.0)
        exact = float(ints[layout.SIGN] * state.floats[ints[layout.CONSTANT]]) * weight[k] * (apart @ pull)
        size = float(np.linalg.norm(exact))
        wrong.append(float(np.linalg.norm(found[k] - exact)) / size if size > 0 else 0.0)
    return float(np.sqrt(np.mean(np.square(wrong)))), max(wrong)


def energy(bodies: Bodies, state: ModelState) -> float:
    """Potential energy [J] of a model: half of each pair's energy for each of its bodies."""
    import numpy as np

    tree, *rest = state.ints
    ints = np.array(rest, dtype=np.int64)
    if tree:
        from sceneql.nbody.tree_kernels import BODIES, POTENTIALS

        bodies_at, n = BODIES, rest[BODIES]
        found = state.floats[rest[POTENTIALS] : rest[POTENTIALS] + n]
    else:
        from sceneql.nbody.direct_kernels import BODIES, potentials

        bodies_at, n = BODIES, rest[BODIES]
        found = np.zeros(n)
        potentials(state.y, state.floats, ints, found)
    first = first_of(bodies, rest[bodies_at:])
    own = slice(first, first + bodies.count)
    weights = state.floats[rest[layout.WEIGHTS] : rest[layout.WEIGHTS] + n]
    constant = float(rest[layout.SIGN] * state.floats[rest[layout.CONSTANT]])
    return -0.5 * constant * float(weights[own] @ found[own])
