"""Mass-spring solids that fill an object: script fields, and the network made from them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any, Literal

from sceneql.bodies.nets import SIDES, Lattice, Net, neighbors, side_masks
from sceneql.doing import doing
from sceneql.island.memory import PLACE, bounded, bounded_net
from sceneql.kinds import FixedLength, FixedScalar, FixedTime, ObjectRef, Problem, Quantity, Record, field
from sceneql.quantities import dimension as dim

if TYPE_CHECKING:
    from numpy import bool_
    from numpy.typing import NDArray

    from sceneql.bodies.filling.fill import Inside
    from sceneql.frame import Floats
    from sceneql.system import Assembly

SHORT, LONG = 0.9, 1.2
"""Weights of the springs on the lattice's short and long edges, for which it is elastically isotropic."""
LEAST_MASS = 1e-200
"""[kg] Lighter masses are taken for mistakes: their inverses overflow."""
SPRINGS_A_MASS = 7
"""Springs per mass: short ones to 8 neighbors and long ones to 6, each shared by two masses."""


class Filling(Record):
    """Masses inside an object, up to its surface as tetrahedra, or at the places of a cubic grid as in a lattice.

    Tetrahedra are those of a body-centred lattice, whose masses are the corners and middles of cubes; near the surface
    they are moved to it or cut (Labelle & Shewchuk 2007), so that the outer masses lie on the surface. Springs run
    along their edges. With a ``modulus`` E each tetrahedron gives a spring of length L along each of its edges
    k = E volume / L^2 (Van Gelder 1998), 1.2 of it along the sides of cubes and 0.9 from their middles: in the small
    this is an isotropic solid with Young's modulus E and Poisson's ratio 1/4, and a finer one is the same solid. No
    spring resists that a tetrahedron turns inside out: what is squeezed to nothing may.
    """

    object: ObjectRef = field("The object; usually a hidden one.")
    spacing: FixedLength = field("Side of the cubes.", "0.1 m", above=0)
    cells: Literal["tetrahedra", "cubes"] = field("What the springs are the edges of.", "tetrahedra")
    shear: FixedScalar | None = field(
        "Of cubes: stiffness of the diagonals as a part of the edges'; 0 leaves them out; by default 1.",
        None,
        at_least=0,
    )
    density: Annotated[float, Quantity(dim.DENSITY)] | None = field(
        "Of tetrahedra: masses by what they hold, in place of masses all alike.", None, above=0
    )
    modulus: Annotated[float, Quantity(dim.PRESSURE)] | None = field(
        "Of tetrahedra: Young's modulus, in place of a stiffness of all springs alike.", None, above=0
    )

    retardation: FixedTime | None = field(
        "With a modulus: viscosity over modulus (Kelvin & Voigt), in place of a damping of all springs alike.",
        None,
        at_least=0,
    )

    def problems(self) -> Iterator[Problem]:
        """Problems: fields of the other kind of cells; masses too light; viscosity without a modulus."""
        others = ("shear",) if self.cells == "tetrahedra" else ("density", "modulus", "retardation")
        for name in others:
            if getattr(self, name) is not None:
                yield Problem(f"{self.cells} have no {name}", (name,), at_key=True)
        if self.density is not None and self.density * (self.spacing * self.spacing * self.spacing) < LEAST_MASS:
            yield Problem(f"masses of less than {LEAST_MASS:g} kg are too light", ("density",), at_key=True)
        if self.cells == "tetrahedra" and self.retardation is not None and self.modulus is None:
            yield Problem("a retardation needs a `modulus`", ("retardation",), at_key=True)

    def fastest(self, stiffness: float, damping: float, mass: float) -> tuple[float, float]:
        """Bounds on (angular frequency)^2 [1/s^2] and decay rate [1/s] of an infinite lattice.

        From the model's stiffness [N/m], damping [N s/m] and mass [kg]. Of tetrahedra a mass has springs to 8 cubes'
        centers and along 6 sides: nets.stiffest evaluated by hand. Masses near the surface may oscillate faster.
        """
        if self.cells == "cubes":
            factor = self._lattice().stiffest() / mass
            return factor * stiffness, factor * damping
        if self.density is not None:
            mass = self.density * (self.spacing * self.spacing * self.spacing) / 2
        factor = 2 * (8 / 3 + 2) / mass
        if self.modulus is None:
            return factor * stiffness, factor * damping
        springs = 8 / 3 * SHORT * 2 / 3 + 2 * LONG / 3  # [modulus times spacing]
        square = 2 * springs * self.modulus * self.spacing / mass
        return square, factor * damping if self.retardation is None else self.retardation * square

    def bounded(self, low: Floats, high: Floats) -> None:
        """Raise Exceeds where a box low..high [m] has too many lattice points to test."""
        import numpy as np

        from sceneql.bodies.filling.fill import grid_counts
        from sceneql.bodies.filling.stuffing import lattice_counts

        if self.cells == "cubes":
            grid_counts(low, high, self.spacing)
        else:
            bounded(2.0 * float(np.prod(lattice_counts(low, high, self.spacing))), "places of a lattice", PLACE)

    def net(self, assembly: Assembly) -> Net:
        """The network that fills the object.

        Raises ScriptError for an object that contains no two neighbors, LimitRefused for too many masses.
        """
        from sceneql.bodies.filling.fill import Inside

        with doing(f"filling {self.object.name}"):
            inside = Inside(self.object, assembly)
            inside.bounded(self.bounded, inside.low, inside.high)
            return self._cubes(inside) if self.cells == "cubes" else self._tetrahedra(inside)

    def _lattice(self) -> Lattice:
        return Lattice(count=(3, 3, 3), shear=1.0 if self.shear is None else self.shear)

    def _cubes(self, inside: Inside) -> Net:
        import numpy as np

        from sceneql.bodies.filling.fill import grid

        points, cells = grid(inside, self.spacing)
        shear = self._lattice().shear
        inside.bounded(bounded_net, len(points), len(points) * (13 if shear else 3))
        pairs, parts = neighbors(cells, shear)
        if not len(pairs):
            raise inside.refusal("no two neighbors of the grid lie in it; make the spacing smaller")
        return Net(
            points=points,
            pairs=pairs,
            stiffness=parts,
            places=side_masks(cells),
            fills=np.full(len(points), self.spacing**3),
            apart=self.spacing,
        )

    def _tetrahedra(self, inside: Inside) -> Net:
        import numpy as np

        from sceneql.bodies.filling.stuffing import stuffed
        from sceneql.bodies.filling.tetrahedra import boundary, edges, volumes

        def holds(places: Floats) -> NDArray[bool_]:
            held = inside.holds(places)
            count = float(np.count_nonzero(held))
            inside.bounded(bounded_net, count, SPRINGS_A_MASS * count)
            return np.asarray(held)

        made = stuffed(inside.low, inside.high, self.spacing, holds, inside.crossing)
        points, tetrahedra = made.points, made.tetrahedra
        if not len(tetrahedra):
            raise inside.refusal("no tetrahedron lies in it; make the spacing smaller")
        pairs, edge = edges(tetrahedra)
        held = volumes(points, tetrahedra)
        if not (held > 0.0).all():
            raise inside.refusal("so far from the origin its tetrahedra have no volume in double precision")
        masses = springs = None
        fills = np.zeros(len(points))
        np.add.at(fills, tetrahedra, 0.25 * held[:, None])
        if self.density is not None:
            masses = np.zeros(len(points))
            np.add.at(masses, tetrahedra, 0.25 * self.density * held[:, None])
        if self.modulus is not None:
            square = np.sum((points[pairs[:, 1]] - points[pairs[:, 0]]) ** 2, axis=1)
            weight = np.where(square[edge] > (0.95 * self.spacing) ** 2, LONG, SHORT)
            shares = np.where(made.whole[:, None], weight, 1.0) * held[:, None]
            springs = self.modulus * np.bincount(edge.ravel(), shares.ravel(), len(pairs)) / square
        return Net(
            points=points,
            pairs=pairs,
            stiffness=np.ones(len(pairs)),
            places=_sides(points, 0.25 * self.spacing),
            triangles=boundary(tetrahedra),
            tetrahedra=tetrahedra,
            masses=masses,
            springs=springs,
            dampers=None if springs is None or self.retardation is None else self.retardation * springs,
            fills=fills,
            apart=self.spacing,
        )


def _sides(points: Floats, depth: float) -> dict[str, Any]:
    """By the names of SIDES, masks (n,) of points (n, 3) within a depth [m] of the bounding box's sides."""
    low, high = points.min(axis=0) + depth, points.max(axis=0) - depth
    masks = [mask for axis in range(3) for mask in (points[:, axis] <= low[axis], points[:, axis] >= high[axis])]
    return dict(zip(SIDES, masks, strict=True))
