"""Masses that rigid bodies collide with: their rows among the bodies, and the surfaces that they meet."""

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
"""Masses above which no step is cut at an impact: looking costs more than it gives."""


@dataclass(frozen=True, slots=True)
class Solid:
    """What masses meet."""

    number: int
    """Among the shapes of the step."""
    ref: Ref
    center: Floats
    """(3,) the center of mass in the axes of its object [m]."""
    place: Floats
    """(7,) center of mass and quaternion at the start."""


def masses_of(everyone: Sequence[Bodies], thickness: float, assembly: Assembly) -> Masses:
    """The masses of a contact, with their tally and memory; bounds the steps that a tolerance chooses."""
    from sceneql.contacts.impact_kernels import MOST_CUTS

    # Impulses at the end of a step are to springs as an explicit method is: stable up to 2 / (2 pi / period).
    longest = min(bodies.springs.period if bodies.springs else math.inf for bodies in everyone) / math.pi
    assembly.step_at_most(longest)
    few = sum(bodies.count for bodies in everyone) <= MOST_CUT
    cuts = [0.0, 0.0, 0.0] if few else [float("inf"), 0.0, float(MOST_CUTS)]
    nan = float("nan")
    return Masses(everyone, thickness, assembly.floats([0.0, nan, nan, 0.0, nan]), assembly.floats([*cuts, longest, 0]))


@dataclass(frozen=True, slots=True)
class Masses:
    """The models of masses of a contact."""

    everyone: Sequence[Bodies]
    thickness: float
    """Distance to keep besides the radii [m]."""
    tally_at: int
    """Offset of the tally of impacts."""
    memory_at: int
    """Offset of the memory of mass_points_kernels."""

    def rows(self, assembly: Assembly) -> list[tuple[int, ...]]:
        """The integers of the masses as bodies of the step (velocity_step_kernels).

        Raises ScriptError for masses that ties hold.
        """
        # Nothing turns them: any inertia does.
        inertia_at = assembly.floats([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
        found: list[tuple[int, ...]] = []
        for bodies in self.everyone:
            must_be_free(bodies.model, assembly)
            for k in range(bodies.count):
                x, v = bodies.position_at + 3 * k, bodies.velocity_at + 3 * k
                found.append((x, v, -1, -1, bodies.mass_at + k, inertia_at, bodies.work_at))
        return found

    def written(self, at: int, first: int, solids: Sequence[Solid], assembly: Assembly) -> list[int]:
        """The integers of mass_near_kernels, to stand at ``at``; ``first``: number of the first mass.

        Raises ScriptError for masses that start inside a solid, and for one that cannot be collided with.
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
    """The integers of surfaces, to stand at ``at``, and behind them those of their shapes."""
    heads: list[int] = []
    tail: list[int] = []
    for head, data in surfaces:
        heads += [*head, at + layout.OBJECT * len(surfaces) + len(tail)]
        tail += data
    return heads + tail
