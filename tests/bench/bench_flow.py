"""Steps of flows beside plain NumPy and SciPy; cylinder, cavities, convection and spheres beside published values.

    python tests/bench/bench_flow.py                    steps and peer
    python tests/bench/bench_flow.py steps              processor time of a step by sbdf2, boxes and cut cells
    python tests/bench/bench_flow.py peer               the same scheme by NumPy and SciPy: time, difference
    python tests/bench/bench_flow.py smoke              a step of smoke in a closed box of 64^2 beside PhiFlow's
    python tests/bench/bench_flow.py errors             error against time of a vortex, beside jax-cfd
    python tests/bench/bench_flow.py cylinder 20        2D-1, so many cells across: drag, lift, pressure
    python tests/bench/bench_flow.py vortices 20        2D-2: Strouhal number, largest drag and lift
    python tests/bench/bench_flow.py drawn 10 auto      a cylinder drawn through resting fluid, and in a stream: drag
    python tests/bench/bench_flow.py cavity 128 100     cells a side, Reynolds number: extrema of the lid-driven cavity
    python tests/bench/bench_flow.py heated 1e5 64      Nusselt numbers of the heated cavity by Ra and cells a side
    python tests/bench/bench_flow.py rolls 1740 24      growth of a roll between plates by Ra and cells of height [1/s]
    python tests/bench/bench_flow.py annulus 0.05       heat between cylinders, by the side of a cell [m]
    python tests/bench/bench_flow.py spheres 32 0.125   drag of rows of spheres, cells a side, their part of the volume

Times are processor time of the march alone, all threads together, compiled and set up. Published: Schafer & Turek
(1996); Botella & Peyret (1998); de Vahl Davis (1983), Le Quere (1991); Chandrasekhar (1961); Zick & Homsy (1982); Kuehn
& Goldstein (1976).
"""

from __future__ import annotations

import math
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
from scipy import fft

from sceneql.pipeline import load
from sceneql.run.run import IslandRun

FOLDER = Path(tempfile.mkdtemp())
SIDE = 2 * math.pi
WAVES = "left: {periodic: yes}, bottom: {periodic: yes}"
BALL = "objects: {ball: {sphere: {position: 3 3 Z m, radius: 0.8 m}}}\n"


class Air:
    """One island with a flow `air`, on its way."""

    def __init__(self, solver: str, end: float, before: str = "", models: str = "", **fields: str) -> None:
        flow = ", ".join(f"{name}: {value}" for name, value in fields.items())
        path = FOLDER / "scene.yaml"
        text = f"clock: {{end: {end!r} s, fps: 1}}\n{before}models:\n  air: {{flow: {{{flow}}}}}\n{models}"
        path.write_text(f"{text}solvers: {{main: {solver}}}\n", encoding="utf-8")
        graph = load(path, pruned=False)
        self.tasks, self.run = graph.tasks, IslandRun(graph, graph.islands[0])

    def read(self, output: str, model: str = "air") -> Any:
        """An output, now."""
        return self.tasks[model].kind.read(output, self.run.state(model))


def vortex(cells: int, deep: bool, cut: bool, step: float, end: float, advection: str = "koren") -> Air:
    """Taylor and Green's vortex in a periodic box, around a ball or not."""
    flat = '"[-cos(x)*sin(y), sin(x)*cos(y)]"'
    whole = '"[sin(x)*cos(y)*cos(z), -cos(x)*sin(y)*cos(z), 0*x]"'
    more = {"around": "[ball]"} if cut else {}
    return Air(
        f"{{sbdf2: {{step: {step!r} s}}}}", end, BALL.replace("Z", "3" if deep else "0") if cut else "",
        size=" ".join([repr(SIDE)] * (3 if deep else 2)) + " m", cell=f"{SIDE}/{cells} m", density="1 kg/m^3",
        viscosity="0.01 Pa*s", initial=f"{{velocity: {whole if deep else flat}}}", advection=advection,
        boundary=f"{{{WAVES}{', back: {periodic: yes}' if deep else ''}}}", **more,
    )  # fmt: skip


def step_time(cells: int, deep: bool, cut: bool, steps: int) -> float:
    """Processor seconds of a step."""
    h = 0.5 * SIDE / cells
    air = vortex(cells, deep, cut, h, 1000 * h)
    air.run.advance(2 * h)
    started = time.process_time()
    air.run.advance((2 + steps) * h)
    return (time.process_time() - started) / steps


def steps() -> None:
    """By kinds and sizes."""
    print("a step by sbdf2: processor ms, ns a cell")
    for deep, cut, sizes in (
        (False, False, (256, 1024)), (False, True, (256, 1024)), (True, False, (64, 128)), (True, True, (64, 128)),
    ):  # fmt: skip
        for cells in sizes:
            found = step_time(cells, deep, cut, 20 if cells == 256 else 3)
            count = cells ** (3 if deep else 2)
            name = f"{'cut cells' if cut else 'box'} {cells}^{3 if deep else 2}"
            print(f"  {name:18s} {1e3 * found:9.1f} {1e9 * found / count:7.0f}")


class Plain:
    """The same scheme on a periodic square by NumPy and SciPy: [u, v] of (2, n, n), [y, x], at low faces."""

    def __init__(self, cells: int, viscosity: float, step: float) -> None:
        self.n, self.d, self.nu, self.h = cells, SIDE / cells, viscosity, step
        k = 4 * np.sin(np.pi * np.arange(cells) / cells) ** 2 / self.d**2
        self.decay = k[:, None] + k[None, : cells // 2 + 1]
        self.inverse = np.divide(1.0, self.decay, out=np.zeros_like(self.decay), where=self.decay > 0)
        x = np.arange(cells) * self.d
        middle = x + 0.5 * self.d
        self.u = np.stack([-np.cos(x)[None] * np.sin(middle)[:, None], np.cos(x)[:, None] * np.sin(middle)[None]])
        self.u = self.projected(self.u)[0]
        rate = self.advected(self.u) + self.nu * self.laplacian(self.u)
        self.p = self.projected(rate)[1]
        self.before: tuple[Any, Any] | None = None

    def gradient(self, p: Any) -> Any:
        return np.stack([p - np.roll(p, 1, 1), p - np.roll(p, 1, 0)]) / self.d

    def divergence(self, u: Any) -> Any:
        return (np.roll(u[0], -1, 1) - u[0] + np.roll(u[1], -1, 0) - u[1]) / self.d

    def projected(self, u: Any) -> tuple[Any, Any, Any]:
        out = self.divergence(u)
        q = fft.irfft2(-fft.rfft2(out) * self.inverse, s=out.shape)
        return u - self.gradient(q), q, out

    def laplacian(self, u: Any) -> Any:
        return (np.roll(u, 1, 1) + np.roll(u, -1, 1) + np.roll(u, 1, 2) + np.roll(u, -1, 2) - 4 * u) / self.d**2

    def advected(self, u: Any) -> Any:
        rate = np.zeros_like(u)
        for component, axis in ((0, 0), (0, 1), (1, 0), (1, 1)):
            c, along, other = u[component], 1 - axis, 1 - component
            passing = 0.5 * (u[axis] + np.roll(u[axis], 1, along if axis == component else other))
            up, down = np.roll(c, 1, along), c
            forth = passing > 0
            behind = np.where(forth, up - np.roll(c, 2, along), down - np.roll(c, -1, along))
            ahead = np.where(forth, down - up, up - down)
            a, b = np.abs(behind), np.abs(ahead)
            half = np.where(behind * ahead > 0, np.copysign(np.minimum(np.minimum(a, (2 * b + a) / 6), b), ahead), 0)
            moved = passing * (np.where(forth, up, down) + half)
            rate[component] += (moved - np.roll(moved, -1, along)) / self.d
        return rate

    def step(self) -> None:
        rate, h = self.advected(self.u), self.h
        if self.before is None:
            lead, wanted = 1.0, self.u + h * rate
        else:
            lead = 1.5
            wanted = (2 * self.u - 0.5 * self.before[0] + h * (2 * rate - self.before[1])) / lead
        wanted = wanted - h / lead * self.gradient(self.p)
        smooth = fft.irfft2(fft.rfft2(wanted) / (1 + h / lead * self.nu * self.decay), s=wanted.shape[1:])
        self.before = (self.u, rate)
        self.u, q, out = self.projected(smooth)
        self.p = self.p + lead / h * q - self.nu * out


def peer() -> None:
    """One program beside the other, in turn, the best of three."""
    cells, count = 256, 10
    h = 0.5 * SIDE / cells
    ours, plain = math.inf, math.inf
    for _ in range(3):
        air = vortex(cells, False, False, h, 1000 * h)
        air.run.advance(2 * h)
        started = time.process_time()
        air.run.advance((2 + count) * h)
        ours = min(ours, (time.process_time() - started) / count)
        one = Plain(cells, 0.01, h)
        for _ in range(2):
            one.step()
        started = time.process_time()
        for _ in range(count):
            one.step()
        plain = min(plain, (time.process_time() - started) / count)
    found = np.array(air.run.y[: 2 * cells * cells]).reshape(2, cells, cells)
    print(f"sbdf2 256^2 a step: {1e3 * ours:.1f} ms, NumPy and SciPy {1e3 * plain:.1f} ms, {plain / ours:.1f} times")
    print(f"  velocities differ by {np.abs(found - one.u).max():.1e} of {np.abs(one.u).max():.2f} m/s")


def smoke() -> None:
    """Smoke that rises in a closed box of 64^2, beside PhiFlow's example, by its NumPy and residuals of 1e-4."""
    from phi import flow as phi

    air = Air(
        "{sbdf2: {step: 0.2 s}}", 1e4,
        models="""  smoke:
    diffusion: {of: concentration, size: 100 100 m, cell: 100/64 m, coefficient: 1e-4 m^2/s,
      source: "exp(-((x - 50)^2 + (y - 9.5)^2)/25)*0.2", drift: {by: air}}
""",
        size="100 100 m", cell="100/64 m", density="1 kg/m^3", viscosity="1e-4 Pa*s",
        buoyancy='{by: smoke.concentration, expansion: 0.01 m^3/kg, reference: 0 kg/m^3}',
    )  # fmt: skip
    ours = [took(air.run.advance, 0.2 * 20 * k) / 20 for k in range(1, 6)]
    box = phi.Box(x=100, y=100)
    velocity = phi.StaggeredGrid((0, 0), 0, x=64, y=64, bounds=box)
    amount = phi.CenteredGrid(0, phi.ZERO_GRADIENT, x=64, y=64, bounds=box)
    source = 0.2 * phi.resample(phi.Sphere(x=50, y=9.5, radius=5), to=amount, soft=True)
    pressure: Any = None

    def step() -> None:
        nonlocal velocity, amount, pressure
        amount = phi.advect.mac_cormack(amount, velocity, 1.0) + source
        pushed = phi.resample(amount * (0, 0.1), to=velocity)
        velocity = phi.advect.semi_lagrangian(velocity, velocity, 1.0) + pushed
        velocity, pressure = phi.fluid.make_incompressible(velocity, (), phi.Solve("CG", 1e-4, x0=pressure))

    theirs = [took(step) for _ in range(6)]
    mine, other = min(ours), min(theirs[1:])
    print(f"smoke 64^2 a step: {1e3 * mine:.2f} ms, PhiFlow {1e3 * other:.0f} ms, {other / mine:.0f} times")


def took(act: Any, *given: Any) -> float:
    """Processor time [s]."""
    started = time.process_time()
    act(*given)
    return time.process_time() - started


def errors() -> None:
    """Taylor and Green's vortex after 2 s, steps of half a cell, beside jax-cfd in float64."""
    import jax
    import jax_cfd.base as cfd

    jax.config.update("jax_enable_x64", True)
    print("largest error of u at 2 s and processor time: cells a side, ours by sbdf2 and central, jax-cfd")
    for cells in (32, 64, 128, 256):
        count = round(4 / (SIDE / cells))
        h, x, middle = 2 / count, np.arange(cells) * SIDE / cells, (np.arange(cells) + 0.5) * SIDE / cells
        fade = math.exp(-2 * 0.01 * 2)
        air = vortex(cells, False, False, h, 4.0, "central")
        air.run.advance(0.0)
        mine = took(air.run.advance, 2.0)
        exact = -np.cos(x)[None] * np.sin(middle)[:, None] * fade
        error = np.abs(air.run.y[: cells * cells].reshape(cells, cells) - exact).max()
        grid = cfd.grids.Grid((cells, cells), domain=((0, SIDE), (0, SIDE)))
        periodic = cfd.boundaries.periodic_boundary_conditions(2)
        places = [grid.mesh(offset) for offset in grid.cell_faces]
        start = tuple(
            cfd.grids.GridVariable(cfd.grids.GridArray(values, offset, grid), periodic)
            for values, offset in zip(
                (-np.cos(places[0][0]) * np.sin(places[0][1]), np.sin(places[1][0]) * np.cos(places[1][1])),
                grid.cell_faces, strict=True,
            )
        )  # fmt: skip
        one = cfd.equations.semi_implicit_navier_stokes(density=1.0, viscosity=0.01, dt=h, grid=grid)
        march = jax.jit(cfd.funcutils.repeated(one, count))
        found = march(start)  # compiled
        other = took(lambda march=march, start=start: march(start)[0].data.block_until_ready())
        end = np.asarray(found[0].data)
        theirs = np.abs(end + np.cos(places[0][0]) * np.sin(places[0][1]) * fade).max()
        print(f"  {cells:4d}  {error:.1e} {1e3 * mine:8.1f} ms   {theirs:.1e} {1e3 * other:8.1f} ms")


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


PARTS = {
    one.__name__: one
    for one in (
        *(steps, peer, smoke, errors, cylinder, vortices, drawn, cavity, heated, rolls, annulus),
        spheres,
    )
}

if __name__ == "__main__":
    if len(sys.argv) > 1:
        PARTS[sys.argv[1]](*sys.argv[2:])
    else:
        steps()
        peer()
