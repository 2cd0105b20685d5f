# mypy: ignore-errors
"""What closed sheets of triangles cut off halves of cells, exactly, and the coefficients of a deep flow, as a term.

Each triangle is cut along the planes of the grid. Each piece adds the signed volume between it and the right end of its
half, and its area seen along x to all halves further right: a sum along rows then has the volume in each.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.flows import layout as flow
from sceneql.flows.varying import fluid_layout as own
from sceneql.flows.varying.coefficients_kernels import begin, blend, finish, known
from sceneql.flows.varying.halves_kernels import halves
from sceneql.system.signatures_kernels import TERM, A, F, I, N

WIDE = 3 * 16
"""Floats of a piece of a triangle: cut by two planes along each axis it has nine corners."""
ROOM = 7 * WIDE
"""Floats for a triangle, and for what is below and above a plane along each axis."""


@lean(types.int64(A, N, N, F, A, A))
def cut(polygon, count, axis, place, below, above):
    """Cut a polygon at a plane across an axis; the number of corners below, and 100 times that of those above."""
    low = high = 0
    for v in range(count):
        w = v + 1 if v < count - 1 else 0
        a, b = polygon[3 * v + axis] - place, polygon[3 * w + axis] - place
        for d in range(3):
            if a <= 0.0:
                below[3 * low + d] = polygon[3 * v + d]
            if a >= 0.0:
                above[3 * high + d] = polygon[3 * v + d]
        low += a <= 0.0
        high += a >= 0.0
        if a * b < 0.0:
            part = a / (a - b)
            for d in range(3):
                at = place if d == axis else polygon[3 * v + d] + part * (polygon[3 * w + d] - polygon[3 * v + d])
                below[3 * low + d] = above[3 * high + d] = at
            low += 1
            high += 1
    return low + 100 * high


@lean_inlined
def up_to(place, last, axis, room, count, below, rest):
    """Cut what is left of a polygon, in ``rest``, at the far plane of a layer: (corners below, corners still left).

    In the last layer all of it is below.
    """
    if place == last:
        for d in range(3 * count):
            below[d] = rest[d]
        return count, 0
    for d in range(3 * count):
        room[d] = rest[d]
    found = cut(room, count, axis, place + 1.0, below, rest)
    return found % 100, found // 100


@lean(types.void(A, N, N, N, N, A, A, I))
def note(piece, count, i, j, k, part, cover, one):
    """Add a piece in half (i, j, k)."""
    nx, ny, nz = halves(one)
    at_end = False
    if one[flow.PERIODIC + 1] == 1:
        j %= ny
    if one[flow.PERIODIC + 2] == 1:
        k %= nz
    if j < 0 or j >= ny or k < 0 or k >= nz:
        return
    low = i
    if one[flow.PERIODIC] == 1:
        i %= nx
    elif i < 0:
        i, at_end = 0, True
    elif i >= nx:
        return
    for v in range(1, count - 1):
        a, b = 3 * v, 3 * v + 3
        y0, z0 = piece[a + 1] - piece[1], piece[a + 2] - piece[2]
        y1, z1 = piece[b + 1] - piece[1], piece[b + 2] - piece[2]
        area = 0.5 * (y1 * z0 - y0 * z1)  # seen from low x
        x = 0.0 if at_end else (piece[0] + piece[a] + piece[b]) / 3.0 - low
        part[i + nx * (j + ny * k)] += area * (1.0 - x)
        cover[i + nx * (j + ny * k)] += area


@lean(types.void(A, A, A, I))
def add_triangle(room, part, cover, one):
    """Add the triangle that ``room`` begins with, in halves from the low corner."""
    layer, rest_z = room[WIDE : 2 * WIDE], room[2 * WIDE : 3 * WIDE]
    line, rest_y = room[3 * WIDE : 4 * WIDE], room[4 * WIDE : 5 * WIDE]
    piece, rest_x = room[5 * WIDE : 6 * WIDE], room[6 * WIDE : 7 * WIDE]
    for d in range(9):
        rest_z[d] = room[d]
    count_z = 3
    k, last_z = math.floor(min(room[2], room[5], room[8])), math.floor(max(room[2], room[5], room[8]))
    while k <= last_z and count_z > 2:
        count, count_z = up_to(k, last_z, 2, room, count_z, layer, rest_z)
        low = high = layer[1]
        for v in range(1, count):
            low, high = min(low, layer[3 * v + 1]), max(high, layer[3 * v + 1])
        for d in range(3 * count):
            rest_y[d] = layer[d]
        count_y = count
        j, last_y = math.floor(low), math.floor(high)
        while j <= last_y and count_y > 2:
            count, count_y = up_to(j, last_y, 1, layer, count_y, line, rest_y)
            low = high = line[0]
            for v in range(1, count):
                low, high = min(low, line[3 * v]), max(high, line[3 * v])
            for d in range(3 * count):
                rest_x[d] = line[d]
            count_x = count
            i, last_x = math.floor(low), math.floor(high)
            while i <= last_x and count_x > 2:
                count, count_x = up_to(i, last_x, 0, line, count_x, piece, rest_x)
                note(piece, count, i, j, k, part, cover, one)
                i += 1
            j += 1
        k += 1


@lean(TERM, inner=True)
def measure(t, y, rate, floats, ints):
    """The density and the viscosity of all halves, and what terms and the projection read of them."""
    if known(y, floats, ints):
        return
    one = ints[ints[own.FLOW] :]
    nx, ny, nz = halves(one)
    n = nx * ny * nz
    part, cover = floats[ints[own.PART] : ints[own.PART] + n], floats[ints[own.COVER] : ints[own.COVER] + n]
    room, box = floats[ints[own.CLIPPED] : ints[own.CLIPPED] + ROOM], ints[own.OWN] + 2
    begin(n, floats, ints)
    for number in range(int(floats[ints[own.TABLE]])):
        row = int(floats[ints[own.TABLE] + 1]) + own.ROW * number
        position, corners = int(floats[row + own.POSITION_AT]), int(floats[row + own.CORNERS_AT])
        for c in range(n):
            part[c] = cover[c] = 0.0
        leftmost = math.inf
        for triangle in range(int(floats[row + own.TRIANGLES])):
            largest = 0.0
            for v in range(3):
                at = position + 3 * int(floats[corners + 3 * triangle + v])
                for d in range(3):
                    room[3 * v + d] = 2.0 * (y[at + d] - floats[box + d]) / floats[box + 3 + d]
                    largest += abs(room[3 * v + d])
                leftmost = min(leftmost, room[3 * v])
            if largest < 1e9:
                add_triangle(room, part, cover, one)
        first = math.floor(leftmost) if one[flow.PERIODIC] == 1 and math.isfinite(leftmost) else 0
        for line in range(ny * nz):
            running = 0.0
            for s in range(nx):
                c = (first + s) % nx + nx * line
                part[c] += running
                running += cover[c]
        blend(n, floats[row + own.ITS_DENSITY], floats[row + own.ITS_VISCOSITY], floats, ints)
    finish(floats, ints)
