"""Steps of flows beside plain NumPy and SciPy, PhiFlow and jax-cfd.

    python tests/bench/bench_flow.py                    steps and peer
    python tests/bench/bench_flow.py steps              processor time of a step by sbdf2, boxes and cut cells
    python tests/bench/bench_flow.py peer               the same scheme by NumPy and SciPy: time, difference
    python tests/bench/bench_flow.py smoke              a step of smoke in a closed box of 64^2 beside PhiFlow's
    python tests/bench/bench_flow.py errors             error against time of a vortex, beside jax-cfd

Times are processor time of the march alone, all threads together, compiled and set up.
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
            found = step_time(cells, deep, cut, 20 if cells == 256 else 10)
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


PARTS = {one.__name__: one for one in (steps, peer, smoke, errors)}

if __name__ == "__main__":
    if len(sys.argv) > 1:
        PARTS[sys.argv[1]](*sys.argv[2:])
    else:
        steps()
        peer()
