"""The tables of fast transforms for the pressure of a box."""

from __future__ import annotations

from collections.abc import Sequence
from math import prod
from typing import TYPE_CHECKING

import numpy as np

from sceneql.flows.layout import COSINES, LANES, PLAN, QUARTER_COSINES, QUARTER_SINES, SINES, WAVES

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Assembly

KINDS = {(False, False): COSINES, (True, True): SINES, (False, True): QUARTER_COSINES, (True, False): QUARTER_SINES}
"""Modes by whether the low and the high end are open."""


def modes(count: int, periodic: bool, opened: tuple[bool, bool]) -> tuple[int, int, Floats]:
    """The modes of an axis, the length of the complex transform, and eigenvalues (count,) of 2 x - left - right."""
    kind = WAVES if periodic else KINDS[opened]
    k = np.arange(count)
    half = kind in (QUARTER_COSINES, QUARTER_SINES)
    turns = {WAVES: k, COSINES: 0.5 * k, SINES: 0.5 * (count - k)}.get(kind, 0.5 * (k + 0.5))
    return kind, 2 * count if half else count, 4.0 * np.sin(np.pi * turns / count) ** 2


def plans(
    shape: tuple[int, int, int], periodic: Sequence[bool], opened: Sequence[tuple[bool, bool]],
    conductances: Sequence[float], assembly: Assembly,
) -> tuple[list[int], Floats, int]:  # fmt: skip
    """Integers of all three axes, 1/eigenvalues (cells,) of the pressure's equation, and the floats of its scratch.

    ``conductances``: of the faces of each axis, two or three of them.
    """
    ints: list[int] = []
    total, lengths = np.zeros(shape[::-1]), []
    for axis in range(3):
        if axis >= len(conductances):
            ints += [0] * PLAN
            continue
        kind, length, values = modes(shape[axis], periodic[axis], opened[axis])
        total += conductances[axis] * values.reshape([-1 if k == 2 - axis else 1 for k in range(3)])
        turn, twist = 2.0 * np.pi * np.arange(length) / length, 0.5 * np.pi * np.arange(length) / length
        waves = assembly.floats(np.concatenate([np.cos(turn), np.sin(turn)]))
        twists = assembly.floats(np.concatenate([np.cos(twist), np.sin(twist)]))
        parts = factors(length)
        own = [kind, length, waves, twists, len(parts), *parts]
        ints += own + [0] * (PLAN - len(own))
        lengths.append(length)
    spectrum = total.ravel()
    least = spectrum[spectrum > 1e-12 * spectrum.max(initial=1e-300)].min(initial=np.inf)
    inverse = 1.0 / (np.where(spectrum >= least, spectrum, least) * prod(lengths))
    return ints, np.where(np.isfinite(inverse), inverse, 0.0), 4 * LANES * max(lengths)


def factors(n: int) -> list[int]:
    """Fours, a two, and odd primes, whose product is n."""
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
