"""Forces between many bodies and curl noise: pairs a second, a tree beside pytreegrav's, nanoseconds a particle.

Run it as ``python tests/bench/bench_nbody.py [BODIES [PART...]]``: bodies of the tree, 1e5 by default; parts are
direct, tree and noise. Bars on two cores: direct sums of 100,000 bodies at 2.5e9 pairs/s (all n^2 counted, each
computed once for both), 4e9 in fast mode; a Plummer sphere of 1e6 bodies at 1e-3 rms in less time than pytreegrav.
"""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytreegrav

from sceneql.compiled.threads_kernels import thread_count, threads, tile_address
from sceneql.nbody.pairs import Pairs
from sceneql.system import Bodies
from sceneql.words.forces import turbulence_kernels

ROUNDS = 3
LONG = 8.0
SAMPLES = 200
SOFTENING = 1e-3
Floats = np.ndarray[Any, np.dtype[np.float64]]


class Scratch:
    """As much of an assembly as a force between masses asks for."""

    def __init__(self, masses: Floats) -> None:
        self.parts, self.size = [masses], len(masses)
        self.kernel, self.ints = "", np.zeros(0, dtype=np.int64)

    def floats(self, values: Any) -> int:
        """Store numbers."""
        at = self.size
        self.parts.append(np.ravel(np.asarray(values, dtype=np.float64)))
        self.size += len(self.parts[-1])
        return at

    def term(self, stage: str, kernel: str, ints: Any, slopes: Any = None) -> None:
        """Keep the term."""
        self.kernel, self.ints = kernel, np.array(ints, dtype=np.int64)

    def remember(self, *ints: int) -> None:
        """Nothing reads it here."""


def plummer(count: int) -> Floats:
    """Places (count, 3) of a Plummer sphere of unit scale (Aarseth, Henon & Wielen 1974)."""
    chance = np.random.Generator(np.random.Philox(1))
    radius = 1.0 / np.sqrt((0.999 * chance.random(count)) ** (-2.0 / 3.0) - 1.0)
    direction = chance.normal(size=(count, 3))
    return radius[:, None] * direction / np.linalg.norm(direction, axis=1)[:, None]


def accelerations(places: Floats, opening: float, fast: bool = False) -> Callable[[], Floats]:
    """A call that gives accelerations (count, 3) for a total mass 1."""
    from sceneql.compiled.generated import function

    count = len(places)
    scratch: Any = Scratch(np.full(count, 1.0 / count))
    pairs = Pairs(1, scratch.floats([1.0]), SOFTENING, opening, [(0, 1)], fast)
    pairs.add(scratch, [Bodies("b", count, 0, 3 * count, 0, 0, 0, 0)], None)
    term, floats = function(scratch.kernel), np.concatenate(scratch.parts)
    y = np.concatenate([places.ravel(), np.zeros(3 * count)])
    rate = np.zeros_like(y)

    def call() -> Floats:
        rate[:] = 0.0
        term(0.0, y, rate, floats, scratch.ints)
        return rate[3 * count :].reshape(-1, 3) * count

    return call


def seconds(call: Callable[[], object]) -> tuple[float, float]:
    """Median wall and processor time of ROUNDS calls after one that is not counted; of LONG ones one."""
    began = time.perf_counter()
    call()
    walls, works = [], []
    for _ in range(ROUNDS if time.perf_counter() - began < LONG else 1):
        wall, work = time.perf_counter(), time.process_time()
        call()
        walls.append(time.perf_counter() - wall)
        works.append(time.process_time() - work)
    return statistics.median(walls), statistics.median(works)


def error(found: Floats, places: Floats) -> float:
    """Root mean square of the relative error of SAMPLES accelerations."""
    wrong = []
    for k in np.random.Generator(np.random.Philox(2)).integers(0, len(places), SAMPLES):
        apart = places - places[k]
        square = (apart**2).sum(axis=1) + SOFTENING**2
        exact = (apart / square[:, None] ** 1.5).sum(axis=0) / len(places)
        wrong.append(np.linalg.norm(found[k] - exact) / np.linalg.norm(exact))
    return float(np.sqrt(np.mean(np.square(wrong))))


def direct() -> None:
    """Sums over all pairs."""
    places = plummer(100_000)
    for name, fast in (("direct", False), ("direct, fast", True)):
        call = accelerations(places, 0.0, fast)
        wall, work = seconds(call)
        rate = len(places) ** 2 / 1e9
        print(
            f"{name}, {len(places):,} bodies: {rate / wall:.2f}e9 pairs/s, {rate / work:.2f}e9 per processor second, "
            f"rms {error(call(), places):.1e}",
            flush=True,
        )


def tree(bodies: int) -> None:
    """The tree beside pytreegrav's, at several openings each."""
    places, masses = plummer(bodies), np.full(bodies, 1.0 / bodies)
    soft = np.full(bodies, SOFTENING)
    for opening in (0.5, 0.65):
        call = accelerations(places, opening)
        wall, work = seconds(call)
        report(f"tree, {bodies:,} bodies, opening {opening}", wall, work, error(call(), places))
    for theta, quadrupole in ((0.5, False), (0.7, True), (0.6, True)):

        def peer(theta: float = theta, quadrupole: bool = quadrupole) -> Floats:
            options = {"theta": theta, "method": "tree", "parallel": True, "quadrupole": quadrupole}
            return np.asarray(pytreegrav.Accel(places, masses, soft, **options))

        wall, work = seconds(peer)
        # It softens by a spline inside the length; so few bodies stand that near that the samples do not notice.
        name = f"pytreegrav, theta {theta}{', quadrupoles' if quadrupole else ''}"
        report(name, wall, work, error(peer(), places))


def report(name: str, wall: float, work: float, wrong: float) -> None:
    """One line of the table."""
    print(f"{name}: {wall:.2f} s ({work:.2f} s of processors), rms {wrong:.1e}", flush=True)


def noise() -> None:
    """Curl noise alone."""
    count = 400_000
    y = np.random.Generator(np.random.Philox(3)).uniform(-30, 30, size=6 * count + 1)
    floats = np.concatenate([[1.0, 1.0], np.zeros(3), [1.0, 0.3], np.ones(2 * count)])
    rate = np.zeros_like(y)
    tile = tile_address(turbulence_kernels.turbulence_tile)
    for octaves in (1, 3):
        numbers = [0, 3 * count, count, 6 * count, 7, 0, 1, 2, 5, 7 + count, octaves, 1, *threads(), tile]
        ints = np.array(numbers)

        def turbulence(ints: Any = ints) -> None:
            turbulence_kernels.turbulence(1.0, y, rate, floats, ints)

        wall, work = seconds(turbulence)
        spent = f"{wall / count * 1e9:.0f} ns a particle ({work / count * 1e9:.0f} ns of one core)"
        print(f"curl noise, {octaves} octaves: {spent}")


def main() -> None:
    """Print the table."""
    bodies = int(float(sys.argv[1])) if len(sys.argv) > 1 else 100_000
    parts = {"direct": direct, "tree": lambda: tree(bodies), "noise": noise}
    print(f"{thread_count()} threads; medians of {ROUNDS}")
    for name in sys.argv[2:] or parts:
        parts[name]()


if __name__ == "__main__":
    main()
