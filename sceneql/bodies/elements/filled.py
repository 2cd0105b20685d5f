"""Meshes of elements in objects and blocks. Imports numpy."""

from __future__ import annotations

from collections.abc import Callable
from math import prod
from typing import TYPE_CHECKING

import numpy as np

from sceneql.bodies.elements.element_mesh import ElementMesh, Onto, meshed
from sceneql.bodies.filling.fill import Inside
from sceneql.bodies.filling.kept_creases import creases_kept, onto_crease
from sceneql.bodies.filling.split_creases import creases_split
from sceneql.bodies.filling.stuffing import lattice_counts, stuffed
from sceneql.bodies.filling.tetrahedra import volumes
from sceneql.doing import doing
from sceneql.failure import LimitRefused
from sceneql.island.memory import PLACE, bounded
from sceneql.kinds import Exceeds
from sceneql.quantities.diagnostic import Diagnostic, ScriptError

if TYPE_CHECKING:
    from numpy import bool_
    from numpy.typing import NDArray

    from sceneql.bodies.elements.block import Block
    from sceneql.bodies.elements.element import Element
    from sceneql.frame import Floats
    from sceneql.kinds import Ref
    from sceneql.system import Assembly

BYTES = {4: 4000, 10: 25000}
"""[bytes] of an element by its nodes, with its part of the state, of an implicit solver's matrix and of the picture."""
PARTS = 10
"""Spacings along the longest side of an object's box where the script tells none."""
A_PLACE = 6
"""Tetrahedra for each corner and middle of the lattice."""
THIN = 1.0
"""What lies in the object farther than so many spacings from all nodes is lost."""
FINE, MOST_LOOKED_AT = 0.25, 3e6
"""It is looked for at places so many spacings apart, and half a spacing where these are too many."""


def bounded_by(spacing: float) -> Callable[[Floats, Floats], None]:
    """A function of the corners of an object's box, that raises Exceeds where there are too many places to test."""

    def check(low: Floats, high: Floats) -> None:
        bounded(2.0 * float(np.prod(lattice_counts(low, high, spacing))), "places of a lattice", PLACE)

    return check


def laid(block: Block, element: type[Element], assembly: Assembly) -> ElementMesh:
    """The mesh of a block. Raises ScriptError for one that is inside out, LimitRefused for too many elements."""
    from sceneql.bodies.elements.block import CUT

    try:
        bounded(float(prod(block.cells)) * CUT[block.cut], "elements", BYTES[element.nodes()])
    except Exceeds as error:
        raise LimitRefused(str(error), assembly.line(), "use fewer `cells`") from None
    points, tetrahedra = block.made()
    held = volumes(points, tetrahedra)
    if not (held > 0.0).all():
        where = points[tetrahedra[int(np.argmin(held))]].mean(axis=0)
        told = ", ".join(f"{c:.4g}" for c in where)
        message = f"the block is inside out, or flat, at ({told}) m: look at the order of its corners"
        raise ScriptError([Diagnostic("not-filled", message, assembly.line())])
    return meshed(element, points, tetrahedra)


def filled(ref: Ref, spacing: float | None, element: type[Element], assembly: Assembly) -> ElementMesh:
    """The mesh of an object. Raises ScriptError where it cannot be filled, LimitRefused for too many elements."""
    with doing(f"filling {ref.name}"):
        return _filled(Inside(ref, assembly), spacing_of(ref, spacing, assembly), element)


def spacing_of(ref: Ref, spacing: float | None, assembly: Assembly) -> float:
    """Side of the cubes in an object [m]: what is given, or a part of its size."""
    if spacing is not None:
        return spacing
    box = Inside(ref, assembly)
    return float((box.high - box.low).max()) / PARTS


def _filled(inside: Inside, spacing: float, element: type[Element]) -> ElementMesh:
    inside.bounded(bounded_by(spacing), inside.low, inside.high)

    def holds(places: Floats) -> NDArray[bool_]:
        held = np.asarray(inside.holds(places))
        inside.bounded(bounded, A_PLACE * float(np.count_nonzero(held)), "elements", BYTES[element.nodes()])
        return held

    made = stuffed(inside.low, inside.high, spacing, holds, inside.crossing)
    points, tetrahedra = made.points, made.tetrahedra
    if not len(tetrahedra):
        raise inside.refusal("no tetrahedron lies in it; make the spacing smaller")
    if not (volumes(points, tetrahedra) > 0.0).all():
        raise inside.refusal("so far from the origin its tetrahedra have no volume in double precision")
    kept = creases_kept(points, tetrahedra, spacing, inside.holds, inside.crossing)
    points, tetrahedra = creases_split(kept, tetrahedra, spacing, inside.holds, inside.crossing)
    _whole(inside, spacing, points)

    def onto(places: Floats, normals: Floats) -> Floats:
        # From inside to outside; what does not cross the surface on the way stays.
        inner, outer = places - 0.5 * spacing * normals, places + 0.5 * spacing * normals
        crosses = np.asarray(inside.holds(inner)) & ~np.asarray(inside.holds(outer))
        found = places.copy()
        if crosses.any():
            share = inside.crossing(inner[crosses], outer[crosses])
            found[crosses] = inner[crosses] + share[:, None] * (outer - inner)[crosses]
        return found

    def onto_edge(places: Floats, normals: Floats, sides: Floats) -> Floats:
        return onto_crease(places, normals, sides, spacing, inside.holds, inside.crossing)

    return meshed(element, points, tetrahedra, Onto(onto, onto_edge))


def _whole(inside: Inside, spacing: float, points: Floats) -> None:
    """Raise ScriptError where a part of the object is too thin for the lattice to have a node there."""
    from scipy.spatial import cKDTree

    counts = np.ceil((inside.high - inside.low) / (FINE * spacing)).astype(int) + 1
    if np.prod(counts, dtype=float) > MOST_LOOKED_AT:
        counts = np.ceil((inside.high - inside.low) / (0.5 * spacing)).astype(int) + 1
    axes = [np.linspace(low, high, n) for low, high, n in zip(inside.low, inside.high, counts, strict=True)]
    places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    places = places[np.asarray(inside.holds(places))]
    if not len(places):
        return
    away, _ = cKDTree(points).query(places)
    k = int(np.argmax(away))
    if away[k] > THIN * spacing:
        where = ", ".join(f"{c:.3g}" for c in places[k])
        raise inside.refusal(f"at ({where}) m it is thinner than the spacing of {spacing:.3g} m; make that smaller")
