"""Outputs of a solid of elements: strain and stress at nodes and at probes, volume, momenta."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from sceneql.kinds import Gives, quantity_type
from sceneql.quantities import dimension as dim
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.expression import Type

if TYPE_CHECKING:
    from sceneql.bodies.elements.element_mesh import ElementMesh
    from sceneql.bodies.elements.strain import Strain
    from sceneql.frame import Floats
    from sceneql.quantities.span import Span
    from sceneql.system import ModelState

STEPS = 8
"""Newton steps to a probe's barycentric coordinates in a curved element."""
BEYOND = 1.0
"""Largest distance of a probe outside its element, in barycentric coordinates, since surfaces are curved."""
NODES = "of each node, the mean of the elements there"
OUTPUTS: Mapping[str, Gives] = {
    "displacements": Gives(
        quantity_type(dim.LENGTH, (None, 3)), "How far each node is from its place of the material.", computed=True
    ),
    "stress": Gives(
        quantity_type(dim.PRESSURE, (None, 3, 3)), f"Cauchy's stress, without viscosity, {NODES}.", computed=True
    ),
    "principal": Gives(
        quantity_type(dim.PRESSURE, (None, 3)), f"Its principal values, the largest first, {NODES}.", computed=True
    ),
    "von_mises": Gives(
        quantity_type(dim.PRESSURE, (None,)), f"The stress of von Mises (1913), {NODES}.", computed=True
    ),
    "strain": Gives(Type((None, 3, 3)), f"Green's strain, {NODES}.", computed=True),
    "J": Gives(Type((None,)), f"Volume over that at rest, {NODES}.", computed=True),
    "volume": Gives(quantity_type(dim.VOLUME), "Its volume.", computed=True),
    "inverted": Gives(
        Type(), "How many elements are turned inside out at a point at which their strain is looked at.", computed=True
    ),
    "triangles": Gives(Type((None, 3)), "Its surface by numbers of nodes.", computed=True),
}
OF_PROBE: Mapping[str, Gives] = {
    "position": Gives(quantity_type(dim.LENGTH, (3,)), "Where it is."),
    "velocity": Gives(quantity_type(dim.VELOCITY, (3,)), "How fast it moves."),
    "acceleration": Gives(quantity_type(dim.ACCELERATION, (3,)), "How fast that changes.", computed=True),
    "displacement": Gives(
        quantity_type(dim.LENGTH, (3,)), "How far it is from its place of the material.", computed=True
    ),
    "stress": Gives(
        quantity_type(dim.PRESSURE, (3, 3)), "Cauchy's stress there, by those of the nodes around.", computed=True
    ),
    "von_mises": Gives(quantity_type(dim.PRESSURE), "The stress of von Mises there.", computed=True),
}
"""Outputs of a probe, under its name: ``tip.position``."""
OF_HOLD: Mapping[str, Gives] = {
    "force": Gives(quantity_type(dim.FORCE, (3,)), "The force by which it holds the solid.", computed=True)
}
"""Outputs of a hold, under its name."""


BY_INERTIA = ("kinetic", "momentum", "angular_momentum")
"""Outputs of point masses that a consistent mass matrix makes sums over pairs of nodes."""


def by_inertia(output: str, solid: Strain, state: ModelState) -> Any:
    """Value of an output of BY_INERTIA, by the mass matrix."""
    import numpy as np

    from sceneql.bodies.bodies import positions, velocities

    assert state.bodies is not None
    speeds = velocities(state.bodies, state)
    momenta = solid.inertia.matrix @ speeds
    match output:
        case "kinetic":
            return 0.5 * float(np.sum(speeds * momenta))
        case "momentum":
            return momenta.sum(axis=0)
    return np.cross(positions(state.bodies, state), momenta).sum(axis=0)


def read(output: str, solid: Strain, state: ModelState) -> Any:
    """Value of an output of OUTPUTS."""
    import numpy as np

    from sceneql.bodies.bodies import positions
    from sceneql.bodies.elements.skin import triangles

    assert state.bodies is not None
    if output == "triangles":
        return triangles(solid.mesh).astype(float)
    if output == "displacements":
        return positions(state.bodies, state) - solid.mesh.points
    gradients, stresses = solid.looked_at(state)
    sizes = np.linalg.det(gradients)
    match output:
        case "volume":
            return float(np.sum(solid.volumes * sizes))
        case "inverted":
            return float(np.count_nonzero((sizes < 0.0).any(axis=1)))
        case "J":
            return at_nodes(solid, sizes)
        case "strain":
            square = np.einsum("eqki,eqkj->eqij", gradients, gradients)
            return at_nodes(solid, 0.5 * (square - np.eye(3)))
    stress = at_nodes(solid, cauchy(gradients, stresses))
    match output:
        case "stress":
            return stress
        case "principal":
            return principal(stress)
    return von_mises(stress)


def cauchy(gradients: Floats, stresses: Floats) -> Floats:
    """Cauchy stresses P F^T / J (..., 3, 3) [Pa], symmetrized, from F ``gradients`` and P ``stresses``."""
    import numpy as np

    with np.errstate(divide="ignore", invalid="ignore"):
        found = np.einsum("...ik,...jk->...ij", stresses, gradients) / np.linalg.det(gradients)[..., None, None]
    symmetric: Floats = 0.5 * (found + np.swapaxes(found, -1, -2))
    return symmetric


def principal(stress: Floats) -> Floats:
    """Principal stresses (n, 3), descending, of stresses (n, 3, 3); NaN where these are not finite."""
    import numpy as np

    found = np.full(stress.shape[:2], np.nan)
    finite = np.isfinite(stress).all(axis=(1, 2))
    found[finite] = np.linalg.eigvalsh(stress[finite])[:, ::-1]
    return found


def von_mises(stress: Floats) -> Any:
    """Von Mises stresses (...) of stresses (..., 3, 3)."""
    import numpy as np

    mean = np.trace(stress, axis1=-2, axis2=-1)[..., None, None] / 3.0
    return np.sqrt(1.5 * np.sum((stress - mean * np.eye(3)) ** 2, axis=(-1, -2)))


def at_nodes(solid: Strain, values: Floats) -> Floats:
    """Values (n, ...) at nodes from values (e, q, ...) at integration points.

    Extrapolated linearly in each element, then averaged over the elements at a node, weighted by volume.
    """
    import numpy as np

    from sceneql.bodies.filling.tetrahedra import ENDS

    mesh = solid.mesh
    places = np.asarray(mesh.element.rule[0])
    flat = values.reshape(*values.shape[:2], -1)
    if len(places) == 1:
        corners = np.repeat(flat, 4, axis=1)
    else:
        corners = np.einsum("cq,eqk->eck", np.linalg.inv(places), flat)
    if mesh.element.edges:
        a, b = np.array(ENDS).T
        corners = np.concatenate([corners, 0.5 * (corners[:, a] + corners[:, b])], axis=1)
    weights = np.repeat(solid.volumes.sum(axis=1), mesh.cells.shape[1])
    nodes, count = mesh.cells.ravel(), len(mesh.points)
    total = np.bincount(nodes, weights, count)
    sums = [np.bincount(nodes, weights * corners[:, :, k].ravel(), count) / total for k in range(corners.shape[2])]
    return np.stack(sums, axis=1).reshape(count, *values.shape[2:])


def probe(name: str, mesh: ElementMesh, place: Floats, line: Span | None) -> tuple[Any, Floats]:
    """Nodes (k,) and shape functions (k,) at a material position (3,) [m], in the element that contains it.

    A place slightly outside (BEYOND) is extrapolated from the nearest element. Raises ScriptError for one farther out.
    """
    import numpy as np

    corners = mesh.points[mesh.cells[:, :4]]
    sides = corners[:, 1:] - corners[:, :1]
    local = np.linalg.solve(np.swapaxes(sides, 1, 2), (place - corners[:, 0])[:, :, None])[:, :, 0]
    at = np.concatenate([1.0 - local.sum(axis=1, keepdims=True), local], axis=1)
    k = int(np.argmax(at.min(axis=1)))
    own = at[k]
    if own.min() < -BEYOND:
        text = f"the probe '{name}' stands outside of the solid"
        raise ScriptError([Diagnostic("probe-outside", text, line)])
    cell, element = mesh.points[mesh.cells[k]], mesh.element
    for _ in range(STEPS if element.edges else 0):  # Newton's method, where edges are curved
        slopes = element.slopes(own[None])[0]
        away = place - element.functions(own[None])[0] @ cell
        step = np.linalg.solve(cell.T @ (slopes[:, 1:] - slopes[:, :1]), away)
        own = own + np.array([-step.sum(), *step])
    return mesh.cells[k].astype(int), element.functions(own[None])[0]


def read_probe(what: str, nodes: Any, weights: Floats, solid: Strain, state: ModelState) -> Any:
    """Value of an output of OF_PROBE, interpolated from the probe's nodes (k,) by its weights (k,)."""
    from sceneql.bodies import bodies as masses

    bodies = state.bodies
    assert bodies is not None
    match what:
        case "position":
            return weights @ masses.positions(bodies, state)[nodes]
        case "velocity":
            return weights @ masses.velocities(bodies, state)[nodes]
        case "acceleration":
            return weights @ masses.accelerations(bodies, state)[nodes]
        case "displacement":
            return weights @ (masses.positions(bodies, state) - solid.mesh.points)[nodes]
    import numpy as np

    stress = np.einsum("n,nij->ij", weights, at_nodes(solid, cauchy(*solid.looked_at(state)))[nodes])
    return stress if what == "stress" else float(von_mises(stress))
