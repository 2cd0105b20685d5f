"""Point masses in an island: allocation of their state, and the outputs common to all models of masses and bodies."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from sceneql.kinds import Gives, quantity_type
from sceneql.quantities import dimension as dim
from sceneql.quantities.expression import Type

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.quantities.span import Span
    from sceneql.system import Assembly, Bodies, ModelState

ANGULAR_MOMENTUM = dim.MOMENTUM * dim.LENGTH

BODY_OUTPUTS: Mapping[str, Gives] = {
    "positions": Gives(quantity_type(dim.LENGTH, (None, 3)), "Where the masses are."),
    "velocities": Gives(quantity_type(dim.VELOCITY, (None, 3)), "How fast they move."),
    "accelerations": Gives(quantity_type(dim.ACCELERATION, (None, 3)), "How fast that changes.", computed=True),
    "radii": Gives(quantity_type(dim.LENGTH, (None,)), "Their radii in contacts.", computed=True),
    "kinetic": Gives(quantity_type(dim.ENERGY), "Kinetic energy.", computed=True),
    "potential": Gives(quantity_type(dim.ENERGY), "Potential energy in the forces and springs.", computed=True),
    "dissipated": Gives(quantity_type(dim.ENERGY), "Energy that damping, drag and impacts have taken out.", tally=True),
    "energy": Gives(
        quantity_type(dim.ENERGY), "Kinetic, potential and dissipated energy: conserved if all is right.", computed=True
    ),
    "momentum": Gives(quantity_type(dim.MOMENTUM, (3,)), "Sum of mass times velocity.", computed=True),
    "angular_momentum": Gives(quantity_type(ANGULAR_MOMENTUM, (3,)), "About the origin.", computed=True),
    "center": Gives(quantity_type(dim.LENGTH, (3,)), "Center of mass."),
    "count": Gives(Type(), "Number of masses.", computed=True),
}

MASS_OUTPUTS: Mapping[str, Gives] = {
    "position": Gives(quantity_type(dim.LENGTH, (3,)), "Where it is."),
    "velocity": Gives(quantity_type(dim.VELOCITY, (3,)), "How fast it moves."),
    "acceleration": Gives(quantity_type(dim.ACCELERATION, (3,)), "How fast that changes.", computed=True),
}
"""Outputs of a single mass, under its own name: ``bob.position``."""


def named_outputs(written: Any) -> dict[str, Gives]:
    """The outputs of named masses; ``written`` is the field that names them, as plain nested dicts."""
    names = written if isinstance(written, Mapping) else {}
    return {f"{name}.{output}": gives for name in names for output, gives in MASS_OUTPUTS.items()}


def reserve(
    name: str,
    assembly: Assembly,
    positions: Floats,
    velocities: Floats,
    masses: Floats,
    radii: Floats,
    fixed: Any,
    spans: Sequence[Span | None] | None = None,
    inertia: Any = None,
) -> Bodies:
    """Put n masses into the state, with the closing term that divides forces [N] by masses.

    ``positions`` and ``velocities`` (n, 3) [m], [m/s]; ``masses`` (n,) [kg]; ``radii`` (n,) [m]; ``fixed`` (n,) bool.
    ``inertia``: a sparse mass matrix (3 n, 3 n) [kg] to solve with instead; ``masses`` are then the lumped ones.
    """
    import numpy as np

    from sceneql.system import Bodies, Slopes

    n = len(masses)
    start = np.concatenate([np.ravel(positions), np.ravel(velocities), [0.0]])
    position_at = assembly.state(start, spans)
    velocity_at = position_at + 3 * n
    assembly.pair(position_at, velocity_at, 3 * n)
    bodies = Bodies(
        model=name,
        count=n,
        position_at=position_at,
        velocity_at=velocity_at,
        work_at=position_at + 6 * n,
        mass_at=assembly.floats(masses),
        inverse_at=assembly.floats(np.divide(1.0, masses, out=np.zeros(n), where=~np.asarray(fixed))),
        radius_at=assembly.floats(radii),
    )
    if inertia is not None:
        from sceneql.bodies import consistent

        consistent.close(assembly, bodies, inertia)
        return bodies
    ints = (position_at, velocity_at, n, bodies.inverse_at)
    assembly.inertia(velocity_at, bodies.inverse_at, n)
    places = np.arange(3 * n)
    slopes = Slopes("sceneql.bodies.bodies_slopes_kernels:close", position_at + places, velocity_at + places)
    assembly.term("close", "sceneql.bodies.bodies_kernels:close", ints, slopes, apart=True, energy="")
    return bodies


def reserve_part(assembly: Assembly, whole: Bodies, state: ModelState, first: int, last: int) -> Bodies:
    """Put the masses first..last-1 of ``whole`` into the state of a block of the island (kinds.Model.assemble_part)."""
    here = slice(first, last)
    inverse = state.floats[whole.inverse_at : whole.inverse_at + whole.count]
    return reserve(
        whole.model,
        assembly,
        positions(whole, state)[here],
        velocities(whole, state)[here],
        masses(whole, state)[here],
        radii(whole, state)[here],
        inverse[here] == 0.0,
    )


def own_blocks(bodies: Bodies, column_at: int) -> tuple[Any, Any]:
    """First rows and first columns (n,) of the 3x3 Jacobian blocks of each body's force by its own state.

    For Slopes of a force on each body that depends on this body alone; ``column_at``: position_at or velocity_at.
    """
    import numpy as np

    first = 3 * np.arange(bodies.count)
    return bodies.velocity_at + first, column_at + first


def positions(bodies: Bodies, state: ModelState) -> Floats:
    """Positions (n, 3) [m], a view of the state."""
    at = bodies.position_at
    return state.y[at : at + 3 * bodies.count].reshape(-1, 3)


def velocities(bodies: Bodies, state: ModelState) -> Floats:
    """Velocities (n, 3) [m/s], a view of the state."""
    at = bodies.velocity_at
    return state.y[at : at + 3 * bodies.count].reshape(-1, 3)


def accelerations(bodies: Bodies, state: ModelState) -> Floats:
    """Accelerations (n, 3) [m/s^2], a view of the state's rate."""
    at = bodies.velocity_at
    return state.rate[at : at + 3 * bodies.count].reshape(-1, 3)


def masses(bodies: Bodies, state: ModelState) -> Floats:
    """Masses (n,) [kg]."""
    return state.floats[bodies.mass_at : bodies.mass_at + bodies.count]


def moving_masses(bodies: Bodies, state: ModelState) -> Floats:
    """Masses (n,) [kg], 0 for a fixed one, whose potential energy is not counted."""
    inverse = state.floats[bodies.inverse_at : bodies.inverse_at + bodies.count]
    return masses(bodies, state) * (inverse > 0)


def held(bodies: Bodies, state: ModelState) -> Any:
    """Mask (n,) of the bodies that are fixed now."""
    return state.floats[bodies.inverse_at : bodies.inverse_at + bodies.count] == 0


def weighed(bodies: Bodies, state: ModelState) -> Floats:
    """Gravitational masses (n,) [kg], 0 for a fixed one."""
    at, inverse = bodies.weighed_at, state.floats[bodies.inverse_at : bodies.inverse_at + bodies.count]
    return state.floats[at : at + bodies.count] * (inverse > 0)


def radii(bodies: Bodies, state: ModelState) -> Floats:
    """Contact radii (n,) [m]."""
    return state.floats[bodies.radius_at : bodies.radius_at + bodies.count]


def read(output: str, bodies: Bodies, state: ModelState, own_potential: float = 0.0) -> Any:
    """Value of an output of BODY_OUTPUTS; ``own_potential`` [J]: the model's own, added to that of the forces.

    Raises KeyError for another output.
    """
    import numpy as np

    x, v, m = positions(bodies, state), velocities(bodies, state), masses(bodies, state)
    match output:
        case "positions":
            return x.copy()
        case "velocities":
            return v.copy()
        case "accelerations":
            return accelerations(bodies, state).copy()
        case "radii":
            return radii(bodies, state).copy()
        case "kinetic":
            return 0.5 * float(np.sum(m * np.sum(v * v, axis=1))) + _of_turning("rotation_energy", bodies, state)
        case "potential":
            return own_potential + state.potential
        case "dissipated":
            return float(state.y[bodies.work_at])
        case "energy":
            parts = ("kinetic", "potential", "dissipated")
            return sum(read(part, bodies, state, own_potential) for part in parts)
        case "momentum":
            return np.sum(m[:, None] * v, axis=0)
        case "angular_momentum":
            return np.sum(m[:, None] * np.cross(x, v), axis=0) + _of_turning("own_momentum", bodies, state)
        case "center":
            return np.average(x, axis=0, weights=m) if np.sum(m) > 0 else np.zeros(3)
        case "count":
            return float(bodies.count)
    raise KeyError(output)


def _of_turning(what: str, bodies: Bodies, state: ModelState) -> Any:
    """The contribution of the rotation of rigid bodies, a function of rigid.turning; 0 for point masses."""
    if bodies.turning is None:
        return 0.0
    from sceneql.bodies.rigid import turning

    return getattr(turning, what)(bodies.turning, bodies.count, state)


def numbered(names: Iterable[str]) -> dict[str, int]:
    """Numbers from 0 by name, for names in the order of their masses."""
    return {name: k for k, name in enumerate(names)}


def read_named(output: str, names: Mapping[str, int], bodies: Bodies, state: ModelState) -> Any:
    """Value (3,) of ``name.position``, ``name.velocity`` or ``name.acceleration``. Raises KeyError for another."""
    name, _, what = output.rpartition(".")
    if name not in names or what not in MASS_OUTPUTS:
        raise KeyError(output)
    rows = {"position": positions, "velocity": velocities, "acceleration": accelerations}[what]
    return rows(bodies, state)[names[name]].copy()


def places(output: str, bodies: Bodies) -> NDArray[int64] | None:
    """Indices in y of an output of BODY_OUTPUTS; None for one that is no part of the state (kinds.Model.places)."""
    import numpy as np

    rows: NDArray[int64] = np.arange(3 * bodies.count).reshape(-1, 3)
    match output:
        case "positions":
            return bodies.position_at + rows
        case "velocities":
            return bodies.velocity_at + rows
        case "center" if bodies.count == 1:
            return bodies.position_at + rows.ravel()
        case "dissipated":
            return np.array(bodies.work_at)
    return None


def places_named(output: str, names: Mapping[str, int], bodies: Bodies) -> NDArray[int64] | None:
    """Indices (3,) in y of an output ``name.position`` or ``name.velocity``; None for another."""
    name, _, what = output.rpartition(".")
    found = places({"position": "positions", "velocity": "velocities"}.get(what, ""), bodies)
    return None if found is None or name not in names else found[names[name]]


def diagonal(bodies: Bodies, start: Floats) -> float:
    """Diagonal [m] of the box, along the axes, of the masses at the start; ``start``: the island's state there."""
    places = start[bodies.position_at :][: 3 * bodies.count].reshape(-1, 3)
    return float(((places.max(axis=0) - places.min(axis=0)) ** 2).sum() ** 0.5)
