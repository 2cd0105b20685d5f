"""Reaction rates of several fields, formulas of position, time and all fields, printed as kernels over cells.

Both kernels are terms with the integers: constants, volumes (0 outside), box (low corner and spacing: 6 floats), nx,
ny, nz, the start of each field in y (its inflow follows its cells), then offsets of values read from other parts. The
first kernel adds dc/dt to each field, and volume dc/dt to its inflow. The second adds the Jacobian: for each pair
(rate, field) whose derivative is not identically zero, one block of entries, a cell each.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from sceneql.compiled.printer import Constants, Printer, write_term
from sceneql.formulas.rate_program import ZERO, RateSystem, derivatives, lifted
from sceneql.kinds import Value

if TYPE_CHECKING:
    from sceneql.grids.ground import Ground
    from sceneql.system import Assembly, Slopes

HEAD = 6
PLACES = {"x": "own_x", "y": "own_y", "z": "own_z", "t": "t", "time": "t"}


def add_reaction(system: RateSystem, ground: Ground, fields: Sequence[int], assembly: Assembly) -> None:
    """Add the reaction term of fields that start at ``fields`` in y, with its symbolic Jacobian."""
    for expr in (*system.rows, *system.where.values()):
        assembly.stop_at_breakpoints(expr)
    constants = Constants()
    meanings, rows = lifted(system, constants)
    printer = Printer(_names(system), meanings, constants)
    rates = [printer.name(row) for row in rows]
    kernel = _kernel("reaction", system, printer, rates, [f"f{k} + cell" for k in range(len(rates))], tally=True)
    ints = _ints(constants, ground, fields, assembly)
    assembly.term("internal", kernel, ints, lambda: _slopes(system, ground, fields, assembly))


def _slopes(system: RateSystem, ground: Ground, fields: Sequence[int], assembly: Assembly) -> Slopes | None:
    """The Jacobian of the reaction, from symbolic derivatives; None where an operation has no derivative."""
    import numpy as np

    from sceneql.system import Slopes

    constants = Constants()
    meanings, rows = lifted(system, constants)
    try:
        entries, derived = derivatives(system.states, meanings, rows)
    except TypeError:
        return None
    places = [divmod(place, len(system.states)) for place, entry in enumerate(entries) if entry != ZERO]
    if not places:
        return Slopes("", [], [])
    printer = Printer(_names(system), {**meanings, **derived}, constants)
    values = [printer.name(entry) for entry in entries if entry != ZERO]
    kernel = _kernel(
        "reaction_slopes", system, printer, values, [f"{k} * cells + cell" for k in range(len(values))], tally=False
    )
    cells = np.arange(ground.count, dtype=np.int64)
    found = [np.concatenate([fields[place[k]] + cells for place in places]) for k in (0, 1)]
    return Slopes(kernel, found[0], found[1], _ints(constants, ground, fields, assembly))


def _names(system: RateSystem) -> dict[str, str]:
    return {**PLACES, **{name: f"s{k}" for k, name in enumerate(system.states)}}


def _ints(constants: Constants, ground: Ground, fields: Sequence[int], assembly: Assembly) -> tuple[int, ...]:
    inputs = [assembly.value(Value(expr)) for expr in constants.inputs]
    return (assembly.floats(constants.values), *ground.memory, *fields, *inputs)


def _kernel(
    function: str, system: RateSystem, printer: Printer, values: Sequence[str], targets: Sequence[str], *, tally: bool
) -> str:
    """Name of a kernel that adds values to ``out`` at targets; ``tally``: also values times volume to the inflow."""
    size = len(system.states)
    text = "\n".join(printer.lines + list(values))
    place = [
        *(["own_x = floats[box] + (i + 0.5) * floats[box + 3]"] if "own_x" in text else []),
        *(["own_y = floats[box + 1] + (j + 0.5) * floats[box + 4]"] if "own_y" in text else []),
        *(["own_z = floats[box + 2] + (k + 0.5) * floats[box + 5]"] if "own_z" in text else []),
    ]
    lines = [
        "    volumes, box, nx, ny, nz = ints[1], ints[2], ints[3], ints[4], ints[5]",
        "    cells = nx * ny * nz",
        *(f"    f{k} = ints[{HEAD + k}]" for k in range(size)),
        *([f"    total{k} = 0.0" for k in range(size)] if tally else []),
        "    for row in range(ny * nz):",
        "        j, k = row % ny, row // ny",
        "        for i in range(nx):",
        "            cell = row * nx + i",
        "            volume = floats[volumes + cell]",
        "            if volume == 0.0:",
        "                continue",
        *(f"            s{k} = y[f{k} + cell]" for k in range(size)),
        *(f"            {line}" for line in (*place, *printer.lines)),
        *(f"            out[{target}] += {value}" for target, value in zip(targets, values, strict=True)),
        *([f"            total{k} += volume * {value}" for k, value in enumerate(values)] if tally else []),
        *([f"    out[f{k} + cells] += total{k}" for k in range(size)] if tally else []),
    ]
    return write_term(function, printer.constants, HEAD + size, lines)
