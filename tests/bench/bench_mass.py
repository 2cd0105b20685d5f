"""Mass and inertia of solids as rigid bodies beside closed forms: errors, and the time to build the run.

python tests/bench/bench_mass.py
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable

import numpy as np
from bench_rigid import build, tell


def main() -> None:
    """Solids by their words; closed forms for a density of 1000 kg/m^3."""

    def ball(r: float) -> tuple[float, list[float]]:
        m = 4000 / 3 * math.pi * r**3
        return m, [0.4 * m * r * r] * 3

    def column(r: float, h: float) -> tuple[float, list[float]]:
        m = 1000 * math.pi * r * r * h
        across = m * (3 * r * r + h * h) / 12
        return m, [across, 0.5 * m * r * r, across]

    def block(a: float, b: float, c: float) -> tuple[float, list[float]]:
        m = 1000 * a * b * c
        return m, [m * (b * b + c * c) / 12, m * (a * a + c * c) / 12, m * (a * a + b * b) / 12]

    def ring(big: float, r: float) -> tuple[float, list[float]]:
        m = 2000 * math.pi**2 * big * r * r
        across = m * (big**2 / 2 + 5 * r * r / 8)
        return m, [across, m * (big**2 + 3 * r * r / 4), across]

    def less(one: tuple[float, list[float]], other: tuple[float, list[float]]) -> tuple[float, list[float]]:
        return one[0] - other[0], list(np.subtract(one[1], other[1]))

    def drilled(s: float) -> tuple[float, list[float]]:
        return less(block(s, 0.6 * s, 0.8 * s), column(0.2 * s, 0.6 * s))

    solids: dict[str, tuple[str, Callable[[float], tuple[float, list[float]]]]] = {
        "sphere": ("{sphere: {radius: 0.5*s}}", lambda s: ball(0.5 * s)),
        "box": ("{box: {size: [s, 0.6*s, 0.8*s]}}", lambda s: block(s, 0.6 * s, 0.8 * s)),
        "cylinder": ("{cylinder: {radius: 0.2*s, height: 0.9*s}}", lambda s: column(0.2 * s, 0.9 * s)),
        "torus": ("{torus: {radius: 0.5*s, tube: 0.15*s}}", lambda s: ring(0.5 * s, 0.15 * s)),
        "torus by its field": (
            "{implicit: {field: '(sqrt(x^2 + z^2) - S/2)^2 + y^2 - (0.15*S)^2'}}",
            lambda s: ring(0.5 * s, 0.15 * s),
        ),
        "box less cylinder": (
            "{difference: {of: [{box: {size: [s, 0.6*s, 0.8*s]}}, {cylinder: {radius: 0.2*s, height: s}}]}}",
            drilled,
        ),
    }
    print("mass and inertia: errors in parts of the largest, ms to build the run")
    tell("", "mass", "inertia", "ms")
    for name, (word, exact) in solids.items():
        for size in (1.01, 1.0):  # the first compiles; a solid of equal form and size is measured once
            script = (
                f"define: {{s: {size} m}}\nclock: {{end: 1 s}}\nobjects: {{it: {word.replace('S', str(size))}}}\n"
                "models: {body: {rigid: {of: it, density: 1000 kg/m^3, velocity: 1 0 0 m/s}}}\n"
            )
            started = time.perf_counter()
            moment = build(script).at(0.0)
            spent = time.perf_counter() - started
        weight, moments = exact(size)
        found = np.asarray(moment.read("body", "inertia"))
        off = np.abs(found - np.diag(moments)).max() / max(moments)
        tell(name, f"{abs(moment.read('body', 'momentum')[0] / weight - 1):.0e}", f"{off:.0e}", f"{1e3 * spent:.1f}")


if __name__ == "__main__":
    main()
