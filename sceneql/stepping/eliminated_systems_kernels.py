# mypy: ignore-errors
"""Linear systems (mu - J) d = r of an island, real and complex, reduced by elimination of trivial rows.

For a pair (x, v) with dx/dt = v, dx = (r_x + s dv)/(mu - c) with s = J_xv and c = J_xx is substituted into the other
rows; entries on which none depends, and fixed masses, have d = r/mu. The reduced matrix is factored in full.

``plan`` (stepping/eliminated_systems.py): [left m, pairs, idle, direct, through], then the m entries left; (x, v among
those left, places of c and s among the values) of each pair; the idle entries; (place of the value, place in the
matrix) of each direct value; (place of the value, row, pair) of each value in a column x.
"""

from sceneql.compiled.kernels import lean_inlined
from sceneql.linear.dense_complex_kernels import factor_complex, solve_complex
from sceneql.linear.dense_kernels import factor, solve

LEFT, PAIRS, IDLE, DIRECT, THROUGH, HEAD = range(6)


@lean_inlined
def parts(plan):
    """Where the lists of a plan begin: pairs, idle, direct, through."""
    pairs = HEAD + plan[LEFT]
    idle = pairs + 4 * plan[PAIRS]
    direct = idle + plan[IDLE]
    return pairs, idle, direct, direct + 2 * plan[DIRECT]


@lean_inlined
def factor_real(mu, values, plan, matrix, pivots):
    """Factor the reduced mu - J; False where it is singular."""
    m = plan[LEFT]
    pairs, _, direct, through = parts(plan)
    for k in range(m * m):
        matrix[k] = 0.0
    for k in range(m):
        matrix[k * m + k] = mu
    for k in range(direct, direct + 2 * plan[DIRECT], 2):
        matrix[plan[k + 1]] -= values[plan[k]]
    for k in range(through, through + 3 * plan[THROUGH], 3):
        pair = pairs + 4 * plan[k + 2]
        ratio = values[plan[pair + 3]] / (mu - values[plan[pair + 2]])
        matrix[plan[k + 1] * m + plan[pair + 1]] -= values[plan[k]] * ratio
    return factor(matrix, m, pivots)


@lean_inlined
def solve_real(mu, values, plan, matrix, pivots, right, r):
    """d in the place of r (n,); ``right`` (m,) is scratch."""
    m = plan[LEFT]
    pairs, idle, direct, through = parts(plan)
    for k in range(m):
        right[k] = r[plan[HEAD + k]]
    for pair in range(pairs, idle, 4):
        r[plan[pair]] /= mu - values[plan[pair + 2]]
    for k in range(through, through + 3 * plan[THROUGH], 3):
        right[plan[k + 1]] += values[plan[k]] * r[plan[pairs + 4 * plan[k + 2]]]
    solve(matrix, m, pivots, right)
    for k in range(m):
        r[plan[HEAD + k]] = right[k]
    for pair in range(pairs, idle, 4):
        r[plan[pair]] += values[plan[pair + 3]] / (mu - values[plan[pair + 2]]) * right[plan[pair + 1]]
    for k in range(idle, direct):
        r[plan[k]] /= mu


@lean_inlined
def factor_pair(mu, nu, values, plan, re, im, pivots):
    """Factor the reduced mu + i nu - J; False where it is singular."""
    m = plan[LEFT]
    pairs, _, direct, through = parts(plan)
    for k in range(m * m):
        re[k] = 0.0
        im[k] = 0.0
    for k in range(m):
        re[k * m + k] = mu
        im[k * m + k] = nu
    for k in range(direct, direct + 2 * plan[DIRECT], 2):
        re[plan[k + 1]] -= values[plan[k]]
    for k in range(through, through + 3 * plan[THROUGH], 3):
        pair = pairs + 4 * plan[k + 2]
        a = mu - values[plan[pair + 2]]
        scale = values[plan[k]] * values[plan[pair + 3]] / (a * a + nu * nu)
        place = plan[k + 1] * m + plan[pair + 1]
        re[place] -= scale * a
        im[place] += scale * nu
    return factor_complex(re, im, m, pivots)


@lean_inlined
def solve_pair(mu, nu, values, plan, re, im, pivots, right, left, p, q):
    """d in the place of p + i q (n,); ``right`` and ``left`` (m,) are scratch."""
    m = plan[LEFT]
    pairs, idle, direct, through = parts(plan)
    for k in range(m):
        right[k] = p[plan[HEAD + k]]
        left[k] = q[plan[HEAD + k]]
    for pair in range(pairs, idle, 4):
        x = plan[pair]
        a = mu - values[plan[pair + 2]]
        scale = 1.0 / (a * a + nu * nu)
        p[x], q[x] = scale * (p[x] * a + q[x] * nu), scale * (q[x] * a - p[x] * nu)
    for k in range(through, through + 3 * plan[THROUGH], 3):
        x = plan[pairs + 4 * plan[k + 2]]
        right[plan[k + 1]] += values[plan[k]] * p[x]
        left[plan[k + 1]] += values[plan[k]] * q[x]
    solve_complex(re, im, m, pivots, right, left)
    for k in range(m):
        p[plan[HEAD + k]] = right[k]
        q[plan[HEAD + k]] = left[k]
    for pair in range(pairs, idle, 4):
        x, v = plan[pair], plan[pair + 1]
        a = mu - values[plan[pair + 2]]
        scale = values[plan[pair + 3]] / (a * a + nu * nu)
        p[x] += scale * (right[v] * a + left[v] * nu)
        q[x] += scale * (left[v] * a - right[v] * nu)
    scale = 1.0 / (mu * mu + nu * nu)
    for k in range(idle, direct):
        i = plan[k]
        p[i], q[i] = scale * (p[i] * mu + q[i] * nu), scale * (q[i] * mu - p[i] * nu)
