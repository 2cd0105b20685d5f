"""Heat on the unit square beside FiPy, py-pde and SciPy with a cached factor; multigrid steps by size; the disk.

    python tests/bench/bench_diffusion.py            everything
    python tests/bench/bench_diffusion.py square     the square at t = 0.1, n = 64 and 128: error and run time
    python tests/bench/bench_diffusion.py peers      the same by FiPy and py-pde
    python tests/bench/bench_diffusion.py multigrid  one implicit step at D dt/h^2 = 1e4 to a residual of 1e-8
    python tests/bench/bench_diffusion.py disk       zero flux on the unit disk, cut cells and staircase
    python tests/bench/bench_diffusion.py mass       what 10,000 steps change of the mass on the disk
    python tests/bench/bench_diffusion.py jump       a jump at D dt/h^2 = 1000: least and largest value by scheme
    python tests/bench/bench_diffusion.py linear     one implicit step at 256^2 by every linear solver

Error: largest, in parts of what is left of the mode. Times are of the march alone, compiled and set up (the best of
three); set-up is told apart. FiPy and py-pde are peers (pip install fipy py-pde) and left out where they are missing.
"""

from __future__ import annotations

import math
import sys
import tempfile
import time
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from scipy.sparse import diags_array, eye_array, kron
from scipy.sparse.linalg import splu
from scipy.special import jv

from sceneql.grids.prepare_stages import report
from sceneql.pipeline import load
from sceneql.run.run import IslandRun

END = 0.1
EXACT = math.exp(-2 * math.pi**2 * END)
ROOT = 3.0542369282271403
FOLDER = Path(tempfile.mkdtemp())


def island(text: str) -> IslandRun:
    """The only island of a script."""
    path = FOLDER / "scene.yaml"
    path.write_text(text, encoding="utf-8")
    graph = load(path, pruned=False)
    return IslandRun(graph, graph.islands[0])


def scene(fields: str, solver: str, end: float, objects: str = "") -> str:
    """A script with one diffusion model."""
    head = f"clock: {{end: {end!r} s, fps: 1}}\n{objects}"
    model = f"{{diffusion: {{of: number, coefficient: 1, {fields}}}}}"
    return f"{head}models: {{plate: {model}}}\nsolvers: {{main: {solver}}}\n"


def ours(n: int, solver: str) -> tuple[float, float]:
    """(error, seconds) on the unit square."""
    fields = f'size: 1 1 m, cell: 1/{n} m, initial: "sin(pi*x)*sin(pi*y)", boundary: {{rest: {{value: 0}}}}'
    best = math.inf
    for _ in range(3):
        run = island(scene(fields, solver, END))
        started = time.perf_counter()
        y, _ = run.march.advance(END)
        best = min(best, time.perf_counter() - started)
    return error(y[: n * n].reshape(n, n)), best


def error(field: np.ndarray) -> float:
    """Of a field on cell centers, (n, n)."""
    n = len(field)
    x = np.sin(math.pi * (np.arange(n) + 0.5) / n)
    return float(np.abs(field / EXACT - np.outer(x, x)).max())


def scipy_factor(n: int, steps: int, scheme: str) -> tuple[float, float]:
    """(error, seconds) by hand: a sparse factor made once, counted; cell centers, values at the sides."""
    x = np.sin(math.pi * (np.arange(n) + 0.5) / n)
    y = np.outer(x, x).ravel()
    started = time.perf_counter()
    middle = np.full(n, -2.0)
    middle[[0, -1]] = -3.0
    one = diags_array([np.ones(n - 1), middle, np.ones(n - 1)], offsets=[-1, 0, 1]) * n**2
    laplace = (kron(one, eye_array(n)) + kron(eye_array(n), one)).tocsc()
    h = END / steps
    unit = eye_array(n * n, format="csc")
    if scheme == "crank_nicolson":
        factor = splu((unit - 0.5 * h * laplace).tocsc(), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
        for _ in range(steps):
            y = factor.solve(y + 0.5 * h * (laplace @ y))
    else:
        g = 2.0 - math.sqrt(2.0)
        factor = splu(
            (unit - 0.5 * g * h * laplace).tocsc(), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}
        )
        for _ in range(steps):
            middle_y = factor.solve(y + 0.5 * g * h * (laplace @ y))
            y = factor.solve((middle_y / g - (1 - g) ** 2 / g * y) / (2 - g))
    return error(y.reshape(n, n)), time.perf_counter() - started


def fipy_implicit(n: int, steps: int) -> tuple[float, float]:
    """(error, seconds) by FiPy's Crank-Nicolson of an implicit and an explicit half."""
    from fipy import CellVariable, DiffusionTerm, ExplicitDiffusionTerm, Grid2D, TransientTerm

    mesh = Grid2D(dx=1 / n, dy=1 / n, nx=n, ny=n)
    x, y = mesh.cellCenters
    field = CellVariable(mesh=mesh, value=np.sin(math.pi * x) * np.sin(math.pi * y))
    field.constrain(0.0, mesh.exteriorFaces)
    equation = TransientTerm() == 0.5 * DiffusionTerm(coeff=1.0) + 0.5 * ExplicitDiffusionTerm(coeff=1.0)
    started = time.perf_counter()
    for _ in range(steps):
        equation.solve(var=field, dt=END / steps)
    return error(np.array(field.value).reshape(n, n)), time.perf_counter() - started


def py_pde(n: int, adaptive: bool) -> tuple[float, float]:
    """(error, seconds) by py-pde's explicit solvers, compiled before: Euler at 0.8 of its limit, or adaptive."""
    from pde import CartesianGrid, DiffusionPDE, EulerSolver, RungeKuttaSolver, ScalarField

    start = ScalarField.from_expression(CartesianGrid([[0, 1], [0, 1]], n), "sin(pi*x)*sin(pi*y)")
    equation = DiffusionPDE(1.0, bc={"value": 0})
    solver = RungeKuttaSolver(equation, adaptive=True, tolerance=1e-4) if adaptive else EulerSolver(equation)
    advance = solver.make_stepper(start, dt=1e-6 if adaptive else 0.2 / n**2)
    advance(start.copy(), 0.0, 1e-4)
    best = math.inf
    for _ in range(3):
        field = start.copy()
        started = time.perf_counter()
        advance(field, 0.0, END)
        best = min(best, time.perf_counter() - started)
    return error(field.data), best


def square() -> None:
    """Error and run time on the square, beside SciPy."""
    schemes = (("tr_bdf2", 2e-3), ("tr_bdf2", 1e-3), ("crank_nicolson", 2e-3), ("adi", 2e-3))
    for n in (64, 128):
        for word, h in schemes:
            tell(n, f"ours, {word} {h * 1e3:g} ms", *ours(n, f"{{{word}: {{step: {h} s}}}}"))
        tell(n, "ours, auto", *ours(n, "auto"))
        for scheme in ("tr_bdf2", "crank_nicolson"):
            wrong, seconds = min((scipy_factor(n, 50, scheme) for _ in range(3)), key=lambda row: row[1])
            tell(n, f"SciPy, cached factor, {scheme} 2 ms", wrong, seconds)


def peers() -> None:
    """FiPy and py-pde on the square, where they are installed."""
    for n in (64, 128):
        if find_spec("fipy"):
            tell(n, "FiPy, Crank-Nicolson 2 ms", *fipy_implicit(n, 50))
        if find_spec("pde"):
            tell(n, "py-pde, Euler at 0.8 of its limit", *py_pde(n, False))
            tell(n, "py-pde, adaptive Runge-Kutta", *py_pde(n, True))


def tell(n: int, name: str, wrong: float, seconds: float) -> None:
    """A line of the table."""
    print(f"n = {n}  {name:44} error {wrong:.1e}  {1e3 * seconds:9.2f} ms", flush=True)


def step_once(n: int, dims: int, linear: str, number: float = 1e4) -> tuple[float, float, float, int]:
    """(set-up, first step, best of the next two [s], iterations) of implicit Euler at D dt/h^2 = number."""
    h = number / n**2
    start = '"where((x>0.3)*(x<0.6)*(y>0.2)*(y<0.9) > 0.5, 1, 0) + 0.3*sin(40*x*y)"'
    fields = f"size: {' '.join(['1'] * dims)} m, cell: 1/{n} m, initial: {start}, boundary: {{rest: {{value: 0}}}}"
    text = scene(fields, f"{{implicit_euler: {{step: {h!r} s, linear: {linear}}}}}", 4 * h)
    started = time.perf_counter()
    march = island(text).march
    march._settings[0] = 1e-8  # the residual asked for
    setup = time.perf_counter() - started
    taken = []
    for k in (1, 2, 3):
        started = time.perf_counter()
        march.advance(h * k)
        taken.append(time.perf_counter() - started)
    done = report(march.scratch)
    return setup, taken[0], min(taken[1:]), done.iterations // done.systems


def multigrid() -> None:
    """One step by multigrid on grids of several sizes."""
    step_once(32, 2, "multigrid")
    for n, dims in ((256, 2), (512, 2), (1024, 2), (64, 3), (128, 3)):
        setup, first, step, iterations = step_once(n, dims, "multigrid")
        cost = f"{1e9 * step / n**dims:.0f} ns a cell, {iterations} iterations"
        # What the first step takes longer than others is set-up too: coarse grids, memory that is touched first.
        print(f"{n}^{dims}: set-up {setup + first - step:.2f} s, step {step:.3f} s, {cost}", flush=True)


def linear() -> None:
    """One step at 256^2 by every linear solver."""
    for number in (1.0, 100.0, 1e5):
        for name in ("fast_transform", "direct", "multigrid", "conjugate_gradient", "sor", "gauss_seidel"):
            if number == 1e5 and name == "gauss_seidel":
                continue  # it does not converge
            _, _, step, iterations = step_once(256, 2, name, number)
            print(f"D dt/h^2 = {number:g}  {name:20} {1e3 * step:9.1f} ms, {iterations} iterations")


def disk() -> None:
    """The disk's mode J2(root r) cos 2 theta + 1 with zero flux at t = 0.1."""
    for edges in ("cut_cell", "staircase"):
        counts = (32, 48, 64, 96, 128, 192, 256)
        worst, mean = [], []
        for n in counts:
            run = on_disk(f"edges: {edges}, cell: 2/{n} m", "{tr_bdf2: {step: 1 ms}}", END)
            run.advance(0.0)
            model = run.graph.tasks["plate"].kind
            layout = model.layout(run.state("plate"))
            volumes = run.march.floats[layout.volumes_at : layout.volumes_at + layout.count]
            x, y, _ = layout.centers().T
            mode = jv(2, ROOT * np.hypot(x, y)) * np.cos(2 * np.arctan2(y, x))
            inside = volumes > 0
            run.march._y1[: layout.count] = np.where(inside, 1 + mode, 0.0)
            run.march._started = False
            mass = volumes @ run.march._y1[: layout.count]
            found, _ = run.march.advance(END)
            wrong = (found[: layout.count] - 1 - mode * math.exp(-(ROOT**2) * END))[inside]
            worst.append(np.abs(wrong).max())
            mean.append(math.sqrt(volumes[inside] @ wrong**2 / math.pi))
            drift = volumes @ found[: layout.count] / mass - 1
            told = f"error {worst[-1]:.2e} at most, {mean[-1]:.2e} mean square; mass drift {drift:.1e}"
            print(f"{edges:10} n = {n}: {told}", flush=True)
        orders = [-np.polyfit(np.log(counts), np.log(errors), 1)[0] for errors in (worst, mean)]
        print(f"{edges:10} observed order {orders[0]:.2f} of the largest error, {orders[1]:.2f} of the mean square")


def on_disk(fields: str, solver: str, end: float) -> IslandRun:
    """A model in the unit disk."""
    return island(
        scene(f"domain: ball, flat: yes, {fields}", solver, end, "objects: {ball: {sphere: {radius: 1 m}}}\n")
    )


def mass() -> None:
    """What 10,000 steps change of the mass where nothing crosses the boundary."""
    start = 'initial: "exp(-8*((x-0.3)^2+(y+0.2)^2))"'
    for edges in ("cut_cell", "staircase"):
        for linear in ("direct", "multigrid"):
            end = 10_000 * 1e-4
            solver = f"{{tr_bdf2: {{step: 0.1 ms, linear: {linear}}}}}"
            run = on_disk(f"edges: {edges}, cell: 2/48 m, {start}", solver, end)
            model = run.graph.tasks["plate"].kind
            run.advance(0.0)
            before = model.read("mass", run.state("plate"))
            run.advance(end)
            drift = model.read("mass", run.state("plate")) / before - 1
            print(f"{edges:10} {linear:10} {run.march.statistics.steps} steps: mass drift {drift:.1e}", flush=True)


def jump() -> None:
    """A jump from 1 to 0 by steps of D dt/h^2 = 1000: it should stay between 0 and 1."""
    h = 1000 / 64**2
    fields = 'size: 1 1 m, cell: 1/64 m, initial: "where(x<0.5, 1, 0)*where(y<0.3, 1, 0)"'
    for word in ("tr_bdf2", "implicit_euler", "crank_nicolson", "adi"):
        run = island(scene(fields, f"{{{word}: {{step: {h!r} s}}}}", 8 * h))
        low, high = math.inf, -math.inf
        for k in range(1, 9):
            y, _ = run.march.advance(k * h)
            low, high = min(low, y[:4096].min()), max(high, y[:4096].max())
        print(f"{word:16} from {low:.9f} to {high:.9f}", flush=True)


if __name__ == "__main__":
    parts = {
        "square": square,
        "peers": peers,
        "multigrid": multigrid,
        "linear": linear,
        "disk": disk,
        "mass": mass,
        "jump": jump,
    }
    for part in sys.argv[1:] or parts:
        parts[part]()
