"""Warnings of objects that stand where a mass starts, and do not follow it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import dist

from sceneql.graph import Task
from sceneql.kinds import Contact, Model, Object, Value
from sceneql.quantities.diagnostic import Diagnostics

NEAR = 1e-9
"""Distance, over that of a mass from the origin, below which an object stands where a mass starts."""


def warn_of_left_behind(tasks: Mapping[str, Task], found: Diagnostics) -> None:
    """Warn of each visible object whose written place is that of a mass that may move."""
    inner = {ref.name for task in tasks.values() if isinstance(task.kind, Object) for ref in task.kind.members()}
    inner |= {ref.name for task in tasks.values() if isinstance(task.kind, Contact) for ref in task.kind.ties()}
    inner |= {need for task in tasks.values() if isinstance(task.kind, Model) for need in task.needs}
    masses = [(f"{task.name}.{name}", place) for task in tasks.values() for name, place in _free(task)]
    for task in tasks.values() if masses else ():
        place = getattr(task.kind, "position", None)
        if not isinstance(task.kind, Object) or task.kind.hidden or task.original or task.name in inner:
            continue
        if not isinstance(place, Value) or not place.constant or place.span is None or not any(place.number()):
            continue
        for mass, start in masses:
            if dist(start, place.number()) <= NEAR * max(map(abs, start)):
                text = f"'{task.name}' stands where '{mass}' starts, and stays there when that moves"
                found.warning("left-behind", text, place.span, help=f"to follow it write `position: {mass}.position`")
                break


def warn_of_one_place(tasks: Mapping[str, Task], found: Diagnostics) -> None:
    """Warn of copies of an object that all stand in one place, where only one of them is seen."""
    copies: dict[str, list[Task]] = {}
    for task in tasks.values():
        name, _, number = task.name.rpartition(".")
        place = getattr(task.kind, "position", None)
        still = isinstance(place, Value) and place.constant and place.span is not None
        if (
            isinstance(task.kind, Object)
            and name
            and number.isdecimal()
            and still
            and not (task.kind.hidden or task.original)
        ):
            copies.setdefault(name, []).append(task)
    for name, several in copies.items():
        looks = [task.kind.model_copy(update={"color": None, "material": None}) for task in several]
        if len(several) > 1 and all(one == looks[0] for one in looks):
            text = f"all {len(several)} copies of '{name}' stand in one place"
            help = "let the copy's number stand in `position`, as `[i*(0.5 m), 0 m, 0 m]`"
            place = getattr(several[0].kind, "position", None)
            if isinstance(place, Value) and place.span is not None and "random" in place.span.text:
                help = "let the copy's number stand in its chance: `random(i)`, in another component `random(i, 1)`"
            found.warning("one-place", text, several[0].span, help=help)


def _free(task: Task) -> Iterator[tuple[str, tuple[float, ...]]]:
    """Names and places of the masses of a model that are listed by name and not fixed."""
    if not isinstance(task.kind, Model) or task.kind.kinematic:
        return
    pinned = set(getattr(task.kind, "pins", None) or ())
    for name in ("list", "masses"):
        for one, mass in (getattr(task.kind, name, None) or {}).items():
            if not mass.fixed and one not in pinned:
                yield one, mass.position
