"""Orders of a deep flow in space and time, by the exact one of Ethier & Steinman (1994).

python tests/bench/bench_exact_flow.py space 64      errors and orders to so many cells a side
python tests/bench/bench_exact_flow.py time sbdf2    differences from much finer steps on 16^3 cells, and orders
"""

from __future__ import annotations

import math
import sys
from typing import Any

import numpy as np
from bench_flow import Air

A, D = math.pi / 4, math.pi / 2


def turned(x: Any, y: Any, z: Any, t: float, nu: float) -> Any:
    """Ethier and Steinman's velocity (n, 3) at places."""

    def one(x: Any, y: Any, z: Any) -> Any:
        wave = np.exp(A * x) * np.sin(A * y + D * z) + np.exp(A * z) * np.cos(A * x + D * y)
        return -A * wave * np.exp(-nu * D * D * t)

    return np.stack([one(x, y, z), one(y, z, x), one(z, x, y)], axis=-1)


def turned_pressure(x: Any, y: Any, z: Any, t: float, nu: float) -> Any:
    """Its pressure, of density 1, but for a constant."""

    def one(x: Any, y: Any, z: Any) -> Any:
        both = 2 * np.sin(A * x + D * y) * np.cos(A * z + D * x) * np.exp(A * (y + z))
        return np.exp(2 * A * x) + both

    return -0.5 * A * A * (one(x, y, z) + one(y, z, x) + one(z, x, y)) * np.exp(-2 * nu * D * D * t)


def corkscrew(cells: int, solver: str, advection: str, end: float, nu: float) -> tuple[Any, Any, Any]:
    """Places, velocities and pressures at the end, in the cube of side 2 with the exact velocity on its boundary."""

    def one(x: str, y: str, z: str, t: str) -> str:
        wave = f"exp({A!r}*{x})*sin({A!r}*{y} + {D!r}*{z}) + exp({A!r}*{z})*cos({A!r}*{x} + {D!r}*{y})"
        return f"-{A!r}*({wave})*exp(-{nu * D * D!r}*{t})"

    whole = (f'"[{one("x", "y", "z", t)}, {one("y", "z", "x", t)}, {one("z", "x", "y", t)}]"' for t in ("0", "t"))
    start, given = whole
    air = Air(
        solver, end, size="2 2 2 m", corner="-1 -1 -1 m", cell=f"{2 / cells!r} m", density="1 kg/m^3",
        viscosity=f"{nu!r} Pa*s", advection=advection, initial=f"{{velocity: {start}}}",
        boundary=f"{{rest: {{inflow: {{velocity: {given}}}}}}}",
    )  # fmt: skip
    air.run.advance(end)
    pressure = air.read("pressure")
    return air.read("centers"), air.read("velocity"), pressure - pressure.mean()


def size_of(values: Any) -> float:
    """The root of the mean square."""
    return float(np.sqrt((values**2).mean()))


def space(cells: str) -> None:
    """Errors at 0.1 s by the cells, of viscosity 1; and their orders."""
    for advection in ("central", "koren"):
        before: list[float] = []
        for n in (int(cells) // 4, int(cells) // 2, int(cells)):
            places, found, pressure = corkscrew(n, f"{{sbdf2: {{step: {0.04 / n!r} s}}}}", advection, 0.1, 1.0)
            off, exact = found - turned(*places.T, 0.1, 1.0), turned_pressure(*places.T, 0.1, 1.0)
            errors = [size_of(off), float(np.abs(off).max()), size_of(pressure - exact + exact.mean())]
            orders = [math.log2(a / b) for a, b in zip(before, errors, strict=False)]
            told = ", ".join(f"{one:.2e}" for one in errors) + "".join(f" {one:.2f}" for one in orders)
            print(f"{advection} {n}^3: velocity L2, maximum, pressure L2 {told}")
            before = errors


STEPS = {"chorin": 10.0, "cnab2": 10.0, "sbdf2": 10.0, "ark3": 25.0}
"""Longest step [ms] of which orders are told."""


def time(solver: str) -> None:
    """Differences at 0.2 s from much finer steps, on 16^3 cells of viscosity 0.1, and their orders."""
    longest = STEPS[solver]
    finest = corkscrew(16, f"{{{solver}: {{step: {longest / 64!r} ms}}}}", "central", 0.2, 0.1)
    before: list[float] = []
    for part in (1, 2, 4):
        found = corkscrew(16, f"{{{solver}: {{step: {longest / part!r} ms}}}}", "central", 0.2, 0.1)
        errors = [size_of(found[k] - finest[k]) for k in (1, 2)]
        orders = [math.log2(a / b) for a, b in zip(before, errors, strict=False)]
        told = ", ".join(f"{one:.2e}" for one in errors) + "".join(f" {one:.2f}" for one in orders)
        print(f"{solver} {longest / part:g} ms: velocity, pressure {told}")
        before = errors


if __name__ == "__main__":
    {"space": space, "time": time}[sys.argv[1]](sys.argv[2])
