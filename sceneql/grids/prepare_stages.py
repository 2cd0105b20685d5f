"""Preparation of implicit steps on a grid: choice of the linear solver, its memory, and the reason for the choice."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import accumulate
from typing import TYPE_CHECKING, Any

from sceneql.failure import LimitRefused
from sceneql.grids.multigrid import layout
from sceneql.system import Grid, Prepared, Stepper

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.island.system import System

DIRECT_CELLS = {2: 40_000, 3: 4_000}
"""Most cells of a 2D or 3D grid for which `auto` chooses a direct factorization."""
LARGEST_FACTORED = {2: 500_000, 3: 30_000}
MOST = {
    "multigrid": 100,
    "conjugate_gradient": 20_000,
    "gauss_seidel": 20_000,
    "sor": 20_000,
    "direct": 1,
    "fast_transform": 1,
}
"""Most iterations for one system; 1: a direct solver, exact to rounding."""
KERNELS = {
    "multigrid": "sceneql.grids.multigrid.multigrid_kernels:solve",
    "conjugate_gradient": "sceneql.grids.multigrid.relaxation_kernels:solve_conjugate_gradient",
    "gauss_seidel": "sceneql.grids.multigrid.relaxation_kernels:solve_gauss_seidel",
    "sor": "sceneql.grids.multigrid.relaxation_kernels:solve_sor",
    "direct": "sceneql.grids.multigrid.grid_factors_kernels:solve",
    "fast_transform": "sceneql.grids.multigrid.transform_kernels:solve",
}
FIRST = {"direct": ("sceneql.linear.multifrontal.symmetric_kernels",)}
"""Further modules of a solver, which the background process compiles first."""
COARSEST = 2
LONGEST_ROW = 512
"""Most cells of a row for which `auto` chooses dense transforms: each cell costs twice as many multiplications."""


@dataclass(frozen=True, slots=True, eq=False)
class _Plan:
    numbers: Any
    room: int
    """Number of floats that the linear solver keeps."""
    text: str


@dataclass(frozen=True, slots=True)
class LinearReport:
    """Statistics of the linear solver over a march."""

    systems: int
    iterations: int
    residuals: tuple[float, ...]
    """2-norms of the last system's residual: after every relaxation_kernels.CHECKED sweeps of gauss_seidel and sor,
    after every iteration of the others."""


def prepare(system: System, stepper: Stepper) -> Prepared:
    """Settings, numbers and scratch of grid_stage_kernels.step.

    Raises LimitRefused where the linear solver that the script names cannot solve on this grid.
    """
    import numpy as np

    from sceneql.grids.grid_stage_kernels import SHARE
    from sceneql.linear.newton_kernels import ABSOLUTE, MEMORY, RELATIVE

    grid = system.fields.single
    assert grid is not None
    stages, explicit_first, _, embedded, error_order = stepper.method.numbers
    settings = stepper.method.settings
    relative, absolute, tableau = settings[RELATIVE], settings[ABSOLUTE], settings[MEMORY:]
    share = SHARE if stepper.control.adaptive else 1.0
    largest = float(np.abs(system.y).max(initial=0.0)) or 1.0
    absolute *= largest if stepper.control.by_scale else 1.0
    separated = separate(grid, system.floats) if _may_separate(grid, stepper.needs.linear) else None
    name, why = _choice(grid, stepper.needs.linear, separated is not None)
    plan = _PLANS[name](grid) if separated is None or name != "fast_transform" else _transform(grid, separated)
    numbers, store = _laid_out(name, grid, plan)
    return Prepared(
        settings=np.array([share * relative, share * absolute if stepper.control.adaptive else 0.0, *tableau]),
        numbers=np.concatenate([[stages, explicit_first, embedded, error_order], numbers]),
        work=(3 + stages) * len(system.y) + store,
        text=f"linear systems by {name}, {plan.text}, {why}",
    )


def laid_out(name: str, grid: Grid) -> tuple[NDArray[int64], int, str]:
    """(plan (linear_kernels), number of floats of the store, description) of a linear solver other than fast_transform.

    Raises LimitRefused where factors would not fit into memory.
    """
    plan = _PLANS[name](grid)
    return (*_laid_out(name, grid, plan), plan.text)


def _laid_out(name: str, grid: Grid, plan: _Plan) -> tuple[NDArray[int64], int]:
    import numpy as np

    from sceneql.compiled.generated import function
    from sceneql.compiled.numbered_kernels import number_of
    from sceneql.grids.multigrid.linear_kernels import SOLVE

    solver, exact = number_of(function(KERNELS[name]), SOLVE), int(MOST[name] == 1)
    offsets = (grid.volumes_at, grid.sink_at, *grid.faces_at)
    head = [solver, exact, *grid.cells.shape, grid.at, *offsets, int(grid.varying), MOST[name], grid.fed_at]
    assert len(head) == layout.PLAN
    cells = grid.cells.shape[0] * grid.cells.shape[1] * grid.cells.shape[2]
    return np.concatenate([head, plan.numbers]).astype(np.int64), 2 * cells + plan.room + layout.RECORD


def likely_kernels(grid: Grid, linear: str) -> tuple[str, ...]:
    """Modules of the linear solver that `prepare` will most likely choose, to be compiled in the background."""
    try:
        name = _choice(grid, linear, _may_separate(grid, linear))[0]
    except LimitRefused:
        return ()
    return (*FIRST.get(name, ()), KERNELS[name].partition(":")[0])


def report(scratch: Floats) -> LinearReport:
    """Statistics of the linear solver of an implicit method on a grid; ``scratch``: the march's scratch."""
    record = scratch[-layout.RECORD :]
    residuals = tuple(float(size) for size in record[layout.HISTORY :] if size >= 0.0)
    return LinearReport(int(record[layout.SOLVES]), int(record[layout.ITERATIONS]), residuals)


def _choice(grid: Grid, asked: str, separable: bool) -> tuple[str, str]:
    """The name of the linear solver, and the reason for it."""
    nx, ny, nz = grid.cells.shape
    dims, cells = (3 if nz > 1 else 2), nx * ny * nz
    if asked == "direct" and cells > LARGEST_FACTORED[dims]:
        raise LimitRefused(
            f"factors of {cells} cells would not fit: at most {LARGEST_FACTORED[dims]} in {dims} dimensions",
            None,
            "take `linear: multigrid`",
        )
    if asked == "fast_transform" and not separable:
        raise LimitRefused(
            "a fast transform needs a flat box whose coefficient and boundary do not vary along x, nor in time, and "
            "that is not periodic along y",
            None,
            "take `linear: auto`",
        )
    if asked != "auto":
        return asked, "as the script says"
    if separable and grid.cells.shape[0] <= LONGEST_ROW:
        return "fast_transform", "chosen since the box and its coefficient are the same in every row"
    if cells > DIRECT_CELLS[dims]:
        return "multigrid", f"chosen since {cells} cells are more than {DIRECT_CELLS[dims]} (factors fill up)"
    if grid.varying:
        return "multigrid", "chosen since the coefficients vary, so that factors would serve once"
    return "direct", f"chosen since {cells} cells are few, and the factors serve for every step of one length"


def _multigrid(grid: Grid) -> _Plan:
    shapes = [grid.cells.shape]
    while any(n > COARSEST for n in shapes[-1]):
        nx, ny, nz = ((n + 1) // 2 if n > COARSEST else n for n in shapes[-1])
        shapes.append((nx, ny, nz))
    sizes = [nx * ny * nz * (8 if nz > 1 else 7) for nx, ny, nz in shapes]
    starts = list(accumulate(sizes, initial=0))
    table = [number for shape, start in zip(shapes, starts, strict=False) for number in (*shape, start)]
    text = f"conjugate gradients with a V-cycle over {len(shapes)} grids"
    return _Plan([len(shapes), *table], (starts[-1] + grid.cells.shape[0] + 1) // 2 + 1, text)


def _iterations(grid: Grid) -> _Plan:
    nx, ny, nz = grid.cells.shape
    return _Plan([], nx * ny * nz, "an iteration over all cells")


def _direct(grid: Grid) -> _Plan:
    import numpy as np

    from sceneql.linear.multifrontal import planning

    pattern, entries = _pattern(grid)
    plan = planning.plan(pattern)
    numbers = np.concatenate([[len(entries), plan.factors, plan.work], entries.ravel(), plan.numbers])
    text = f"a sparse factorization with {plan.factors:.3g} numbers, made once for each length of step"
    return _Plan(numbers, len(entries) + plan.factors + plan.work, text)


def _may_separate(grid: Grid, asked: str) -> bool:
    """Whether ``separate`` may succeed and pay off."""
    nx, _, nz = grid.cells.shape
    wanted = asked == "fast_transform" or (asked == "auto" and nx <= LONGEST_ROW)
    deep_or_bent = nz > 1 or grid.varying or grid.cells.periodic[1] or nx > 4 * LONGEST_ROW or grid.cells.outside.any()
    return wanted and not deep_or_bent


def separate(grid: Grid, floats: Floats) -> tuple[Floats, ...] | None:
    """Separation of a 2D operator along x: None where rows differ.

    (Modes of a row as rows (nx, nx), as columns (nx, nx), eigenvalues (nx,), conductances (ny,) and sinks (ny,) along
    y, volume of a cell (1,)).
    """
    import numpy as np

    nx, ny, _ = grid.cells.shape
    n = nx * ny
    offsets = (grid.volumes_at, grid.sink_at, *grid.faces_at[:2])
    volume, sink, gx, gy = (floats[at : at + n].reshape(ny, nx) for at in offsets)
    along_y = sink[:, nx // 2]
    along_x = sink[ny // 2] - sink[ny // 2, nx // 2]
    same = (volume, volume[0, 0]), (gx, gx[0]), (gy, gy[:, :1]), (sink, along_y[:, None] + along_x)
    if not all(np.allclose(one, other, rtol=1e-13, atol=1e-13 * float(np.abs(one).max())) for one, other in same):
        return None
    g = gx[0]
    matrix = np.diag(g + np.roll(g, -1) + along_x)
    for i in range(nx):
        matrix[i, i - 1] -= g[i]
        matrix[i - 1, i] -= g[i]
    values, vectors = np.linalg.eigh(matrix)
    return vectors.T, vectors, values, gy[:, 0], along_y, volume[0, :1]


def _transform(grid: Grid, separated: tuple[Floats, ...]) -> _Plan:
    import numpy as np

    table = np.concatenate([np.ravel(part) for part in separated]).view(np.int64)
    cells = grid.cells.shape[0] * grid.cells.shape[1]
    return _Plan(table, 3 * cells, "modes of the rows along x and tridiagonal systems along y")


def _pattern(grid: Grid) -> tuple[Any, NDArray[int64]]:
    """The CSR pattern (cells, cells), and for each of its values cell and face (k, 2) (see grid_factors_kernels)."""
    import numpy as np
    from scipy.sparse import csr_array

    n = int(np.prod(grid.cells.shape))
    cells = np.arange(n, dtype=np.int64).reshape(grid.cells.shape[::-1])
    rows, columns, faces = [cells.ravel()], [cells.ravel()], [np.zeros(n, dtype=np.int64)]
    for axis in range(3 if grid.cells.shape[2] > 1 else 2):
        before = np.roll(cells, 1, axis=2 - axis)
        tied = np.ones(cells.shape, dtype=bool)
        if not grid.cells.periodic[axis]:
            tied[tuple(slice(1) if k == 2 - axis else slice(None) for k in range(3))] = False
        high, low = cells[tied], before[tied]
        rows += [high, low]
        columns += [low, high]
        faces += [np.full(len(high), axis + 1), np.full(len(high), axis + 4)]
    i, j, face = (np.concatenate(part) for part in (rows, columns, faces))
    pattern = csr_array((np.ones(len(i)), (i, j)), shape=(n, n))
    pattern.sort_indices()
    order = np.lexsort((j, i))
    return pattern, np.column_stack([i[order], face[order]])


_PLANS = {
    "multigrid": _multigrid,
    "conjugate_gradient": _iterations,
    "gauss_seidel": _iterations,
    "sor": _iterations,
    "direct": _direct,
}
