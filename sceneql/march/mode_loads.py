"""Modes under varying loads: q'' + 2 c q' + w^2 q = f(t), solved exactly where f is a polynomial in each piece."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sceneql.island.breakpoint_table import BreakpointTable, before, next_breakpoint

if TYPE_CHECKING:
    from collections.abc import Callable

    from sceneql.frame import Floats

PLACES = (0.0, 0.146446609406726, 0.5, 0.853553390593274, 1.0)
"""Nodes of a piece, relative to its length: Chebyshev's extreme points for polynomials of fourth degree."""
BETWEEN = (0.0573, 0.3017, 0.7219, 0.9411)
"""Points of a piece at which the interpolating polynomials are checked."""
TERMS = len(PLACES)
FIRST, SHORTEST = 1 / 16, 1e-7
"""Lengths of the first piece tried, relative to the run, and of the shortest, relative to the run."""
SERIES = 18
"""Number of terms in the series of the exponential of a matrix of norm 1."""


@dataclass(frozen=True, slots=True, eq=False)
class Modes:
    """Modes of unit mass: decay rates c (m,) [1/s] and squared angular frequencies w^2 (m,) [1/s^2]."""

    decays: Floats
    squares: Floats

    def moved(self, q: Floats, speed: Floats, load: Floats, h: float) -> tuple[Floats, Floats, Floats]:
        """q and q' (m,) after a time h [s], and repeated integrals (m, terms - 1) of q over that time.

        ``load`` (m, terms): f and its derivatives at the beginning. By the exponential of a matrix for each mode, in
        units of h (Van Loan 1978, IEEE Trans. Automat. Control 23, 395-404).
        """
        m, terms = load.shape
        if h == 0.0:
            return q.copy(), speed.copy(), np.zeros((m, terms - 1))
        unit = np.maximum(1.0, h * np.sqrt(np.maximum(self.squares, 0.0)))
        size = 2 + 2 * terms - 1
        matrix = np.zeros((m, size, size))
        matrix[:, 0, 1], matrix[:, 1, 0] = unit, -self.squares * h * h / unit
        matrix[:, 1, 1], matrix[:, 1, 2] = -2.0 * self.decays * h, 1.0 / unit
        for k in range(2, 1 + terms):
            matrix[:, k, k + 1] = 1.0
        for k in range(2 + terms, size):
            matrix[:, k, 0 if k == 2 + terms else k - 1] = 1.0
        start = np.zeros((m, size))
        start[:, 0], start[:, 1] = q, h * speed / unit
        start[:, 2 : 2 + terms] = load * h ** np.arange(2, 2 + terms)
        end = (exponentials(matrix) @ start[:, :, None])[:, :, 0]
        integrals = end[:, 2 + terms :] * h ** np.arange(1, terms)
        return end[:, 0], end[:, 1] * unit / h, integrals


def exponentials(matrices: Floats) -> Floats:
    """Exponentials of matrices (m, k, k), by scaling and squaring (Moler & Van Loan 2003, SIAM Review 45, 3-49)."""
    found = np.empty_like(matrices)
    halvings = np.maximum(0, np.ceil(np.log2(np.abs(matrices).sum(axis=2).max(axis=1, initial=1.0)))).astype(int)
    for times in np.unique(halvings):
        mine = halvings == times
        small = matrices[mine] / 2.0**times
        one = np.broadcast_to(np.eye(small.shape[1]), small.shape)
        total = one
        for k in range(SERIES, 0, -1):
            total = one + small @ total / k
        for _ in range(times):
            total = total @ total
        found[mine] = total
    return found


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """A part of the run in which loads are polynomials."""

    start: float
    end: float
    loads: Floats
    """(k, terms) each load and its derivatives at the start, or (k, 1) where it is constant."""

    def at(self, time: float) -> Floats:
        """(k, terms) the loads and their derivatives at an instant [s]."""
        found, h = np.zeros_like(self.loads), time - self.start
        terms = self.loads.shape[1]
        for k in range(terms):
            factor = 1.0
            for j in range(k, terms):
                found[:, k] += factor * self.loads[:, j]
                factor *= h / (j - k + 1)
        return found


def next_piece(
    loads: Callable[[float], Floats], start: float, length: float, stops: BreakpointTable, end: float, allowed: float
) -> Piece | None:
    """A piece that begins at ``start``, at most ``length`` [s] long; None: loads are not smooth there.

    ``loads(t)`` (k,) at a time [s]; ``allowed``: largest difference of polynomial and loads, relative to the largest
    load.
    """
    stop = next_breakpoint(stops, start, end)
    h = min(length, stop - start)
    places = np.array(PLACES)
    to_powers = np.linalg.inv(np.vander(places, increasing=True))
    factorials = np.array([1.0, 1.0, 2.0, 6.0, 24.0])
    known: dict[float, Floats] = {}

    def seen(share: float) -> Floats:
        t = start + share * h
        t = min(t, before(stop)) if stop < end else t
        if t not in known:
            known[t] = loads(t)
        return known[t]

    while h > SHORTEST * end:
        powers = to_powers @ np.array([seen(share) for share in PLACES])
        between = np.array(BETWEEN)
        found = np.vander(between, TERMS, increasing=True) @ powers
        errors = np.abs(found - np.array([seen(share) for share in BETWEEN]))
        if errors.max(initial=0.0) <= allowed * max(np.abs(one).max(initial=0.0) for one in known.values()):
            return Piece(start, min(start + h, stop), (powers * (factorials / h ** np.arange(TERMS))[:, None]).T)
        h *= 0.5
    return None
