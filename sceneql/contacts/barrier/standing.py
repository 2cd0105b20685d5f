"""Barrier between the skin of a solid or a rigid body and objects whose motion is given. Imports numpy."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.contacts.barrier import objects_layout as layout
from sceneql.contacts.barrier.surfaces_of import soft_skin
from sceneql.contacts.colliders import surfaces
from sceneql.quantities.diagnostic import Diagnostic, ScriptError

if TYPE_CHECKING:
    from sceneql.contacts.barrier.surfaces_of import Surface
    from sceneql.frame import Floats
    from sceneql.kinds import Ref
    from sceneql.system import Assembly, Bodies, Slopes

KERNELS = "sceneql.contacts.barrier.objects_kernels:force"
ENERGY = "sceneql.contacts.barrier.objects_energy_kernels:energy"
LIMIT = "sceneql.contacts.barrier.objects_limit_kernels:limit"
AFTER = "sceneql.contacts.barrier.held_friction_kernels:rub_objects"
SLOPES = "sceneql.contacts.barrier.objects_slopes_kernels:slopes"
BODY_SLOPES = "sceneql.contacts.barrier.body_on_objects_slopes_kernels:slopes"


def add_objects(
    assembly: Assembly,
    bodies: Bodies,
    refs: Sequence[Ref],
    friction_at: int,
    numbers: tuple[float, float, float],
    rubs: bool,
) -> None:
    """Add the barrier between the skin of ``bodies`` and objects.

    ``numbers``: by objects_layout.NUMBERS; ``rubs``: whether there may be friction.
    Raises ScriptError for an object without a collider, or one that the skin touches at the start.
    """
    skin = soft_skin(bodies)
    assert skin is not None
    nodes, which = np.unique(skin.triangles, return_inverse=True)
    corners = which.reshape(-1, 3)
    sides = np.sort(corners[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges, of_side = np.unique(sides, axis=0, return_inverse=True)
    places = assembly.start()[bodies.position_at :][: 3 * bodies.count].reshape(-1, 3)
    areas = areas_of(places[skin.triangles])
    # Corners and edge middles cut a triangle into four; each small corner gets a third of its triangle.
    own = np.bincount(corners.ravel(), np.repeat(areas / 12.0, 3), len(nodes))
    middle = np.bincount(of_side.ravel(), np.repeat(areas / 4.0, 3), len(edges))
    objects = surfaces(refs, assembly, layout.HEAD)
    points = len(nodes) + len(edges)
    head = (
        *(bodies.position_at, bodies.velocity_at, bodies.work_at, bodies.inverse_at),
        *(len(nodes), len(edges), layout.HEAD + len(objects)),
        assembly.floats(numbers),
        friction_at,
        assembly.floats(np.concatenate([own, middle])),
        assembly.floats(np.zeros(layout.LOADS + layout.LAG * points * len(refs))),
        assembly.floats(np.full(layout.KNOW * points * len(refs), -1.0)),
        len(refs),
        -1,
    )
    ints = (*head, *objects, *nodes.tolist(), *edges.ravel().tolist(), *np.ravel(skin.held[nodes]).astype(int).tolist())
    must_be_apart(bodies.model, refs, places[nodes], ints, numbers[layout.GAP], assembly)

    def slopes() -> Slopes:
        from sceneql.system import Slopes

        rows, columns = (np.concatenate([np.arange(len(nodes)), edges[:, side].ravel()]) for side in ([0, 1], [1, 0]))
        at = [bodies.velocity_at + 3 * nodes[rows]] * 2
        by = [start + 3 * nodes[columns] for start in (bodies.position_at, bodies.velocity_at)]
        return Slopes(SLOPES, np.concatenate(at), np.concatenate(by), blocks=True)

    _add(assembly, ints, slopes, rubs)


def add_objects_to_body(
    assembly: Assembly,
    surface: Surface,
    refs: Sequence[Ref],
    friction_at: int,
    numbers: tuple[float, float, float],
    rubs: bool,
) -> None:
    """Add the barrier between a rigid body's vertices and objects; arguments and errors as in `add_objects`."""
    thirds = np.repeat(areas_of(surface.at[surface.triangles]) / 3.0, 3)
    count = len(surface.at)
    position, velocity, work, inverse = surface.places[0, :4].tolist()
    objects = surfaces(refs, assembly, layout.HEAD)
    head = (
        *(position, velocity, work, inverse, count, 0, -1),
        assembly.floats(numbers),
        friction_at,
        assembly.floats(np.bincount(surface.triangles.ravel(), thirds, count)),
        assembly.floats(np.zeros(layout.LOADS + layout.LAG * count * len(refs))),
        assembly.floats(np.full(layout.KNOW * count * len(refs), -1.0)),
        len(refs),
        layout.HEAD + len(objects),
    )
    ints = (*head, *objects, *surface.places.ravel().tolist())
    must_be_apart(surface.model, refs, surface.at, ints, numbers[layout.GAP], assembly)

    def slopes() -> Slopes:
        from sceneql.bodies.rigid.place_slopes import force_places
        from sceneql.system import Slopes

        place = surface.places[0].tolist()
        return Slopes(BODY_SLOPES, *force_places([(place, place)]))

    _add(assembly, ints, slopes, rubs)


def _add(assembly: Assembly, ints: tuple[int, ...], slopes: Callable[[], Slopes], rubs: bool) -> None:
    assembly.term("force", KERNELS, ints, slopes, energy=ENERGY)
    assembly.limit(LIMIT, ints)
    if rubs:
        assembly.after_step(AFTER, ints)


def areas_of(corners: Floats) -> Floats:
    """Areas (k,) [m^2] of triangles (k, 3, 3)."""
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    found: Floats = 0.5 * np.linalg.norm(across, axis=1)
    return found


def must_be_apart(model: str, refs: Sequence[Ref], places: Floats, ints: Any, gap: float, assembly: Assembly) -> float:
    """Least distance of nodes from objects at the start [m]. Raises ScriptError for a node on or in an object."""
    from sceneql.contacts.barrier.nearest_node_kernels import nearest

    d, node, other = nearest(assembly.start(), assembly.numbers(), np.array(ints, dtype=np.int64))
    if d > 0.0:
        return float(d)
    x, y, z = places[node]
    where = f"{-d:.3g} m deep" if d < -1e-9 * float(np.abs(places).max()) else "on its surface"
    ref = refs[other]
    text = f"'{model}' starts inside '{ref.name}', {where} at ({x:.4g}, {y:.4g}, {z:.4g}) m"
    text = text if "deep" in where else f"'{model}' starts on '{ref.name}' at ({x:.4g}, {y:.4g}, {z:.4g}) m"
    help = f"leave a distance: forces begin at the gap of {gap:.3g} m"
    raise ScriptError([Diagnostic("starts-inside", text, ref.span or assembly.line(), help)])
