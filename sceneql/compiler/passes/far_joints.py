"""Warnings of ties that hold a body far outside of it, as in wrong coordinates, and of hinges that nothing turns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import hypot
from typing import Any, cast

from sceneql.compiler.passes.fall_through import pull_of, starts_of
from sceneql.compiler.passes.fillings import Beginning
from sceneql.compiler.passes.unforced import starts_moving
from sceneql.failure import LimitRefused, RunFailure
from sceneql.graph import Island, Task
from sceneql.kinds import Interaction, Model, Ref, Tie, Value
from sceneql.quantities.diagnostic import Diagnostics, ScriptError

FAR, FAR_OF_BOB = 1.0, 20.0
"""Distance from the body's box, relative to its diagonal, from which on a point is far; a compact bob may hang on a
long arm."""
STILL = 1e-6
"""Torque of a weight, relative to the largest for the length of its arm, up to which it turns nothing."""
AXES = ((0, 0, 1), (1, 0, 0))
"""Axes across the default weight, that towards the usual camera first."""
TURNING = ("motor", "stiffness")
"""Fields of a hinge that turn its body."""
BOB = 2.0
"""Largest ratio of the sides of a bob's box."""


def warn_of_far_joints(tasks: Mapping[str, Task], found: Diagnostics) -> None:
    """Warn of each tie whose point is far outside of its body's object, if the script determines both at the start."""
    ties = [task for task in tasks.values() if isinstance(task.kind, Tie)]
    start: Any = Beginning(tasks)
    for task in ties:
        for place, refs in task.kind.places() if isinstance(task.kind, Tie) else ():
            for ref in refs:
                try:
                    far = next(_outside(start.at(place), ref, tasks, start), None)
                except (TypeError, ValueError, ArithmeticError, RunFailure, LimitRefused, ScriptError):
                    continue  # only a run knows
                if far is not None:
                    distance, where = far
                    which = ref.within or ref.name
                    text = f"'{task.name}' holds '{which}' {distance:.3g} m outside of it"
                    help = f"this is a place in the world, where '{which}' goes from {where} m; a string is a `rod`"
                    found.warning("far-joint", text, place.span or task.span, help=help)


def _outside(place: Any, ref: Ref, tasks: Mapping[str, Task], start: Any) -> Iterator[tuple[float, str]]:
    """The distance [m] of a point from the box of a body's object, and that box in words; nothing where it is near."""
    import numpy as np

    model: Any = tasks[ref.name].kind if ref.name else None
    for name, fields in model.drives().items() if isinstance(model, Model) else ():
        body = (getattr(model, "bodies", None) or {}).get(ref.within, model)
        placed = getattr(body, "position", None) is not None  # not where its object stands
        if placed or fields.get("position", "").rpartition(".")[0] != ref.within:
            continue
        kind: Any = tasks[name].original or tasks[name].kind
        low, high = kind.extent(np.eye(3, 4), start)
        distance = float(np.linalg.norm(np.maximum(np.maximum(low - place, place - high), 0.0)))
        far = FAR_OF_BOB if (high - low).max() <= BOB * (high - low).min() else FAR
        if distance > far * float(np.linalg.norm(high - low)):
            yield distance, " to ".join(", ".join(f"{x:.4g}" for x in corner) for corner in (low, high))


def warn_of_unturned(tasks: Mapping[str, Task], groups: Sequence[Island], found: Diagnostics) -> None:
    """Warn of each hinge to the world whose body starts at rest, where its weight alone acts and does not turn it."""
    start: Any = Beginning(tasks)
    for island in groups:
        ties = list(dict.fromkeys(name for name, _ in island.forces if isinstance(tasks[name].kind, Tie)))
        forces = [cast(Interaction, tasks[name].kind) for name, _ in island.forces if name not in ties]
        pull = pull_of(forces)
        if len(ties) != 1 or len(island.models) != 1 or island.contacts or pull is None:
            continue
        tie, model = tasks[ties[0]], tasks[island.models[0]]
        places = [place for place, _, _ in starts_of(cast(Model, model.kind), tasks, start)]
        if len(places) == 1 and not starts_moving(model.kind) and _hangs(tie.kind, places[0], pull):
            text = f"'{model.name}' hangs straight down at rest: nothing moves"
            help = "let it start aside, by another `position`, or give it a `velocity`"
            found.warning("nothing-moves", text, tie.span, help=help)
            continue
        axis, at = getattr(tie.kind, "axis", None), getattr(tie.kind, "at", None)
        if not isinstance(axis, Value) or not isinstance(at, Value) or not axis.constant or not at.constant:
            continue
        if any(getattr(tie.kind, field, None) is not None for field in TURNING) or starts_moving(model.kind):
            continue
        if len(places) != 1:
            continue
        arm = tuple(c - float(p) for c, p in zip(places[0], at.number(), strict=True))
        if _turning(arm, pull, axis.number()) >= STILL:
            continue
        text = f"its weight does not turn '{model.name}' about this axis: nothing moves"
        better = next((way for way in AXES if _turning(arm, pull, way) >= STILL), None)
        help = "hold it beside its center of mass, by another `at`"
        if better is not None:
            seen = ", for a swing in the picture" if better == AXES[0] else ""
            help = f"write `axis: {' '.join(map(str, better))}`{seen}"
        found.warning("nothing-moves", text, axis.span or tie.span, help=help)


def _hangs(tie: Any, place: Sequence[float], pull: Sequence[float]) -> bool:
    """Whether a rod holds a body straight below a fixed point of the world, at a place above or below its middle."""
    ends = [getattr(tie, name, None) for name in ("from_", "to")]
    fixed = [end for end, ref in zip(ends, tie.between, strict=True) if not ref.name]
    own = [end for end, ref in zip(ends, tie.between, strict=True) if ref.name and end is not None]
    known = [end.number() for end in (*fixed, *own) if isinstance(end, Value) and end.constant]
    if len(fixed) != 1 or len(known) < len(fixed) + len(own):
        return False
    arms = [[float(c) - float(p) for c, p in zip(at, known[0], strict=True)] for at in (place, *known[1:])]
    along = [sum(a * b for a, b in zip(arm, pull, strict=True)) for arm in arms]
    return all(part > (1.0 - STILL) * hypot(*arm) * hypot(*pull) > 0.0 for part, arm in zip(along, arms, strict=True))


def _turning(arm: Sequence[float], pull: Sequence[float], axis: Sequence[float]) -> float:
    """The torque of a pull about an axis through the end of an arm, relative to the largest possible for its length."""
    (a, b, c), (u, v, w), (x, y, z) = arm, pull, axis
    torque = x * (b * w - c * v) + y * (c * u - a * w) + z * (a * v - b * u)
    return abs(torque) / (max(hypot(*arm), 1e-12) * max(hypot(*pull), 1e-12) * max(hypot(*axis), 1e-12))
