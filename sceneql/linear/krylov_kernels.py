# mypy: ignore-errors
"""Sparse systems by Krylov iterations: conjugate gradients where symmetric, else BiCGStab, preconditioned by ILU(0).

The integers: [unknowns, starts of rows (n + 1), places of the diagonal (n), columns, rising in each row, number of the
preconditioner], then its own. The pattern is symmetric. Sources: Hestenes & Stiefel (1952); van der Vorst (1992), SIAM
J. Sci. Stat. Comput. 13, 631-644; ILU(0): Meijerink & van der Vorst (1977), Math. Comp. 31, 148-162.
"""

import math

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.linear.solver_kernels import FACTOR_SYSTEM, PRECONDITION, SOLVE_SYSTEM, precondition_at

REDUCTION = 1e-11
"""Relative residual at which the iterations end."""
MOST = 3000
ACCEPTED = 1e-7
"""Relative residual that is accepted after MOST iterations."""


@lean(FACTOR_SYSTEM)
def factor_system(plan, values, factors, work, symmetric):
    """ILU(0), the diagonal of U as reciprocals; a pivot that breaks down is replaced by the matrix's diagonal."""
    n = plan[0]
    diagonal, columns = 2 + n, 2 + 2 * n
    for k in range(plan[1 + n]):
        factors[k] = values[k]
    for i in range(n):
        end = plan[2 + i]
        place = plan[1 + i]
        while place < plan[diagonal + i]:
            k = plan[columns + place]
            ratio = factors[place] * factors[plan[diagonal + k]]
            factors[place] = ratio
            at = place + 1
            for other in range(plan[diagonal + k] + 1, plan[2 + k]):
                j = plan[columns + other]
                while at < end and plan[columns + at] < j:
                    at += 1
                if at == end:
                    break
                if plan[columns + at] == j:
                    factors[at] -= ratio * factors[other]
            place += 1
        own = plan[diagonal + i]
        if not factors[own] / values[own] > 1e-3:
            factors[own] = values[own]
        factors[own] = 1.0 / factors[own]
    return True


@lean_inlined
def own_at(plan):
    """Index in the plan of the number of the preconditioner."""
    n = plan[0]
    return 2 + 2 * n + plan[1 + n]


@lean(PRECONDITION)
def precondition(plan, factors, b, x):
    """x = (L U)^-1 b."""
    n = plan[0]
    diagonal, columns = 2 + n, 2 + 2 * n
    for i in range(n):
        value = b[i]
        for place in range(plan[1 + i], plan[diagonal + i]):
            value -= factors[place] * x[plan[columns + place]]
        x[i] = value
    for i in range(n - 1, -1, -1):
        value = x[i]
        for place in range(plan[diagonal + i] + 1, plan[2 + i]):
            value -= factors[place] * x[plan[columns + place]]
        x[i] = value * factors[plan[diagonal + i]]


@lean_inlined
def multiply(plan, values, x, out):
    """out = A x."""
    n = plan[0]
    columns = 2 + 2 * n
    for i in range(n):
        value = 0.0
        for place in range(plan[1 + i], plan[2 + i]):
            value += values[place] * x[plan[columns + place]]
        out[i] = value


@lean_inlined
def inner(x, y):
    """Sum of x[k] y[k]."""
    total = 0.0
    for k in range(x.size):
        total += x[k] * y[k]
    return total


@lean_inlined
def conjugate_gradients(plan, values, factors, b, x, r, z, p, q):
    """Solve from x = 0, r = b; the relative residual reached."""
    near = precondition_at(plan[own_at(plan)])
    start = math.sqrt(inner(b, b))
    left = start
    before = 1.0
    for iteration in range(MOST):
        if left <= REDUCTION * start:
            break
        near(plan, factors, r, z)
        now = inner(r, z)
        ratio = now / before if iteration else 0.0
        before = now
        for k in range(p.size):
            p[k] = z[k] + ratio * p[k]
        multiply(plan, values, p, q)
        weight = now / inner(p, q)
        for k in range(p.size):
            x[k] += weight * p[k]
            r[k] -= weight * q[k]
        left = math.sqrt(inner(r, r))
        if not left < math.inf:
            break
    return left / start


@lean_inlined
def bicgstab(plan, values, factors, b, x, r, z, p, q, s, t):
    """Solve from x = 0, r = b; the relative residual reached. b stays as the shadow residual."""
    near = precondition_at(plan[own_at(plan)])
    start = math.sqrt(inner(b, b))
    left = start
    before = weight = omega = 1.0
    for iteration in range(MOST):
        if left <= REDUCTION * start:
            break
        now = inner(b, r)
        ratio = now / before * (weight / omega) if iteration else 0.0
        before = now
        for k in range(p.size):
            p[k] = r[k] + ratio * (p[k] - omega * q[k])
        near(plan, factors, p, z)
        multiply(plan, values, z, q)
        weight = now / inner(b, q)
        for k in range(p.size):
            x[k] += weight * z[k]
            r[k] -= weight * q[k]
        near(plan, factors, r, s)
        multiply(plan, values, s, t)
        size = inner(t, t)
        omega = inner(t, r) / size if size > 0.0 else 0.0
        for k in range(p.size):
            x[k] += omega * s[k]
            r[k] -= omega * t[k]
        left = math.sqrt(inner(r, r))
        if not left < math.inf:
            break
    return left / start


@lean(SOLVE_SYSTEM)
def solve_system(plan, values, factors, b, work, symmetric):
    """Solve A x = b; x takes the place of b (n,). False where the iterations do not converge. ``work`` (8 n,)."""
    n = plan[0]
    x, r, z, p = work[:n], work[n : 2 * n], work[2 * n : 3 * n], work[3 * n : 4 * n]
    q, s, t = work[4 * n : 5 * n], work[5 * n : 6 * n], work[6 * n : 7 * n]
    size = 0.0
    for k in range(n):
        x[k] = p[k] = q[k] = 0.0
        r[k] = b[k]
        size += abs(b[k])
    if size == 0.0:
        return True
    if symmetric:
        reached = conjugate_gradients(plan, values, factors, b, x, r, z, p, q)
    else:
        reached = bicgstab(plan, values, factors, b, x, r, z, p, q, s, t)
    for k in range(n):
        b[k] = x[k]
    return reached <= ACCEPTED
