"""Masses immersed in a flow: they move with its velocity, and their inertia is added to the fluid's."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.system import Bodies, Immersed, Membrane

if TYPE_CHECKING:
    from sceneql.bodies.nets import Net
    from sceneql.frame import Floats
    from sceneql.system import Assembly, Flow

LIGHTEST = 0.2
"""Least mass of a solid relative to the displaced fluid's. Masses do not fill cells evenly, so lighter ones would leave
cells without inertia."""
WITHIN = 1e-9
"""Distance from the plane of a flat flow that counts as rounding, in cells."""


def reserve(
    name: str,
    assembly: Assembly,
    net: Net,
    velocities: Floats,
    masses: Floats,
    radii: Floats,
    fixed: Any,
    pull: float,
    flow: Flow,
) -> Bodies:
    """Put n masses that move with a flow into the state; forces on them are spread to the fluid around them.

    ``velocities`` (n, 3) [m/s], not zero only for fixed masses; ``masses`` (n,) [kg]; ``radii`` (n,) [m]; ``fixed``
    (n,) bool; ``pull`` [J]: sum of stiffness times squared length of the springs. Raises ScriptError for masses that
    are too light, too far apart, outside the flow, or in its obstacles.
    """
    import numpy as np

    n, cell = len(masses), min(flow.spacing[: len(flow.areas)])
    fills = _fills(name, net, flow, assembly)
    displaced = flow.density * fills
    if masses.sum() < LIGHTEST * displaced.sum():
        text = f"'{name}' is {masses.sum() / displaced.sum():.2g} times as heavy as the fluid that it displaces: "
        text += f"a flow carries no solid lighter than {LIGHTEST:g} times that"
        help = "take a `membrane` with a `filling` of that density"
        raise ScriptError([Diagnostic("invalid", text, assembly.line(), help)])
    _must_fit(name, net, flow, cell, assembly)
    if velocities[~np.asarray(fixed)].any():
        text = f"'{name}' is carried by a flow, and so moves as that does at the start: it has no velocity of its own"
        help = "leave `velocity` and `spin` out; the flow's `initial` has one"
        raise ScriptError([Diagnostic("invalid", text, assembly.line(), help)])
    position_at = assembly.state(net.points)
    velocity_at = assembly.state(np.append(velocities, 0.0))
    assembly.follows(velocity_at, 3 * n + 1)
    faces = np.asarray(net.pairs if net.triangles is None else net.triangles, dtype=np.int64)
    across = net.apart or cell
    shares = np.full(n, across * flow.spacing[2] if len(flow.areas) == 2 else across * across)
    # Pressure scale: the springs' modulus, over a layer of one cell if the net fills no volume; else the weight.
    pressure = 0.5 * pull / (fills.sum() or shares.sum() * cell) or 9.81 * masses.sum() / shares.sum()
    return Bodies(
        model=name,
        count=n,
        position_at=position_at,
        velocity_at=velocity_at,
        work_at=velocity_at + 3 * n,
        mass_at=assembly.floats(masses),
        inverse_at=assembly.floats(np.divide(1.0, masses, out=np.zeros(n), where=~np.asarray(fixed))),
        radius_at=assembly.floats(radii),
        immersed=Immersed(
            Membrane(n, position_at, assembly.floats(np.zeros(3 * n)), faces, shares, pressure, cell),
            assembly.floats(masses - displaced),
        ),
    )


def must_hold(pins: Any, assembly: Assembly) -> None:
    """Raise ScriptError for pins (of a model's field) that release their masses during the run."""
    for pin, how in pins.items() if isinstance(pins, dict) else ():
        if how.until is not None:
            text = f"the pin '{pin}' lets go of masses that a flow carries, which would move at once as it does"
            raise ScriptError([Diagnostic("invalid", text, assembly.line(), "leave its `until` out")])


def _fills(name: str, net: Net, flow: Flow, assembly: Assembly) -> Floats:
    """Volumes (n,) [m^3] of fluid that the masses displace. Raises ScriptError for masses off a flat flow's plane."""
    import numpy as np

    if len(flow.areas) == 3:
        return np.zeros(len(net.points)) if net.fills is None or net.layer else net.fills
    if np.abs(net.points[:, 2]).max() > WITHIN * flow.spacing[0]:
        text = f"masses of '{name}' stand off the plane z = 0, and its flow is flat"
        help = "take masses in that plane, as a `lattice` of one layer, or a deep flow, whose `size` has three sides"
        raise ScriptError([Diagnostic("invalid", text, assembly.line(), help)])
    return np.zeros(len(net.points)) if net.fills is None else net.fills * flow.spacing[2]


def _must_fit(name: str, net: Net, flow: Flow, cell: float, assembly: Assembly) -> None:
    """Raise ScriptError where masses are outside their flow or in its obstacles, or farther apart than a cell."""
    import numpy as np

    if net.apart > cell * (1.0 + WITHIN):
        text = f"masses of '{name}' {net.apart:.3g} m apart are too coarse for cells of {cell:.3g} m: "
        text += "fluid would pass between them"
        help = f"let them be {cell:.3g} m apart or less, better half of that"
        raise ScriptError([Diagnostic("invalid", text, assembly.line(), help)])
    for axis in range(len(flow.areas)):
        first, last = flow.low[axis], flow.low[axis] + flow.cells.shape[axis] * flow.spacing[axis]
        low, high = net.points[:, axis].min(), net.points[:, axis].max()
        if not flow.cells.periodic[axis] and (low < first or high > last):
            text = f"'{name}' stands outside its flow, which ends at {'xyz'[axis]} = "
            text += f"{first if low < first else last:g} m"
            raise ScriptError([Diagnostic("invalid", text, assembly.line(), "move it inside, or take a larger `size`")])
    if flow.fractions is None:
        return
    shape, axes = flow.cells.shape, len(flow.areas)
    at = [np.floor((net.points[:, k] - flow.low[k]) / flow.spacing[k]).astype(int) % shape[k] for k in range(axes)]
    number = at[0] + shape[0] * (at[1] + shape[1] * (at[2] if axes == 3 else 0))
    shut = np.flatnonzero(np.asarray(flow.fractions)[number] == 0.0)
    if len(shut):
        x, y, z = net.points[shut[0]]
        text = f"'{name}' stands where its flow has no fluid, at ({x:.4g}, {y:.4g}, {z:.4g}) m"
        raise ScriptError([Diagnostic("invalid", text, assembly.line(), "move it to where the fluid is")])
