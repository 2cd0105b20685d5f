# mypy: ignore-errors
"""A multigrid cycle for the systems of implicit stages of several species on one grid: blocks of a cell's species.

What preconditions the iterations of linear/krylov_kernels: a symmetric V(2,2)-cycle, red-black Gauss-Seidel by whole
cells (all species of a cell at once), residuals restricted by sums, corrections prolonged as constants. A
coarse cell's block sums the reactions and storage of its cells; its couplings are half the sums of theirs where the
spacing doubles (Braess 1995, Computing 55, 379-393). A drift is in the residuals alone.

Behind the preconditioner's number the plan has: levels, species s, directions d (low and high along each axis), where s
rows of scratch are, then of each level nx, ny, nz, where its floats start; the place of each unknown, species by
species; places of the values of the blocks (s, s, cells) and of the ties (d, s, cells), -1: none; bits of the cells'
volumes. Floats of a level: ties (d, s, n), blocks and then their inverses (s, s, n), x, b and what x was before the
last sweep (s, n).
"""

import numpy as np
from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.linear.krylov_kernels import own_at, solve_system
from sceneql.linear.solver_kernels import FACTOR_SYSTEM, PRECONDITION
from sceneql.system.signatures_kernels import A, N

LEVELS, SPECIES, DIRECTIONS, SCRATCH, TABLE = range(1, 6)
__all__ = ["factor_system", "precondition", "solve_system"]
LEVEL = 4
SWEEPS = 2
"""Number of sweeps before and after the coarser levels."""


@lean(types.boolean(N, N, A), inner=True)
def invert_blocks(s, n, blocks):
    """Turn each of n matrices, (s, s, n) in all, into its inverse by Gauss and Jordan; False where a pivot is lost.

    Without exchanges of rows: a cell's own entry is the largest where the stage's step is one that can be solved.
    """
    for c in range(n):
        for p in range(s):
            own = (p * s + p) * n + c
            if not abs(blocks[own]) > 0.0:
                return False
            pivot = 1.0 / blocks[own]
            blocks[own] = 1.0
            for q in range(s):
                blocks[(p * s + q) * n + c] *= pivot
            for m in range(s):
                if m == p:
                    continue
                part = blocks[(m * s + p) * n + c]
                blocks[(m * s + p) * n + c] = 0.0
                for q in range(s):
                    blocks[(m * s + q) * n + c] -= part * blocks[(p * s + q) * n + c]
    return True


@lean_inlined
def take_in(plan, at, values, level):
    """Fill the finest level with the matrix, its rows times the volumes."""
    levels, s, d = plan[at + LEVELS], plan[at + SPECIES], plan[at + DIRECTIONS]
    n = plan[at + TABLE] * plan[at + TABLE + 1] * plan[at + TABLE + 2]
    blocks = at + TABLE + LEVEL * levels + plan[0]
    ties = blocks + s * s * n
    volumes = plan[ties + d * s * n : ties + d * s * n + n].view(np.float64)
    for direction in range(d):
        for m in range(s):
            for c in range(n):
                place = plan[ties + (direction * s + m) * n + c]
                level[(direction * s + m) * n + c] = -volumes[c] * values[place] if place >= 0 else 0.0
    for m in range(s):
        for q in range(s):
            for c in range(n):
                place = plan[blocks + (m * s + q) * n + c]
                other = volumes[c] if m == q else 0.0
                level[d * s * n + (m * s + q) * n + c] = volumes[c] * values[place] if place >= 0 else other


@lean(types.void(N, N, N, N, N, A, N, N, N, A), inner=True)
def coarsen(s, d, nx, ny, nz, fine, mx, my, mz, coarse):
    """A level's ties and blocks from those of the finer one."""
    n, m = nx * ny * nz, mx * my * mz
    for k in range((d * s + s * s) * m):
        coarse[k] = 0.0
    for k in range(nz):
        for j in range(ny):
            for i in range(nx):
                c = i + nx * (j + ny * k)
                target = (i >> 1 if mx < nx else i) + mx * (
                    (j >> 1 if my < ny else j) + my * (k >> 1 if mz < nz else k)
                )
                for one in range(s * s):
                    coarse[d * s * m + one * m + target] += fine[d * s * n + one * n + c]
                for direction in range(d):
                    axis, high = direction >> 1, direction & 1
                    index, count = (i, nx) if axis == 0 else ((j, ny) if axis == 1 else (k, nz))
                    coarser = mx if axis == 0 else (my if axis == 1 else mz)
                    halved = coarser < count
                    across = coarser > 1 and (not halved or (index & 1) == high or (index == count - 1 and high == 1))
                    for one in range(s):
                        tie = fine[(direction * s + one) * n + c]
                        # Couplings within a coarse cell are dropped, others halved where the spacing doubles.
                        kept = (0.5 * tie if halved else tie) if across else 0.0
                        coarse[(direction * s + one) * m + target] += kept
                        coarse[d * s * m + (one * s + one) * m + target] += kept - tie


@lean(FACTOR_SYSTEM)
def factor_system(plan, values, factors, work, symmetric):
    """All levels of the matrix; False where a block is singular."""
    at = own_at(plan)
    levels, s, d = plan[at + LEVELS], plan[at + SPECIES], plan[at + DIRECTIONS]
    take_in(plan, at, values, factors)
    regular = True
    for level in range(levels):
        t = at + TABLE + LEVEL * level
        n = plan[t] * plan[t + 1] * plan[t + 2]
        own = factors[plan[t + 3] :]
        if level + 1 < levels:
            u = t + LEVEL
            coarsen(
                s, d, plan[t], plan[t + 1], plan[t + 2], own, plan[u], plan[u + 1], plan[u + 2], factors[plan[u + 3] :]
            )
        regular = invert_blocks(s, n, own[d * s * n : (d * s + s * s) * n]) and regular
    return regular


@lean_inlined
def pull_row(n, d, nx, ny, nz, j, k, ties, x, out):
    """Add the couplings (d, stride) of one species to its row (j, k), out (nx,); ``n``: stride of ``ties``.

    The whole row is computed, also for cells of one color: contiguous cells fill the vector lanes.
    """
    plane = nx * ny
    row = nx * j + plane * k
    own, tie = x[row : row + nx], ties[row : row + nx]
    out[0] += tie[0] * own[nx - 1]
    for i in range(1, nx):
        out[i] += tie[i] * own[i - 1]
    tie = ties[n + row : n + row + nx]
    out[nx - 1] += tie[nx - 1] * own[0]
    for i in range(nx - 1):
        out[i] += tie[i] * own[i + 1]
    for direction in range(2, d):
        way = 2 * (direction & 1) - 1
        other = row + ((j + way) % ny - j) * nx if direction < 4 else row + ((k + way) % nz - k) * plane
        tie, beside = ties[direction * n + row : direction * n + row + nx], x[other : other + nx]
        for i in range(nx):
            out[i] += tie[i] * beside[i]


@lean(types.void(N, N, N, N, N, A, A, A, A, N, A), inner=True)
def sweep(s, d, nx, ny, nz, ties, inverse, x, b, color, lines):
    """Solve the equations of the cells of one color of the checkerboard; ``lines`` (s, nx) is scratch."""
    n = nx * ny * nz
    for k in range(nz):
        for j in range(ny):
            row = nx * (j + ny * k)
            for m in range(s):
                line, right = lines[m * nx : (m + 1) * nx], b[m * n + row : m * n + row + nx]
                for i in range(nx):
                    line[i] = right[i]
                pull_row(s * n, d, nx, ny, nz, j, k, ties[m * n :], x[m * n : (m + 1) * n], line)
            mine = (j + k + color) & 1
            for m in range(s):
                own = x[m * n + row : m * n + row + nx]
                for q in range(s):
                    part = inverse[(m * s + q) * n + row : (m * s + q) * n + row + nx]
                    line = lines[q * nx : (q + 1) * nx]
                    for i in range(mine, nx, 2):
                        own[i] = part[i] * line[i] + (own[i] if q > 0 else 0.0)


@lean(types.void(N, N, N, N, N, A, A, A, N, N, N, A, A), inner=True)
def restrict_residual(s, d, nx, ny, nz, ties, x, before, mx, my, mz, coarse, line):
    """Sum the residuals over the coarse cells: after a sweep they are the couplings' changes since (``before``: x).

    Residuals of the color that was swept last are 0. ``line`` (nx,) is scratch.
    """
    n, count = nx * ny * nz, mx * my * mz
    half = 1 if mx < nx else 0
    for one in range(s * count):
        coarse[one] = 0.0
    for one in range(s * n):
        before[one] = x[one] - before[one]
    for k in range(nz):
        for j in range(ny):
            target = mx * ((j >> 1 if my < ny else j) + my * (k >> 1 if mz < nz else k))
            for m in range(s):
                for i in range(nx):
                    line[i] = 0.0
                pull_row(s * n, d, nx, ny, nz, j, k, ties[m * n :], before[m * n : (m + 1) * n], line)
                for i in range(nx):
                    coarse[m * count + target + (i >> half)] += line[i]


@lean_inlined
def add_coarse(s, nx, ny, nz, x, mx, my, mz, coarse):
    """Add to every cell the values of its coarse cell."""
    n, count = nx * ny * nz, mx * my * mz
    for m in range(s):
        for k in range(nz):
            for j in range(ny):
                source = mx * ((j >> 1 if my < ny else j) + my * (k >> 1 if mz < nz else k))
                for i in range(nx):
                    x[m * n + i + nx * (j + ny * k)] += coarse[m * count + source + (i >> 1 if mx < nx else i)]


@lean_inlined
def cycle(plan, table, levels, s, d, factors, lines):
    """One V-cycle on the finest level: its x from its b; ``lines`` (s, nx) is scratch."""
    for stage in range(2 * levels):
        # Down and up again in one loop, so that inlined functions are compiled once.
        down = stage < levels
        level = stage if down else 2 * levels - 1 - stage
        t = table + LEVEL * level
        nx, ny, nz, start = plan[t], plan[t + 1], plan[t + 2], plan[t + 3]
        n = nx * ny * nz
        ties, inverse = factors[start : start + d * s * n], factors[start + d * s * n : start + (d * s + s * s) * n]
        start += (d * s + s * s) * n
        x, b = factors[start : start + s * n], factors[start + s * n : start + 2 * s * n]
        before = factors[start + 2 * s * n : start + 3 * s * n]
        if down:
            for c in range(s * n):
                x[c] = 0.0
        last = level + 1 == levels
        u = t if last else t + LEVEL
        mx, my, mz = plan[u], plan[u + 1], plan[u + 2]
        m = mx * my * mz
        coarse = factors[plan[u + 3] + (d * s + s * s) * m :]
        if not down and not last:
            add_coarse(s, nx, ny, nz, x, mx, my, mz, coarse[: s * m])
        count = 2 * SWEEPS
        for number in range(count):
            if down and number == count - 1:
                for c in range(s * n):
                    before[c] = x[c]
            sweep(s, d, nx, ny, nz, ties, inverse, x, b, number & 1 if down else (number + 1) & 1, lines)
        if down and not last:
            restrict_residual(s, d, nx, ny, nz, ties, x, before, mx, my, mz, coarse[s * m : 2 * s * m], lines)


@lean(PRECONDITION)
def precondition(plan, factors, b, x):
    """Approximate the solution x of A x = b by one cycle."""
    at = own_at(plan)
    levels, s, d = plan[at + LEVELS], plan[at + SPECIES], plan[at + DIRECTIONS]
    t = at + TABLE
    n = plan[t] * plan[t + 1] * plan[t + 2]
    numbers = t + LEVEL * levels
    ties = numbers + plan[0] + s * s * n
    volumes = plan[ties + d * s * n : ties + d * s * n + n].view(np.float64)
    target = factors[(d * s + s * s + s) * n : (d * s + s * s + 2 * s) * n]
    for c in range(s * n):
        target[c] = 0.0
    for u in range(plan[0]):
        place = plan[numbers + u]
        target[place] = volumes[place % n] * b[u]
    cycle(plan, t, levels, s, d, factors, factors[plan[at + SCRATCH] : plan[at + SCRATCH] + s * plan[t]])
    found = factors[(d * s + s * s) * n : (d * s + s * s + s) * n]
    for u in range(plan[0]):
        x[u] = found[plan[numbers + u]]
