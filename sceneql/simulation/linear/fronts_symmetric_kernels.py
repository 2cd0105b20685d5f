# mypy: ignore-errors
"""The multifrontal factorization of symmetric matrices: U alone, in its place, on several threads.

For the plan see fronts_kernels. A front's eliminated rows (width x rows) are computed where they stay, among the
factors, with the reciprocals of the pivots D^-1 on the diagonal; A = U^T D^-1 U. Its update is the upper half of the
square of its other rows. L = U^T D^-1 is never stored: its entries are products. Large subtrees of fronts are pieces
that threads share; the bytes do not depend on how many there are.
"""

import math

from numba import types

from sceneql.kernels import kernel, lean, lean_inlined
from sceneql.simulation.arithmetic_kernels import fma, widest
from sceneql.simulation.threads_kernels import TILE as PIECE
from sceneql.simulation.threads_kernels import over_threads
from sceneql.system_kernels import A, I, N

PIECES_AT, PIECES, ENTRY, THREADS, PIECE_AT, HEAD = 8, 9, 10, 11, 12, 13
FIELDS = 10
TILE = 256
"""Columns of a tile of the update."""
BLOCK = 48
"""Rows that are eliminated before the rest of a front is updated: their part of a tile stays in the cache."""

UPDATE = types.void(A, N, N, N, A, N, N, N, N)
FACTOR_SYMMETRIC = types.boolean(I, A, A, A)
FACTOR_FRONTS = types.boolean(I, A, A, A, N, N)


@lean(UPDATE, inner=True)
def update(panel, height, begin, end, target, stride, shift, low, high):
    """Rows low..high of the front less L U of the rows begin..end, from the diagonal on.

    Entry (i, j) of the front is target[(i - shift) stride + j - shift]. Four rows by four at a time; products and sums
    are fused, which is twice as fast.
    """
    widest()
    for tile in range(low, height, TILE):
        edge = min(tile + TILE, height)
        for i in range(low, min(high, edge), 4):
            start = max(tile, i)
            a = (i - shift) * stride - shift
            if i + 4 > high:
                for row in range(i, high):
                    for k in range(begin, end):
                        p = -(panel[k * height + row] * panel[k * height + k])
                        for j in range(start, edge):
                            target[a + j] = fma(p, panel[k * height + j], target[a + j])
                    a += stride
                continue
            b, c, d = a + stride, a + 2 * stride, a + 3 * stride
            first, second = target[a + start : a + edge], target[b + start : b + edge]
            third, fourth = target[c + start : c + edge], target[d + start : d + edge]
            k = begin
            while k + 4 <= end:
                k0, k1, k2, k3 = k * height, (k + 1) * height, (k + 2) * height, (k + 3) * height
                v0, v1, v2, v3 = -panel[k0 + k], -panel[k1 + k + 1], -panel[k2 + k + 2], -panel[k3 + k + 3]
                p0, p1, p2, p3 = panel[k0 + i] * v0, panel[k1 + i] * v1, panel[k2 + i] * v2, panel[k3 + i] * v3
                m = i + 1
                q0, q1, q2, q3 = panel[k0 + m] * v0, panel[k1 + m] * v1, panel[k2 + m] * v2, panel[k3 + m] * v3
                m = i + 2
                r0, r1, r2, r3 = panel[k0 + m] * v0, panel[k1 + m] * v1, panel[k2 + m] * v2, panel[k3 + m] * v3
                m = i + 3
                s0, s1, s2, s3 = panel[k0 + m] * v0, panel[k1 + m] * v1, panel[k2 + m] * v2, panel[k3 + m] * v3
                u0, u1 = panel[k0 + start : k0 + edge], panel[k1 + start : k1 + edge]
                u2, u3 = panel[k2 + start : k2 + edge], panel[k3 + start : k3 + edge]
                for j in range(first.size):
                    x0, x1, x2, x3 = u0[j], u1[j], u2[j], u3[j]
                    first[j] = fma(p3, x3, fma(p2, x2, fma(p1, x1, fma(p0, x0, first[j]))))
                    second[j] = fma(q3, x3, fma(q2, x2, fma(q1, x1, fma(q0, x0, second[j]))))
                    third[j] = fma(r3, x3, fma(r2, x2, fma(r1, x1, fma(r0, x0, third[j]))))
                    fourth[j] = fma(s3, x3, fma(s2, x2, fma(s1, x1, fma(s0, x0, fourth[j]))))
                k += 4
            while k < end:
                at = k * height
                v = -panel[at + k]
                p, q, r, s = panel[at + i] * v, panel[at + i + 1] * v, panel[at + i + 2] * v, panel[at + i + 3] * v
                u = panel[at + start : at + edge]
                for j in range(first.size):
                    x = u[j]
                    first[j] = fma(p, x, first[j])
                    second[j] = fma(q, x, second[j])
                    third[j] = fma(r, x, third[j])
                    fourth[j] = fma(s, x, fourth[j])
                k += 1


@lean_inlined
def eliminate(panel, height, begin, end):
    """Rows begin..end of U; False where a pivot is 0 or not finite."""
    for low in range(begin, end, 4):
        high = min(low + 4, end)
        for k in range(low, high):
            row = panel[k * height : (k + 1) * height]
            pivot = row[k]
            if not 0.0 < abs(pivot) < math.inf:
                return False
            inverse = 1.0 / pivot
            row[k] = inverse
            for i in range(k + 1, high):
                below = panel[i * height : (i + 1) * height]
                factor = -row[i] * inverse
                for j in range(i, height):
                    below[j] = fma(factor, row[j], below[j])
        if high < end:
            update(panel, height, low, high, panel, height, 0, high, end)
    return True


@lean_inlined
def take_in(panel, width, height, square, child, below, places):
    """Add a child's update (below x below) at its places in the front."""
    rest = height - width
    for i in range(below):
        place = places[i]
        part = child[i * below : (i + 1) * below]
        if place < width:
            row = panel[place * height : (place + 1) * height]
            for j in range(i, below):
                row[places[j]] += part[j]
        else:
            row = square[(place - width) * rest : (place - width + 1) * rest]
            for j in range(i, below):
                row[places[j] - width] += part[j]


@lean(FACTOR_FRONTS, inner=True)
def factor_fronts(plan, values, factors, work, begin, end):
    """Fronts begin..end, whose children are factored before them; False where a pivot is 0 or not finite."""
    maps, entries = plan[4], plan[5]
    for s in range(begin, end):
        t = HEAD + FIELDS * s
        width, height = plan[t + 1], plan[t + 2]
        rest = height - width
        panel = factors[plan[t + 5] : plan[t + 5] + width * height]
        square = work[plan[t + 9] : plan[t + 9] + rest * rest]
        for k in range(panel.size):
            panel[k] = 0.0
        for k in range(square.size):
            square[k] = 0.0
        for e in range(entries + 2 * plan[t + 6], entries + 2 * plan[t + FIELDS + 6], 2):
            if plan[e + 1] < panel.size:
                panel[plan[e + 1]] += values[plan[e]]
        child = plan[t + 7]
        while child >= 0:
            c = HEAD + FIELDS * child
            below = plan[c + 2] - plan[c + 1]
            take_in(panel, width, height, square, work[plan[c + 9] :], below, plan[maps + plan[c + 4] :])
            child = plan[c + 8]
        for low in range(0, width, BLOCK):
            high = min(low + BLOCK, width)
            if not eliminate(panel, height, low, high):
                return False
            update(panel, height, low, high, panel, height, 0, high, width)
            update(panel, height, low, high, square, rest, width, width, height)
    return True


@kernel(PIECE)
def piece(number, t, values, factors, work, plan):
    """The fronts of a piece; its third integer says that all pivots were regular."""
    at = plan[PIECES_AT] + 3 * number
    plan[at + 2] = 1 if factor_fronts(plan, values, factors, work, plan[at], plan[at + 1]) else 0


@lean(FACTOR_SYMMETRIC, inner=True)
def factor_symmetric(plan, values, factors, work):
    """Factor as fronts_kernels.factor_system does; half of the values is read."""
    over_threads(plan[ENTRY], plan[THREADS], plan[PIECE_AT], plan[PIECES], 0.0, values, factors, work, plan)
    done = 0
    for at in range(plan[PIECES_AT], plan[PIECES_AT] + 3 * plan[PIECES], 3):
        if plan[at + 2] == 0 or not factor_fronts(plan, values, factors, work, done, plan[at]):
            return False
        done = plan[at + 1]
    return factor_fronts(plan, values, factors, work, done, plan[1])
