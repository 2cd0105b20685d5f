"""A tape's own coordinates: three affine forms of x, y, z, if f depends on the point through these alone.

Rays are then transformed once, in float64, instead of each point on them: a moved object costs as much as one at rest,
and float32 resolves small objects far from the origin.

Imports numpy: to be imported by the function that needs it.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from sceneql.field.tape import tape_ops as ops
from sceneql.field.tape.plans import tape_of_rows

if TYPE_CHECKING:
    from sceneql.frame import Floats, Tape

LEAST = 1e-9
"""Determinant of three unit vectors below which they count as coplanar."""


_made: list[Tape] = []
"""The last tapes in their own coordinates: an object in rigid motion gets the same one each time, and whatever else is
kept by tape is found again."""
KEPT = 16


@lru_cache(maxsize=KEPT)
def in_own_coordinates(tape: Tape) -> tuple[Tape, Floats]:
    """(tape g, A (3, 4)) with f(p) = g(A (p, 1)); the tape itself and the identity where f has no such coordinates.

    For an object in rigid motion g is the same tape at all times, with the same constants.
    """
    same = tape, np.eye(3, 4)
    forms = _affine_rows(tape)
    for seen in (_seen(tape, forms), _seen_first(tape, forms)):
        axes: dict[bytes, int] = {}
        for row in seen:
            axes.setdefault((forms[row] + 0.0).tobytes(), len(axes))  # makes -0.0 and 0.0 the same key
        if len(axes) == 3:
            break
    else:
        return same
    matrix = np.array([np.frombuffer(form) for form in axes])
    lengths = np.linalg.norm(matrix[:, :3], axis=1)
    if (matrix == same[1]).all() or not abs(np.linalg.det(matrix[:, :3] / lengths[:, None])) > LEAST:
        return same
    code = tape.code.copy()
    for row in seen:
        code[row] = ops.X + axes[(forms[row] + 0.0).tobytes()], 0, 0, 0
    own = replace(tape, code=code)
    return _kept(_with_its_own_constants(replace(own, code=tape_of_rows(own, [len(code) - 1])))), matrix


def _kept(tape: Tape) -> Tape:
    """The tape, or an equal one that was made before."""
    for known in list(_made):
        if known.code.shape == tape.code.shape and all(
            np.array_equal(one, other)
            for one, other in (
                (known.code, tape.code),
                (known.constants, tape.constants),
                (known.parts, tape.parts),
            )
        ):
            return known
    _made[:] = [tape, *_made[: KEPT - 1]]
    return tape


def _seen(tape: Tape, forms: dict[int, Floats]) -> list[int]:
    """The affine rows that rows which are not affine read, in order, without constants."""
    read = {row for k in range(len(tape.code)) if k not in forms for row in _operands(tape, k) if row in forms}
    return [row for row in sorted(read) if forms[row][:3].any()]


def _seen_first(tape: Tape, forms: dict[int, Floats]) -> list[int]:
    """Three affine rows at the beginning through which all else sees the point: a formula in x, y, z of an object that
    is moved, in which more forms follow. The last such rows; empty if there are none."""
    last_use: dict[int, int] = {}
    for k in range(len(tape.code)):
        if tape.code[k, 0] not in (ops.CONSTANT, ops.X, ops.Y, ops.Z):
            last_use |= dict.fromkeys(_operands(tape, k), k)
    found: list[int] = []
    live: list[int] = []
    for k in range(len(tape.code) - 1):
        if k not in forms:
            break
        live = [row for row in [*live, k] if last_use.get(row, -1) > k and forms[row][:3].any()]
        if len(live) == 3:
            found = live
    return found


def _with_its_own_constants(tape: Tape) -> Tape:
    """The tape with its unused constants removed."""
    code, of_constants = tape.code.copy(), tape.code[:, 0] == ops.CONSTANT
    read, code[of_constants, 1] = np.unique(code[of_constants, 1], return_inverse=True)
    return replace(tape, code=code, constants=tape.constants[read])


def _affine_rows(tape: Tape) -> dict[int, Floats]:
    """By row, the coefficients (a, b, c, d) of each row that is affine in the point: a x + b y + c z + d."""
    forms: dict[int, Floats] = {}
    for k, (op, left, right, _) in enumerate(tape.code.tolist()):
        if op == ops.CONSTANT:
            forms[k] = np.array([0.0, 0.0, 0.0, tape.constants[left]])
        elif op in (ops.X, ops.Y, ops.Z):
            forms[k] = np.eye(3, 4)[op - ops.X]
        elif op in (ops.COPY, ops.NEG) and left in forms:
            forms[k] = forms[left] if op == ops.COPY else -forms[left]
        elif op in (ops.ADD, ops.SUB) and left in forms and right in forms:
            forms[k] = forms[left] + forms[right] if op == ops.ADD else forms[left] - forms[right]
        elif op == ops.MUL and left in forms and right in forms:
            a, b = (forms[left], forms[right]) if forms[right][:3].any() else (forms[right], forms[left])
            if not a[:3].any():
                forms[k] = a[3] * b
    return forms


def _operands(tape: Tape, row: int) -> tuple[int, ...]:
    """Rows that an operation reads."""
    op, left, right, third = map(int, tape.code[row])
    if op in ops.OF_PARTS:
        return third, third + 1, third + 2
    return (left, right)
