"""Holds: prescribed motion of nodes of a solid, in all components or some."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import hypot
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from sceneql import kinds
from sceneql.bodies.time_shift import APART, later
from sceneql.kinds import Formula, Position, Problem, Record, Symbols, Value, field
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Link, Symbol
from sceneql.quantities.intervals import range_of

if TYPE_CHECKING:
    from sceneql.bodies.elements.element_mesh import ElementMesh
    from sceneql.frame import Floats
    from sceneql.quantities.span import Span
    from sceneql.system import Assembly, Bodies

AXES = ("x", "y", "z")
HELD, LOADED = "hold {}", "load {}"
"""Names of the lines and points of holds and loads in a mesh."""
TURNED = "sceneql.bodies.elements.turned_hold_kernels"


class Part(Record):
    """A part of a solid by places of its material: where these stand before it is moved or turned."""

    where: Annotated[Formula, Symbols(AXES)] | None = field(
        "A formula of the place [m] that holds there, `x < 0.1`; with an equality a line on the surface, along which "
        "elements get nodes: `(y == 0.3)*(x > 0)`.",
        None,
    )
    near: kinds.FixedPosition | None = field(
        "A place: the point of the surface that is nearest to it, where a hold gives elements a node; or all `within` "
        "a distance.",
        None,
    )
    within: kinds.FixedLength | None = field("Distance from `near`.", None, above=0)
    object: kinds.ObjectRef | None = field("An object: what lies in it.", None)

    def problems(self) -> Iterator[Problem]:
        """Problems: more or less than one of `where`, `near` and `object`; `within` without `near`."""
        given = [name for name in ("where", "near", "object") if getattr(self, name) is not None]
        if len(given) != 1:
            said = f", not {' and '.join(given)}" if given else ""
            yield Problem(f"a part of a solid is told by one of `where`, `near` and `object`{said}", tuple(given[1:2]))
        elif self.within is not None and self.near is None:
            yield Problem("a distance is from a place: say `near`", ("within",), at_key=True)

    def place(self) -> Span | None:
        """Place in the script; None if unknown."""
        told = self.where or self.object
        return None if told is None else told.span

    def misses(self, low: Sequence[float], high: Sequence[float]) -> bool:
        """Whether its own fields show that no place of the box low..high [m] lies in it."""
        if self.where is not None:
            known = dict(zip(AXES, zip(low, high, strict=True), strict=True))
            return range_of(self.where.expr, known) == (0.0, 0.0)
        if self.near is None or self.within is None:
            return False
        away = [max(a - x, x - b, 0.0) for x, a, b in zip(self.near, low, high, strict=True)]
        return hypot(*away) > self.within

    def holds(self, places: Floats, assembly: Assembly) -> Any:
        """(n,) bool: which of places (n, 3) [m] lie in the part; with `near` but no `within` only the nearest ones."""
        import numpy as np

        if self.where is not None:
            known = {Symbol(axis): places[:, k] for k, axis in enumerate(AXES)}
            return np.broadcast_to(evaluate(self.where.expr, known, arrays=True), len(places)).astype(bool)
        if self.object is not None:
            from sceneql.bodies.filling.fill import Inside

            return np.asarray(Inside(self.object, assembly).holds(places))
        away = np.linalg.norm(places - np.asarray(self.near), axis=1)
        return away <= self.within if self.within is not None else away == away.min()


class Hold(Part):
    """What holds nodes of a solid, and moves them."""

    said_by: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("rotation", "rotate", "turn", "angle", "spin", "axis", "about", "twist"),
        "a hold turns with the object that it `follows`: name one whose `rotation` has keys, as "
        "`rotation: {about: x, angle: {keys: {0 s: 0 deg, 1 s: 90 deg}}}`",
    )

    components: Literal["xyz", "x", "y", "z", "xy", "xz", "yz"] = field("In which directions it holds.", "xyz")
    shift: Position = field("How far what is held has been moved from where it starts.", "0 0 0 m")
    follows: kinds.ObjectRef | None = field(
        "An object that moves by keys or formulas: what is held moves and turns with it, about its position.", None
    )

    def problems(self) -> Iterator[Problem]:
        """Problems of a part; both a shift and an object to follow."""
        yield from super().problems()
        if self.follows is not None and self.shift.span is not None:
            yield Problem("what is held either has a shift or follows an object", ("shift",))

    def axes(self) -> list[int]:
        """The held components as numbers of axes, 0 to 2."""
        return [AXES.index(axis) for axis in self.components]

    def still(self, assembly: Assembly) -> bool:
        """Whether the prescribed motion is none."""
        if self.follows is not None:
            return False
        return self.shift.constant and not any(assembly.initial(self.shift))


def chosen(name: str, hold: Part, mesh: ElementMesh, assembly: Assembly, line: Span | None) -> Any:
    """Numbers (k,) of the nodes of a mesh that lie in a part. Raises ScriptError where there is none."""
    import numpy as np

    on = mesh.lines.get(HELD.format(name))
    found = np.flatnonzero(hold.holds(mesh.points, assembly)) if on is None or on.inside else on.nodes
    if on is not None and on.inside:
        found = np.union1d(found, on.nodes)
    if not len(found):
        help = None if hold.within is None else "the nodes stand a spacing apart: take a larger `within`"
        if on is not None:
            help = "an equality tells a line where its surface crosses it: `(y == 0.1)*(x > 0)`, in meters"
        raise ScriptError([Diagnostic("no-mass", f"'{name}' holds no node", hold.place() or line, help)])
    return found


@dataclass(frozen=True, slots=True, eq=False)
class Held:
    """The nodes of a hold, and the nodes that the mass matrix couples with them."""

    nodes: Any
    """(k,) the held nodes."""
    starts: Floats
    """(k, 3) [m] their positions at the start."""
    near: Any
    """(n,) the nodes coupled with them by the mass matrix, the held ones included."""
    weights: Floats
    """(n,) [kg] the coupling: sums of the mass matrix over the held nodes."""
    free: Any
    """(n, 3) bool: components of the coupled nodes that nothing holds."""
    rows: Any
    """(k, all nodes) sparse [kg], the held nodes' rows of the mass matrix."""


def add_holds(
    holds: Mapping[str, Hold], held: Mapping[str, Held], assembly: Assembly, bodies: Bodies
) -> dict[str, int]:
    """Add the terms of holds to an island; returns by name the offset of the hold's force [N] in the floats.

    The work of a hold on the solid is subtracted from the dissipated energy. Velocities and accelerations of the
    prescribed motion are central differences. Raises ScriptError for a shift that is no function of time.
    """
    import numpy as np

    from sceneql.system import Slopes

    folder = "sceneql.bodies.elements.hold_kernels"
    alone, each, found = Slopes("", (), ()), [], {}
    for name, hold in holds.items():
        part = held[name]
        if hold.follows is not None:
            found[name] = _add_turned(hold, part, assembly, bodies)
            continue
        shifts = [assembly.value(_moved(hold.shift, by, assembly)) for by in (-APART, 0.0, APART)]
        found[name] = assembly.floats(np.zeros(9))
        axes = [int(axis in hold.components) for axis in AXES]
        places = (bodies.position_at, bodies.velocity_at, bodies.work_at, bodies.mass_at, bodies.inverse_at)
        numbers = (*shifts, assembly.floats([APART]), assembly.floats(part.starts), found[name], *axes, int(all(axes)))
        counts = (len(part.nodes), len(part.near), assembly.floats(part.weights))
        lists = (np.ravel(one).astype(int).tolist() for one in (part.nodes, part.near, part.free))
        each.append(
            (
                hold.still(assembly),
                not part.free[:, hold.axes()].any(),
                (*places, *numbers, *counts, *(k for one in lists for k in one)),
            )
        )
    for still, alone_moved, ints in each:
        if not still:
            assembly.term("internal", f"{folder}:feel_strain", ints, alone, energy="")
            assembly.after_step(f"{folder}:put", ints)
        # A consistent mass matrix couples the prescribed accelerations with the neighboring nodes.
        assembly.term("tie", f"{folder}:feel", ints, alone, energy="" if still or alone_moved else None)
        assembly.term("constrain", f"{folder}:lead", ints, alone, energy="")
    for _, _, ints in each:
        assembly.term("constrain", f"{folder}:tell", ints, alone, energy="")
    return found


def start_velocity(hold: Hold, places: Floats, assembly: Assembly) -> Floats:
    """Velocity (3,) or (k, 3) [m/s], at the start, of the held places (k, 3) [m]."""
    import numpy as np

    if hold.follows is not None:
        return _turned_velocity(hold, places, assembly)

    ends = [np.asarray(assembly.initial(_moved(hold.shift, by, assembly))) for by in (-APART, APART)]
    velocity: Floats = (ends[1] - ends[0]) / (2 * APART)
    return velocity


def _moved(shift: Value, by: float, assembly: Assembly) -> Value:
    """The shift as a value at time t + ``by`` [s]. Raises ScriptError where it is no function of time."""
    try:
        return Value(later(shift.expr, by, assembly.formula), shift.span)
    except ValueError as error:
        message = f"a hold is moved by a function of time: {error}"
        raise ScriptError([Diagnostic("unsupported-link", message, shift.span)]) from None


def _add_turned(hold: Hold, part: Held, assembly: Assembly, bodies: Bodies) -> int:
    """Add the terms of a hold that follows an object; returns the offset of its force [N] in the floats.

    Raises ScriptError for an object whose motion depends on the solved state.
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
    assembly.term("internal", f"{TURNED}:feel_strain", ints, alone, energy="")
    assembly.after_step(f"{TURNED}:put", ints)
    pulls = bool(free[:, hold.axes()].any())
    assembly.term("tie", f"{TURNED}:feel", ints, alone, energy=None if pulls else "")
    assembly.term("constrain", f"{TURNED}:lead", ints, alone, energy="")
    assembly.term("constrain", f"{TURNED}:tell", ints, alone, energy="")
    return force


def _turned_velocity(hold: Hold, places: Floats, assembly: Assembly) -> Floats:
    """Velocities (k, 3) [m/s], at the start, of places (k, 3) [m] that move rigidly with the followed object."""
    from sceneql.shapes.placement import rotation_matrix

    (x0, q0), (x, q), (x1, q1) = (_pose(hold, by, assembly) for by in (-APART, 0.0, APART))
    numbers = assembly.numbers()
    arms = (places - numbers[x : x + 3]) @ rotation_matrix(numbers[q : q + 4])
    ends = [numbers[a : a + 3] + arms @ rotation_matrix(numbers[b : b + 4]).T for a, b in ((x0, q0), (x1, q1))]
    velocity: Floats = (ends[1] - ends[0]) / (2 * APART)
    return velocity


def _pose(hold: Hold, by: float, assembly: Assembly) -> tuple[int, int]:
    """Offsets in the floats of the followed object's position and rotation at time t + ``by`` [s].

    Raises ScriptError for an object without a position, with a varying height, in a group that is moved itself, or
    whose motion depends on the solved state.
    """
    ref = hold.follows
    assert ref is not None
    kind, found = assembly.object(ref), []
    _refuse_member(ref, assembly)
    position, height = getattr(kind, "position", None), getattr(kind, "height", None)
    if not isinstance(position, Value):
        message = f"'{ref.name}' has no position of its own, which a hold could follow"
        help = f"put it into a group that moves, `{{group: {{children: [{ref.name}]}}}}`, and name that"
        raise ScriptError([Diagnostic("no-position", message, ref.span, help)])
    if isinstance(height, Value) and not height.constant:
        message = f"the height of '{ref.name}' varies, by which a hold does not follow it"
        raise ScriptError([Diagnostic("unsupported-link", message, height.span, "let its `position` vary")])
    try:
        for name, rest in (("position", (0.0, 0.0, 0.0)), ("rotation", (1.0, 0.0, 0.0, 0.0))):
            value = getattr(kind, name, None)
            if isinstance(value, Value):
                # By a link, which resolves to a model's motion of the object; the field alone is its start.
                link = Link(ref.name, name, value.expr.type)
                found.append(assembly.value(Value(later(link, by, assembly.formula), value.span)))
            else:
                found.append(assembly.floats(rest))
    except ValueError as error:
        message = f"a hold follows an object that moves by functions of time: {error}"
        help = "move it by keys or a formula of `time`"
        raise ScriptError([Diagnostic("unsupported-link", message, ref.span, help)]) from None
    return found[0], found[1]


def _refuse_member(ref: kinds.Ref, assembly: Assembly) -> None:
    """Raise ScriptError for a member of a group with a position, rotation or scale of its own.

    The member's position and rotation are relative to the group's coordinates, so following them would be wrong.
    """
    found = assembly.holder(ref)
    if found is None:
        return
    name, group = found
    for field_, rest in (("position", (0.0, 0.0, 0.0)), ("rotation", (1.0, 0.0, 0.0, 0.0)), ("scale", (1.0, 1.0, 1.0))):
        value = getattr(group, field_, None)
        if isinstance(value, Value) and not (value.constant and _equal(assembly.initial(value), rest)):
            message = f"'{ref.name}' is a member of '{name}', whose own {field_} a hold that follows it would not see"
            help = f"write `follows: {name}`, or take '{ref.name}' out of that"
            raise ScriptError([Diagnostic("unsupported-link", message, ref.span, help)])


def _equal(value: Any, rest: tuple[float, ...]) -> bool:
    import numpy as np

    return bool((np.asarray(value) == np.asarray(rest)).all())
