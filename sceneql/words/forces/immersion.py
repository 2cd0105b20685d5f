"""immersion: skins and masses in a flow, which moves them and takes up their forces."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, Literal

from sceneql.grids.domain.cells import counts
from sceneql.kinds import Force, ModelRef, Problem, Ref, field
from sceneql.kinds.stable_step import Oscillation, StaticScene

if TYPE_CHECKING:
    from sceneql.system import Assembly, Bodies


SMOOTH = 0.6
"""Fastest swing in the flow of a net much finer than cells, over (distance of masses/cell) times that without fluid."""
BESIDE = 2.5
"""Width [cells] of the fluid that moves along with a net, along each axis across it."""


def swing(name: str, net: Any, density: float, cell: float, axes: int, depth: float, scene: StaticScene) -> float:
    """Estimate of the fastest oscillation or decay [1/s] of masses in a flow, with the fluid that moves along.

    ``net``: the model of the masses; ``density`` [kg/m^3] of the fluid; ``cell`` and ``depth`` [m] and ``axes`` of the
    flow. Compared with the largest eigenvalues (skins/immersed_masses.py), the estimate is at most 1.3 times too large
    for nets finer than half a cell (tests/test_immersed_masses.py).
    """
    modes = tuple(net.fastest(name, scene))
    alone, damped = max((one.frequency for one in modes), default=0.0), max((one.decay for one in modes), default=0.0)
    mass = min((one.mass for one in net.static_masses().values()), default=0.0)
    spread = net.static_net()
    if spread is None:
        return max(alone, damped)
    apart, along = spread
    fluid = density * apart**along * depth * (BESIDE * cell) ** max(axes - along, 0)
    share = mass / (mass + fluid) if along < axes and mass > 0.0 else 1.0
    smooth = min(1.0, SMOOTH * apart / cell) * share**0.5
    return float(max(alone * smooth, damped * smooth**2))


class Immersion(Force):
    """What is in a `flow`, both ways: a skin (`membrane`), or masses (`mass_spring`, `cloth`), move as the fluid there.

    Velocities are read from faces and forces spread to them by the same composite B-splines, of order 4 along a
    component and 3 across, so that what is read is free of divergence, and no fluid passes the skin. Beside walls faces
    are continued by reflection. Where a skin holds a fluid of its own (`filling`), faces count by their mass besides,
    so that the skin goes with the heavy one. Sources: Peskin (2002), Acta Numerica 11, 479-517; Gruninger & Griffith
    (2025).

    The inertia of masses is part of the fluid's around: what they weigh is spread by the same splines, and takes its
    momentum along. A `solid`, and a `lattice` of layers, or of one layer in a flat flow, displace fluid: of their mass
    counts what it is more or less than that of the fluid, and `gravity` has that sink or rise. Cloth, ropes and single
    masses displace none. What is held by `pins` stays, and fluid goes past. Forces reach some cells far, so a body is
    half a cell to one wider for the fluid than its masses are: what sinks in syrup is slower by as much. Rigid bodies
    and finite elements are not immersed: a flow goes `around` objects. Source: Zhu & Peskin (2002), J. Comput. Phys.
    179, 452-468.

    `forces: [{immersion: {on: [balloon], in: air}}]`
    """

    in_: ModelRef = field("The `flow`.")
    kernel: Literal["splines", "peskin"] = field(
        "What reads and spreads: composite splines, or to compare Peskin's kernel of four points, which leaks.",
        "splines",
    )

    def problems(self) -> Iterator[Problem]:
        """Nothing."""
        if not self.on:
            yield Problem("an immersion names the skins and masses in the flow: `on: [balloon]`")

    def carrier(self) -> Ref:
        """The flow."""
        return self.in_

    def fastest_carried(self, models: Mapping[str, Any], flow: Any, scene: StaticScene) -> Iterator[Oscillation]:
        """The fastest waves of each skin that the flow's cells know; viscosity takes a quarter of its largest rate."""
        size, axes = flow.size, 2 if flow.flat else 3
        cell = flow.cell
        if size is not None:
            cell, axes = min(side / n for side, n in zip(size, counts(size, cell), strict=False)), len(size)
        decay = flow.thickest() / flow.density * axes / cell**2
        filled = any(model.carried and model.fluid() is not None for model in models.values())
        for name, model in models.items():
            if model.carried:
                inside = (model.fluid() or (flow.density, 0.0))[0]
                what, weight = f"the skin '{name}' in cells of {cell:g} m", 0.5 * (flow.density + inside) * cell**3
                turn = (model.largest_tension(cell) / weight) ** 0.5
                yield Oscillation(0.0, decay, what, ("on",), turn, tension=axes == 2 and not filled)
                continue
            turn = swing(name, model, flow.density, cell, axes, flow.depth if axes == 2 else 1.0, scene)
            yield Oscillation(0.0, decay, f"the springs of '{name}' in cells of {cell:g} m", ("on",), turn)

    def assemble(self, name: str, assembly: Assembly, bodies: Bodies) -> None:
        """Have the flow carry masses; where it could not be made nothing is to do."""
        from sceneql.skins.immersed_masses import immerse_masses

        flow = assembly.flow_of(self.in_.name)
        if flow is not None and bodies.immersed is not None:
            immerse_masses(flow, bodies, self.kernel == "peskin", assembly)

    def assemble_carried(self, name: str, assembly: Assembly, model: str) -> None:
        """Have the flow carry a skin; where one of them could not be made nothing is to do."""
        from sceneql.skins.immersed import immerse

        skin, flow = assembly.membrane_of(model), assembly.flow_of(self.in_.name)
        if skin is not None and flow is not None:
            immerse(flow, skin, self.kernel == "peskin", assembly)
