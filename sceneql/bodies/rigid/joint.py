"""Base of the words of ties: the two bodies, their poses at the start, the constraint rows, forces between them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from sceneql.kinds import Gives, Object, Problem, Ref, Tie, Value, quantity_type
from sceneql.kinds.values import TIME
from sceneql.kinds.word import written_name
from sceneql.quantities import dimension as dim
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.expression import Expr, Link, Symbol, Type, walk
from sceneql.system import Drive, Led, Place, Tied, TieRow

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from sceneql.frame import Floats
    from sceneql.system import Assembly, Bodies, ModelState, Mover
    from sceneql.system.ties import Triple

APART = 1e-9
"""Largest distance of a mass from the place where it is held, relative to 1 m plus the place's coordinates."""
FORCES = {
    "broken": Gives(Type(), "1 once it is gone, else 0."),
    "force": Gives(quantity_type(dim.FORCE, (3,)), "Its force on the first body."),
    "torque": Gives(quantity_type(dim.FORCE * dim.LENGTH, (3,)), "Its torque on the first body, about where it is."),
}


@dataclass(frozen=True, slots=True)
class Side:
    """One of the two bodies of a tie, at the start of the run."""

    mover: Mover
    position: Floats
    """(3,) [m] center of mass, or position of an object."""
    axes: Floats
    """(3, 3) rotation matrix from the body's axes to the world's."""

    @property
    def turns(self) -> bool:
        """Whether it can rotate: false for a point mass."""
        return not (isinstance(self.mover, Place) and self.mover.bodies.turning is None)

    def place(self, point: Any) -> Triple:
        """A point of the world in body coordinates, relative to its position."""
        return _triple(self.axes.T @ (point - self.position))

    def direction(self, vector: Any) -> Triple:
        """A vector of the world in body axes."""
        return _triple(self.axes.T @ vector)


def _triple(vector: Floats) -> Triple:
    x, y, z = (float(c) for c in vector)
    return x, y, z


class Joint(Tie):
    """A tie made of constraint rows, which its word defines."""

    def problems(self) -> Iterator[Problem]:
        """Problems of a tie; a place or an axis that depends on time, since only its value at the start is used."""
        yield from super().problems()
        for name in ("at", "from_", "to", "axis", "other_axis"):
            value = getattr(self, name, None)
            if isinstance(value, Value) and any(isinstance(n, Symbol) and n.name in TIME for n in walk(value.expr)):
                text = "a tie stays where it is at the start in the bodies that it holds, and does not move by the time"
                yield Problem(text, (written_name(name),))

    def rows(self, first: Side, second: Side, assembly: Assembly) -> list[TieRow]:
        """The constraint rows of the tie, all satisfied at the start."""
        raise NotImplementedError

    def assemble_together(self, name: str, assembly: Assembly, everyone: Sequence[Bodies]) -> None:
        """Add the tie's constraints to an island. Raises ScriptError for bodies that cannot be tied."""
        import numpy as np

        from sceneql.bodies.rigid.ties.tie_rows_kernels import ROW
        from sceneql.bodies.rigid.ties.tie_system import integers
        from sceneql.bodies.rigid.ties.tied_step import OFTEN

        first, second = sides_of(self.between, assembly)
        if first.mover == second.mover:
            raise ScriptError([Diagnostic("same-mass", "a tie leads from a body to itself", self.between[1].span)])
        rows = self.rows(first, second, assembly)
        scratch, holds = assembly.floats(np.zeros(ROW * len(rows))), assembly.floats([1.0])
        motion, drive = self.assemble_motion(first, second, holds, assembly)
        assembly.tie(Tied((first.mover, second.mover), tuple(rows), scratch, holds, drive, name, assembly.line()))
        arm = assembly.floats(rows[0].vectors[0] if rows[0].kind in ("point", "distance", "ball") else (0.0, 0.0, 0.0))
        assembly.remember(scratch, len(rows), holds, arm, *integers(first.mover), *integers(second.mover))
        assembly.remember(*motion)
        if self.breaks is not None:
            ints = (scratch, len(rows), holds, assembly.floats([self.breaks, -1.0, 0.0]), *motion)
            assembly.after_step("sceneql.bodies.rigid.break_kernels:part", ints)
            assembly.step_at_most(OFTEN)  # what rests under a growing load would be taken over its break in one step

    def assemble_motion(
        self, first: Side, second: Side, holds: int, assembly: Assembly
    ) -> tuple[tuple[int, ...], Drive | None]:
        """Add forces along its degree of freedom, by default none: (integers of drive_kernels, bounded forces)."""
        return (), None

    def read(self, output: str, state: ModelState) -> Any:
        """Value of an output of FORCES."""
        import numpy as np

        from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_FORCE, AT_J, AT_PUSH, ROW

        at, count, holds = state.ints[:3]
        if output == "broken":
            return float(state.floats[holds] == 0.0)
        rows = state.floats[at : at + ROW * count].reshape(count, ROW)
        parts = (rows[:, AT_FORCE] + rows[:, AT_PUSH])[:, None] * rows[:, AT_J : AT_J + 6]
        force = parts[:, :3].sum(axis=0)
        if output == "force":
            return force
        return parts[:, 3:].sum(axis=0) - np.cross(self._arm(state), force)

    def trouble(self, state: ModelState) -> str:
        """Text on the distance or angle by which the tie was violated; empty if it was held."""
        from sceneql.bodies.rigid.ties.tie_rows_kernels import AT_OPEN, ROW

        at, count = state.ints[:2]
        opened = float(state.floats[at : at + ROW * count].reshape(count, ROW)[:, AT_OPEN].max())
        if opened == 0.0:
            return ""
        return f"it came open by {opened:.2g} (m or rad): other ties, or what leads its bodies, ask for something else"

    def _arm(self, state: ModelState) -> Floats:
        """Vector (3,) [m] from the position of the first body to the tie's point on it."""
        from sceneql.bodies.rigid.ties.tie_rows_kernels import ROTATION, TURN
        from sceneql.shapes.placement import rotation_matrix

        arm_at, mover = state.ints[3], state.ints[4:]
        arm = state.floats[arm_at : arm_at + 3]
        if mover[ROTATION] >= 0:
            return rotation_matrix(state.y[mover[ROTATION] :][:4]) @ arm
        return rotation_matrix(state.floats[mover[TURN] :][:4]) @ arm if mover[TURN] >= 0 else arm


def sides_of(refs: Sequence[Ref], assembly: Assembly) -> tuple[Side, Side]:
    """The two bodies of a tie. Raises ScriptError for a reference to no body."""
    first, second = (_side(ref, assembly) for ref in refs)
    return first, second


def _side(ref: Ref, assembly: Assembly) -> Side:
    """A body of a tie; without a name the world. Raises ScriptError for a reference to no body."""
    import numpy as np

    from sceneql.shapes.placement import rotation_matrix

    if not ref.name:
        return Side(None, np.zeros(3), np.eye(3))
    kind = assembly.object(ref)
    if isinstance(kind, Object):
        return led_side(ref, kind, assembly)
    output = f"{ref.within}.position" if ref.within else "position"
    place = assembly.place(Link(ref.name, output, Type((3,), dim.LENGTH)))
    if place is None:
        message = f"'{ref.name}' is no body that a tie could hold"
        raise ScriptError([Diagnostic("no-mass", message, ref.span, "name a rigid body or a mass, or `world`")])
    y, at = assembly.start(), place.ints
    turn = np.eye(3) if place.bodies.turning is None else rotation_matrix(y[at[4] : at[4] + 4])
    return Side(Place(place.bodies, place.body), y[at[0] : at[0] + 3].copy(), turn)


def led_side(ref: Ref, kind: Object, assembly: Assembly) -> Side:
    """The side of a tie at an object with prescribed motion; an object at rest is part of the world.

    Raises ScriptError for an object without position and rotation, or whose velocity is not a function of time.
    """
    import numpy as np

    from sceneql.bodies.time_shift import exact_rate, rate_of_change
    from sceneql.quantities.turned import spin
    from sceneql.shapes.placement import UPRIGHT, rotation_matrix

    position, rotation = getattr(kind, "position", None), getattr(kind, "rotation", UPRIGHT)
    if not (isinstance(position, Value) and isinstance(rotation, Value)):
        message = f"'{ref.name}' has no position and rotation of its own"
        raise ScriptError([Diagnostic("no-position", message, ref.span)])
    if position.constant and rotation.constant:
        return Side(None, np.zeros(3), np.eye(3))

    def rate(expr: Expr) -> Expr:
        return exact_rate(expr, assembly.formula) or rate_of_change(expr, assembly.formula)

    try:
        velocity, turning = (rate(position.expr), rate(rotation.expr))
        spinning = spin(rotation.expr, turning)
        exprs = (velocity, spinning, rate(velocity), rate(spinning))
    except ValueError as error:
        message = f"it cannot be told how '{ref.name}' moves: {error}"
        raise ScriptError([Diagnostic("no-velocity", message, ref.span)]) from None
    rates = (assembly.value(Value(expr, ref.span)) for expr in exprs)
    mover = Led(assembly.value(position), assembly.value(rotation), *rates)
    turn = rotation_matrix(assembly.initial(rotation))
    return Side(mover, np.asarray(assembly.initial(position), dtype=np.float64), turn)


def across(axis: Any) -> tuple[Floats, Floats]:
    """Two unit vectors u, v orthogonal to a unit vector ``axis`` (3,), with axis x u = v."""
    import numpy as np

    least = np.zeros(3)
    least[int(np.argmin(np.abs(axis)))] = 1.0
    first = np.cross(axis, least)
    first /= np.linalg.norm(first)
    return first, np.cross(axis, first)


def together(first: Side, second: Side, point: Any) -> list[TieRow]:
    """Three rows: a common point of both bodies stays common."""
    return [TieRow("ball", (first.place(point), second.place(point))), TieRow("written"), TieRow("written")]


def parallel(first: Side, second: Side) -> list[TieRow]:
    """Three rows: the relative rotation of both bodies stays as it is."""
    import numpy as np

    one, two, three = np.eye(3)
    pairs = ((one, two), (two, three), (three, one))
    return [TieRow("angle", (first.direction(u), second.direction(w))) for u, w in pairs]


def point_of(
    value: Value | None, refs: Sequence[Ref], sides: Sequence[Side], assembly: Assembly, center: bool = False
) -> Floats:
    """The point (3,) [m] of a tie at the start: the given value, else a tied mass, else with ``center`` the first body.

    Raises ScriptError where none of these is known, and for a point away from a mass that is tied there.
    """
    import numpy as np

    points = [side for side in sides if not side.turns]
    bodies = points or [side for side in sides if center and side.mover is not None]
    if value is None and bodies:
        found: Floats = bodies[0].position
    elif value is None:
        message = "where the tie is at the start is not told"
        raise ScriptError(
            [Diagnostic("no-place", message, assembly.line(), "say it by `at: 0 1 0 m`, or `at: crate.hook`")]
        )
    else:
        found = np.asarray(assembly.initial(value), dtype=np.float64)
    for ref, side in zip(refs, sides, strict=True):
        away = float(np.linalg.norm(found - side.position))
        if not side.turns and away > APART * (1.0 + float(np.abs(found).max())):
            message = f"'{_named(ref)}' is a mass, {away:.3g} m away from this place"
            help = "leave the place out: a tie holds a mass where that is"
            raise ScriptError([Diagnostic("ties-apart", message, None if value is None else value.span, help)])
    return found


def _named(ref: Ref) -> str:
    return f"{ref.name}.{ref.within}" if ref.within else ref.name


def must_turn(refs: Sequence[Ref], sides: Sequence[Side]) -> None:
    """Raise ScriptError for a point mass among the sides, which cannot be held by axes."""
    for ref, side in zip(refs, sides, strict=True):
        if not side.turns:
            message = f"'{_named(ref)}' is a mass, which has no axes to be held by"
            raise ScriptError([Diagnostic("no-rotation", message, ref.span, "a mass is held by a `ball` or a `rod`")])


def axis_of(value: Value, assembly: Assembly) -> Floats:
    """Unit vector (3,), in the world, along a value at the start."""
    from sceneql.shapes.placement import unit_vector

    return unit_vector(assembly.initial(value))
