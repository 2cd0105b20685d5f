"""Element meshes of objects, blocks and mesh files. Imports numpy."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from math import prod
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.bodies.elements.element_mesh import ElementMesh, Onto, curved, meshed
from sceneql.bodies.elements.refined import Lengths, bent, hollows, in_curved, refined
from sceneql.bodies.filling.fill import Inside
from sceneql.bodies.filling.finer import Finer, lengths
from sceneql.bodies.filling.held_lines import Lines, surface_of
from sceneql.bodies.filling.kept_creases import creases_kept, onto_crease
from sceneql.bodies.filling.msh import Read, read_msh
from sceneql.bodies.filling.split_creases import creases_split
from sceneql.bodies.filling.split_lines import Surface
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

    from sceneql.bodies.elements.element import Element
    from sceneql.bodies.elements.hold import Part
    from sceneql.bodies.filling.block import Block
    from sceneql.frame import Floats, Ints
    from sceneql.kinds import Ref
    from sceneql.quantities.span import Span
    from sceneql.system import Assembly

BYTES = {4: 4000, 10: 25000}
"""Memory [bytes] of an element by its number of nodes: with its share of state, implicit solver's matrix, picture."""
PARTS = 10
"""Default number of nodes along the longest side of an object's box; ten-node elements have one on each edge, too."""
A_PLACE = 6
"""Tetrahedra per node of the lattice, which has one at each cube's corner and center."""
TOO_FINE = "take larger spacings under `finer`"
THIN = 1.0
"""Distance from all nodes, in spacings, beyond which a part of the object counts as missed by the mesh."""
KEPT = 4
"""Meshes in the cache, the last ones used."""
_kept: dict[tuple[Any, ...], ElementMesh] = {}
FINE, MOST_LOOKED_AT = 0.25, 3e6
"""Spacing, in spacings of the mesh, of the test points for missed parts; half a spacing if these would be too many."""


def bounded_by(spacing: float) -> Callable[[Floats, Floats], None]:
    """A function (low, high) of a box's corners that raises Exceeds where its lattice has too many nodes to test."""

    def check(low: Floats, high: Floats) -> None:
        bounded(2.0 * prod(lattice_counts(low, high, spacing).tolist()), "places of a lattice", PLACE)

    return check


def laid(
    block: Block, element: type[Element], finer: Mapping[str, Finer], assembly: Assembly, parts: Mapping[str, Part]
) -> ElementMesh:
    """The mesh of a block, in which lines and points of ``parts`` have nodes.

    Raises ScriptError for one that is inside out, LimitRefused for too many elements.
    """
    from sceneql.bodies.filling.block import CUT

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
    try:
        return _fitted(element, points, tetrahedra, finer, None, assembly.line(), Lines(parts))
    except Exceeds as error:
        raise LimitRefused(str(error), assembly.line(), TOO_FINE) from None


def _fitted(
    element: type[Element],
    points: Floats,
    tetrahedra: Ints,
    finer: Mapping[str, Finer],
    onto: Onto | None,
    line: Span | None,
    lines: Lines,
    spacing: float = 0.0,
    turn: float | None = None,
) -> ElementMesh:
    """The mesh of elements on tetrahedra (t, 4), refined by ``finer`` and at concave surfaces; ``lines`` get nodes.

    ``turn``: largest angle [rad] by which a concave surface may turn along an edge, None for any. Raises Exceeds for
    too many elements, ScriptError for an entry of ``finer`` far from all elements.
    """

    def check(count: float) -> None:
        bounded(count, "elements", BYTES[element.nodes()])

    def made(wanted: list[Lengths]) -> tuple[ElementMesh, int]:
        """The mesh refined to the wanted lengths, and how many of its outer nodes stay off the object's surface."""
        at, cells = points, tetrahedra
        if wanted:
            at, cells = refined(at, cells, lambda places: np.min([one(places) for one in wanted], axis=0), onto, check)
        if not lines:
            straight = meshed(element, at, cells)
            return (straight, 0) if onto is None or not element.edges else curved(straight, onto)
        cut = lines.cut(at, cells, surface_of(onto), element.edges)
        straight = meshed(element, cut.points, cut.cells)
        mesh, flat = curved(straight, lines.curved(cut, onto)) if element.edges else (straight, 0)
        return lines.marked(cut, mesh), flat

    asked = [lengths(finer)] if finer else []
    hollow = None if onto is None or turn is None else hollows(points, tetrahedra, onto, spacing, turn)
    mesh, flat = made(asked)
    if hollow is not None:
        # Halved elements may be too thin to be curved; flat ones lose more accuracy than their smaller size gains.
        finest, more = made([*asked, hollow])
        mesh = finest if more <= flat else mesh
    for name, one in finer.items():
        if not one.reaches(mesh.points):
            message = f"'{name}' is near no element"
            help = "its place is one of the material, before the solid is moved or turned"
            raise ScriptError([Diagnostic("no-mass", message, line, help)])
    return mesh


def of_file(
    file: str, element: type[Element], finer: Mapping[str, Finer], assembly: Assembly, parts: Mapping[str, Part]
) -> ElementMesh:
    """The mesh of a .msh file, in which lines and points of ``parts`` have nodes.

    Raises ScriptError for one that cannot be read, LimitRefused for too many elements.
    """
    line, path, lines = assembly.line(), Path(file), Lines(parts)
    try:
        with doing(f"reading {path.name}"):
            read = read_msh(path)
        bounded(float(len(read.cells)), "elements", BYTES[element.nodes()])
    except Exceeds as error:
        raise LimitRefused(str(error), line, "take fewer elements") from None
    except (ValueError, OSError) as error:
        raise ScriptError([Diagnostic("not-filled", str(error), line, _instead(path))]) from None
    if read.cells.shape[1] == 4 or finer or not element.edges:
        used, which = np.unique(read.cells[:, :4], return_inverse=True)
        points, tetrahedra = read.points[used], which.reshape(-1, 4).astype(np.int32)
        _upright(points, tetrahedra, read, path.name, line)
        try:
            return _fitted(element, points, tetrahedra, finer, None, line, lines)
        except Exceeds as error:
            raise LimitRefused(str(error), line, TOO_FINE) from None
    corners = np.unique(read.cells[:, :4])
    order = np.concatenate([corners, np.setdiff1d(np.arange(len(read.points)), corners)])
    number = np.empty(len(order), dtype=np.int32)
    number[order] = np.arange(len(order))
    mesh = ElementMesh(element, read.points[order], number[read.cells], len(corners))
    _upright(mesh.points, mesh.cells, read, path.name, line)
    places = np.concatenate([np.eye(4), np.asarray(element.rule[0])])
    _told(mesh.sizes(places).min(axis=1), mesh.points[mesh.cells[:, :4]], read, path.name, line)
    if not lines:
        return mesh
    surface = Surface(real=partial(in_curved, mesh))
    cut = lines.cut(mesh.points[: mesh.corners], mesh.cells[:, :4], surface, more=True)
    if cut.put != (0, 0):
        straight = meshed(element, cut.points, cut.cells)
        mesh = replace(straight, points=bent(mesh, straight.points, straight.cells, cut.parents))
    return lines.marked(cut, mesh)


def _instead(path: Path) -> str:
    """What to write or save in place of a file of another kind; "" for a .msh."""
    if path.suffix.lower() in (".stl", ".obj", ".ply"):
        return f"a surface is filled as an object: `mesh: {{file: {path.name}}}` under objects, and `of` it a `spacing`"
    if path.suffix.lower() != ".msh":
        return f"save it as a .msh in text, as by Gmsh: `gmsh -0 {path.name} -format msh2 -o {path.stem}.msh`"
    return ""


def _upright(points: Floats, cells: Ints, read: Read, name: str, line: Span | None) -> None:
    """Raise ScriptError where elements of a file are inverted or flat, by the volumes of their corners."""
    _told(volumes(points, cells[:, :4]), points[cells[:, :4]], read, name, line)


def _told(held: Floats, corners: Floats, read: Read, name: str, line: Span | None) -> None:
    """Raise ScriptError where volumes or determinants ``held`` (e,) of elements with corners (e, 4, 3) are not > 0."""
    turned = np.flatnonzero(~(held > 0.0))
    if not len(turned):
        return
    where = ", ".join(f"{c:.4g}" for c in corners[turned[0]].mean(axis=0))
    many = "one element" if len(turned) == 1 else f"{len(turned)} elements"
    message = (
        f"{many} of {name} turned inside out, or flat: the first is number {read.numbers[turned[0]]}, at ({where}) m"
    )
    help = "swap two corners of each that is turned; one that is flat needs another mesh"
    raise ScriptError([Diagnostic("not-filled", message, line, help)])


def filled(
    ref: Ref,
    spacing: float | None,
    element: type[Element],
    finer: Mapping[str, Finer],
    assembly: Assembly,
    turn: float | None = None,
    parts: Mapping[str, Part] | None = None,
) -> ElementMesh:
    """The mesh of an object, in which lines and points of ``parts`` have nodes; whose lattice lies along its axes.

    Raises ScriptError where it cannot be filled, LimitRefused for too many elements.

    ``turn``: largest angle [rad] by which the object's concave surfaces turn along an edge; None for any. Meshes of
    implicit objects without ``finer`` are cached, since variants, studies and twins fill the same object repeatedly.
    """
    inside, spacing = Inside(ref, assembly, own_axes=True), spacing_of(ref, spacing, element, assembly)
    key, lines = None, Lines(parts or {}, inside.axes)
    if inside.field is not None and not finer and not lines:
        told = (inside.field.code, inside.field.constants, inside.field.parts, inside.low, inside.high)
        key = (element, spacing, turn, *(part.tobytes() for part in (*told, inside.in_world(np.eye(3)))))
    if key is None or (mesh := _kept.pop(key, None)) is None:
        with doing(f"filling {ref.name}"):
            mesh = _filled(inside, spacing, element, finer, assembly.line(), lines, turn)
    if key is not None:
        _kept[key] = mesh
        if len(_kept) > KEPT:
            del _kept[next(iter(_kept))]
        mesh = replace(mesh, points=mesh.points.copy(), cells=mesh.cells.copy())
    return mesh


def spacing_of(ref: Ref, spacing: float | None, element: type[Element], assembly: Assembly) -> float:
    """Side [m] of the lattice's cubes in an object: the given one, or the default one of its box."""
    if spacing is not None:
        return spacing
    box = Inside(ref, assembly, own_axes=True)
    return default_spacing(box.low, box.high, element)


def default_spacing(low: Floats, high: Floats, element: type[Element]) -> float:
    """Side [m] of the lattice's cubes by which PARTS nodes fit along a box between two corners (3,) [m]."""
    return float((high - low).max()) * (2 if element.edges else 1) / PARTS


def _filled(
    inside: Inside,
    spacing: float,
    element: type[Element],
    finer: Mapping[str, Finer],
    line: Span | None,
    lines: Lines,
    turn: float | None,
) -> ElementMesh:
    inside.bounded(bounded_by(spacing), inside.low, inside.high)

    def holds(places: Floats) -> NDArray[bool_]:
        held = np.asarray(inside.holds(places))
        inside.bounded(bounded, A_PLACE * float(np.count_nonzero(held)), "elements", BYTES[element.nodes()])
        return held

    if inside.axes is not None:
        axes = inside.axes
        finer = {name: one.model_copy(update={"near": tuple(axes.T @ one.near)}) for name, one in finer.items()}
    made = stuffed(inside.low, inside.high, spacing, holds, inside.crossing)
    points, tetrahedra = made.points, made.tetrahedra
    if not len(tetrahedra):
        raise inside.refusal("no tetrahedron lies in it; make the spacing smaller")
    if not (volumes(points, tetrahedra) > 0.0).all():
        raise inside.refusal("so far from the origin its tetrahedra have no volume in double precision")
    surface = inside.holds, inside.crossing, inside.smooth
    points, tetrahedra = creases_split(
        creases_kept(points, tetrahedra, spacing, *surface), tetrahedra, spacing, *surface
    )
    _whole(inside, spacing, points)

    def onto(places: Floats, normals: Floats) -> Floats:
        # Along the normal from inside to outside; places that do not cross the surface stay.
        inner, outer = places - 0.5 * spacing * normals, places + 0.5 * spacing * normals
        crosses = np.asarray(inside.holds(inner)) & ~np.asarray(inside.holds(outer))
        found = places.copy()
        if crosses.any():
            share = inside.crossing(inner[crosses], outer[crosses])
            found[crosses] = inner[crosses] + share[:, None] * (outer - inner)[crosses]
        return found

    def onto_edge(places: Floats, normals: Floats, sides: Floats) -> Floats:
        return onto_crease(places, normals, sides, spacing, inside.holds, inside.crossing)

    try:
        mesh = _fitted(element, points, tetrahedra, finer, Onto(onto, onto_edge), line, lines, spacing, turn)
    except Exceeds as error:
        raise LimitRefused(str(error), inside.span, TOO_FINE) from None
    return replace(mesh, points=inside.in_world(mesh.points))


def _whole(inside: Inside, spacing: float, points: Floats) -> None:
    """Raise ScriptError where a part of the object is farther than THIN from all nodes, too thin for the lattice."""
    from scipy.spatial import cKDTree

    counts = np.ceil((inside.high - inside.low) / (FINE * spacing)).astype(int) + 1
    if np.prod(counts, dtype=float) > MOST_LOOKED_AT:
        counts = np.ceil((inside.high - inside.low) / (0.5 * spacing)).astype(int) + 1
    axes = [np.linspace(low, high, n) for low, high, n in zip(inside.low, inside.high, counts, strict=True)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    held = np.asarray(inside.holds(grid.reshape(-1, 3))).reshape(grid.shape[:3])
    tree = cKDTree(points)
    # Whatever is beside a place with a node near it has that node near it, too.
    some = np.full(held.shape, np.inf)[::2, ::2, ::2]
    some[held[::2, ::2, ::2]] = tree.query(grid[::2, ::2, ::2][held[::2, ::2, ::2]])[0]
    beside = np.ix_(*(np.arange(count) // 2 for count in counts))
    near = some[beside] + np.linalg.norm(grid - grid[::2, ::2, ::2][beside], axis=-1) <= THIN * spacing
    places = grid[held & ~near]
    if not len(places):
        return
    away, _ = tree.query(places)
    k = int(np.argmax(away))
    if away[k] > THIN * spacing:
        where = ", ".join(f"{c:.3g}" for c in inside.in_world(places)[k])
        raise inside.refusal(f"at ({where}) m it is thinner than the spacing of {spacing:.3g} m; make that smaller")
