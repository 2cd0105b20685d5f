# mypy: ignore-errors
"""Sparse factorization on a planned pattern by the multifrontal method, and solutions with the factors.

The integers of a plan: [unknowns, fronts, where these start: order, rows, maps, entries, pivots; floats of the stack],
then a table with FIELDS a front: first unknown, number eliminated, rows of the front, then where its rows, its map
into the parent, its factors and its entries start, its last child and the child of its parent before it (-1: none);
last a row that ends them.
A front keeps U (width x rows, the reciprocals of the pivots on its diagonal) and, where the matrix is not symmetric,
L below it ((rows - width) x width). Symmetric: A = U^T D^-1 U. Pivots are sought in the front's own rows alone.
"""

import math

from numba import types

from sceneql.kernels import lean, lean_inlined
from sceneql.system_kernels import A, I

HEAD = 8
FIELDS = 9
TILE = 256
"""Columns of a tile of the update: a tile of four rows stays in the first cache."""

FACTOR = types.boolean(I, A, A, A, types.boolean)
SOLVE = types.void(I, A, A, A, types.boolean)


@lean_inlined
def eliminate(front, height, width, pivots, symmetric):
    """Factor the first ``width`` rows and columns of a front; False where a pivot is 0 or not finite."""
    for k in range(width):
        row = k * height
        best = k
        if not symmetric:
            for i in range(k + 1, width):
                if abs(front[i * height + k]) > abs(front[best * height + k]):
                    best = i
        pivots[k] = best
        if best != k:
            swap = best * height
            for j in range(height):
                front[row + j], front[swap + j] = front[swap + j], front[row + j]
        pivot = front[row + k]
        if not 0.0 < abs(pivot) < math.inf:
            return False
        inverse = 1.0 / pivot
        front[row + k] = inverse
        for i in range(k + 1, width):
            below = i * height
            factor = front[row + i] * inverse if symmetric else front[below + k] * inverse
            if not symmetric:
                front[below + k] = factor
            if factor != 0.0:
                for j in range(i if symmetric else k + 1, height):
                    front[below + j] -= factor * front[row + j]
    return True


@lean_inlined
def lower(front, height, width, panel, symmetric):
    """L of the rows below, in their place in the front; of an unsymmetric matrix into ``panel`` too."""
    for i in range(width, height):
        at = i * height
        for k in range(width):
            inverse = front[k * height + k]
            if symmetric:
                front[at + k] = front[k * height + i] * inverse
            else:
                value = front[at + k] * inverse
                front[at + k] = value
                panel[(i - width) * width + k] = value
                for j in range(k + 1, width):
                    front[at + j] -= value * front[k * height + j]


@lean_inlined
def update(front, height, width, symmetric):
    """The rest of the front less L U: four rows and four columns of L at a time (a symmetric one's upper half)."""
    for tile in range(width, height, TILE):
        end = min(tile + TILE, height)
        for i in range(width, end if symmetric else height, 2):
            start = max(tile, i) if symmetric else tile
            a = i * height
            two = i + 1 < height
            b = a + height if two else a
            k = 0
            while two and k + 4 <= width:
                p0 = front[a + k]
                p1 = front[a + k + 1]
                p2 = front[a + k + 2]
                p3 = front[a + k + 3]
                q0 = front[b + k]
                q1 = front[b + k + 1]
                q2 = front[b + k + 2]
                q3 = front[b + k + 3]
                first = front[a + start : a + end]
                second = front[b + start : b + end]
                u0 = front[k * height + start : k * height + end]
                u1 = front[(k + 1) * height + start : (k + 1) * height + end]
                u2 = front[(k + 2) * height + start : (k + 2) * height + end]
                u3 = front[(k + 3) * height + start : (k + 3) * height + end]
                for j in range(first.size):
                    x0, x1, x2, x3 = u0[j], u1[j], u2[j], u3[j]
                    first[j] -= p0 * x0 + p1 * x1 + p2 * x2 + p3 * x3
                    second[j] -= q0 * x0 + q1 * x1 + q2 * x2 + q3 * x3
                k += 4
            while k < width:
                p = front[a + k]
                for j in range(start, end):
                    front[a + j] -= p * front[k * height + j]
                if two:
                    q = front[b + k]
                    for j in range(start, end):
                        front[b + j] -= q * front[k * height + j]
                k += 1


@lean_inlined
def take_in(front, height, child, rest, places, symmetric):
    """Add a child's update (rest x rest) at its places in the front."""
    for i in range(rest):
        at = places[i] * height
        for j in range(i if symmetric else 0, rest):
            front[at + places[j]] += child[i * rest + j]


@lean(FACTOR)
def factor(plan, values, factors, work, symmetric):
    """Factor the matrix of ``values``, in the order of the pattern planned; False where a pivot is 0 or not finite.

    ``factors`` and ``work`` of the plan's sizes; ``symmetric`` says that the values are, so that half is computed.
    """
    maps, entries, pivots = plan[4], plan[5], plan[6]
    front = work[plan[7] :]
    top = 0
    for s in range(plan[1]):
        t = HEAD + FIELDS * s
        width, height, panel = plan[t + 1], plan[t + 2], plan[t + 5]
        rest = height - width
        for k in range(height * height):
            front[k] = 0.0
        for e in range(plan[t + 6], plan[t + FIELDS + 6]):
            front[plan[entries + 2 * e + 1]] += values[plan[entries + 2 * e]]
        child = plan[t + 7]
        while child >= 0:
            c = HEAD + FIELDS * child
            below = plan[c + 2] - plan[c + 1]
            top -= below * below
            take_in(front, height, work[top:], below, plan[maps + plan[c + 4] :], symmetric)
            child = plan[c + 8]
        if not eliminate(front, height, width, plan[pivots + plan[t] :], symmetric):
            return False
        lower(front, height, width, factors[panel + width * height :], symmetric)
        for k in range(width * height):
            factors[panel + k] = front[k]
        update(front, height, width, symmetric)
        if rest > 0:
            for i in range(rest):
                at = (width + i) * height + width
                for j in range(i if symmetric else 0, rest):
                    work[top + i * rest + j] = front[at + j]
            top += rest * rest
    return True


@lean_inlined
def product(a, x, count):
    """Sum of a[k] x[k], in four parts so that additions need not wait for each other."""
    s0 = s1 = s2 = s3 = 0.0
    k = 0
    while k + 4 <= count:
        s0 += a[k] * x[k]
        s1 += a[k + 1] * x[k + 1]
        s2 += a[k + 2] * x[k + 2]
        s3 += a[k + 3] * x[k + 3]
        k += 4
    while k < count:
        s0 += a[k] * x[k]
        k += 1
    return (s0 + s1) + (s2 + s3)


@lean(SOLVE)
def solve(plan, factors, b, work, symmetric):
    """Solve by the factors of ``factor``; the solution takes the place of b."""
    n, fronts, order, rows, pivots = plan[0], plan[1], plan[2], plan[3], plan[6]
    x = work[:n]
    reached = work[n:]
    for k in range(n):
        x[k] = b[plan[order + k]]
    for s in range(fronts):
        t = HEAD + FIELDS * s
        first, width, height, panel = plan[t], plan[t + 1], plan[t + 2], plan[t + 5]
        row = rows + plan[t + 3]
        own = x[first:]
        if symmetric:
            for j in range(height - width):
                reached[j] = 0.0
            for k in range(width):
                u = factors[panel + k * height : panel + (k + 1) * height]
                value = own[k] * u[k]
                for j in range(k + 1, width):
                    own[j] -= u[j] * value
                for j in range(height - width):
                    reached[j] += u[width + j] * value
            for j in range(width, height):
                x[plan[row + j]] -= reached[j - width]
        else:
            for k in range(width):
                swap = plan[pivots + first + k]
                own[k], own[swap] = own[swap], own[k]
            for k in range(1, width):
                own[k] -= product(factors[panel + k * height :], own, k)
            below = panel + width * height
            for i in range(width, height):
                x[plan[row + i]] -= product(factors[below + (i - width) * width :], own, width)
    for s in range(fronts - 1, -1, -1):
        t = HEAD + FIELDS * s
        first, width, height, panel = plan[t], plan[t + 1], plan[t + 2], plan[t + 5]
        row = rows + plan[t + 3]
        for j in range(height):
            reached[j] = x[plan[row + j]]
        for k in range(width - 1, -1, -1):
            u = factors[panel + k * height :]
            value = (reached[k] - product(u[k + 1 :], reached[k + 1 :], height - k - 1)) * u[k]
            reached[k] = value
            x[first + k] = value
    for k in range(n):
        b[plan[order + k]] = x[k]
