"""Preparation of the multistep solvers of flows, and their stability."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from sceneql.flows.layout import LED, PLAN
from sceneql.flows.schemes.operator_layout import ODD, TALLY
from sceneql.system import Control, Method, Needs, Prepared, Stepper
from sceneql.system.stepping import UNREAD

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.island.system import System
    from sceneql.system import Flow, Grid

CHORIN, CNAB2, SBDF2 = range(3)
UNSOLVED = "a value is no longer finite, or the pressure and viscosity of a step are not solved for: it is too long"
"""Message on a failed step of these solvers."""
SAME = 1e-9
"""Difference from a box with a constant coefficient, relative to the largest number, that counts as rounding."""


def stepper(scheme: int, order: int, step: float) -> Stepper:
    """The stepper of multistep_kernels.step with fixed steps [s]."""
    kernels = "sceneql.flows.schemes.multistep_kernels"
    method = Method(step=f"{kernels}:step", order=order, dense=f"{kernels}:dense", numbers=(scheme, 0, 0), last_stage=0)
    return Stepper(
        method, Control(first_step=step, unsolved=UNSOLVED), Needs(prepare="sceneql.flows.schemes.multistep:prepare")
    )


def control(step: float | None, tolerance: float, largest: float | None, unsolved: str) -> Control:
    """Step control: fixed steps [s], or adaptive ones by a tolerance; ``unsolved``: message on a failed step."""
    by = 0.0 if step is not None else tolerance
    return Control(
        first_step=step or 0.0,
        adaptive=step is None,
        tolerance=by,
        absolute=by,
        largest_step=largest or float("inf"),
        unsolved=unsolved,
    )


class Tables:
    """Numbers that the operators' transforms read, collected."""

    def __init__(self) -> None:
        self.numbers: list[float] = []

    def store(self, values: Any) -> int:
        """Append numbers; returns the offset of the first."""
        self.numbers += [float(one) for one in values]
        return len(self.numbers) - len(values)


def operator(grid: Grid, floats: Floats, tables: Tables, tallied: bool) -> list[int]:
    """The integers of a field's diffusion operator (operators_kernels), with transforms that solve it on a plain box.

    The transforms are the exact solver for a box with a constant coefficient, else a preconditioner. ``tallied``:
    whether an entry for the total inflow follows the field in y.
    """
    import numpy as np

    from sceneql.flows.transforms import lines_room, modes, plan_of

    shape, n = grid.cells.shape, int(np.prod(grid.cells.shape))
    volume = floats[grid.cells.insides_at : grid.cells.insides_at + n].reshape(shape[::-1])
    sink = floats[grid.sink_at : grid.sink_at + n].reshape(shape[::-1])
    inner = volume[tuple(slice(1, -1) if count > 2 else slice(None) for count in shape[::-1])]
    # Cells that solids cut may have more than a whole one: the fluid moved with them.
    whole = float(np.median(inner[inner > 0.0])) if (inner > 0.0).any() else float(volume.max())
    decays, plans, lengths, total, axes, along = [], [], 1, 0.0, [], []
    for axis in range(3):
        count, periodic = shape[axis], grid.cells.periodic[axis]
        ties = floats[grid.faces_at[axis] : grid.faces_at[axis] + n].reshape(shape[::-1])
        if axis == 2 and count == 1:
            decays.append(tables.store([0.0]))
            plans += [0] * PLAN
            continue
        rate = float(np.median(ties[ties > 0.0])) / whole if (ties > 0.0).any() else 0.0
        ends = [np.moveaxis(part, 2 - axis, 0) for part in (volume, sink, ties)]
        fixed = [float((ends[0][end] > 0.0).mean()) < 0.5 for end in (0, -1)]
        halved = [float(np.median(ends[0][end])) < 0.75 * whole for end in (0, -1)]
        faces = any(halved) and not periodic
        middle = np.moveaxis(sink, 2 - axis, 0)[count // 2]
        held = [float(np.median(ends[1][end] - middle)) > rate * whole for end in (0, -1)]
        zero = (fixed[0], fixed[1]) if faces else (held[0], held[1])
        kind, length, values = modes(count, periodic, zero, faces)
        decays.append(tables.store(rate * values))
        along.append((kind, rate, rate * values))
        plans += plan_of(kind, length, tables.store)
        lengths *= length
        total += 2.0 * rate * whole
        axes.append((ties, *_line(count, rate, periodic, zero, faces)))
    offsets = (grid.at, *shape, grid.cells.insides_at, grid.sink_at, *grid.faces_at)
    odd = _unlike_product(volume, sink, whole, axes)
    sizes = tables.store([lengths, whole, total])
    lines = -1
    if len(along) == 2:
        kind, tie, _ = along[1]
        room = lines_room(shape, kind, along[0][2], tie)
        lines = tables.store([np.nan, tie, room, *[0.0] * room]) if room > 0 else -1
    exact, rows = int(not odd.any()), _odd_rows(odd)
    odd_at = tables.store(rows) if rows else -1
    return [*offsets, *decays, sizes, grid.at + n if tallied else -1, exact, *plans, odd_at, lines]


def _odd_rows(odd: Any) -> list[int]:
    """Number of rows of a grid (nz, ny, nx) with a marked cell; of each the row, from and to before which cell. Empty
    where none is."""
    import numpy as np

    flat = odd.reshape(-1, odd.shape[2])
    rows = np.flatnonzero(flat.any(axis=1))
    first, last = flat[rows].argmax(axis=1), odd.shape[2] - flat[rows, ::-1].argmax(axis=1)
    return [len(rows), *np.column_stack([rows, first, last]).ravel().tolist()] if len(rows) else []


def _line(count: int, rate: float, periodic: bool, zero: tuple[bool, bool], faces: bool) -> tuple[Any, Any, Any]:
    """Volumes, conductances to the cell before and sinks, (count,) each, of the row with eigenmodes `modes`."""
    import numpy as np

    volumes, ties, sinks = np.ones(count), np.full(count, rate), np.zeros(count)
    if not periodic:
        ties[0] = 0.0
        for end, held in zip((0, -1), zero, strict=True):
            if faces:
                volumes[end] = 0.0 if held else 0.5
            else:
                sinks[end] += 2.0 * rate * held
    return volumes, ties, sinks


def _unlike_product(volume: Floats, sink: Floats, whole: float, axes: list[tuple[Any, ...]]) -> Any:
    """Of a field (nz, ny, nx) the cells whose equation is not that of the tensor product of rows along its axes, which
    transforms solve exactly."""
    import numpy as np

    def spread(axis: int, values: Any) -> Any:
        found = np.full((1, 1, 1), whole)
        for other, (_, volumes, _, _) in enumerate(axes):
            mine = values if other == axis else volumes
            found = found * mine.reshape([-1 if k == 2 - other else 1 for k in range(3)])
        return found

    solved = volume > 0.0
    sinks = sum(spread(axis, one[3]) for axis, one in enumerate(axes))
    odd = _unlike(volume, spread(0, axes[0][1])) | (_unlike(sink, sinks) & solved)
    for axis, (ties, _, along, _) in enumerate(axes):
        cut = _unlike(ties, spread(axis, along))
        odd |= (cut | np.roll(cut, -1, axis=2 - axis)) & solved
    return odd


def _unlike(found: Any, wanted: Any) -> Any:
    """Where two arrays differ by more than rounding."""
    import numpy as np

    wanted = np.broadcast_to(wanted, found.shape)
    return np.abs(found - wanted) > SAME * max(np.abs(wanted).max(), 1e-300)


def operators_of(system: System) -> tuple[Flow, list[list[int]], int, Tables, str]:
    """(flow, operators (operators_kernels), number of velocities among them, tables of transforms, text for `explain`).

    Raises ScriptError for an island without a flow, or with varying density or viscosity.
    """
    from sceneql.quantities.diagnostic import Diagnostic, ScriptError

    flow, grids = system.fields.flow, system.fields.grids
    if flow is None:
        _, _, part, spans = system.ranges[0]
        message = f"this solver marches an island with a flow, and '{part}' is none"
        raise ScriptError([Diagnostic("no-flow", message, spans[0], "let auto march it")])
    if flow.varying:
        _, _, part, spans = system.ranges[0]
        message = "density or viscosity varies in this flow, which this solver does not know"
        raise ScriptError(
            [Diagnostic("invalid", message, spans[0], "take `imex_midpoint`, `chorin`, or let auto march")]
        )
    velocities = [grid for grid in flow.components if _spreads(grid, system.floats)]
    fixed = [grid for grid in grids if not grid.varying]
    fields = [*velocities, *(grid for grid in fixed if _spreads(grid, system.floats))]
    tables = Tables()
    found = [operator(grid, system.floats, tables, grid not in velocities) for grid in fields]
    for one in found:
        # Solids that move; and amounts, of which transforms may leave less than nothing by rounding.
        if flow.ints[LED] > 0 or one[TALLY] >= 0:
            one[ODD] = -1
    left = len(grids) - len(fixed)
    text = "advection explicit, viscosity and diffusion implicit by conjugate gradients, then a projection"
    text += flow.pressure
    return (
        flow,
        found,
        len(velocities),
        tables,
        text + (f"; {left} fields with varying coefficients explicit" if left else ""),
    )


def prepare(system: System, stepper: Stepper) -> Prepared:
    """Settings, numbers and scratch of multistep_kernels.step. Raises ScriptError as ``operators_of``."""
    import numpy as np

    from sceneql.flows.schemes.multistep_kernels import ARRAYS
    from sceneql.flows.schemes.operator_layout import OPERATOR
    from sceneql.flows.schemes.operators_kernels import HEAD

    flow, operators, velocities, tables, text = operators_of(system)
    head = (*stepper.method.numbers, len(operators), HEAD + OPERATOR * len(operators), velocities)
    volume = flow.areas[0] * flow.spacing[0]
    kernels = system.structure
    alone = not (kernels.local or kernels.after or kernels.settling or system.pairs)
    first = (-np.inf, -np.inf, 1.0, flow.viscosity / flow.density / volume, not alone)
    return Prepared(
        settings=np.array([*first, *tables.numbers]),
        numbers=np.array([*head, *np.ravel(operators), *flow.ints], dtype=np.int64),
        work=ARRAYS * len(system.y) + 4 * int(np.prod(flow.cells.shape)),
        text=text,
        last_stage=UNREAD if alone else None,
    )


def _spreads(grid: Grid, floats: object) -> bool:
    """Whether a field has any nonzero conductance or sink."""
    import numpy as np

    n = int(np.prod(grid.cells.shape))
    numbers = np.asarray(floats)
    axes = grid.faces_at[: 3 if grid.cells.shape[2] > 1 else 2]
    return any(numbers[at : at + n].any() for at in (*axes, grid.sink_at))


def growth(scheme: int, decay: float, turn: float, step: float) -> float:
    """Growth factor of a step for y' = -decay y + i turn y, the first part implicit, the second explicit."""
    implicit, explicit = step * decay, 1j * step * turn
    if scheme == CHORIN:
        return abs((1.0 + explicit) / (1.0 + implicit))
    if scheme == CNAB2:
        a, b, c = 1.0 + 0.5 * implicit, 1.0 - 0.5 * implicit + 1.5 * explicit, 0.5 * explicit
    else:
        a, b, c = 1.5 + implicit, 2.0 + 2.0 * explicit, 0.5 + explicit
    root = (b * b - 4.0 * a * c) ** 0.5
    return max(abs(b + root), abs(b - root)) / (2.0 * abs(a))


def largest_growth(jacobian: Floats, of_mode: Callable[[float, float], float]) -> float:
    """Largest growth factor over the eigenvalues of a Jacobian; ``of_mode``: from decay and angular frequency [1/s]."""
    import numpy as np

    return max((of_mode(-float(mode.real), float(mode.imag)) for mode in np.linalg.eigvals(jacobian)), default=0.0)
