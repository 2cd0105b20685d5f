"""Flows beside published values: cylinder, cavities, convection, rows of spheres.

    bench_flow_values.py cylinder 20  2D-1, so many cells across: drag, lift, pressure
    bench_flow_values.py vortices 20  2D-2: Strouhal number, largest drag and lift
    bench_flow_values.py drawn 10 auto  a cylinder drawn through resting fluid, and in a stream: drag
    bench_flow_values.py cavity 128 100  cells a side, Reynolds number: extrema of the lid-driven cavity
    bench_flow_values.py heated 1e5 64  Nusselt numbers of the heated cavity by Ra and cells a side
    bench_flow_values.py rolls 1740 24  growth of a roll between plates by Ra and cells of height [1/s]
    bench_flow_values.py annulus 0.05  heat between cylinders, by the side of a cell [m]
    bench_flow_values.py spheres 32 0.125  drag of rows of spheres, cells a side, their part of the volume

Schafer & Turek (1996); Botella & Peyret (1998); de Vahl Davis (1983), Le Quere (1991); Chandrasekhar (1961); Zick &
Homsy (1982); Kuehn & Goldstein (1976).
"""

from __future__ import annotations

import math
import sys
import time
from typing import Any

import numpy as np
from bench_flow import WAVES, Air


def in_channel(across: int, speed: float, step: float, end: float) -> Air:
    """Schafer and Turek's channel."""
    inflow = f'"[{4 * speed!r}*y*(0.41 - y)/0.41^2, 0]"'
    return Air(
        f"{{sbdf2: {{step: {step!r} s}}}}", end, "objects: {cyl: {sphere: {position: 0.2 0.2 0 m, radius: 5 cm}}}\n",
        size="2.2 0.41 m", cell=f"{0.1 / across!r} m", density="1 kg/m^3", viscosity="1e-3 Pa*s", advection="central",
        around="[cyl]", boundary=f"{{left: {{inflow: {{velocity: {inflow}}}}}, right: {{outflow: {{}}}}}}",
    )  # fmt: skip


def coefficients(air: Air, speed: float) -> Any:
    """Drag and lift."""
    return air.read("cyl.force")[:2] * 2 / ((2 * speed / 3) ** 2 * 0.1)


def pressure_at(air: Air, x: float, y: float, way: int) -> float:
    """The pressure at a point of the wall, drawn on from the two cells before or behind it."""
    places, found = air.read("centers"), air.read("pressure")
    width = int(np.flatnonzero(np.diff(places[:, 1]) > 0)[0]) + 1
    xs, ys, table = places[:width, 0], places[::width, 1], found.reshape(-1, width)
    j = int(np.searchsorted(ys, y))
    row = table[j - 1] + (y - ys[j - 1]) / (ys[j] - ys[j - 1]) * (table[j] - table[j - 1])
    i = int(np.searchsorted(xs, x)) - (way < 0) + way
    return float(row[i] + (x - xs[i]) / (xs[i + way] - xs[i]) * (row[i + way] - row[i]))


def cylinder(across: str) -> None:
    """2D-1."""
    air = in_channel(int(across), 0.3, 0.2 / int(across), 8.0)
    air.run.advance(8.0)
    drag, lift = coefficients(air, 0.3)
    jump = pressure_at(air, 0.15, 0.2, -1) - pressure_at(air, 0.25, 0.2, 1)
    print(f"2D-1, {across} cells: drag {drag:.4f} (5.5795), lift {lift:.5f} (0.01062), pressure {jump:.5f} (0.11752)")


def vortices(across: str) -> None:
    """2D-2: the last six of the periods up to 8 s."""
    air = in_channel(int(across), 1.5, 0.016 / int(across), 8.0)
    times = np.arange(6.0, 8.0, 2.5e-3)
    found = []
    for now in times:
        air.run.advance(float(now))
        found.append(coefficients(air, 1.5))
    drag, lift = np.array(found).T
    centered = lift - 0.5 * (lift.max() + lift.min())
    ups = np.flatnonzero((centered[:-1] < 0) & (centered[1:] >= 0))
    zeros = times[ups] + 2.5e-3 * centered[ups] / (centered[ups] - centered[ups + 1])
    number = 0.1 / np.diff(zeros).mean()
    print(f"2D-2, {across} cells: Strouhal {number:.4f} (0.295 to 0.305), drag {drag.max():.4f} (3.22 to 3.24)")
    print(f"  lift {lift.max():.4f} (0.99 to 1.01), peak to peak {np.ptp(lift):.4f} (2.0079)")


def drawn(across: str, solver: str = "auto") -> None:
    """Drag at 1 m/s in a periodic channel of a fluid at rest, beside that in a stream whose walls move along.

    ``solver``: `auto`, or one of fixed steps, which are then of a tenth of a cell's crossing.
    """
    cell = 0.2 / int(across)
    times = 0.4 + 0.0037 * np.arange(60)
    wall = '{wall: {velocity: "[-1, 0]"}}'
    drags = []
    for moves in (False, True):
        place = "[0.6 m + 1 m/s*time, 0.413 m, 0 m]" if moves else "0.6 0.413 0 m"
        walls = "" if moves else f", bottom: {wall}, top: {wall}"
        more = {} if moves else {"initial": '{velocity: "[-1 + 0*x, 0*x]"}'}
        by = "{auto: {}}" if solver == "auto" else f"{{{solver}: {{step: {0.1 * cell!r} s}}}}"
        air = Air(
            by, 1.0, f"objects: {{cyl: {{sphere: {{position: {place}, radius: 0.1 m}}}}}}\n", size="2.4 0.8 m",
            cell=f"{cell!r} m", density="1 kg/m^3", viscosity="0.025 Pa*s", advection="central", around="[cyl]",
            boundary=f"{{left: {{periodic: yes}}{walls}}}", **more,
        )  # fmt: skip
        found, started = [], time.process_time()
        for now in times:
            air.run.advance(float(now))
            found.append(air.read("cyl.force")[0])
        drags.append(np.array(found))
        took = time.process_time() - started
        done = air.run.march.statistics
        count = f"{done.steps} steps, {done.rejected} rejected"
        print(f"  {'moves' if moves else 'stands'}: {drags[-1].mean():.5f} N, {took:.1f} s, {count}")
    apart = 100 * (drags[1] / drags[0] - 1)
    print(f"drawn, {across} cells: drag {apart.mean():+.2f} % in the mean, {np.abs(apart).max():.2f} % at most")


CAVITY = {100: (-0.2140424, 0.1795728, -0.2538030), 1000: (-0.3885698, 0.3769447, -0.5270771)}
"""Extrema by Reynolds number: least u, largest and least v."""


def cavity(cells: str, reynolds: str = "1000") -> None:
    """To a steady state; extrema on the middle lines, by parabolas through three values."""
    n, number = int(cells), int(reynolds)
    air = Air(
        f"{{sbdf2: {{step: {0.5 / n!r} s}}}}", 120.0, size="1 1 m", cell=f"1/{n} m", density="1 kg/m^3",
        viscosity=f"{1 / number!r} Pa*s", advection="central", boundary='{top: {wall: {velocity: "[1, 0]"}}}',
    )  # fmt: skip
    for now in range(20, 121 if number > 100 else 41, 20):
        air.run.advance(float(now))
        y = np.array(air.run.y)
        u, v = y[: n * (n + 1)].reshape(n, n + 1)[:, n // 2], y[n * (n + 1) :].reshape(n + 1, n)[n // 2]
        found = [-vertex(-u), vertex(v), -vertex(-v)]
        worst = max(abs(a / b - 1) for a, b in zip(found, CAVITY[number], strict=True))
        values = " ".join(f"{one:.5f}" for one in found)
        print(f"cavity Re {number} {n}^2 at {now} s: {values}, worst {100 * worst:.2f} %")


def vertex(values: Any) -> float:
    """The top of the parabola through the largest of some values and its neighbors."""
    k = int(np.argmax(values))
    a, b, c = values[k - 1 : k + 2]
    return float(b - (c - a) ** 2 / (8 * (a - 2 * b + c)))


def heated(rayleigh: str, cells: str) -> None:
    """Pr 0.71; Nusselt numbers at both walls, from a start that is not symmetric until they agree."""
    ra, n = float(rayleigh), int(cells)
    step = 0.25 / n / math.sqrt(ra * 0.71) * 8
    heat = (
        f"  heat: {{diffusion: {{size: 1 1 m, cell: 1/{n} m, of: temperature, coefficient: 1 m^2/s, "
        'initial: "(1 - x)^2", drift: {by: air}, boundary: {left: {value: 1}, right: {value: 0}}}}\n'
    )
    lift = f"{{by: heat.temperature, expansion: {0.71 * ra!r} 1/K, reference: 0.5 K, gravity: 0 -1 0 m/s^2}}"
    air = Air(
        f"{{sbdf2: {{step: {step!r} s}}}}", 4.0, models=heat, size="1 1 m", cell=f"1/{n} m", density="1 kg/m^3",
        viscosity="0.71 Pa*s", advection="central", buoyancy=lift,
    )  # fmt: skip
    for now in (0.1, 0.2, 0.3, 0.4, 0.8, 1.2, 1.6, 2.0):
        air.run.advance(now)
        field = air.read("temperature", "heat").reshape(n, n)
        sides = 2 * n * (1 - field[:, 0]).mean(), 2 * n * field[:, -1].mean()
        apart = abs(sides[0] - sides[1]) / sides[1]
        print(f"heated Ra {ra:g} {n}^2 at {now} s: Nu {sides[0]:.4f} {sides[1]:.4f}, apart {apart:.1e}", flush=True)
        if apart < 1e-9:
            break


def rolls(rayleigh: str, cells: str) -> None:
    """A roll of small amplitude between rigid plates, Pr 0.71; how its energy grows."""
    ra, n = float(rayleigh), int(cells)
    wide = 2.0158
    box = f"size: {wide} 1 m, cell: {1 / n!r} m"
    heat = (
        f"  heat: {{diffusion: {{{box}, of: temperature, coefficient: 1 m^2/s, drift: {{by: air}}, "
        f'initial: "1 - y + 1e-4*sin(pi*y)*cos(2*pi*x/{wide})", '
        "boundary: {bottom: {value: 1}, top: {value: 0}, left: {periodic: yes}}}}\n"
    )
    air = Air(
        "{sbdf2: {step: 2 ms}}", 3.0, models=heat, size=f"{wide} 1 m", cell=f"{1 / n!r} m", density="1 kg/m^3",
        viscosity="0.71 Pa*s", advection="central", boundary="{left: {periodic: yes}}",
        buoyancy=f"{{by: heat.temperature, expansion: {0.71 * ra!r} 1/K, reference: 0.5 K, gravity: 0 -1 0 m/s^2}}",
    )  # fmt: skip
    energies = []
    for now in (1.0, 2.0, 3.0):
        air.run.advance(now)
        energies.append(air.read("kinetic_energy"))
    print(f"rolls Ra {ra:g}, {n} cells: growth {0.5 * math.log(energies[2] / energies[1]):+.4f} 1/s (0 at 1707.762)")


def annulus(cell: str) -> None:
    """Heat between cylinders, the inner one warm, Ra 1e4, Pr 0.7, over that by conduction."""
    h = float(cell)
    ring = "objects: {outer: {sphere: {position: 0 0 0 m, radius: 1.625 m}}, inner: {sphere: {position: 0 0 0 m, "
    ring += "radius: 0.625 m}}, ring: {difference: {of: [outer, inner]}}}\n"
    said = 'of: temperature, coefficient: 1 m^2/s, initial: "0.5", drift: {by: air}, domain: ring, flat: yes'
    held = '{warm: {where: "1 - x^2 - y^2", value: 1}, rest: {value: 0}}'
    heat = f"  heat: {{diffusion: {{{said}, cell: {cell} m, boundary: {held}}}}}\n"
    air = Air(
        "{ark3: {}}", 0.6, ring, heat, domain="ring", flat="yes", cell=f"{cell} m",
        density="1 kg/m^3", viscosity="0.7 Pa*s", advection="central",
        buoyancy="{by: heat.temperature, expansion: 7000 1/K, reference: 0.5 K, gravity: 0 -1 0 m/s^2}",
    )  # fmt: skip
    for now in (0.2, 0.4, 0.6):
        air.run.advance(now)
        pairs = zip(air.read("centers", "heat"), air.read("temperature", "heat"), strict=True)
        known = {(round(x / h * 4), round(y / h * 4)): c for (x, y, _), c in pairs}
        centers = air.read("centers")
        warm = np.array([known.get((round(x / h * 4), round(y / h * 4)), 0.0) for x, y, _ in centers])
        outwards = (air.read("velocity") * centers).sum(axis=1) / np.maximum((centers**2).sum(axis=1), 0.1)
        found = 1 + float((outwards * warm).sum()) * h * h / (2 * math.pi)
        print(f"annulus, {cell} m at {now} s: {found:.4f} times conduction (2.010)", flush=True)


SPHERES = {0.027: 2.008, 0.064: 2.810, 0.125: 4.292, 0.216: 7.442, 0.343: 15.4, 0.45: 28.1}


def spheres(cells: str, part: str) -> None:
    """K = F/(6 pi mu a U) of a cubic row of spheres that a force drives a slow flow past."""
    n, fraction = int(cells), float(part)
    radius = (3 * fraction / (4 * math.pi)) ** (1 / 3)
    ball = f"objects: {{ball: {{sphere: {{position: 0.5 0.5 0.5 m, radius: {radius!r} m}}}}}}\n"
    air = Air(
        "{sbdf2: {step: 5 ms}}", 2.0, ball, size="1 1 1 m", cell=f"{1 / n!r} m", density="1 kg/m^3",
        viscosity="1 Pa*s", around="[ball]", force='"[1e-3, 0, 0]"',
        boundary=f"{{{WAVES}, back: {{periodic: yes}}}}",
    )  # fmt: skip
    for now in (0.5, 1.0):
        air.run.advance(now)
        mean = float(air.read("momentum")[0])
        found = 1e-3 / (6 * math.pi * radius * mean)
        held = float(air.read("ball.force")[0]) / (1e-3 * (1 - fraction))
        known = SPHERES.get(fraction, math.nan)
        print(f"spheres {n}^3, part {fraction} at {now} s: K {found:.4f} ({known}), force by balance {held:.4f}")


PARTS = {one.__name__: one for one in (cylinder, vortices, drawn, cavity, heated, rolls, annulus, spheres)}

if __name__ == "__main__":
    PARTS[sys.argv[1]](*sys.argv[2:])
