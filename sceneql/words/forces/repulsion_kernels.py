# mypy: ignore-errors
"""Repulsion at short range, by cell lists."""

import math

from sceneql.bodies.neighbors_kernels import cell_of, sort_by_cell
from sceneql.compiled.kernels import kernel
from sceneql.compiled.threads_kernels import TILE, over_threads
from sceneql.nbody.shared_masses_kernels import gather, leave_out_massless, velocity_of
from sceneql.system.signatures_kernels import TERM

STRENGTH, NUMBERS, ENERGIES, POINTS, SORTED, ORDER, START, SIZE, P, Q, ENTRY, THREADS, TILE_AT, BODIES = range(14)
"""Places in ints; from BODIES on the masses (nbody/layout.py)."""
PART = 1024


@kernel(TILE, inner=True)
def repulsion_tile(tile, t, y, rate, floats, ints):
    """All forces on the masses of a tile, from PART tile on in order of cells, and their halves of the energies."""
    n, alive = ints[BODIES], int(floats[ints[START] + ints[SIZE]])
    strength, reach = floats[ints[STRENGTH]], floats[ints[NUMBERS]]
    exponent = floats[ints[NUMBERS] + 1]
    mask, start = ints[SIZE] - 1, ints[START]
    xs, ys, zs = ints[SORTED], ints[SORTED] + n, ints[SORTED] + 2 * n
    for one in range(tile * PART, min(alive, tile * PART + PART)):
        x, y_, z = floats[xs + one], floats[ys + one], floats[zs + one]
        i, j, l = cell_of(x, reach), cell_of(y_, reach), cell_of(z, reach)
        fx, fy, fz, energy = 0.0, 0.0, 0.0, 0.0
        for row in range(27):
            di, dj, dl = row % 3 - 1, (row // 3) % 3 - 1, row // 9 - 1
            place = (i + di + ints[P] * (j + dj) + ints[Q] * (l + dl)) & mask
            for other in range(int(floats[start + place]), int(floats[start + place + 1])):
                dx, dy, dz = x - floats[xs + other], y_ - floats[ys + other], z - floats[zs + other]
                square = dx * dx + dy * dy + dz * dz
                if square >= reach * reach or other == one:
                    continue
                r = math.sqrt(square)
                left = 1.0 - r / reach
                push = strength * (left if exponent == 1.0 else left**exponent)
                energy += 0.5 * push * left * reach / (exponent + 1.0)
                if r > 0.0:
                    scale = push / r
                    fx += scale * dx
                    fy += scale * dy
                    fz += scale * dz
        number = int(floats[ints[ORDER] + one])
        floats[ints[ENERGIES] + number] = energy
        at = velocity_of(number, ints, BODIES)
        rate[at] += fx
        rate[at + 1] += fy
        rate[at + 2] += fz


@kernel(TERM)
def repulsion(t, y, rate, floats, ints):
    """Adds the forces between all pairs in reach. ints: see above."""
    n = ints[BODIES]
    gather(y, floats, ints, BODIES, ints[POINTS])
    leave_out_massless(floats, ints, BODIES, ints[POINTS])
    for k in range(n):
        floats[ints[ENERGIES] + k] = 0.0
    reach = floats[ints[NUMBERS]]
    sort_by_cell(floats, n, ints[POINTS], reach, ints[SIZE], ints[P], ints[Q], ints[SORTED], ints[ORDER], ints[START])
    over_threads(ints[ENTRY], ints[THREADS], ints[TILE_AT], (n + PART - 1) // PART, t, y, rate, floats, ints)
