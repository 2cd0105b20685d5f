# mypy: ignore-errors
"""Coulomb's law for few contacts, with all ties: a dense complementarity problem, solved to rounding.

s = W x + b, with s the rows' speeds (or accelerations) and x their impulses (or forces). Of a tie s = 0; of a contact
s_N >= 0, x_N >= 0, s_N x_N = 0, and |x_T| <= mu x_N with x_T against s_T where it slides; so is a moment of at most a
length times x_N, and what has bounds of its own, as a motor. A semismooth Newton method on
the projections (Alart & Curnier 1991), by steps of the proximal method of multipliers (Rockafellar 1976), so that
redundant rows share what the least change of the guess gives them.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.contacts.rigid_exact.law_kinds import ACROSS, ALONG, BILATERAL, BOUNDED, MOMENT, NORMAL, UNILATERAL
from sceneql.linear.dense_kernels import factor, solve
from sceneql.system.signatures_kernels import A, F, I, N

STIFF, SOFT = 1e9, 1e3
"""Stiffness of the proximal steps, of the rows' effective masses: the last, and that which finds its way."""
EASE = 2.0**-7
"""Part of the effective masses' inverses by which rows yield at first."""
EXACT, ENOUGH = 2e-15, 1e-12
"""What may be left of a row, of the sizes of the numbers in it, to need no further step; what is taken for rounding
where further steps make it no smaller."""
GOOD = 1e-10
"""What is taken for a solution where the numbers allow no better one."""
FIRST, MOST = 25, 60
"""Newton's steps of the first try, and of the others."""
POOR = 10
"""Steps in one try that do not lessen what is left."""
HALVINGS = 7
"""Most lengths of a step that are tried."""
FEWEST, SWEEPS, LAST = 25, 400, 1_000_000
"""Sweeps of block relaxation before the second try, and the third; those before the last, of a system of one row."""

VECTORS = 9
"""Vectors of length n of scratch, before the matrix: sizes, projections, the step, points, the best x, the last x, and,
given by the caller, sizes of the numbers that b is a sum of, and the bounds: the lower (of a moment its length over
the normal force), and the upper. Behind the matrix stands what is left, as a sum of squares
(in energies), and after it how many operations it took."""

MANY = 30
"""Rows from which an interior-point method leads to the solution, where Newton's does not find it from the guess."""

interior = lazy("sceneql.contacts.rigid_exact.exact_interior_kernels:interior", types.boolean(N, A, A, I, F, A))

WORST = F(N, A, A, I, F, A, A, A)
TRY = types.boolean(N, A, A, I, F, A, A, A, I, F, N)


@lean_inlined
def projected(n, kinds, i, z, mu, work, to):
    """Write the projection of a row's z (of three rows of a contact, or of a moment) to ``to``."""
    kind = kinds[i]
    if kind == BILATERAL:
        to[i] = z[i]
    elif kind == UNILATERAL:
        to[i] = max(0.0, z[i])
    elif kind == NORMAL:
        to[i] = max(0.0, z[i])
        length, bound = math.sqrt(z[i + 1] * z[i + 1] + z[i + 2] * z[i + 2]), mu * to[i]
        part = 1.0 if length <= bound else bound / length
        to[i + 1], to[i + 2] = part * z[i + 1], part * z[i + 2]
    elif kind == BOUNDED:
        to[i] = min(work[8 * n + i], max(work[7 * n + i], z[i]))
    elif kind == MOMENT:
        length = math.sqrt(z[i] * z[i] + z[i + 1] * z[i + 1] + z[i + 2] * z[i + 2])
        bound = work[7 * n + i] * to[kinds[n + i]]
        part = 1.0 if length <= bound else bound / length
        to[i], to[i + 1], to[i + 2] = part * z[i], part * z[i + 1], part * z[i + 2]


@lean_inlined
def softness(n, w, kinds, i):
    """The inverse of a row's effective mass; 0 where no mass can meet it."""
    if kinds[i] == ACROSS:
        return 0.5 * (w[i * n + i] + w[(i + 1) * n + i + 1])
    if kinds[i] == ALONG:
        return 0.5 * (w[i * n + i] + w[(i - 1) * n + i - 1])
    if kinds[i] >= MOMENT:
        first = i - (kinds[i] - MOMENT)
        total = 0.0
        for k in range(first, first + 3):
            total += w[k * n + k]
        return total / 3.0
    return abs(w[i * n + i])


@lean(WORST)
def left(n, w, b, kinds, mu, x, s, work):
    """Write s; what is left of the law, the largest against the size of the numbers in its row."""
    sizes, to, z, given = work[:n], work[n : 2 * n], work[3 * n : 4 * n], work[6 * n : 7 * n]
    largest = 0.0
    for i in range(n):
        total, size = b[i], max(abs(b[i]), given[i])
        for j in range(n):
            part = w[i * n + j] * x[j]
            total += part
            size += abs(part)
        s[i] = total
        sizes[i] = size
        largest = max(largest, size)
    for i in range(n):
        soft = softness(n, w, kinds, i)
        z[i] = x[i] - s[i] / soft if soft > 0.0 else x[i]
    worst = every = merit = 0.0
    for i in range(n):
        projected(n, kinds, i, z, mu, work, to)
    for i in range(n):
        size = max(sizes[i], 1e-6 * largest)
        every += s[i]
        merit += (x[i] - to[i]) ** 2 * softness(n, w, kinds, i)
        size = size if size > 0.0 else abs(to[i]) * softness(n, w, kinds, i)
        if size > 0.0:
            worst = max(worst, abs(x[i] - to[i]) * softness(n, w, kinds, i) / size)
    work[VECTORS * n + n * n] = merit
    return worst if abs(every) < math.inf else math.inf


@lean(types.boolean(N, A, I, F, A, A, A, I, F))
def newton(n, w, kinds, mu, x, s, work, pivots, stiff):
    """One step of Newton's method from x, s; False where the matrix is singular."""
    to, step, z = work[n : 2 * n], work[2 * n : 3 * n], work[3 * n : 4 * n]
    matrix = work[VECTORS * n : VECTORS * n + n * n]
    for i in range(n):
        soft = softness(n, w, kinds, i)
        z[i] = x[i] - stiff * s[i] / soft if soft > 0.0 else x[i]
    for i in range(n):
        projected(n, kinds, i, z, mu, work, to)
    for i in range(n):
        row, kind = i * n, kinds[i]
        soft = softness(n, w, kinds, i)
        by = stiff / soft if soft > 0.0 else 0.0
        own = across = normal = length = 0.0
        # The derivative of the projection: by this row's z, the other tangent's, the normal's.
        first = i
        force = i
        if kind == BILATERAL:
            own = 1.0
        elif kind == UNILATERAL or kind == NORMAL:
            own = 1.0 if z[i] > 0.0 else 0.0
        elif kind == BOUNDED:
            own = 1.0 if work[7 * n + i] < z[i] < work[8 * n + i] else 0.0
        elif kind >= MOMENT:
            first, force = i - (kind - MOMENT), kinds[n + i]
            length = math.sqrt(z[first] ** 2 + z[first + 1] ** 2 + z[first + 2] ** 2)
            reach = work[7 * n + i]
            bound = reach * max(0.0, z[force])
            if length <= bound and bound > 0.0:
                own = 1.0
            elif bound > 0.0:
                own, across, normal = bound / length, -bound / length, reach * z[i] / length
        else:
            force = i - 1 if kind == ACROSS else i - 2
            first = i - 1 if kind == ACROSS else i - 2
            p, q, bound = z[first + 1], z[first + 2], mu * max(0.0, z[first])
            length = math.sqrt(p * p + q * q)
            if length <= bound and bound > 0.0:
                own = 1.0
            elif bound > 0.0:
                d, e = p / length, q / length
                part = bound / length
                mine, other = (d, e) if kind == ACROSS else (e, d)
                own = part * (1.0 - mine * mine)
                across = -part * mine * other
                normal = mu * mine
        for j in range(n):
            matrix[row + j] = by * own * w[row + j]
        if across != 0.0 and kind >= MOMENT:
            for k in range(first, first + 3):
                part = across * z[i] * z[k] / (length * length)
                for j in range(n):
                    matrix[row + j] += by * part * w[k * n + j]
        elif across != 0.0:
            twin = first + 2 if kind == ACROSS else first + 1
            for j in range(n):
                matrix[row + j] += by * across * w[twin * n + j]
        if normal != 0.0:
            stiffer = stiff / softness(n, w, kinds, force)
            for j in range(n):
                matrix[row + j] += stiffer * normal * w[force * n + j]
        matrix[row + i] += 1.0
        step[i] = to[i] - x[i]
        # Rows of one size, so that the largest pivot is one.
        largest = 0.0
        for j in range(n):
            largest = max(largest, abs(matrix[row + j]))
        for j in range(n):
            matrix[row + j] /= largest
        step[i] /= largest
    work[VECTORS * n + n * n + 1] += n * n * n + 10.0 * n * n
    if not factor(matrix, n, pivots):
        return False
    solve(matrix, n, pivots, step)
    for i in range(n):
        x[i] += step[i]
    return True


@lean(types.boolean(N, A, A, I, F, A, A, A, I, F))
def damped(n, w, b, kinds, mu, x, s, work, pivots, stiff):
    """A step of Newton's method, halved until it lessens what is left; False where the matrix is singular."""
    old, merit_at = work[5 * n : 6 * n], VECTORS * n + n * n
    before = work[merit_at]
    for i in range(n):
        old[i] = x[i]
    if not newton(n, w, kinds, mu, x, s, work, pivots, stiff):
        return False
    step = work[2 * n : 3 * n]
    part, best, found = 1.0, math.inf, 1.0
    for _ in range(HALVINGS):
        for i in range(n):
            x[i] = old[i] + part * step[i]
        left(n, w, b, kinds, mu, x, s, work)
        if work[merit_at] < best:
            best, found = work[merit_at], part
        if work[merit_at] <= (1.0 - 0.1 * part) * before:
            break
        part *= 0.5
    for i in range(n):
        x[i] = old[i] + found * step[i]
    return True


@lean(TRY)
def attempt(n, w, b, kinds, mu, x, s, work, pivots, stiff, most):
    """Newton's steps from x; whether they find the solution. The best x that is met stands in the scratch."""
    best_x = work[4 * n : 5 * n]
    before, best, poor = math.inf, math.inf, 0
    for number in range(most + 1):
        worst = left(n, w, b, kinds, mu, x, s, work)
        if worst < best:
            for i in range(n):
                best_x[i] = x[i]
        if worst <= EXACT or (worst <= ENOUGH and worst > 0.5 * before):
            if worst > best:
                for i in range(n):
                    x[i] = best_x[i]
                left(n, w, b, kinds, mu, x, s, work)
            return True
        if worst > 0.9 * best:
            poor += 1
        if number == most or poor > POOR or not worst < math.inf:
            break
        before, best = worst, min(best, worst)
        if not damped(n, w, b, kinds, mu, x, s, work, pivots, stiff):
            break
    for i in range(n):
        x[i] = best_x[i] if best < math.inf else 0.0
    return left(n, w, b, kinds, mu, x, s, work) <= GOOD


@lean(types.void(N, A, A, I, F, A, A, A, N))
def relax(n, w, b, kinds, mu, x, s, work, sweeps):
    """Sweeps of projected relaxation, contact by contact (Jean 1999)."""
    to, z = work[n : 2 * n], work[3 * n : 4 * n]
    work[VECTORS * n + n * n + 1] += float(sweeps) * n * n
    for _ in range(sweeps):
        i = 0
        while i < n:
            count = 3 if kinds[i] == NORMAL or kinds[i] == MOMENT else 1
            for k in range(i, i + count):
                total = b[k]
                for j in range(n):
                    total += w[k * n + j] * x[j]
                soft = softness(n, w, kinds, k)
                z[k] = x[k] - total / soft if soft > 0.0 else x[k]
            projected(n, kinds, i, z, mu, work, to)
            for k in range(i, i + count):
                x[k] = to[k]
            i += count


@lean(types.boolean(N, A, A, I, F, A, A, A, I))
def search(n, w, b, kinds, mu, x, s, work, pivots):
    """Soft steps of Newton's method, then stiff ones, from nothing; whether they find the solution."""
    for i in range(n):
        x[i] = 0.0
    if attempt(n, w, b, kinds, mu, x, s, work, pivots, SOFT, MOST):
        return True
    return attempt(n, w, b, kinds, mu, x, s, work, pivots, STIFF, FIRST)


@lean(types.boolean(N, A, A, I, F, A, A, A, I, types.boolean))
def solve_law(n, w, b, kinds, mu, x, s, work, pivots, thorough):
    """Solve for x and s (n,) from the guess x; whether the law holds to rounding.

    Not ``thorough``: what is nearly a solution will do, as where rows contradict each other by rounding.

    ``w`` (n, n) row by row; ``kinds`` (2 n,); ``work``: VECTORS n + n n + 2 numbers; ``pivots`` (n,).
    """
    # Where forces are not unique, those near the guess; else nearly those of rows that yield a little.
    if attempt(n, w, b, kinds, mu, x, s, work, pivots, STIFF, FIRST):
        # Stiff steps leave the rounding of rows that depend on one another; soft ones from there less, if any.
        if thorough and left(n, w, b, kinds, mu, x, s, work) > ENOUGH:
            attempt(n, w, b, kinds, mu, x, s, work, pivots, SOFT, FIRST)
        return True
    if n >= MANY and thorough and interior(n, w, b, kinds, mu, x):
        work[VECTORS * n + n * n + 1] += 30.0 * n * n * n
        if attempt(n, w, b, kinds, mu, x, s, work, pivots, STIFF, FIRST):
            return True
    for i in range(n):
        x[i] = 0.0
    sweeps = FEWEST
    while sweeps <= SWEEPS:
        relax(n, w, b, kinds, mu, x, s, work, sweeps)
        if left(n, w, b, kinds, mu, x, s, work) <= EXACT:
            return True
        if attempt(n, w, b, kinds, mu, x, s, work, pivots, STIFF, FIRST):
            return True
        if not thorough:
            return False
        sweeps *= 4
    for i in range(n):
        w[i * n + i] *= 1.0 + EASE
    search(n, w, b, kinds, mu, x, s, work, pivots)
    for i in range(n):
        w[i * n + i] /= 1.0 + EASE
    if attempt(n, w, b, kinds, mu, x, s, work, pivots, STIFF, FIRST):
        return True
    if attempt(n, w, b, kinds, mu, x, s, work, pivots, SOFT, MOST):
        return True
    if search(n, w, b, kinds, mu, x, s, work, pivots):
        return True
    # What cannot be solved so stays near what relaxation finds: it never pulls, and has friction's bound.
    for i in range(n):
        x[i] = 0.0
    relax(n, w, b, kinds, mu, x, s, work, max(SWEEPS, LAST // (n * n)))
    return left(n, w, b, kinds, mu, x, s, work) <= GOOD or attempt(n, w, b, kinds, mu, x, s, work, pivots, STIFF, FIRST)
