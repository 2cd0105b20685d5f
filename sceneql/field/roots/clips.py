"""Bounding quadrics of solids {f < 0}, to which rays are clipped before roots are searched.

Imports numpy: to be imported by the function that needs it.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from sceneql.field.tape import tape_ops as ops
from sceneql.field.tape.own_coordinates import in_own_coordinates
from sceneql.field.tape.plans import root_of, without_factor

if TYPE_CHECKING:
    from sceneql.frame import Floats, Tape

PRODUCTS = (0, 1, 2, 0, 1, 2), (0, 1, 2, 1, 2, 0)
"""Axes of the first six coefficients: x^2, y^2, z^2, xy, yz, zx."""
LINEAR, LAST = 6, 9
"""Indices of the coefficient of x, which y and z follow, and of the constant."""
LARGEST = 1e100
"""Largest coefficient of a clip, so that its values stay finite at all places where solids may lie."""


def clips_of(tape: Tape) -> Floats:
    """(k, 10) coefficients of k polynomials q of degree 1 or 2, with q < 0 wherever f < 0.

    In the order x^2, y^2, z^2, xy, yz, zx, x, y, z, 1; computed with rounding errors.
    """
    own, matrix = in_own_coordinates(tape)
    with np.errstate(over="ignore", invalid="ignore"):
        found = np.array([_seen_from(quadric, matrix) for quadric, _ in _clips(own)]).reshape(-1, LAST + 1)
    small: Floats = found[np.abs(found).max(axis=1) <= LARGEST]
    return small


def clip_rows(tape: Tape) -> list[int]:
    """Rows of the tape that are convex clips: negative on rays clipped by ``clips_of``, but for rounding at the ends.

    At least one branch of the tape is not among them.
    """
    rows = [row for quadric, row in _clips(tape) if _convex(quadric)]
    return rows if len(rows) < len(branches(tape)) else rows[1:]


def branches(tape: Tape) -> list[int]:
    """Rows of a tape that is the maximum of several: those operands, up to positive factors; else its last row."""
    found = []
    rows = [len(tape.code) - 1]
    while rows:
        row = rows.pop()
        inner = without_factor(tape, row)
        if tape.code[inner, 0] == ops.MAX:
            rows += map(int, tape.code[inner, 1:3])
        else:
            found.append(row)
    return found


def _seen_from(quadric: Floats, matrix: Floats) -> Floats:
    """Coefficients (10,) of q(A (p, 1)), of q in the coordinates into which the ``matrix`` A (3, 4) maps p."""
    form = np.zeros((4, 4))
    i, j = PRODUCTS
    form[i, j] = 0.5 * quadric[:LINEAR]
    form[:3, 3], form[3, 3] = 0.5 * quadric[LINEAR:LAST], 0.5 * quadric[LAST]
    whole = np.vstack([matrix, [0.0, 0.0, 0.0, 1.0]])
    form = whole.T @ (form + form.T) @ whole
    found: Floats = form[(*i, 0, 1, 2, 3), (*j, 3, 3, 3, 3)] * ([1.0] * 3 + [2.0] * 6 + [1.0])
    return found


@lru_cache(maxsize=16)
def _clips(tape: Tape) -> list[tuple[Floats, int]]:
    """Polynomials (10,) as of ``clips_of``, each with the row of the tape whose sign it has."""
    found = []
    for branch in branches(tape):
        row, radius = root_of(tape, without_factor(tape, branch))
        with np.errstate(over="ignore", invalid="ignore"):  # polynomials that overflow are no clips
            quadric = _expanded(tape, row)
            if quadric is not None and radius >= 0:
                quadric[LAST] -= tape.constants[radius] ** 2
        if quadric is not None and quadric[:LAST].any() and np.abs(quadric).max() <= LARGEST:
            found.append((quadric, branch))
    return found


def _convex(quadric: Floats) -> bool:
    """Whether a polynomial of degree 2 is convex, and so the region where it is negative."""
    form = np.diag(quadric[:3])
    form[[0, 1, 2], [1, 2, 0]] = form[[1, 2, 0], [0, 1, 2]] = 0.5 * quadric[3:LINEAR]
    values = np.linalg.eigvalsh(form)
    return bool(values[0] >= -1e-12 * abs(values).max())


def _expanded(tape: Tape, row: int) -> Floats | None:
    """Coefficients (10,) of a row as a polynomial in x, y, z; None unless it is one of degree 2 or less."""
    op, left, right, _ = map(int, tape.code[row])
    if op == ops.CONSTANT or op in (ops.X, ops.Y, ops.Z):
        plain: Floats = np.zeros(LAST + 1)
        plain[LAST if op == ops.CONSTANT else LINEAR + op - ops.X] = tape.constants[left] if op == ops.CONSTANT else 1.0
        return plain
    if op not in (ops.COPY, ops.NEG, ops.SQUARE, ops.ADD, ops.SUB, ops.MUL):
        return None
    a = _expanded(tape, left)
    b = _expanded(tape, right) if op in (ops.ADD, ops.SUB, ops.MUL) else a
    if a is None or b is None:
        return None
    if op == ops.COPY:
        return a
    if op == ops.NEG:
        return -a
    if op in (ops.SQUARE, ops.MUL):
        return _product(a, b)
    total: Floats = a + b if op == ops.ADD else a - b
    return total


def _product(a: Floats, b: Floats) -> Floats | None:
    """Product (10,) of two polynomials (10,); None if its degree might exceed 2."""
    if not b[:LAST].any():
        a, b = b, a
    if not a[:LAST].any():
        scaled: Floats = b * a[LAST]
        return scaled
    if a[:LINEAR].any() or b[:LINEAR].any():
        return None
    out: Floats = a * b[LAST] + b * a[LAST]
    out[LAST] = a[LAST] * b[LAST]
    u, v = a[LINEAR:LAST], b[LINEAR:LAST]
    for k, (i, j) in enumerate(zip(*PRODUCTS, strict=True)):
        out[k] = u[i] * v[j] + (u[j] * v[i] if i != j else 0.0)
    return out
