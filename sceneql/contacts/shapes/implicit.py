"""Colliders of objects with a field, by the field's tape in the object's own coordinates."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from sceneql.island.start import Start
from sceneql.kinds import Collider, Formula, Moment, Object, Value
from sceneql.quantities.dimension import LENGTH
from sceneql.quantities.expression import Number, Type, Vector
from sceneql.shapes.placement import UPRIGHT, Placed

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Tape
    from sceneql.system import Assembly

SMALLEST = 1e-4
"""Thickness, relative to a solid's size, below which a fast body might pass through it."""
ORIGIN = Value(Vector((Number(0.0), Number(0.0), Number(0.0)), Type((3,), LENGTH)))


def collider(kind: Object, assembly: Assembly) -> Collider:
    """Collider of any object with an inside, which may move but not change its shape.

    Raises TypeError for an object without an inside, ValueError for one whose shape varies.
    """
    import numpy as np

    from sceneql.field.tape.builder import TapeBuilder
    from sceneql.field.tape.tape_ops import SCRATCH_COLUMNS, scratch_rows

    own = kind
    if isinstance(kind, Placed):
        own = kind.model_copy(update={"position": ORIGIN, "rotation": UPRIGHT})
    if changes(own, assembly):
        raise ValueError("a surface that changes its shape in time cannot be collided with")
    start = cast(Moment, Start(assembly))
    build = TapeBuilder()
    tape = build.finish(own.implicit(build, build.x, build.y, build.z, start))
    low, high = own.extent(np.eye(3, 4), start)
    sides = high - low
    size = float(sides[np.isfinite(sides)].max(initial=0.0)) or 1.0
    rows = scratch_rows(len(tape.code), len(tape.parts))
    data = (
        assembly.floats(tape.constants),
        len(tape.constants),
        assembly.floats(tape.parts),
        len(tape.parts),
        assembly.floats(np.zeros(rows * SCRATCH_COLUMNS)),
        rows,
        len(tape.code),
        *packed(tape).tolist(),
    )
    return Collider(
        "sceneql.contacts.shapes.implicit_kernels",
        *place(kind, assembly),
        assembly.floats([size]),
        assembly.floats([SMALLEST * size]),
        data,
    )


def place(kind: Object, assembly: Assembly) -> tuple[int, int]:
    """Offsets of an object's position and rotation in the floats."""
    position, rotation = (kind.position, kind.rotation) if isinstance(kind, Placed) else (ORIGIN, UPRIGHT)
    return assembly.value(position), assembly.value(rotation)


def changes(kind: Object, assembly: Assembly) -> bool:
    """Whether any value of an object or of its members varies in time."""
    own = any(isinstance(value, Value | Formula) and not value.constant for _, value in kind)
    return own or any(changes(cast(Object, assembly.object(ref)), assembly) for ref in kind.members())


def packed(tape: Tape) -> NDArray[int64]:
    """Code of a tape, (n, 4) int32, packed into (2 n,) int64."""
    import numpy as np

    return np.ascontiguousarray(tape.code, dtype=np.int32).reshape(-1).view(np.int64)
