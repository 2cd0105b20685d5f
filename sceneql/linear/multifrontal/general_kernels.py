# mypy: ignore-errors
"""Multifrontal LU factors of unsymmetric matrices, compiled at the first such matrix (systems_kernels)."""

import math

from numba import types

from sceneql.compiled.arithmetic_kernels import fma, widest
from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.linear.multifrontal import layout
from sceneql.linear.multifrontal.entries_kernels import FACTOR_GENERAL, SOLVE_GENERAL, put
from sceneql.system.signatures_kernels import A, N

TILE = 256
"""Columns of a tile of the update."""
BLOCK = 48
"""Rows that are eliminated before the rest of a front is updated: their part of a tile stays in the cache."""

UPDATE = types.void(A, N, N, N, N, N)


@lean(UPDATE, inner=True)
def update(front, height, begin, end, low, high):
    """Rows low..high less L U of the rows begin..end, from column ``low`` on.

    Four rows by four at a time; L stands in its place. Products and sums are fused, which is twice as fast.
    """
    widest()
    for tile in range(low, height, TILE):
        edge = min(tile + TILE, height)
        for i in range(low, high, 4):
            a = i * height
            if i + 4 > high:
                for row in range(a, high * height, height):
                    for k in range(begin, end):
                        p = -front[row + k]
                        for j in range(tile, edge):
                            front[row + j] = fma(p, front[k * height + j], front[row + j])
                continue
            b, c, d = a + height, a + 2 * height, a + 3 * height
            first, second = front[a + tile : a + edge], front[b + tile : b + edge]
            third, fourth = front[c + tile : c + edge], front[d + tile : d + edge]
            k = begin
            while k + 4 <= end:
                p0, p1, p2, p3 = -front[a + k], -front[a + k + 1], -front[a + k + 2], -front[a + k + 3]
                q0, q1, q2, q3 = -front[b + k], -front[b + k + 1], -front[b + k + 2], -front[b + k + 3]
                r0, r1, r2, r3 = -front[c + k], -front[c + k + 1], -front[c + k + 2], -front[c + k + 3]
                s0, s1, s2, s3 = -front[d + k], -front[d + k + 1], -front[d + k + 2], -front[d + k + 3]
                u0 = front[k * height + tile : k * height + edge]
                u1 = front[(k + 1) * height + tile : (k + 1) * height + edge]
                u2 = front[(k + 2) * height + tile : (k + 2) * height + edge]
                u3 = front[(k + 3) * height + tile : (k + 3) * height + edge]
                for j in range(first.size):
                    x0, x1, x2, x3 = u0[j], u1[j], u2[j], u3[j]
                    first[j] = fma(p3, x3, fma(p2, x2, fma(p1, x1, fma(p0, x0, first[j]))))
                    second[j] = fma(q3, x3, fma(q2, x2, fma(q1, x1, fma(q0, x0, second[j]))))
                    third[j] = fma(r3, x3, fma(r2, x2, fma(r1, x1, fma(r0, x0, third[j]))))
                    fourth[j] = fma(s3, x3, fma(s2, x2, fma(s1, x1, fma(s0, x0, fourth[j]))))
                k += 4
            while k < end:
                p0, q0, r0, s0 = -front[a + k], -front[b + k], -front[c + k], -front[d + k]
                u0 = front[k * height + tile : k * height + edge]
                for j in range(first.size):
                    x0 = u0[j]
                    first[j] = fma(p0, x0, first[j])
                    second[j] = fma(q0, x0, second[j])
                    third[j] = fma(r0, x0, third[j])
                    fourth[j] = fma(s0, x0, fourth[j])
                k += 1


@lean_inlined
def eliminate(front, height, begin, end, pivots):
    """Factor rows begin..end to U, with pivoting among these rows alone, and L below them."""
    for k in range(begin, end):
        row = k * height
        best = k
        for i in range(k + 1, end):
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
        for i in range(k + 1, height):
            below = i * height
            factor = front[below + k] * inverse
            front[below + k] = factor
            if factor != 0.0:
                for j in range(k + 1, height if i < end else end):
                    front[below + j] -= factor * front[row + j]
    return True


@lean_inlined
def take_in(front, height, child, rest, runs):
    """Add a child's update (rest x rest) at its places in the front, in runs (end in the update, place)."""
    first = run = 0
    while first < rest:
        end, place = runs[run], runs[run + 1]
        for i in range(first, end):
            low = (place + i - first) * height
            begin = other = 0
            while begin < rest:
                stop = runs[other]
                at = low + runs[other + 1]
                into, part = front[at : at + stop - begin], child[i * rest + begin : i * rest + stop]
                for j in range(part.size):
                    into[j] += part[j]
                begin = stop
                other += 2
        first = end
        run += 2


@lean(FACTOR_GENERAL, inner=True)
def factor_general(plan, values, factors, work):
    """Factor as systems_kernels.factor_system does."""
    maps, entries, pivots = plan[4], plan[5], plan[6]
    front = work[plan[7] :]
    for s in range(plan[1]):
        t = layout.HEAD + layout.FIELDS * s
        width, height, panel = plan[t + 1], plan[t + 2], plan[t + 5]
        rest = height - width
        for k in range(height * height):
            front[k] = 0.0
        put(plan, values, 1.0, front, height, entries + 2 * plan[t + 6], entries + 2 * plan[t + layout.FIELDS + 6])
        child = plan[t + 7]
        while child >= 0:
            c = layout.HEAD + layout.FIELDS * child
            below = plan[c + 2] - plan[c + 1]
            take_in(front, height, work[plan[c + 9] :], below, plan[maps + plan[c + 4] :])
            child = plan[c + 8]
        for begin in range(0, width, BLOCK):
            end = min(begin + BLOCK, width)
            if not eliminate(front, height, begin, end, plan[pivots + plan[t] :]):
                return False
            update(front, height, begin, end, end, height)
        for k in range(width * height):
            factors[panel + k] = front[k]
        panel += width * height
        for i in range(width, height):
            for k in range(width):
                factors[panel + (i - width) * width + k] = front[i * height + k]
        top = plan[t + 9]
        for i in range(rest):
            at = (width + i) * height + width
            for j in range(rest):
                work[top + i * rest + j] = front[at + j]
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


@lean(SOLVE_GENERAL, inner=True)
def solve_general(plan, factors, b, work):
    """Solve as systems_kernels.solve_system does."""
    n, fronts, order, rows, pivots = plan[0], plan[1], plan[2], plan[3], plan[6]
    x = work[:n]
    reached = work[n:]
    for k in range(n):
        x[k] = b[plan[order + k]]
    for s in range(fronts):
        t = layout.HEAD + layout.FIELDS * s
        first, width, height, panel = plan[t], plan[t + 1], plan[t + 2], plan[t + 5]
        row = rows + plan[t + 3]
        own = x[first:]
        for k in range(width):
            swap = plan[pivots + first + k]
            own[k], own[swap] = own[swap], own[k]
        for k in range(1, width):
            own[k] -= product(factors[panel + k * height :], own, k)
        below = panel + width * height
        for i in range(width, height):
            x[plan[row + i]] -= product(factors[below + (i - width) * width :], own, width)
    for s in range(fronts - 1, -1, -1):
        t = layout.HEAD + layout.FIELDS * s
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
