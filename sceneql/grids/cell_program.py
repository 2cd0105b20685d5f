"""Formulas of position, time and the field, printed as kernels that evaluate them at cells, boundary faces or points.

Cells: ``floats[target + cell] = floats[base + cell] + floats[weight + cell] * value``; integers: constants, field (in
y), target, base, weight, nx, ny, nz, box (low corner and spacing: 6 floats), then offsets of values read from other
parts (inputs). Faces: ``floats[target + cell] += floats[weight + k] * value`` for face k of a cell; integers:
constants, field, target, weight, number of faces, points (3 floats a face), index of the cells in ints, inputs, cells.
Points: ``floats[target + k] = value`` with the field in floats; integers: constants, field, target, count, points,
inputs.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from sceneql.compiled.printer import Constants, Printer, write_term
from sceneql.kinds import Value
from sceneql.quantities.derivative import components
from sceneql.quantities.expression import TIME_SYMBOL, Expr

if TYPE_CHECKING:
    from sceneql.system import Assembly

FIELD = "c"
NAMES = {"x": "own_x", "y": "own_y", "z": "own_z", FIELD: "own_c", TIME_SYMBOL: "t"}


def over_cells(
    assembly: Assembly, expr: Expr, at: int, arrays: tuple[int, int, int], shape: tuple[int, int, int], box: int
) -> tuple[str, tuple[int, ...]]:
    """Name of a kernel over all cells, and its integers; ``arrays``: offsets of target, base, weight."""
    constants, printer, value = _printed(assembly, expr)
    lines = [
        "    field, target, base, weight = ints[1], ints[2], ints[3], ints[4]",
        "    nx, ny, nz, box = ints[5], ints[6], ints[7], ints[8]",
        "    for k in range(nz):",
        "        own_z = floats[box + 2] + (k + 0.5) * floats[box + 5]",
        "        for j in range(ny):",
        "            own_y = floats[box + 1] + (j + 0.5) * floats[box + 4]",
        "            for i in range(nx):",
        "                own_x = floats[box] + (i + 0.5) * floats[box + 3]",
        "                cell = i + nx * (j + ny * k)",
        "                if floats[weight + cell] == 0.0:",
        "                    floats[target + cell] = floats[base + cell]",
        "                    continue",
        "                own_c = y[field + cell]",
        *(f"                {line}" for line in printer.lines),
        f"                floats[target + cell] = floats[base + cell] + floats[weight + cell] * {value}",
    ]
    ints = (assembly.floats(constants.values), at, *arrays, *shape, box, *_stored(assembly, constants))
    return write_term("cells", constants, 9, lines), ints


def over_faces(
    assembly: Assembly, expr: Expr, at: int, target: int, weight: int, points: int, cells: Sequence[int]
) -> tuple[str, tuple[int, ...]]:
    """Name of a kernel over boundary faces, and its integers; ``cells``: the cell of each face."""
    constants, printer, value = _printed(assembly, expr)
    lines = [
        "    field, target, weight, points = ints[1], ints[2], ints[3], ints[5]",
        "    for k in range(ints[4]):",
        "        cell = ints[ints[6] + k]",
        "        own_x, own_y, own_z = floats[points + 3 * k], floats[points + 3 * k + 1], floats[points + 3 * k + 2]",
        "        own_c = y[field + cell]",
        *(f"        {line}" for line in printer.lines),
        f"        floats[target + cell] += floats[weight + k] * {value}",
    ]
    inputs = _stored(assembly, constants)
    head = (assembly.floats(constants.values), at, target, weight, len(cells), points, 7 + len(inputs))
    return write_term("faces", constants, 7, lines), (*head, *inputs, *cells)


def over_points(
    assembly: Assembly, expr: Expr, field: int, target: int, count: int, points: int
) -> tuple[str, tuple[int, ...]]:
    """Name of a kernel over points, and its integers.

    ``field``: offset in the floats of the field at the points; any offset where the formula does not read it.
    """
    constants, printer, value = _printed(assembly, expr)
    lines = [
        "    field, target, points = ints[1], ints[2], ints[4]",
        "    for k in range(ints[3]):",
        "        own_x, own_y, own_z = floats[points + 3 * k], floats[points + 3 * k + 1], floats[points + 3 * k + 2]",
        "        own_c = floats[field + k]",
        *(f"        {line}" for line in printer.lines),
        f"        floats[target + k] = {value}",
    ]
    head = (assembly.floats(constants.values), field, target, count, points)
    return write_term("points", constants, 5, lines), (*head, *_stored(assembly, constants))


def _printed(assembly: Assembly, expr: Expr) -> tuple[Constants, Printer, str]:
    assembly.stop_at_breakpoints(expr)
    constants = Constants()
    printer = Printer(NAMES, {}, constants)
    return constants, printer, printer.name(constants.lift(components(expr)[0]))


def _stored(assembly: Assembly, constants: Constants) -> list[int]:
    return [assembly.value(Value(expr)) for expr in constants.inputs]
