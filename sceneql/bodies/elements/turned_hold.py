"""Holds that follow an object, which moves and turns by keys or formulas."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sceneql.bodies.time_shift import APART, later
from sceneql.kinds import Value
from sceneql.quantities.diagnostic import Diagnostic, ScriptError

if TYPE_CHECKING:
    from sceneql.bodies.elements.hold import Held, Hold
    from sceneql.frame import Floats
    from sceneql.system import Assembly, Bodies

FOLDER = "sceneql.bodies.elements.turned_hold_kernels"


def add_turned(hold: Hold, part: Held, assembly: Assembly, bodies: Bodies) -> int:
    """Add the terms of a hold that follows an object; the offset of its force [N] in the floats.

    Raises ScriptError for an object that follows what is solved.
    """
    import numpy as np
    from scipy.sparse import csr_array

    from sceneql.shapes.placement import rotation_matrix
    from sceneql.system import Slopes

    before, here, after = (_pose(hold, by, assembly) for by in (-APART, 0.0, APART))
    numbers = assembly.numbers()
    arms = (part.starts - numbers[here[0] :][:3]) @ rotation_matrix(numbers[here[1] :][:4])
    rows = csr_array(part.rows)
    near = np.unique(rows.indices)
    moved = np.isin(part.near, near)
    free = np.zeros((len(near), 3), dtype=bool)
    free[np.searchsorted(near, part.near[moved])] = part.free[moved]
    axes = [int(axis in hold.axes()) for axis in range(3)]
    force = assembly.floats(np.zeros(3 + 6 * len(part.nodes)))
    offsets = (bodies.position_at, bodies.velocity_at, bodies.work_at, bodies.mass_at, *before, *here)
    head = (*offsets, assembly.floats([APART]), *after, assembly.floats(arms), force, *axes, int(all(axes)))
    lists = (part.nodes, near, np.ravel(free), rows.indptr, np.searchsorted(near, rows.indices))
    counts = (len(part.nodes), len(near), assembly.floats(rows.data))
    ints = (*head, *counts, *(int(k) for one in lists for k in one))
    alone = Slopes("", (), ())
    assembly.term("internal", f"{FOLDER}:feel_strain", ints, alone, energy="")
    assembly.after_step(f"{FOLDER}:put", ints)
    pulls = bool(free[:, hold.axes()].any())
    assembly.term("tie", f"{FOLDER}:feel", ints, alone, energy=None if pulls else "")
    assembly.term("constrain", f"{FOLDER}:lead", ints, alone, energy="")
    assembly.term("constrain", f"{FOLDER}:tell", ints, alone, energy="")
    return force


def start_velocity(hold: Hold, places: Floats, assembly: Assembly) -> Floats:
    """(k, 3) [m/s] of what it holds at places (k, 3) at the start."""
    from sceneql.shapes.placement import rotation_matrix

    (x0, q0), (x, q), (x1, q1) = (_pose(hold, by, assembly) for by in (-APART, 0.0, APART))
    numbers = assembly.numbers()
    arms = (places - numbers[x : x + 3]) @ rotation_matrix(numbers[q : q + 4])
    ends = [numbers[a : a + 3] + arms @ rotation_matrix(numbers[b : b + 4]).T for a, b in ((x0, q0), (x1, q1))]
    velocity: Floats = (ends[1] - ends[0]) / (2 * APART)
    return velocity


def _pose(hold: Hold, by: float, assembly: Assembly) -> tuple[int, int]:
    """Offsets of the object's position and rotation a little later."""
    assert hold.follows is not None
    kind, found = assembly.object(hold.follows), []
    try:
        for name, rest in (("position", (0.0, 0.0, 0.0)), ("rotation", (1.0, 0.0, 0.0, 0.0))):
            value = getattr(kind, name, None)
            if isinstance(value, Value):
                found.append(assembly.value(Value(later(value.expr, by, assembly.formula), value.span)))
            else:
                found.append(assembly.floats(rest))
    except ValueError as error:
        message = f"a hold follows an object that moves by functions of time: {error}"
        raise ScriptError([Diagnostic("unsupported-link", message, hold.follows.span)]) from None
    return found[0], found[1]
