"""Masses in contacts with rigid bodies: their rows among the bodies, and the surfaces they collide with."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sceneql.contacts import layout
from sceneql.contacts.colliders import must_be_free, must_be_outside, surface_of

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.kinds import Ref
    from sceneql.system import Assembly, Bodies

MOST_CUT = 4096
"""Number of masses above which no step is cut at an impact: the search costs more than it gains."""


@dataclass(frozen=True, slots=True)
class Solid:
    """Solid that masses collide with."""

    number: int
    """Index among the shapes of the step."""
    ref: Ref
    center: Floats
    """(3,) [m]: center of mass in the axes of its object."""
    place: Floats
    """(7,): center of mass [m] and quaternion at the start."""


def masses_of(everyone: Sequence[Bodies], thickness: float, assembly: Assembly) -> Masses:
    """Masses of a contact, with their tally and memory; also bounds adaptive steps by the springs' shortest period."""
    from sceneql.contacts.impact_kernels import MOST_CUTS

    # For springs, impulses at the end of a step act as an explicit method: stable up to 2 / (2 pi / period).
    longest = min(bodies.springs.period if bodies.springs else math.inf for bodies in everyone) / math.pi
    assembly.step_at_most(longest)
    few = sum(bodies.count for bodies in everyone) <= MOST_CUT
    cuts = [0.0, 0.0, 0.0] if few else [float("inf"), 0.0, float(MOST_CUTS)]
    nan = float("nan")
    return Masses(everyone, thickness, assembly.floats([0.0, nan, nan, 0.0, nan]), assembly.floats([*cuts, longest, 0]))


@dataclass(frozen=True, slots=True)
class Masses:
    """Models of masses in a contact."""

    everyone: Sequence[Bodies]
    thickness: float
    """Distance kept in addition to the radii [m]."""
    tally_at: int
    """Offset of the tally of impacts."""
    memory_at: int
    """Offset of the memory of mass_points_kernels."""

    def rows(self, assembly: Assembly) -> list[tuple[int, ...]]:
        """Integers of the masses as bodies of the step (velocity_step_kernels).

        Raises ScriptError for masses with ties.
        """
        # Masses do not turn: the inertia is arbitrary.
        inertia_at = assembly.floats([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
        found: list[tuple[int, ...]] = []
        for bodies in self.everyone:
            must_be_free(bodies.model, assembly)
            for k in range(bodies.count):
                x, v = bodies.position_at + 3 * k, bodies.velocity_at + 3 * k
                found.append((x, v, -1, -1, bodies.mass_at + k, inertia_at, bodies.work_at))
        return found

    def written(self, at: int, first: int, solids: Sequence[Solid], assembly: Assembly) -> list[int]:
        """Integers of mass_near_kernels, to stand at index ``at``; ``first``: number of the first mass.

        Raises ScriptError for masses that start inside a solid, and for a solid without a collider.
        """
        from sceneql.contacts.distance import mass_near_kernels as kernels

        surfaces_at = kernels.HEAD + kernels.MODEL * len(self.everyone)
        objects_at = surfaces_at + kernels.TOUCHED * len(solids)
        records: list[int] = []
        surfaces = []
        for k, solid in enumerate(solids):
            head, data, relative = surface_of(solid.ref, solid.center, solid.place, assembly)
            surfaces.append((head, data))
            records += [solid.number, assembly.floats(relative), at + objects_at + layout.OBJECT * k]
        models: list[int] = []
        for bodies in self.everyone:
            models += [first, bodies.count, bodies.position_at, bodies.velocity_at]
            models += [bodies.inverse_at, bodies.mass_at, bodies.radius_at, bodies.work_at]
            first += bodies.count
            here = (bodies.position_at, *(0 for _ in range(layout.INVERSE - 1)), bodies.inverse_at, 0, bodies.count)
            spare = (0 for _ in range(layout.OBJECTS - layout.BODIES - 1))
            ints = (*here, *spare, len(surfaces), *_laid(surfaces, layout.HEAD))
            must_be_outside(bodies.model, [solid.ref for solid in solids], ints, assembly)
        begin = [len(self.everyone), assembly.floats([self.thickness]), self.memory_at, self.tally_at]
        begin += [len(solids), at + surfaces_at]
        return [*begin, *models, *records, *_laid(surfaces, at + objects_at)]


def _laid(surfaces: Sequence[tuple[tuple[int, ...], tuple[int, ...]]], at: int) -> list[int]:
    """Integers of surfaces, to stand at index ``at``, followed by the data of their shapes."""
    heads: list[int] = []
    tail: list[int] = []
    for head, data in surfaces:
        heads += [*head, at + layout.OBJECT * len(surfaces) + len(tail)]
        tail += data
    return heads + tail
