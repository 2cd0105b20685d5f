# mypy: ignore-errors
"""Corners of an overlay beyond those that a pair has room for, compiled where there are so many."""

import math

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.contacts.distance.core_kernels import CORNER, at3, cross, dot
from sceneql.system.signatures_kernels import A, F, N


@lean(types.void(A, N, N, N, F, F, F), inner=True)
def thin_out(room, at, count, most, nx, ny, nz):
    """Keeps ``most`` of more corners: the farthest in all directions but one across the normal, and the lowest."""
    if abs(nx) <= min(abs(ny), abs(nz)):
        ux, uy, uz = cross(nx, ny, nz, 1.0, 0.0, 0.0)
    elif abs(ny) <= abs(nz):
        ux, uy, uz = cross(nx, ny, nz, 0.0, 1.0, 0.0)
    else:
        ux, uy, uz = cross(nx, ny, nz, 0.0, 0.0, 1.0)
    vx, vy, vz = cross(nx, ny, nz, ux, uy, uz)
    for turn in range(most):
        best, found = math.inf, 0
        angle = 2.0 * math.pi * turn / (most - 1)
        pu, pv = math.cos(angle), math.sin(angle)
        for k in range(count):
            p = at + CORNER * k
            if room[p + 3] < math.inf:
                x, y, z = at3(room, p)
                away = (
                    room[p + 3] if turn == most - 1 else -pu * dot(ux, uy, uz, x, y, z) - pv * dot(vx, vy, vz, x, y, z)
                )
                if away < best:
                    best, found = away, k
        # Those that are taken stand behind the others, and are out of the search.
        for c in range(CORNER):
            room[at + CORNER * (count + turn) + c] = room[at + CORNER * found + c]
        room[at + CORNER * found + 3] = math.inf
    for k in range(CORNER * most):
        room[at + k] = room[at + CORNER * count + k]
