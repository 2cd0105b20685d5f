# mypy: ignore-errors
"""What solids that move leave open of a flow's faces, and how fast that grows: cut anew at each instant."""

import math

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.contacts import layout as surfaces
from sceneql.contacts.shape_kernels import clear
from sceneql.flows import layout
from sceneql.flows.advection_kernels import sides
from sceneql.flows.obstacles import moving_layout as own
from sceneql.flows.obstacles.cut_kernels import cut, nearest, place, reach, wall_velocity
from sceneql.flows.obstacles.no_slip_numbers import SLIVER
from sceneql.system.signatures_kernels import A, F, I, N

APART = 0.02
"""How far walls are thought to go on, in cells, for the rate of what they leave open."""
NEAR, LONGEST = 3.0, 16
"""Cells that are near a wall, whose distance is not always that along a row; places that are passed over at most."""


@lean(F(A, I, N, N, F, F, F, F, F, F), inner=True)
def growth(floats, ints, component, number, a, b, c, x, y, z):
    """How fast the open part of a face around (x, y, z) grows [1/s] where the solid at (a, b, c) moves on: as the face
    itself would have it if it moved back."""
    axes = ints[ints[own.FLOW] + layout.AXES]
    u, v, w = wall_velocity(floats, ints, number, a, b, c)
    speed = math.sqrt(u * u + v * v + w * w)
    if speed == 0.0:
        return 0.0
    at = ints[own.NUMBERS] + own.SPACING
    time = APART * min(floats[at], floats[at + 1], floats[at + 2] if axes == 3 else floats[at]) / speed
    later = cut(floats, ints, axes, component, x - time * u, y - time * v, z - time * w)[0]
    earlier = cut(floats, ints, axes, component, x + time * u, y + time * v, z + time * w)[0]
    return (later - earlier) / (2.0 * time)


@lean(N(A, I, N, F, F, F, F), inner=True)
def passed_over(floats, ints, axes, d, x, y, z):
    """How many places further on in a row from (x, y, z) are proved to be far from every wall: none within a solid. Its
    normal is not asked for there, and its distance is at least what is left of half of d, of which proof is needed:
    d is larger than the distance in the section of a slanted side, and in fields that are no distances."""
    at = ints[own.NUMBERS] + own.SPACING
    dx, dy, dz = floats[at], floats[at + 1], floats[at + 2] if axes == 3 else 0.0
    near = NEAR * max(dx, dy, dz)
    if not 0.5 * d >= near + dx:
        return 0
    count = int(min((0.5 * d - near) / dx, LONGEST))
    for k in range(ints[own.SOLIDS]):
        if not clear(floats, ints, own.HEAD + surfaces.OBJECT * k, x, y, z, near + count * dx):
            return 0
    return count


@lean(types.void(A, I, N), inner=True)
def open_faces(floats, ints, component):
    """What is open of a component's faces."""
    flow = ints[ints[own.FLOW] :]
    axes, start = flow[layout.AXES], flow[layout.STARTS + component]
    nx, ny, nz = sides(component, flow)
    dx = floats[ints[own.NUMBERS] + own.SPACING]
    d, a, b, c, number = 0.0, 0.0, 0.0, 0.0, 0
    for k in range(nz):
        for j in range(ny):
            last = -1
            for i in range(nx):
                f = start + i + nx * (j + ny * k)
                x, y_, z = place(floats, ints, axes, component, i, j, k)
                if i > last:
                    d, a, b, c, number = nearest(floats, ints, axes, x, y_, z)
                    last = i + passed_over(floats, ints, axes, d, x, y_, z)
                else:  # no wall has come near since
                    d -= dx
                part, depth = 1.0 if d > 0.0 else 0.0, max(d, 0.0)
                cx, cy, cz = x, y_, z
                if abs(d) <= reach(floats, ints, axes, component, a, b, c):
                    part, depth, cx, cy, cz = cut(floats, ints, axes, component, x, y_, z)
                if part < SLIVER:
                    part = 0.0
                floats[ints[own.LEVELS] + f], floats[ints[own.PARTS] + f], floats[ints[own.DEPTHS] + f] = d, part, depth
                floats[ints[own.CENTERS] + f], floats[ints[own.CENTERS + 1] + f] = cx, cy
                floats[ints[own.CENTERS + 2] + f] = cz
                floats[ints[own.NORMALS] + f], floats[ints[own.NORMALS + 1] + f] = a, b
                floats[ints[own.NORMALS + 2] + f], floats[flow[layout.OWNERS] + f] = c, number
                floats[flow[layout.AREAS] + f] = part * floats[ints[own.AREAS] + f]
                floats[ints[own.OPENING] + f] = 0.0
                if 0.0 < part < 1.0:
                    grows = growth(floats, ints, component, number, cx, cy, cz, x, y_, z)
                    floats[ints[own.OPENING] + f] = grows * floats[ints[own.AREAS] + f]
