"""Barrier between surfaces of several solids, and of an elastic one with itself. Imports numpy."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.contacts.barrier import pairs_layout as layout
from sceneql.contacts.barrier.carriers import Carriers, Places
from sceneql.contacts.barrier.standing import areas_of
from sceneql.quantities.diagnostic import Diagnostic, ScriptError

if TYPE_CHECKING:
    from sceneql.contacts.barrier.surfaces_of import Surface
    from sceneql.frame import Floats
    from sceneql.system import Assembly

KERNELS = "sceneql.contacts.barrier.skin_forces_kernels:force"
ENERGY = "sceneql.contacts.barrier.skins_energy_kernels:energy"
LIMIT = "sceneql.contacts.barrier.skins_limit_kernels:limit"
AFTER = "sceneql.contacts.barrier.held_friction_kernels:rub_skins"

ROOM = 48
"""Storage for pairs: per vertex and per edge; for pairs that press, a quarter per edge."""
AHEAD = 0.3
"""Margin beyond the gap, relative to the mean side of triangles, within which pairs enter the pattern together."""


def add_pairs(
    assembly: Assembly,
    surfaces: Sequence[Surface],
    friction_at: int,
    gap: float,
    slip: float,
    side: float,
    rubs: bool,
) -> None:
    """Add the barrier between surfaces.

    ``side`` [m]: mean side of the elastic surfaces' triangles; ``rubs``: whether there may be friction.
    Raises ScriptError for surfaces that cross or touch at the start.
    """
    firsts = np.cumsum([0, *(len(one.at) for one in surfaces)])
    corners = np.concatenate([first + one.triangles for first, one in zip(firsts, surfaces, strict=False)])
    stiffest = max(one.stiffness for one in surfaces if not one.rigid)
    stiffness = [np.full(len(one.at), min(one.stiffness, stiffest)) for one in surfaces]
    solid = np.repeat([one.number for one in surfaces], np.diff(firsts))
    rest = np.concatenate([one.at for one in surfaces])
    sides = np.sort(corners[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges, of_side = np.unique(sides, axis=0, return_inverse=True)
    thirds = np.repeat(areas_of(rest[corners]) / 3.0, 3)
    areas = [np.bincount(corners.ravel(), thirds, len(rest)), np.bincount(of_side.ravel(), thirds, len(edges))]
    points_most, edges_most, lagged_most = ROOM * len(rest), ROOM * len(edges), ROOM // 4 * len(edges)
    cells = 2 * len(edges) + 1
    rows = np.column_stack(
        [np.concatenate([one.places for one in surfaces]), solid, np.concatenate([one.held for one in surfaces])]
    ).astype(np.int64)
    _mark_pinned(rows, assembly)
    lists = np.concatenate([rows.ravel(), corners.ravel(), edges.ravel()]).astype(np.int64)
    head = [
        *(len(rest), len(corners), len(edges), layout.HEAD),
        assembly.floats([gap, slip, side]),
        friction_at,
        assembly.floats(np.concatenate(areas)),
        assembly.floats(np.concatenate(stiffness)),
        assembly.floats(rest),
        assembly.floats(np.zeros(layout.AT + 3 * len(rest))),
        *(assembly.floats(np.zeros(2 * points_most)), points_most),
        *(assembly.floats(np.zeros(2 * edges_most)), edges_most),
        *(assembly.floats(np.zeros(cells + 1 + len(edges))), cells),
        *(assembly.floats(np.zeros(layout.LAG * lagged_most)), lagged_most),
        assembly.floats(np.zeros(layout.BEFORE * lagged_most)),
        assembly.floats(np.zeros(2 * len(rest))),
        assembly.floats(np.zeros(7 * len(rest))),
        int((solid < 0).sum()),
        layout.HEAD + len(lists),
    ]
    ints = np.concatenate([np.array(head, dtype=np.int64), lists])
    if any(one.rigid for one in surfaces):
        known: Places = Carriers.of(surfaces, rows)
    else:
        known = Places(len(rest), np.arange(len(rest), dtype=np.int64) * (len(rest) + 1), rows)

    def grow(floats: Floats) -> bool:
        if _released(floats, ints, assembly):
            return True
        near = listed(floats, ints)
        soon = near[near[:, 0] < gap + AHEAD * side]
        return known.add(soon[:, 1:]) or known.add(near[:, 1:])

    start = assembly.start(), assembly.numbers()
    names = np.repeat([one.model for one in surfaces], np.diff(firsts))
    _must_be_apart(start, ints, rest, names, assembly)
    _must_not_cross(rest, corners, edges, rows, names, assembly)
    assembly.term("force", KERNELS, ints, lambda: known.slopes(ints), energy=ENERGY)
    assembly.limit(LIMIT, ints)
    if rubs:
        assembly.after_step(AFTER, ints)
    assembly.grows(grow)


def _mark_pinned(rows: Any, assembly: Assembly) -> None:
    """Mark masses that are pinned at the start in rows (n, VERTEX) of vertices."""
    masses = (rows[:, layout.ROTATION] < 0) & (rows[:, layout.HELD] == 0)
    pinned = masses & (assembly.numbers()[rows[:, layout.INVERSE]] == 0.0)
    rows[pinned, layout.HELD] = layout.PINNED


def _released(floats: Floats, ints: Any, assembly: Assembly) -> bool:
    """Whether pins have let go of masses since; these count as unknowns then."""
    last = layout.HEAD + layout.VERTEX * ints[layout.VERTICES]
    rows = ints[layout.HEAD : last].reshape(-1, layout.VERTEX)
    free = (rows[:, layout.HELD] == layout.PINNED) & (floats[rows[:, layout.INVERSE]] > 0.0)
    for at in rows[free, layout.INVERSE].tolist():
        assembly.write(at, floats[at : at + 1])
    rows[free, layout.HELD] = 0
    return bool(free.any())


def listed(floats: Floats, ints: Any) -> Floats:
    """(k, 5): distance [m] and four vertices of each listed pair."""
    from sceneql.contacts.barrier.growth_kernels import measure

    memory = int(ints[layout.MEMORY])
    count = int(floats[memory + layout.POINT_PAIRS] + floats[memory + layout.EDGE_PAIRS])
    found = np.zeros((count, 5))
    measure(floats, ints, found.reshape(-1))
    return found


def _must_be_apart(start: tuple[Floats, Floats], ints: Any, rest: Floats, names: Any, assembly: Assembly) -> None:
    """Raise ScriptError for two surfaces that touch at the start."""
    from sceneql.contacts.barrier.pairs_kernels import known

    y, floats = start
    known(y, floats, ints)
    near = listed(floats, ints)
    touching = near[near[:, 0] <= 1e-9 * float(np.abs(rest).max())]
    if len(touching):
        _refuse("touches", int(touching[0, 1]), int(touching[0, 3]), rest, names, assembly)


def _must_not_cross(rest: Floats, corners: Any, edges: Any, rows: Any, names: Any, assembly: Assembly) -> None:
    """Raise ScriptError for an edge that passes through a triangle at the start.

    All near pairs are tested except those of one rigid body and those of fixed bodies.
    """
    from scipy.spatial import cKDTree

    a, b, c = (rest[corners[:, k]] for k in range(3))
    p, q = rest[edges[:, 0]], rest[edges[:, 1]]
    across, middle = np.cross(b - a, c - a), (a + b + c) / 3.0
    reach = max(float(np.linalg.norm(end - middle, axis=1).max()) for end in (a, b, c))
    reach += 0.5 * float(np.linalg.norm(q - p, axis=1).max())
    near = cKDTree(middle).query_ball_point(0.5 * (p + q), reach)
    edge = np.repeat(np.arange(len(edges)), [len(some) for some in near])
    face = np.concatenate([np.asarray(some, dtype=np.int64) for some in near])
    first, last = (np.einsum("ij,ij->i", end[edge] - a[face], across[face]) for end in (p, q))
    shared = (corners[face][:, :, None] == edges[edge][:, None, :]).any(axis=(1, 2))
    own, other = rows[edges[edge, 0], layout.BODY], rows[corners[face, 0], layout.BODY]
    shared |= (own < 0) & (own == other)
    some = np.flatnonzero((first * last < 0.0) & ~shared)
    edge, face, part = edge[some], face[some], first[some] / (first[some] - last[some])
    hit = p[edge] + part[:, None] * (q[edge] - p[edge])
    inside = np.ones(len(some), dtype=bool)
    for u, v in ((a, b), (b, c), (c, a)):
        inside &= np.einsum("ij,ij->i", np.cross(v[face] - u[face], hit - u[face]), across[face]) > 0.0
    if inside.any():
        k = np.flatnonzero(inside)[0]
        one, other = int(edges[edge[k], 0]), int(corners[face[k], 0])
        _refuse("crosses", one, other, rest, names, assembly)


def _refuse(what: str, one: int, other: int, rest: Floats, names: Any, assembly: Assembly) -> None:
    """Raise the ScriptError for skins that touch or cross, near vertex ``one``."""
    x, y, z = rest[one]
    first, second = str(names[one]), str(names[other])
    told = f"'{first}' {what} itself" if first == second else f"'{first}' {what} '{second}'"
    text = f"{told} at the start, at ({x:.4g}, {y:.4g}, {z:.4g}) m"
    raise ScriptError([Diagnostic("starts-inside", text, assembly.line(), "leave a distance between them")])
