# mypy: ignore-errors
"""A way to the forces of many exact contacts at once, compiled at the first system that Newton's method does not solve.

Mehrotra's interior-point method with Nesterov and Todd's scaling on the dense system of exact_law_kernels, the
correction of De Saxce & Feng (1998), by which Coulomb's law is a law of cones, renewed at every iteration: as
cone_kernels does for velocities. It goes near a solution; Newton's method ends there.
"""

import math

import numpy as np
from numba import types

from sceneql.compiled.integers_kernels import filled
from sceneql.compiled.kernels import kernel, lean, lean_inlined
from sceneql.contacts.rigid_exact.law_kinds import ALONG, BILATERAL, NORMAL, UNILATERAL
from sceneql.linear.cones.cone_layout_kernels import (
    AT_DS,
    AT_DX,
    AT_ETA,
    AT_LAMBDA,
    AT_Q,
    AT_S,
    AT_SLIDE,
    AT_SLIP,
    AT_W,
    AT_X,
    CONTACT,
)
from sceneql.linear.cones.cone_points_kernels import aim, inner, scale, scaled, scaled_step, tail
from sceneql.linear.cones.cone_rows_kernels import put
from sceneql.linear.dense_kernels import factor, solve
from sceneql.system.signatures_kernels import A, F, I, N

MOST, PATIENT = 60, 12
"""Iterations, and those within which what is left must have fallen to half of its least."""
CLOSED = 1e-11
"""What may be left, of the size of the numbers, where the method ends."""
NEAR, NEARLY, CENTERED = 1e-4, 1e-2, 0.1
"""What is left from which it aims at less of the complementarity than CENTERED, and how much."""
BACK = 0.99
"""Part of the step to the boundary of the cones."""
EASE = 1e-12
"""Part of its diagonal that is added to a tie's row: ties may say the same twice."""


@lean_inlined
def write(floats, c, at, wide, values, i):
    """Write the numbers of a contact's rows, of which one without friction has one, to floats[c + at:]."""
    if wide == 3:
        put(floats, c + at, values[i], values[i + 1], values[i + 2])
    else:
        put(floats, c + at, values[i], 0.0, 0.0)


@lean(F(N, A, A, I, I, A, A, A, A), inner=True)
def look(n, w, b, first, wide, floats, x, left, sizes):
    """Write to ``left`` how far s is from what x gives, each correction renewed; the largest part that is left."""
    largest = 0.0
    for i in range(n):
        total, size = b[i], abs(b[i])
        for j in range(n):
            part = w[i * n + j] * x[j]
            total += part
            size += abs(part)
        left[i], sizes[i] = -total, size
        largest = max(largest, size)
    worst, every = 0.0, 0.0
    for k in range(first.size):
        i, c = first[k], CONTACT * k
        s = c + AT_S
        if wide[k] == 3:
            slip = math.sqrt(left[i + 1] * left[i + 1] + left[i + 2] * left[i + 2])
            # s moves with the correction as far as it stays in its cone.
            room = 0.5 * (floats[s] - tail(floats, s))
            floats[s] += max(slip - floats[c + AT_SLIP], -room)
            by = 1.0 / slip if slip > 0.0 else 0.0
            floats[c + AT_SLIP] = slip
            floats[c + AT_SLIDE], floats[c + AT_SLIDE + 1] = -by * left[i + 1], -by * left[i + 2]
            left[i] -= slip
        for j in range(wide[k]):
            left[i + j] += floats[s + j]
        size = max(sizes[i], 1e-6 * largest)
        worst = max(worst, abs(inner(floats, c + AT_X, s)) / max(size * size / w[i * n + i], floats[c + AT_X] * size))
    for i in range(n):
        worst = max(worst, abs(left[i]) / max(sizes[i], 1e-6 * largest, 1e-300))
        every += left[i]
    return worst if abs(every) < math.inf else math.inf


@lean(types.boolean(N, A, I, I, I, A, A, A, I), inner=True)
def assemble(n, w, kinds, first, wide, floats, matrix, scales, pivots):
    """Write and factor the matrix of Newton's method: of the forces' changes. False where one is outside its cone."""
    for k in range(n * n):
        matrix[k] = w[k]
    for i in range(n):
        if kinds[i] == BILATERAL:
            matrix[i * n + i] *= 1.0 + EASE
    for k in range(first.size):
        i, c = first[k], CONTACT * k
        if not scale(floats, c):
            return False
        square = floats[c + AT_ETA] * floats[c + AT_ETA]
        for p in range(wide[k]):
            for j in range(n if p > 0 else 0):
                matrix[i * n + j] += floats[c + AT_SLIDE + p - 1] * w[(i + p) * n + j]
        for p in range(wide[k]):
            for q in range(wide[k]):
                part = 2.0 * floats[c + AT_W + p] * floats[c + AT_W + q]
                unit = 1.0 if p == q else 0.0
                matrix[(i + p) * n + i + q] += square * (part + (unit if p > 0 else -unit))
    for i in range(n):
        size = 0.0
        for j in range(n):
            size = max(size, abs(matrix[i * n + j]))
        scales[i] = 1.0 / size if size > 0.0 else 1.0
        for j in range(n):
            matrix[i * n + j] *= scales[i]
    return factor(matrix, n, pivots)


@lean(F(N, A, I, I, A, A, A, I, A, A), inner=True)
def direct(n, w, first, wide, floats, matrix, scales, pivots, left, change):
    """Write the changes of x and s for the aims Q; the longest step along them, 1 at most."""
    for i in range(n):
        change[i] = left[i]
    for k in range(first.size):
        i, c = first[k], CONTACT * k
        p, q, r = scaled(floats, c, floats[c + AT_Q], floats[c + AT_Q + 1], floats[c + AT_Q + 2], 1.0)
        change[i] += p
        if wide[k] == 3:
            change[i + 1] += q
            change[i + 2] += r
    for i in range(n):
        change[i] *= scales[i]
    solve(matrix, n, pivots, change)
    longest = 1.0
    for k in range(first.size):
        i, c = first[k], CONTACT * k
        ds = c + AT_DS
        write(floats, c, AT_DX, wide[k], change, i)
        put(floats, ds, 0.0, 0.0, 0.0)
        for p in range(wide[k]):
            total = 0.0
            for j in range(n):
                total += w[(i + p) * n + j] * change[j]
            floats[ds + p] = total
        if wide[k] == 3:
            floats[ds] += floats[c + AT_SLIDE] * floats[ds + 1] + floats[c + AT_SLIDE + 1] * floats[ds + 2]
        for p in range(wide[k]):
            floats[ds + p] -= left[i + p]
        longest = min(longest, BACK * scaled_step(floats, c))
    return longest


@lean(types.void(N, A, A, I, I, A, A, A, I), inner=True)
def begin(n, w, b, first, wide, floats, x, matrix, pivots):
    """The first point: springs of the rows' effective masses in place of the law, then moved into the cones."""
    fast = 0.0
    for i in range(n):
        fast = max(fast, abs(b[i]))
        x[i] = -b[i]
        for j in range(n):
            matrix[i * n + j] = w[i * n + j]
        matrix[i * n + i] = 2.0 * w[i * n + i] if w[i * n + i] > 0.0 else 1.0
    if factor(matrix, n, pivots):
        solve(matrix, n, pivots, x)
    for k in range(first.size):
        i, c = first[k], CONTACT * k
        soft = 0.0
        for p in range(wide[k]):
            soft = max(soft, w[(i + p) * n + i + p])
        soft = soft if soft > 0.0 else 1.0
        write(floats, c, AT_X, wide[k], x, i)
        at, slip = c + AT_X, tail(floats, c + AT_X)
        put(
            floats,
            c + AT_S,
            max(-soft * floats[at], soft * slip) + fast,
            -soft * floats[at + 1],
            -soft * floats[at + 2],
        )
        floats[at] = max(floats[at], slip) + fast / soft
        floats[c + AT_SLIP] = soft * slip
        x[i] = floats[at]


@kernel(types.boolean(N, A, A, I, F, A), inner=True)
def interior(n, w0, b0, kinds, mu, x0):
    """Write forces near a solution to ``x0`` (n,); False where a row is of another kind than ties and contacts."""
    count = 0
    for i in range(n):
        if kinds[i] > ALONG:
            return False
        count += kinds[i] == UNILATERAL or kinds[i] == NORMAL
    first, wide = filled(count, 0), filled(count, 1)
    stretch = np.ones(n)
    count = 0
    for i in range(n):
        if kinds[i] == UNILATERAL or kinds[i] == NORMAL:
            first[count] = i
            if kinds[i] == NORMAL:
                wide[count], stretch[i] = 3, 1.0 / mu
            count += 1
    floats, w, b = np.zeros(CONTACT * count), np.empty(n * n), np.empty(n)
    x, left, sizes, scales, change, best_x = (
        np.zeros(n),
        np.empty(n),
        np.empty(n),
        np.empty(n),
        np.empty(n),
        np.zeros(n),
    )
    matrix, pivots = np.empty(n * n), filled(n, 0)
    for i in range(n):
        b[i] = stretch[i] * b0[i]
        for j in range(n):
            w[i * n + j] = stretch[i] * w0[i * n + j] * stretch[j]
    begin(n, w, b, first, wide, floats, x, matrix, pivots)
    best, half, since = math.inf, math.inf, 0
    for number in range(MOST):
        worst = look(n, w, b, first, wide, floats, x, left, sizes)
        if worst < best:
            best = worst
            for i in range(n):
                best_x[i] = x[i]
        if worst <= 0.5 * half:
            half, since = worst, number
        if worst <= CLOSED or number - since >= PATIENT or not worst < math.inf:
            break
        if not assemble(n, w, kinds, first, wide, floats, matrix, scales, pivots):
            break
        total = 0.0
        for k in range(count):
            c = CONTACT * k
            total += inner(floats, c + AT_X, c + AT_S)
            point = c + AT_LAMBDA
            put(floats, c + AT_Q, -floats[point], -floats[point + 1], -floats[point + 2])
        rest = 1.0 - direct(n, w, first, wide, floats, matrix, scales, pivots, left, change)
        least = CENTERED if worst > NEAR else NEARLY
        centered = max(least, rest * rest * rest) * total / max(1, count)
        for k in range(count):
            aim(floats, CONTACT * k, centered)
        part = direct(n, w, first, wide, floats, matrix, scales, pivots, left, change)
        for i in range(n):
            x[i] += part * change[i]
        for k in range(count):
            c = CONTACT * k
            for j in range(3):
                floats[c + AT_X + j] += part * floats[c + AT_DX + j]
                floats[c + AT_S + j] += part * floats[c + AT_DS + j]
            slope = floats[c + AT_SLIDE] * (floats[c + AT_DS + 1]) + floats[c + AT_SLIDE + 1] * floats[c + AT_DS + 2]
            floats[c + AT_SLIP] += part * slope if wide[k] == 3 else 0.0
    for i in range(n):
        x0[i] = stretch[i] * best_x[i]
    return best < math.inf
