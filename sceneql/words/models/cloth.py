"""cloth: a sheet that resists stretching, shearing and bending."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any

from sceneql import kinds
from sceneql.bodies import bodies as point_masses
from sceneql.bodies.nets import CORNERS, EDGES, Net, stiffest, turned
from sceneql.bodies.nets import Cloth as Sheet
from sceneql.bodies.springs import SpringModel, pin_problems
from sceneql.kinds import Gives, Problem, Quantity, field
from sceneql.kinds.stable_step import Oscillation, StaticMass, StaticScene
from sceneql.quantities import dimension as dim

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Assembly


MOST_SHEAR = 4.0
"""Largest tearing strain of diagonals, relative to that of threads; below it they tear at the threads' tension."""


class Cloth(SpringModel):
    """A rectangle of cloth, whose weight and stiffnesses belong to the cloth: a finer mesh is the same cloth.

    Masses stand at the corners of the cells. Springs along the cells' sides carry the ``stretch``, a tension in N/m
    over the strain: k = stretch * width / length of the strip that a spring stands for. Springs along the diagonals
    carry the ``shear`` likewise (k = shear: exact for square cells), and springs over two cells resist folding (Provot
    1995). Damping is a part of the critical one of each spring with the masses at its ends, c = 2 damping sqrt(k m).
    """

    size: Annotated[tuple[float, float], Quantity(dim.LENGTH, (2,))] = field("Width and height.", "2 2 m", above=0)
    cells: tuple[int, int] = field("Cells across the width and the height.", (20, 20), at_least=1)
    center: kinds.FixedPosition = field("Where its middle starts.", "0 2 0 m")
    facing: kinds.Axis = field("Where its front faces: y lies flat, z hangs with its top up.", "0 1 0")
    rotation: kinds.Rotation | None = field("How it is turned besides, at the start.", None)
    mass: Annotated[float, Quantity(dim.MASS / dim.LENGTH / dim.LENGTH)] = field(
        "Mass of a square meter.", "0.2 kg/m^2", above=0
    )
    stretch: kinds.FixedStiffness = field("Tension, over a width, for a relative stretch.", "400 N/m", above=0)
    shear: kinds.FixedStiffness = field("Shear force, over a width, for a shear angle.", "40 N/m", at_least=0)
    bend: kinds.FixedStiffness = field("Stiffness over two cells, as that of `stretch`.", "4 N/m", at_least=0)
    damping: kinds.FixedScalar = field("Damping as a part of the critical one.", "0.02", at_least=0)
    thickness: kinds.FixedLength = field("Its thickness, in contacts and in the picture.", "5 mm", above=0)

    @classmethod
    def outputs(cls, written: Mapping[str, Any]) -> Mapping[str, Gives]:
        """Those of all masses, and of the corners by name: ``top_left.position``."""
        return {**cls.gives, **point_masses.named_outputs(dict.fromkeys(CORNERS))}

    def problems(self) -> Iterator[Problem]:
        """What is wrong with the sheet, and pins that are no mass of it."""
        yield from self._sheet().problems()
        yield from pin_problems(self.pins, (*EDGES, *CORNERS), self.mass_count())

    def faceless(self) -> str:
        """Of one that tears, whose faces would open."""
        return "tears" if self.tear is not None else ""

    def mass_count(self) -> int:
        """Number of masses."""
        return self._sheet().mass_count()

    def _sheet(self) -> Sheet:
        return Sheet.model_construct(
            size=self.size,
            cells=self.cells,
            center=self.center,
            facing=self.facing,
            shear=float(self.shear > 0),
            bend=float(self.bend > 0),
        )

    def static_masses(self) -> Mapping[str, StaticMass]:
        """One at a corner, a quarter of the others' mass."""
        wide, high = (side / cells for side, cells in zip(self.size, self.cells, strict=True))
        return {"": StaticMass(0.25 * self.mass * wide * high, None, self.velocity)}

    def fastest(self, name: str, scene: StaticScene) -> tuple[Oscillation, ...]:
        """Of a mass inside, by the springs around it: see `stiffest`."""
        wide, high = (side / cells for side, cells in zip(self.size, self.cells, strict=True))
        mass = self.mass * wide * high
        across, along = self.stretch * high / wide, self.stretch * wide / high
        bend = self.bend / self.stretch
        springs: list[tuple[tuple[float, ...], float]] = []
        for side in (-1.0, 1.0):
            springs += [((side, 0.0, 0.0), across), ((0.0, side, 0.0), along)]
            springs += [((side * wide, up * high, 0.0), self.shear) for up in (-1.0, 1.0)]
            springs += [((side, 0.0, 0.0), 0.5 * bend * across), ((0.0, side, 0.0), 0.5 * bend * along)]
        damped = [(way, 2.0 * self.damping * math.sqrt(0.5 * k * mass)) for way, k in springs]
        square, decay = (stiffest(these) / mass for these in (springs, damped))
        return (Oscillation(math.sqrt(square), decay, f"the springs of '{name}'", ("stretch",)),)

    def static_net(self) -> tuple[float, int]:
        """Its cells' shorter side."""
        return min(side / cells for side, cells in zip(self.size, self.cells, strict=True)), 2

    def make(self, assembly: Assembly) -> tuple[Net, Floats, Floats]:
        """The sheet with numbers by the areas that masses and springs stand for."""
        import numpy as np

        net = self._sheet().net()
        columns, rows = self.cells
        wide, high = self.size[0] / columns, self.size[1] / rows
        place = np.stack(np.divmod(np.arange(len(net.points)), rows + 1), axis=1)
        # Fraction of each mass's strip that lies inside the cloth, across and along.
        parts = np.where((place == 0) | (place == (columns, rows)), 0.5, 1.0)
        weights = self.mass * wide * high * parts.prod(axis=1)
        a, b = net.pairs.T
        step = place[b] - place[a]
        along, across = np.abs(step[:, 0]) * wide, np.abs(step[:, 1]) * high
        level, upright = step[:, 1] == 0, step[:, 0] == 0
        length = np.hypot(along, across)
        modulus = np.where(np.abs(step).max(axis=1) == 2, self.bend, self.stretch)
        strip = np.where(level, high * parts[a, 1], wide * parts[a, 0])
        stiffness = np.where(level | upright, modulus * strip / length, self.shear)
        critical = 2 * np.sqrt(stiffness * weights[a] * weights[b] / (weights[a] + weights[b]))
        zero = np.zeros(len(length))
        diagonal = ~(level | upright)
        softer = min(max(self.stretch / self.shear, 1.0), MOST_SHEAR) if self.shear > 0 else 1.0
        net = replace(net, toughness=np.where(diagonal, softer, 1.0))
        if self.rotation is not None:
            net = replace(net, points=turned(net.points, self.center, assembly.initial(self.rotation)))
        return net, weights, np.column_stack([length, stiffness, zero, self.damping * critical, zero])

    def mass_radius(self) -> float:
        """Half its thickness [m]."""
        return 0.5 * self.thickness if self.radius is None else self.radius
