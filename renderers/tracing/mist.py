"""Mists: packing for the kernels, and their light, which is computed before rays are traced."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from renderers.tracing import layout
from renderers.tracing.mist_kernels import mists_along
from renderers.tracing.scene_kernels import MIST
from renderers.tracing.solids.grid_kernels import BLOCK
from renderers.tracing.solids.grids import blocks_with
from sceneql.compiled.kernels import address, over_tiles
from sceneql.shapes.placement import inverse
from sceneql.shapes.world_boxes import box_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from renderers.tracing.scene_kernels import Scene
    from sceneql.frame import Floats, Mist

    Corner = tuple[float, float, float]

FAINT = 1e-4
"""Optical depth across a mist's box below which it counts as 0: a carried field has faint rims that reach far."""
ORDERS = 6
"""Number of further scatterings in mists after the first one."""
COARSE = 10
"""Number of places along the longest side of a mist's grid at which light from around is gathered."""
DIRECTIONS = 24
"""Number of directions, evenly over the sphere, from which it is gathered."""


def row(shape: Mist) -> Floats:
    """Reals of a mist (see layout), with its emitted light still 0."""
    counts = shape.absorption.shape[::-1]
    low, high = box_of(shape)
    some = shape.absorption * np.linalg.norm(high - low) > FAINT
    absorption = np.where(some, shape.absorption, 0.0)
    found = blocks_with(some)
    corner, top = _bounds(shape, found)
    low, high = box_of(replace(shape, low=corner, high=top))
    to_nodes = np.asarray(shape.to_cells, dtype=np.float64)
    maps = [to_nodes.ravel(), inverse(to_nodes).ravel()]
    head = [*corner, *top, *counts, *low, *high, *shape.surface.color, float(shape.lit)]
    source = np.zeros(3 * absorption.size if shape.lit else 0)
    return np.concatenate([*maps, head, absorption.ravel(), source, found.ravel()])


def _bounds(shape: Mist, found: NDArray[np.bool_]) -> tuple[Corner, Corner]:
    """Corners of a mist's box, cut to the blocks ``found`` that contain any mist."""
    low, high = list(shape.low), list(shape.high)
    for axis in range(3):
        some = np.flatnonzero(found.any(axis=tuple({0, 1, 2} - {2 - axis})))
        if len(some) > 0:
            low[axis] = max(low[axis], float(BLOCK * some[0]))
            high[axis] = min(high[axis], float(BLOCK * (some[-1] + 1)))
    return (low[0], low[1], low[2]), (high[0], high[1], high[2])


def passed(scene: Scene) -> Scene:
    """Scene with the address of the kernel for mists."""
    return scene._replace(mist=address(mists_along, MIST))


def light_up(scene: Scene, rows: int, orders: int = ORDERS) -> None:
    """Compute the light that the scene's lit mists send; ``rows`` of scratch.

    The light of lamps and suns, attenuated by solids and mists, is computed at each node. The light of the sky, of
    surfaces and of mists is gathered at a few places, ``orders`` times, once for each further scattering.
    """
    from renderers.tracing.light.bounce_kernels import WAY
    from renderers.tracing.light.mist_light_kernels import REACH, gather_around, light_nodes, scatter_again, spread
    from renderers.tracing.scratch import begun, scratch
    from renderers.tracing.solids.packet_choice import lender

    reals = scene.reals
    places = [int(at) for at in scene.ints[scene.ints[layout.MISTS_AT] :]]
    lit = [at for at in places if reals[at + layout.LIT] != 0.0]
    with_scratch = lender(lambda: (scratch(rows), np.zeros((1, layout.ANSWERS)), np.zeros(WAY)))
    ways = directions()
    layers = [(at, k) for at in lit for k in range(int(reals[at + layout.NODES + 2]))]
    over_tiles(len(layers), lambda i: with_scratch(lambda own: light_nodes(scene, begun(own[0]), *layers[i])))
    if not lit or orders == 0:
        return
    lamps = [_source(scene, at).copy() for at in lit]
    around = [np.zeros((*_coarse(reals, at), REACH + DIRECTIONS)) for at in lit]
    rods = [(m, k) for m in range(len(lit)) for k in range(len(around[m]))]

    def gather(i: int) -> None:
        m, k = rods[i]
        with_scratch(lambda own: gather_around(scene, begun(own[0]), *own[1:], lit[m], ways, around[m], k))

    def scatter(i: int) -> None:
        m, k = rods[i]
        scatter_again(scene, lit[m], ways, around[m], k)

    def join(i: int) -> None:
        at, k = layers[i]
        m = lit.index(at)
        spread(scene, at, lamps[m], around[m], k)

    over_tiles(len(rods), gather)
    for _ in range(orders):
        over_tiles(len(layers), join)
        over_tiles(len(rods), scatter)
    over_tiles(len(layers), join)


def _source(scene: Scene, at: int) -> Floats:
    """Light that a mist sends, (3 nodes,), a view into the scene's reals."""
    count = int(np.prod(scene.reals[at + layout.NODES : at + layout.NODES + 3]))
    first = at + layout.ABSORPTION + count
    found: Floats = scene.reals[first : first + 3 * count]
    return found


def _coarse(reals: Floats, at: int) -> tuple[int, int, int]:
    """Numbers of places along z, y, x."""
    nodes = reals[at + layout.NODES : at + layout.NODES + 3]
    x, y, z = (max(2, round(COARSE * float(side / nodes.max()))) for side in nodes)
    return z, y, x


def directions(count: int = DIRECTIONS) -> Floats:
    """Unit vectors (count, 3) evenly over the sphere, on a spiral (Gonzalez 2010)."""
    up = 1.0 - (2.0 * np.arange(count) + 1.0) / count
    turn = np.pi * (1.0 + np.sqrt(5.0)) * np.arange(count)
    across = np.sqrt(1.0 - up * up)
    return np.stack([across * np.cos(turn), up, across * np.sin(turn)], axis=1)
