"""Warnings of single bodies that a tie holds to the world, and that do not move as the tie is meant to let them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import asin, degrees, hypot, inf
from typing import Any, cast

from sceneql.compiler.meaning.facts import Facts, constant
from sceneql.compiler.passes.fall_through import pull_of, starts_of
from sceneql.compiler.passes.fillings import Beginning
from sceneql.compiler.passes.overlaps import UNKNOWN
from sceneql.compiler.passes.unforced import starts_moving
from sceneql.graph import Island, Task
from sceneql.kinds import Interaction, Model
from sceneql.quantities.diagnostic import Diagnostics

Vector = tuple[float, ...]

ALONG = 1e-3
"""Part of a vector's length up to which it lies across another."""
WEAK, HALF = 0.7, 0.5
"""Part of the largest torque of a weight that a motor needs for a turn, and of a weight that a tie has to bear."""
SEEN = 0.01
"""[rad] Turn over the film below which nothing moves."""
SLOW = 4.0
"""Times the film's length that a motor may take to reach its speed."""


@dataclass(frozen=True)
class Held:
    """A body that one tie holds to the world."""

    tie: Task
    model: Task
    pull: Vector
    """Its weight's acceleration [m/s^2]; 0 where it has none."""
    start: Any

    @property
    def kind(self) -> Any:
        """The tie's fields."""
        return self.tie.kind

    @property
    def sign(self) -> float:
        """1 where the body is the tie's first, -1 where it is the second."""
        return 1.0 if self.kind.between[0].name else -1.0

    def mass(self, facts: Facts) -> tuple[float, Any]:
        """Mass [kg] and properties (of density 1) of the body; 0 where they are not known."""
        from sceneql.bodies.rigid.mass_properties import properties  # here, where a tie has forces to compare with

        model: Any = self.model.kind
        try:
            found = properties(facts.objects[model.of.name], self.start)
        except UNKNOWN:
            return 0.0, None
        density = 1000.0 if model.density is None else model.density
        return (model.mass or density * found.volume), found


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of each such body, where nothing but its weight acts on it."""
    start: Any = Beginning(facts.tasks)
    for island in facts.groups if facts.whole else ():
        held = _held(facts, island, start)
        if held is None:
            continue
        axis, at = constant(getattr(held.kind, "axis", None)), constant(getattr(held.kind, "at", None))
        if "axis" not in type(held.kind).model_fields:
            if "at" not in type(held.kind).model_fields and "from_" not in type(held.kind).model_fields:
                text = f"'{held.tie.name}' holds '{held.model.name}' to the world in all directions: nothing moves"
                help = "write a `hinge`, about which it turns, or a `slider`, along which it moves"
                found.warning("nothing-moves", text, held.tie.span, help=help)
        elif axis is not None and at is None and "at" not in type(held.kind).model_fields:
            _slider(facts, held, _unit(axis), found)
        elif axis is not None and at is not None:
            _hinge(facts, held, _unit(axis), at, found)


def _held(facts: Facts, island: Island, start: Any) -> Held | None:
    ties, forces = facts.ties(island), facts.forces(island)
    if len(ties) != 1 or len(island.models) != 1 or island.contacts:
        return None
    tie, model = ties[0], facts.tasks[island.models[0]]
    kind, body = cast(Any, tie.kind), cast(Any, model.kind)
    pull = pull_of([cast(Interaction, one.kind) for one in forces]) if forces else (0.0, 0.0, 0.0)
    worlds = [ref for ref in kind.between if not ref.name]
    single = getattr(body, "of", None) is not None and hasattr(body, "density") and not getattr(body, "bodies", None)
    if pull is None or len(worlds) != 1 or not single or body.fixed or body.position is not None:
        return None
    return Held(tie, model, pull, start)


def _slider(facts: Facts, held: Held, axis: Vector, found: Diagnostics) -> None:
    """A slider across the weight; one whose motor does not lift its body."""
    kind, name = held.kind, held.model.name
    along = _dot(held.pull, axis)
    motor, spring = kind.motor, kind.stiffness
    if motor is None and spring is None and not starts_moving(held.model.kind):
        if any(held.pull) and abs(along) < ALONG * hypot(*held.pull):
            text = f"its weight does not move '{name}' along this axis, which is level: nothing moves"
            help = "write `axis: 0 1 0`, up and down, an axis that slopes, a `motor`, or a `velocity` of the body"
            found.warning("nothing-moves", text, getattr(kind.axis, "span", None) or held.tie.span, help=help)
        return
    force, speed = (constant(getattr(motor, field, None)) for field in ("force", "speed"))
    if force is None or speed is None or spring is not None or not any(held.pull):
        return
    mass, _ = held.mass(facts)
    weight = mass * along * held.sign
    if speed * weight < 0.0 and abs(weight) > force:
        text = f"this motor has {force:g} N, and '{name}' weighs {abs(weight):.3g} N against it: it goes the other way"
        found.warning("too-weak", text, motor.force.span or held.tie.span, help=_more("force", 1.5 * abs(weight), "N"))


def _hinge(facts: Facts, held: Held, axis: Vector, at: Vector, found: Diagnostics) -> None:
    """A spin across the axis; a motor that is too weak; friction or damping that hold; a tie that breaks at once."""
    kind, model, name = held.kind, cast(Any, held.model.kind), held.model.name
    spin = model.spin
    if any(spin) and abs(_dot(spin, axis)) < ALONG * hypot(*spin):
        which = " ".join(f"{c:g}" for c in axis)
        text = f"'{held.tie.name}' turns about {which}, and '{name}' spins across that: nothing of its spin is left"
        turned = " ".join(f"{0.0 + c / max(map(abs, spin)):.3g}" for c in spin)
        place = getattr(kind.axis, "span", None) or held.tie.span
        found.warning("no-spin", text, place, help=f"write `axis: {turned}`")
        return
    friction, damping = constant(kind.friction), constant(kind.damping)
    torque, speed = (constant(getattr(kind.motor, field, None)) for field in ("torque", "speed"))
    if (friction, damping, torque) == (None, None, None) and kind.breaks is None:
        return
    if kind.stiffness is not None or starts_moving(model):
        return
    mass, made = held.mass(facts)
    places = [place for place, _, _ in starts_of(cast(Model, model), facts.tasks, held.start)]
    if mass <= 0.0 or len(places) != 1:
        return
    arm = tuple(float(c) - p for c, p in zip(made.center, at, strict=True))
    across = tuple(a - _dot(arm, axis) * u for a, u in zip(arm, axis, strict=True))
    pull = tuple(g - _dot(held.pull, axis) * u for g, u in zip(held.pull, axis, strict=True))
    now, most = held.sign * mass * _dot(_cross(arm, held.pull), axis), mass * hypot(*across) * hypot(*pull)
    told = _motor(held, friction, torque, speed, now, most, found)
    if told:
        return
    if kind.breaks is not None and kind.breaks < HALF * mass * hypot(*held.pull) and kind.motor is None:
        weight = mass * hypot(*held.pull)
        text = f"'{held.tie.name}' breaks at once: '{name}' weighs {weight:.3g} N, and it bears {kind.breaks:g} N"
        found.warning("too-weak", text, held.tie.span, help=_more("breaks", 10.0 * weight, "N"))
    elif kind.motor is None and friction is not None and friction > most > 0.0:
        text = f"this friction holds '{name}', whose weight turns it by at most {most:.3g} N*m: nothing moves"
        help = _more("friction", 0.05 * most, "N*m")
        found.warning("nothing-moves", text, kind.friction.span or held.tie.span, help=help)
    elif kind.motor is None and damping and most > 0.0 and most / damping * facts.clock.end < SEEN:
        far = degrees(most / damping * facts.clock.end)
        text = f"with this damping '{name}' turns by at most {far:.2g} degrees in the film"
        help = _more("damping", 0.05 * most, "N*m*s")
        found.warning("nothing-moves", text, kind.damping.span or held.tie.span, help=help)
    elif torque and speed and not any(held.pull):
        turning = mass / made.volume * _about(made, arm, axis)
        needed = turning * abs(speed) / torque
        if needed > SLOW * facts.clock.end:
            text = f"this motor needs {needed:.3g} s to bring '{name}' to its speed"
            text += f", and the clock ends at {facts.clock.end:g} s"
            help = _more("torque", turning * abs(speed) / (0.1 * facts.clock.end), "N*m")
            found.warning("too-weak", text, kind.motor.torque.span or held.tie.span, help=help)


def _motor(held: Held, friction: Any, torque: Any, speed: Any, now: float, most: float, found: Diagnostics) -> bool:
    """Warn of a motor that its body's weight, or the friction, holds; whether it is so."""
    kind, name = held.kind, held.model.name
    if torque is None or speed is None or not speed:
        return False
    place = kind.motor.torque.span or held.tie.span
    limited = kind.limits is not None
    if friction is not None and friction >= torque and not any(held.pull):
        text = f"this motor has {torque:g} N*m, and the friction is {friction:g} N*m: nothing moves"
        found.warning("too-weak", text, place, help=_more("torque", 2.0 * friction, "N*m"))
    elif now * speed < 0.0 and abs(now) > torque:
        text = f"this motor has {torque:g} N*m, and '{name}' weighs {abs(now):.3g} N*m against it: it does not lift it"
        found.warning("too-weak", text, place, help=_more("torque", 1.5 * max(most, abs(now)), "N*m"))
    elif not limited and torque < WEAK * most and abs(now) < ALONG * most:
        far = degrees(asin(torque / most))
        text = f"this motor has {torque:g} N*m, and '{name}' weighs up to {most:.3g} N*m"
        text += f": it lifts it by {far:.2g} degrees"
        found.warning("too-weak", text, place, help=_more("torque", 1.5 * most, "N*m"))
    else:
        return False
    return True


def _more(field: str, number: float, unit: str) -> str:
    return f"write `{field}: {float(f'{number:.2g}'):g} {unit}`"


def _about(made: Any, arm: Vector, axis: Vector) -> float:
    """Moment of inertia about an axis at the end of an arm, for density 1 [m^5]."""
    inertia = sum(u * float(made.inertia[i][j]) * v for i, u in enumerate(axis) for j, v in enumerate(axis))
    away = hypot(*(a - _dot(arm, axis) * u for a, u in zip(arm, axis, strict=True)))
    return inertia + float(made.volume) * away * away


def _unit(vector: Sequence[float]) -> Vector:
    size = hypot(*vector) or inf
    return tuple(float(c) / size for c in vector)


def _dot(a: Sequence[float], b: Sequence[float]) -> float:
    return sum(float(x) * float(y) for x, y in zip(a, b, strict=True))


def _cross(a: Sequence[float], b: Sequence[float]) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
