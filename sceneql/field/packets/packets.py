"""Packets of rays against the solid {f < 0} of a tape, for Python callers: numpy arrays in, numpy arrays out.

Imports numpy and numba: to be imported by the function that needs it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.field.packets import packet_roots_kernels, ray_rows
from sceneql.field.packets.packet_kernels import LANES, VECTOR, WIDTH
from sceneql.field.packets.packet_parts import density_columns, point_blocks, skeleton_columns
from sceneql.field.packets.packet_roots_kernels import GROUP
from sceneql.field.packets.packet_rows import PART
from sceneql.field.packets.slab_kernels import BEAM, OCTET
from sceneql.field.roots import density_march_kernels, density_roots_kernels, density_slice_kernels
from sceneql.field.roots.polynomial_kernels import ABREAST, DEGREES, POLYNOMIAL
from sceneql.field.roots.polynomial_steps_kernels import ROWS, C
from sceneql.field.tape.plans import degrees_of, density_of, places_of, tape_of_rows, without_factor
from sceneql.field.tape.tape_ops import DENSITY, MAX, OF_PARTS, SKELETON
from sceneql.field.tape.tape_solid import scratch

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy import float32, int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Tape


def single_parts(tape: Tape) -> NDArray[float32]:
    """The parts of a tape as columns of packet_rows, padded by VECTOR columns, since kernels load whole vectors."""
    out = lined((PART, len(tape.parts) + VECTOR), np.float32)
    for op, start, stop, _ in tape.code.tolist():
        if op in OF_PARTS:
            columns = density_columns if op == DENSITY else skeleton_columns
            out[:, start:stop] = columns(tape.parts[start:stop])
    return out


def enclosures(tape: Tape, origins: Floats, directions: Floats, t0: Floats, t1: Floats) -> Floats:
    """(4, n) enclosures c0, c1, e and status of f on segments o + t d, t in [t0, t1] (n,), of n rays.

    f lies in c0 + c1 tau +- e wherever it is defined, with t = (t0 + t1)/2 + tau (t1 - t0)/2, |tau| <= 1. The status is
    WHOLE, PARTIAL or NOWHERE. Where c0, c1 or e is not finite, there is no bound.
    """
    from sceneql.field.enclose.enclosures_kernels import enclose_rays

    out = np.empty((4, len(t0)))
    registers = np.zeros((len(tape.code), WIDTH), dtype=np.float32)
    point, status = np.zeros((3, WIDTH), dtype=np.float32), np.zeros(LANES, dtype=np.float32)
    memory = registers, point, status
    enclose_rays(tape.code, tape.constants, single_parts(tape), *memory, origins, directions, t0, t1, out)
    return out


def plan_of(tape: Tape) -> NDArray[int64]:
    """The form of a tape f or max(f, g), up to positive factors, by which packet kernels find its roots.

    (row of the density D, index of its constant c, row of g, row of the polynomial p), -1 for rows that the form lacks:
    f is c - D or p. For a polynomial follow the degrees of the rows up to p, and the offsets of their coefficients. To
    the plan of any other tape ``Memory`` appends the rows by which rays are clipped.
    """
    last = without_factor(tape, len(tape.code) - 1)
    rows = [last]
    if tape.code[last, 0] == MAX:
        rows = [without_factor(tape, int(row)) for row in tape.code[last, 1:3]]
    # The kernels gather the parts near a bundle for one row only.
    alone = sum(int(op) in OF_PARTS for op in tape.code[:, 0]) == 1
    turns = list(zip(rows, [*rows[1:], *rows[:1]] if len(rows) > 1 else [-1], strict=True))
    for row, other in turns:
        if alone and (found := density_of(tape, row)) is not None:
            return np.array([*found, other, -1], dtype=np.int64)
    for row, other in turns:
        if (degrees := degrees_of(tape, row)) is not None:
            starts = [ROWS // ABREAST + place for place in places_of(tape, degrees)[0]]
            return np.array([-1, 0, other, row, *degrees, *starts, C // ABREAST], dtype=np.int64)
    return np.array([-1, 0, -1, -1], dtype=np.int64)


def others_of(plan: NDArray[int64]) -> list[int]:
    """The rows of a tape that must be negative at a root of the plan's form for it to be a root of the tape."""
    if plan[density_roots_kernels.ROW_OF] < 0 and plan[POLYNOMIAL] < 0:
        return [int(row) for row in plan[POLYNOMIAL + 1 :]]
    return [int(row) for row in plan[[density_roots_kernels.OTHER]] if row >= 0]


def room_for(plan: NDArray[int64]) -> int:
    """Size of the working memory [numbers] for the polynomials of a plan: see polynomial_steps_kernels."""
    rows = int(plan[POLYNOMIAL]) + 1
    if rows == 0:
        return ROWS
    ends = plan[DEGREES : DEGREES + rows] + plan[DEGREES + rows :] + 1
    return max(int(ends.max()) * ABREAST, ROWS + 2 * rows)


CACHE_LINE = 64
"""[bytes]; a vector that crosses a cache line is read and written at half the speed."""


STAGGER = 8
"""Unused columns of an array, since rows a power of two apart would evict each other from the first-level cache."""


def lined(shape: tuple[int, ...] | int, dtype: Any = np.float64) -> NDArray[Any]:
    """An array of zeros aligned to a cache line."""
    size = int(np.prod(shape)) * np.dtype(dtype).itemsize
    raw = np.zeros(size + CACHE_LINE, dtype=np.uint8)
    first = -raw.ctypes.data % CACHE_LINE
    numbers: NDArray[Any] = raw[first : first + size].view(dtype).reshape(shape)
    return numbers


class Memory:
    """One thread's working memory for bundles of up to ``count`` rays against a tape.

    Rays should be clipped by the rows ``cut`` of the tape (see ``clips.clip_rows``); since clipping rounds, these rows
    are tested at each root. Roots of rays that are not clipped are correct too, but take the slower certified search.
    """

    def __init__(self, tape: Tape, count: int, cut: Sequence[int] = ()) -> None:
        whole = OCTET * GROUP
        count = -(-count // whole) * whole  # whole vectors: lanes beyond the rays are computed too
        rows = len(tape.code)
        self.tape = tape
        self.rays = lined((ray_rows.RAY, count))
        self.found = lined((5, count))
        single = np.float32
        self.packet = (
            lined((rows, WIDTH), single),
            lined((3, WIDTH), single),
            lined(LANES, single),
            lined(max(ray_rows.LANE_ROWS * LANES, density_march_kernels.ROWS), single),
            lined(2 * LANES, np.int64),
        )
        self.asked, self.queue = lined((ray_rows.ASK, count), single), lined(count, np.int64)
        plan = plan_of(tape)
        enclosed = plan[density_roots_kernels.ROW_OF] < 0 and plan[POLYNOMIAL] < 0
        # Roots of a density or polynomial are found without enclosures of all parts.
        self.singles = single_parts(tape) if enclosed else lined((PART, VECTOR), single)
        self.blocks: NDArray[float32] | None = None
        """Columns of point_blocks_kernels where the tape's form is a skeleton of points."""
        own = plan[density_roots_kernels.ROW_OF]
        if own >= 0 and tape.code[own, 0] == SKELETON:
            self.singles = self.blocks = point_blocks(tape.parts)
        beams, doubles = lined((BEAM, -(-count // GROUP) + VECTOR)), lined((rows, LANES))
        near = np.zeros((2 * rows, 4), dtype=np.int32), lined(self.singles.shape, single), lined(tape.parts.shape)
        if enclosed:
            plan = np.array([*plan, *cut], dtype=np.int64)
        most = STAGGER + -(-max(count, density_march_kernels.LANES, len(tape.parts)) // LANES) * LANES
        march = (
            plan,
            lined(4 * density_march_kernels.LANES + count + len(tape.parts), np.int64),
            lined((density_slice_kernels.ROOM, most)),
            lined((density_roots_kernels.MOST_PARTS, density_march_kernels.COLUMNS), single),
            lined(room_for(plan)),
            tape_of_rows(tape, others_of(plan)),
        )
        self.rest = tape.parts, lined(scratch(tape).shape), beams, doubles, lined((3, LANES)), *near, *march

    @property
    def bundle(self) -> tuple[Any, ...]:
        """The arrays of a bundle of rays, in the order in which kernels take them."""
        packet = self.tape.code, self.tape.constants, self.singles, *self.packet
        return *packet, self.rays, self.asked, self.queue

    def settle(self, count: int, anywhere: bool) -> tuple[int, int]:
        """Write first roots of the first ``count`` of ``rays`` to ``found``: see packet_roots_kernels.first_roots."""
        counts: tuple[int, int] = packet_roots_kernels.first_roots(
            *self.bundle, count, anywhere, self.found, *self.rest
        )
        return counts
