"""Recognizes tapes whose roots on a ray can be found by an exact form instead of enclosures: densities, polynomials.

Imports numpy: to be imported by the function that needs it.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from sceneql.field.skeleton.skeleton import plain_points
from sceneql.field.tape import tape_ops as ops

if TYPE_CHECKING:
    from numpy import int32
    from numpy.typing import NDArray

    from sceneql.frame import Ints, Tape

MOST_DEGREE = 8
"""Largest degree of a polynomial."""


def without_factor(tape: Tape, row: int) -> int:
    """The row that remains of a row without positive constant factors, which do not change its roots."""
    op, left, right, _ = map(int, tape.code[row])
    factors = {ops.MUL: ((left, right), (right, left)), ops.DIV: ((right, left),)}.get(op, ())
    for factor, rest in factors:
        if tape.code[factor, 0] == ops.CONSTANT and tape.constants[tape.code[factor, 1]] > 0.0:
            return without_factor(tape, rest)
    return row


def density_of(tape: Tape, row: int) -> tuple[int, int] | None:
    """(row of the density D, index of the constant c) where a row is c - D, D of lone points with Wyvill's kernel.

    Only c > 0 qualifies, so that points out of all parts' reach are outside.
    """
    op, left, right, _ = tape.code[row]
    if op != ops.SUB or tape.code[left, 0] != ops.CONSTANT or tape.code[right, 0] not in ops.OF_PARTS:
        return None
    if not tape.constants[tape.code[left, 1]] > 0.0:
        return None
    kind, start, stop, at = tape.code[right]
    place = [tape.code[row[1], 0] if row[0] == ops.COPY else row[0] for row in tape.code[at : at + 3]]
    parts = tape.parts[start:stop] if kind == ops.DENSITY else plain_points(tape.parts[start:stop])
    if place != [ops.X, ops.Y, ops.Z] or parts is None or not (parts[:, :3] == parts[:, 3:6]).all():
        return None
    return int(right), int(tape.code[left, 1])


def degrees_of(tape: Tape, row: int) -> list[int] | None:
    """Degrees of the rows up to a polynomial's (-1: not needed); None where it has no degree of 2 to MOST_DEGREE."""
    degrees = [-1] * (row + 1)
    needed = {row}
    for k in range(row, -1, -1):
        op, left, right, _ = map(int, tape.code[k])
        if k in needed and op not in (ops.CONSTANT, ops.X, ops.Y, ops.Z):
            if op not in (ops.COPY, ops.ADD, ops.SUB, ops.MUL, ops.NEG, ops.SQUARE):
                return None
            needed |= {left, right}
    for k in sorted(needed):
        op, left, right, _ = map(int, tape.code[k])
        if op in (ops.CONSTANT, ops.X, ops.Y, ops.Z):
            degrees[k] = 0 if op == ops.CONSTANT else 1
        elif op in (ops.MUL, ops.SQUARE):
            degrees[k] = degrees[left] + degrees[right]
        else:
            degrees[k] = max(degrees[left], degrees[right])
    return degrees if 1 < degrees[row] <= MOST_DEGREE else None


def places_of(tape: Tape, degrees: list[int]) -> tuple[list[int], int]:
    """(where the coefficients of each row but the last begin, working memory in all); rows not used again free
    theirs."""
    last_use = dict.fromkeys(range(len(degrees)), -1)
    for k, degree in enumerate(degrees):
        if degree >= 0 and tape.code[k, 0] not in (ops.CONSTANT, ops.X, ops.Y, ops.Z):
            last_use |= dict.fromkeys(map(int, tape.code[k, 1:3]), k)
    places, most = [0] * (len(degrees) - 1), 0
    held: list[tuple[int, int, int]] = []  # (begin, end, last use)
    for k, degree in enumerate(degrees[:-1]):
        if degree < 0:
            continue
        begin = 0
        for start, end, _ in sorted(held):
            if begin + degree + 1 <= start:
                break
            begin = end
        places[k] = begin
        most = max(most, begin + degree + 1)
        held = [*(piece for piece in held if piece[2] > k), (begin, begin + degree + 1, last_use[k])]
    return places, most


NO_FORM, POLYNOMIAL = range(2)
"""First entry of a plan for single rays."""
OWN, CLIP, RADIUS, DEGREES = range(1, 5)
"""The next entries, for a field p, max(p, q) or max(p, sqrt(q) - r): the row of p; the row of the quadratic q, or -1;
the index of the constant r, or -1; then for each row up to the last of these its degree, or -1 where it is not needed;
then where its numbers begin in the working memory."""
BESIDE = 2
"""Numbers that a row keeps behind its coefficients: its norm and its error."""


def root_of(tape: Tape, row: int) -> tuple[int, int]:
    """(row of q, index of r) where a row is sqrt(q) - r, r > 0, which has the sign of q - r^2; else (row, -1)."""
    op, left, right, _ = map(int, tape.code[row])
    if op == ops.SUB and tape.code[left, 0] == ops.SQRT and tape.code[right, 0] == ops.CONSTANT:
        index = int(tape.code[right, 1])
        if tape.constants[index] > 0.0:
            return int(tape.code[left, 1]), index
    return row, -1


def ray_plan(tape: Tape) -> Ints:
    """The plan by which ray_polynomial_kernels finds roots of a tape on a single ray; NO_FORM alone: by enclosures."""
    return _ray_plan(_Form(tape))


class _Form:
    """What plans depend on: a tape's code, and which constants are positive: the same as an object moves."""

    def __init__(self, tape: Tape) -> None:
        self.tape = tape
        self._key = tape.code.tobytes(), (tape.constants > 0.0).tobytes()

    def __hash__(self) -> int:
        return hash(self._key)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Form) and self._key == other._key


@lru_cache(maxsize=64)
def _ray_plan(form: _Form) -> Ints:
    tape = form.tape
    none = np.array([NO_FORM], dtype=np.int32)
    last = without_factor(tape, len(tape.code) - 1)
    rows = [(last, -1)]
    if tape.code[last, 0] == ops.MAX:
        rows = [root_of(tape, without_factor(tape, int(row))) for row in tape.code[last, 1:3]]
    degrees = np.full((len(rows), max(rows)[0] + 1), -1)
    for known, (row, _) in zip(degrees, rows, strict=True):
        found = degrees_of(tape, row)
        if found is None:
            return none
        known[: row + 1] = found
    needed = degrees.max(axis=0)
    *clips, (own, rooted) = sorted(rows, key=lambda pair: (pair[1] < 0, int(needed[pair[0]])))
    if rooted >= 0 or any(needed[row] != 2 for row, _ in clips):
        return none
    ends = MOST_DEGREE + 1 + np.cumsum(np.where(needed < 0, 0, needed + 1 + BESIDE))
    if ends[-1] > len(tape.code) * ops.SCRATCH_COLUMNS:
        return none
    starts = ends - needed - 1 - BESIDE
    return np.array([POLYNOMIAL, own, *(clips or [(-1, -1)])[0], *needed, *starts], dtype=np.int32)


def tape_of_rows(tape: Tape, rows: list[int]) -> NDArray[int32]:
    """Code (k, 4) of max of some rows of the tape, with the rows that they need; empty for no rows."""
    needed = set(rows)
    for k in range(max(rows, default=-1), -1, -1):
        op, left, right, point = map(int, tape.code[k])
        if k in needed and op in ops.OF_PARTS:
            needed |= {point, point + 1, point + 2}
        elif k in needed and op not in (ops.CONSTANT, ops.X, ops.Y, ops.Z):
            needed |= {left, right}
    place = {k: i for i, k in enumerate(sorted(needed))}
    code = [[int(n) for n in tape.code[k]] for k in place]
    for line in code:
        if line[0] in ops.OF_PARTS:
            line[3] = place[line[3]]
        elif line[0] not in (ops.CONSTANT, ops.X, ops.Y, ops.Z):
            # The third operand of an angle is a flag, no row: see whole_turns.
            third = line[3] if line[0] == ops.ATAN2 else place.get(line[3], 0)
            line[1:] = place[line[1]], place[line[2]], third
    last = [place[row] for row in rows]
    for row in last[1:]:
        code.append([ops.MAX, last[0], row, 0])
        last[0] = len(code) - 1
    return np.array(code, dtype=np.int32).reshape(-1, 4)
