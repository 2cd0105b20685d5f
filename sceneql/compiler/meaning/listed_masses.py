"""Errors of listed masses that collide with one another and overlap at the start."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import combinations
from math import dist
from typing import Any

from sceneql.graph import Island, Task
from sceneql.kinds import Contact
from sceneql.quantities.diagnostic import Diagnostics

MOST = 400
"""Largest number of masses that are compared with one another."""
DEFAULT = 0.05
"""Radius [m] of a mass that says none."""
ROUNDING = 1e-6
"""Depth relative to the radii up to which masses only touch."""


def report_masses(tasks: Mapping[str, Task], groups: tuple[Island, ...], found: Diagnostics) -> None:
    """Report listed masses that collide with one another and overlap at the start."""
    for island in groups:
        mutual = {name for name, _, _ in island.contacts if _mutual(tasks[name])}
        for contact in mutual:
            models = [model for name, model, _ in island.contacts if name == contact]
            masses = [one for model in models for one in _listed(tasks[model])]
            for (a, x, r), (b, y, s) in combinations(masses, 2) if len(masses) <= MOST else ():
                depth = r + s - dist(x, y)
                if depth > ROUNDING * (r + s):
                    text = f"'{a}' and '{b}' overlap by {depth:.3g} m at the start, and collide"
                    help = f"move them {r + s:.3g} m apart, or make them smaller"
                    found.error("masses-overlap", text, tasks[a.partition(".")[0]].span, help=help)
                    return


def _mutual(task: Task) -> bool:
    return isinstance(task.kind, Contact) and task.kind.mutual


def _listed(task: Task) -> Iterator[tuple[str, tuple[float, ...], float]]:
    """Names, places [m] and radii [m] of the listed masses of a model that may move."""
    kind: Any = task.kind
    default = DEFAULT if getattr(kind, "radius", None) is None else kind.radius
    for name, one in (getattr(kind, "list", None) or {}).items():
        if not one.fixed:
            yield f"{task.name}.{name}", one.position, default if one.radius is None else one.radius
