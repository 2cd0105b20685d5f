"""The solid {f < 0} of a tape, for Python callers: numpy arrays in, numpy arrays out.

Imports numpy and numba: to be imported by the function that needs it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.field.tape import tape_kernels
from sceneql.field.tape.tape_ops import SCRATCH_COLUMNS, scratch_rows

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from sceneql.frame import Floats, Tape


def scratch(tape: Tape) -> Floats:
    """Working memory for the kernels of one thread."""
    return np.zeros((scratch_rows(len(tape.code), len(tape.parts)), SCRATCH_COLUMNS))


def field_values(tape: Tape, points: Floats) -> Floats:
    """Values (n,) of f at points (n, 3) [m]."""
    points = np.ascontiguousarray(points, dtype=np.float64)
    out = np.empty(len(points))
    tape_kernels.values(tape.code, tape.constants, tape.parts, scratch(tape), points, out)
    return out


def exits(tape: Tape, inner: Floats, outer: Floats) -> Floats:
    """Parameters (n,) in 0..1 at which segments from ``inner`` to ``outer`` points (n, 3) [m] leave the solid."""
    from sceneql.field.tape.exits_kernels import leave

    inner, outer = (np.ascontiguousarray(ends, dtype=np.float64) for ends in (inner, outer))
    out = np.empty(len(inner))
    leave(tape.code, tape.constants, tape.parts, scratch(tape), inner, outer, out)
    return out


def field_gradients(tape: Tape, points: Floats) -> Floats:
    """Gradients (n, 3) [1/m] of f at points (n, 3) [m]."""
    from sceneql.field.tape.gradient_kernels import gradient

    room = scratch(tape)
    rows = [gradient(tape.code, tape.constants, tape.parts, room, *map(float, point)) for point in points]
    return np.array(rows).reshape(-1, 4)[:, 1:]


def many_gradients(tape: Tape, points: Floats) -> Floats:
    """As ``field_gradients``, with the same bits, by the kernels that meshing has compiled: faster for many points."""
    from sceneql.field.tape.batch_gradient_kernels import differentiate
    from sceneql.field.tape.batch_kernels import LANES

    out, slope = np.empty((len(points), 3)), np.empty((len(tape.code), 3, LANES))
    for start, n, registers in _by_lanes(tape, points):
        differentiate(tape.code, tape.constants, tape.parts, registers, slope, n)
        out[start : start + n] = slope[-1, :, :n].T
    return out


def cast(
    tape: Tape,
    origins: Floats,
    directions: Floats,
    t0: Floats | float,
    t1: Floats | float,
    tolerance: float = 1e-9,
    *,
    surface: bool = False,
) -> tuple[NDArray[np.int64], Floats]:
    """(status, t), each (n,), of the first entry of rays o + t d, t in [t0, t1], into the solid.

    By isolation_kernels.first_root; with ``surface`` of the first root of f, by sheet_roots_kernels.surface_root.
    """
    first: Any
    if surface:
        from sceneql.field.roots.sheet_roots_kernels import surface_root as first
    else:
        from sceneql.field.roots.isolation_kernels import first_root as first
    room = scratch(tape)
    origins, directions = np.broadcast_arrays(np.atleast_2d(origins), np.atleast_2d(directions))
    starts = np.broadcast_to(np.asarray(t0, dtype=np.float64), len(origins))
    ends = np.broadcast_to(np.asarray(t1, dtype=np.float64), len(origins))
    status = np.empty(len(origins), dtype=np.int64)
    t = np.empty(len(origins))
    for i in range(len(origins)):
        o, d = origins[i], directions[i]
        ray = (*map(float, o), *map(float, d), float(starts[i]), float(ends[i]), tolerance)
        status[i], t[i] = first(tape.code, tape.constants, tape.parts, room, *ray)
    return status, t


def paint_values(tape: Tape, points: Floats) -> Floats:
    """Values (n, 3) of a tape's last three registers, the linear RGB of paint, at points (n, 3) [m]."""
    out = np.empty((len(points), 3))
    for start, n, registers in _by_lanes(tape, points):
        out[start : start + n] = registers[-3:, :n].T
    return out


def _by_lanes(tape: Tape, points: Floats) -> Iterator[tuple[int, int, Floats]]:
    """Evaluate a tape at points (n, 3) [m], LANES at a time: yields (first point, number, registers (rows, LANES))."""
    from sceneql.field.tape.batch_kernels import LANES, evaluate

    registers, block = np.empty((len(tape.code), LANES)), np.zeros((3, LANES))
    for start in range(0, len(points), LANES):
        n = min(LANES, len(points) - start)
        block[:, :n] = points[start : start + n].T
        evaluate(tape.code, tape.constants, tape.parts, registers, block, n)
        yield start, n, registers
