"""Tables of the fast transforms that solve the pressure equation of a box."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import prod
from typing import TYPE_CHECKING

import numpy as np

from sceneql.flows.layout import (
    BOTH,
    COSINES,
    FREE_FREE,
    FREE_NODES,
    NODES,
    NODES_FREE,
    PAD,
    PLAN,
    QUARTER_COSINES,
    QUARTER_SINES,
    SINES,
    WAVES,
)

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Assembly

KINDS = {(False, False): COSINES, (True, True): SINES, (False, True): QUARTER_COSINES, (True, False): QUARTER_SINES}
"""Eigenmodes of values at cells' centers, by whether they vanish at the low and the high end."""
NODE_KINDS = {(True, True): NODES, (True, False): NODES_FREE, (False, True): FREE_NODES, (False, False): FREE_FREE}
"""Eigenmodes of values at faces, by the same."""


def modes(count: int, periodic: bool, zero: tuple[bool, bool], faces: bool = False) -> tuple[int, int, Floats]:
    """(kind of eigenmodes of an axis, length of its complex transform, eigenvalues (count,) of 2 x - left - right).

    ``zero``: whether values vanish at the low and the high end; ``faces``: whether values are at faces, ends included.
    """
    k = np.arange(count)
    if periodic:
        return WAVES, count, 4.0 * np.sin(np.pi * k / count) ** 2
    if faces:
        kind, last = NODE_KINDS[zero], count - 1
        half = kind in (NODES_FREE, FREE_NODES)
        turns = np.maximum(0.5 * k - 0.25, 0.0) if half else 0.5 * k
        return kind, (4 if half else 2) * last, 4.0 * np.sin(np.pi * turns / last) ** 2
    kind = KINDS[zero]
    half = kind in (QUARTER_COSINES, QUARTER_SINES)
    turns = {COSINES: 0.5 * k, SINES: 0.5 * (count - k)}.get(kind, 0.5 * (k + 0.5))
    return kind, 2 * count if half else count, 4.0 * np.sin(np.pi * turns / count) ** 2


def plan_of(kind: int, length: int, store: Callable[[Floats], int]) -> list[int]:
    """The PLAN integers of an axis's transform; ``store`` appends numbers and returns their offset."""
    turn, twist = 2.0 * np.pi * np.arange(length) / length, 0.5 * np.pi * np.arange(length) / length
    waves = store(np.concatenate([np.cos(turn), np.sin(turn)]))
    twists = store(np.concatenate([np.cos(twist), np.sin(twist)]))
    parts = factors(length)
    found = [kind, length, waves, twists, len(parts), *parts]
    return found + [0] * (PLAN - len(found))


def plans(
    shape: tuple[int, int, int], periodic: Sequence[bool], opened: Sequence[tuple[bool, bool]],
    conductances: Sequence[float], assembly: Assembly,
) -> tuple[list[int], Floats, int]:  # fmt: skip
    """(integers of all three axes, 1/eigenvalues (cells,) of the pressure equation, size of scratch [floats]).

    Of a flat box, in place of these, the store of lines_kernels.

    Eigenvalues stand in the order in which `through_modes_of_rows` asks for them: of BOTH rows along the last axis
    after those of the BOTH before, so that memory gives one after another.
    ``conductances``: those of the faces normal to each of the two or three axes.
    """
    from sceneql.flows import lines_kernels as lines

    ints: list[int] = []
    total, lengths, kinds = np.zeros(shape[::-1]), [], []
    for axis in range(3):
        if axis >= len(conductances):
            ints += [0] * PLAN
            continue
        kind, length, values = modes(shape[axis], periodic[axis], opened[axis])
        total += conductances[axis] * values.reshape([-1 if k == 2 - axis else 1 for k in range(3)])
        ints += plan_of(kind, length, assembly.floats)
        lengths.append(length)
        kinds.append((kind, values))
    room = BOTH * (8 * max(shape) + (max(shape) + 1) + 16) + 2 * PAD
    spectrum = total.ravel()
    least = spectrum[spectrum > 1e-12 * spectrum.max(initial=1e-300)].min(initial=np.inf)
    if shape[2] == 1 and shape[1] >= lines.FEWEST:
        (_, along_x), (kind, _) = kinds
        store = np.zeros(lines.HEAD + 8 * (shape[0] + shape[1]) + 2 * spectrum.size)
        held = 0.0 if spectrum.min() >= least else least
        taken = lines.prepare(store, *shape[:2], kind, held, 0.0, conductances[0], along_x, conductances[1], lengths[0])
        return ints, store[:taken], room
    inverse = 1.0 / (np.where(spectrum >= least, spectrum, least) * prod(lengths))
    rows = np.where(np.isfinite(inverse), inverse, 0.0).reshape(shape[len(conductances) - 1], -1)
    inverse = np.concatenate([rows[:, begin : begin + BOTH].ravel() for begin in range(0, rows.shape[1], BOTH)])
    return ints, inverse, room


def lines_room(shape: tuple[int, int, int], kind: int, along_x: Floats, tie: float) -> int:
    """Numbers that a store of lines_kernels takes for (1 + a L) x = w of a flat box, whatever a is; 0: there is none.

    L has the eigenvalues ``along_x`` (nx,) along x, and modes of a ``kind`` and ``tie`` (2 x - left - right) along y.
    """
    from sceneql.flows import lines_kernels as lines

    nx, ny, _ = shape
    if ny < lines.FEWEST or not tie > 0.0:
        return 0
    store = np.zeros(lines.HEAD + 8 * (nx + ny) + 2 * nx * ny)
    taken: int = lines.prepare(store, nx, ny, kind, 0.0, 1e-12 * tie, 1.0, along_x, tie, 1.0)
    return max(0, taken)


def factors(n: int) -> list[int]:
    """The factors 4, 2 and odd primes of n, with multiplicity."""
    found = []
    for prime in (4, 2, 3, 5, 7, 11, 13):
        while n % prime == 0:
            found.append(prime)
            n //= prime
    prime = 17
    while n > 1:
        while n % prime == 0:
            found.append(prime)
            n //= prime
        prime = prime + 2 if prime * prime <= n else n
    return found
