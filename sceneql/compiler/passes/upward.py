"""Warnings of scripts in which z is up: here y is, for the ground, cameras and lights."""

from __future__ import annotations

from collections.abc import Mapping
from typing import cast

from sceneql.compiler.passes.fillings import Beginning
from sceneql.compiler.passes.overlaps import UNKNOWN
from sceneql.compiler.passes.unseen import ground_level
from sceneql.graph import Task
from sceneql.kinds import Camera, Interaction, Model, Moment, Object, Value
from sceneql.quantities.diagnostic import Diagnostics

EVEN = 0.1
"""Part of its height by which the middle of an object may lie beside its position."""
MOSTLY = 0.9
"""Part of a vector's length along z from which on it is taken for up or down."""


def warn_of_z_up(tasks: Mapping[str, Task], found: Diagnostics) -> None:
    """Warn of a weight along z, unless a camera or a ground has z upwards, too, or another weight has not."""
    ups = [getattr(task.kind, "up", None) for task in tasks.values() if isinstance(task.kind, Camera)]
    ups += [getattr(task.kind, "normal", None) for task in tasks.values() if getattr(task.kind, "grounds", False)]
    weights = [task.kind for task in tasks.values() if isinstance(task.kind, Interaction) and task.kind.weighs]
    along = [any(_along_z(getattr(one, field, None)) for field in ("acceleration", "direction")) for one in weights]
    if any(_along_z(up) for up in ups) or not all(along):
        return
    for task in tasks.values():
        if not (isinstance(task.kind, Interaction) and task.kind.weighs):
            continue
        given = [getattr(task.kind, field, None) for field in ("acceleration", "direction")]
        for value in filter(_along_z, given):
            text = f"'{task.name}' pulls along z, but y is up here: the ground lies in x and z, cameras stand upright"
            help = "write places as `x y z` with y for the height, and leave the direction out: gravity is along -y"
            found.warning("z-up", text, getattr(value, "span", None) or task.span, help=help)


def warn_of_z_high(tasks: Mapping[str, Task], found: Diagnostics) -> None:
    """Warn of objects that fall, start with their middle in the ground, and are high along z."""
    level, start = ground_level(tasks), cast(Moment, Beginning(tasks))
    weighs = any(isinstance(task.kind, Interaction) and task.kind.weighs for task in tasks.values())
    if level is None or not weighs:
        return
    for model in [task.kind for task in tasks.values() if isinstance(task.kind, Model) and not task.kind.kinematic]:
        for name in model.drives():
            kind = tasks[name].original if name in tasks else None
            position = getattr(kind, "position", None)
            if not isinstance(position, Value) or not position.constant:
                continue
            x, y, z = (float(one) for one in position.number())
            if y <= level < z and _in_the_middle(cast(Object, kind), y, start):
                text = f"'{name}' starts with its middle in the ground, and {z:g} m along z: y is up here"
                help = f"write `position: {x:g} {z:g} {y:g} m`"
                found.warning("z-up", text, position.span or tasks[name].span, help=help)


def _in_the_middle(kind: Object, height: float, start: Moment) -> bool:
    """Whether an object reaches as far below a height [m] as above; of a group, or one above its place, it is not."""
    import numpy as np

    try:
        low, high = kind.extent(np.eye(3, 4), start)
    except UNKNOWN:
        return False
    return bool(abs(0.5 * (low[1] + high[1]) - height) < EVEN * (high[1] - low[1]))


def _along_z(value: object) -> bool:
    if not isinstance(value, Value) or not value.constant:
        return False
    x, y, z = (float(one) for one in value.number())
    length = (x * x + y * y + z * z) ** 0.5
    return bool(abs(z) > MOSTLY * length > 0)


def warn_of_rising(tasks: Mapping[str, Task], found: Diagnostics) -> None:
    """Warn of the only weight of a script where it points upwards, along y."""
    weights = [task for task in tasks.values() if isinstance(task.kind, Interaction) and task.kind.weighs]
    ups = [getattr(task.kind, "up", None) for task in tasks.values() if isinstance(task.kind, Camera)]
    if any(isinstance(up, Value) and up.constant and up.number()[1] < 0.0 for up in ups):
        return  # y points downwards there
    for task in weights if len(weights) == 1 else ():
        for field in ("acceleration", "direction"):
            value = getattr(task.kind, field, None)
            if isinstance(value, Value) and value.constant:
                x, y, z = (float(one) for one in value.number())
                if y > MOSTLY * (x * x + y * y + z * z) ** 0.5 > 0:
                    help = "what pulls down points along -y: write `0 -1 0`, or leave it out"
                    help = (
                        help if field == "direction" else f"what pulls down points along -y: write `0 {-y:g} 0 m/s^2`"
                    )
                    text = f"'{task.name}' pulls upwards: all that weighs rises"
                    found.warning("rises", text, value.span or task.span, help=help)
