# mypy: ignore-errors
"""Stiffness in the principal directions of a deformation, for laws that are alike in all directions.

F = U diag(s) V^T with rotations U and V, so that the least s is below 0 where the material is turned inside out
(Irving, Teran & Fedkiw 2004). The derivative of such a law's stress has nine modes: three stretches, coupled by a 3x3
matrix, and for each pair of directions a symmetric and an antisymmetric one, with (p_i -+ p_j)/(s_i -+ s_j) for their
numbers, p the derivatives of the energy by s (Smith, De Goes & Kim, Analytic eigensystems for isotropic distortion
energies, 2019). So a law tells these numbers alone; made definite, none is below 0.
"""

import math

from sceneql.compiled.kernels import lean_inlined

SWEEPS = 12
ROUNDING = 1e-16
FLAT = 1e-14
"""Stretches of less than this part of the largest have no direction of their own."""
S, U, V, MODES, OWN, TURN = 0, 3, 12, 21, 33, 42
"""Where in the scratch stand the stretches (3), U and V (9 each), the numbers of modes (12); two 3x3 of scratch.
Modes: the stretches' matrix xx, yy, zz, yz, xz, xy; the symmetric ones of yz, xz, xy; the antisymmetric."""


@lean_inlined
def turn_columns(w, p, q, c, s):
    """Columns p and q of a 3x3, row by row, times a rotation."""
    for i in range(0, 9, 3):
        a, b = w[i + p], w[i + q]
        w[i + p], w[i + q] = c * a - s * b, s * a + c * b


@lean_inlined
def swap_columns(w, p, q):
    """Columns p and q change places, one of them turned round."""
    for i in range(0, 9, 3):
        a = w[i + p]
        w[i + p], w[i + q] = w[i + q], -a


@lean_inlined
def column_length(w, p):
    """Length of a column."""
    return math.sqrt(w[p] * w[p] + w[3 + p] * w[3 + p] + w[6 + p] * w[6 + p])


@lean_inlined
def principal(f, scratch):
    """Write S, U and V of F: the columns of F V are turned until they are at right angles (Hestenes 1958)."""
    u, v = scratch[U : U + 9], scratch[V : V + 9]
    for k in range(9):
        u[k] = f[k]
        v[k] = 1.0 if k % 4 == 0 else 0.0
    for _ in range(SWEEPS):
        done = True
        for p in range(2):
            for q in range(p + 1, 3):
                a = u[p] * u[p] + u[3 + p] * u[3 + p] + u[6 + p] * u[6 + p]
                b = u[q] * u[q] + u[3 + q] * u[3 + q] + u[6 + q] * u[6 + q]
                g = u[p] * u[q] + u[3 + p] * u[3 + q] + u[6 + p] * u[6 + q]
                if abs(g) > ROUNDING * math.sqrt(a * b) and g != 0.0:
                    done = False
                    z = (b - a) / (2.0 * g)
                    t = (1.0 if z >= 0.0 else -1.0) / (abs(z) + math.sqrt(1.0 + z * z))
                    c = 1.0 / math.sqrt(1.0 + t * t)
                    turn_columns(u, p, q, c, t * c)
                    turn_columns(v, p, q, c, t * c)
        if done:
            break
    for p in range(2):
        for q in range(1, 3 - p):
            if column_length(u, q) > column_length(u, q - 1):
                swap_columns(u, q - 1, q)
                swap_columns(v, q - 1, q)
    one, two = column_length(u, 0), column_length(u, 1)
    x, y, z = u[2], u[5], u[8]
    if one == 0.0:
        for k in range(9):
            u[k] = 1.0 if k % 4 == 0 else 0.0
    else:
        for i in range(0, 9, 3):
            u[i] /= one
        if two <= FLAT * one:
            least = 0
            for k in range(1, 3):
                if abs(u[3 * k]) < abs(u[3 * least]):
                    least = k
            dot = u[3 * least]
            for k in range(3):
                u[3 * k + 1] = (1.0 if k == least else 0.0) - dot * u[3 * k]
            length = column_length(u, 1)
            for i in range(1, 9, 3):
                u[i] /= length
        else:
            for i in range(1, 9, 3):
                u[i] /= two
        u[2] = u[3] * u[7] - u[6] * u[4]
        u[5] = u[6] * u[1] - u[0] * u[7]
        u[8] = u[0] * u[4] - u[3] * u[1]
    scratch[S], scratch[S + 1] = one, two
    scratch[S + 2] = x * u[2] + y * u[5] + z * u[8]


@lean_inlined
def made_definite(a, scratch):
    """The symmetric 3x3 a (xx, yy, zz, yz, xz, xy) without its negative part, by Jacobi's rotations."""
    m = scratch[OWN : OWN + 9]
    m[0], m[4], m[8] = a[0], a[1], a[2]
    m[5] = m[7] = a[3]
    m[2] = m[6] = a[4]
    m[1] = m[3] = a[5]
    x0, x1, x2, y0, y1, y2, z0, z1, z2 = 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0
    for _ in range(SWEEPS):
        size = abs(m[0]) + abs(m[4]) + abs(m[8])
        if abs(m[1]) + abs(m[2]) + abs(m[5]) <= ROUNDING * size:
            break
        for pair in range(3):
            p, q = (0 if pair < 2 else 1), (1 if pair == 0 else 2)
            g = m[3 * p + q]
            if g == 0.0:
                continue
            z = (m[4 * q] - m[4 * p]) / (2.0 * g)
            t = (1.0 if z >= 0.0 else -1.0) / (abs(z) + math.sqrt(1.0 + z * z))
            c = 1.0 / math.sqrt(1.0 + t * t)
            s = t * c
            turn_columns(m, p, q, c, s)
            for i in range(3):
                first, second = m[3 * p + i], m[3 * q + i]
                m[3 * p + i], m[3 * q + i] = c * first - s * second, s * first + c * second
            if pair == 0:
                x0, y0 = c * x0 - s * y0, s * x0 + c * y0
                x1, y1 = c * x1 - s * y1, s * x1 + c * y1
                x2, y2 = c * x2 - s * y2, s * x2 + c * y2
            elif pair == 1:
                x0, z0 = c * x0 - s * z0, s * x0 + c * z0
                x1, z1 = c * x1 - s * z1, s * x1 + c * z1
                x2, z2 = c * x2 - s * z2, s * x2 + c * z2
            else:
                y0, z0 = c * y0 - s * z0, s * y0 + c * z0
                y1, z1 = c * y1 - s * z1, s * y1 + c * z1
                y2, z2 = c * y2 - s * z2, s * y2 + c * z2
    e, g, h = max(m[0], 0.0), max(m[4], 0.0), max(m[8], 0.0)
    a[0] = e * x0 * x0 + g * y0 * y0 + h * z0 * z0
    a[1] = e * x1 * x1 + g * y1 * y1 + h * z1 * z1
    a[2] = e * x2 * x2 + g * y2 * y2 + h * z2 * z2
    a[3] = e * x1 * x2 + g * y1 * y2 + h * z1 * z2
    a[4] = e * x0 * x2 + g * y0 * y2 + h * z0 * z2
    a[5] = e * x0 * x1 + g * y0 * y1 + h * z0 * z1


@lean_inlined
def from_modes(definite, c, scratch):
    """Write the 9x9 of the modes that stand in the scratch."""
    a, u, v = scratch[MODES : MODES + 12], scratch[U : U + 9], scratch[V : V + 9]
    if definite == 1:
        made_definite(a, scratch)
        for k in range(6, 12):
            a[k] = max(a[k], 0.0)
    for k in range(81):
        c[k] = 0.0
    row, other = scratch[OWN : OWN + 3], scratch[TURN : TURN + 3]
    # c[ij,kl] = sum over modes; U first in i and k, V in j and l.
    for i in range(3):
        for j in range(3):
            for p in range(3):
                row[p] = u[3 * i + p] * v[3 * j + p]
            other[0] = a[0] * row[0] + a[5] * row[1] + a[4] * row[2]
            other[1] = a[5] * row[0] + a[1] * row[1] + a[3] * row[2]
            other[2] = a[4] * row[0] + a[3] * row[1] + a[2] * row[2]
            at = 9 * (3 * i + j)
            for k in range(3):
                for l in range(3):
                    total = 0.0
                    for p in range(3):
                        total += other[p] * u[3 * k + p] * v[3 * l + p]
                    c[at + 3 * k + l] = total
            for n in range(3):
                p, q = (1 if n == 0 else 0), (1 if n == 2 else 2)
                half, cross = 0.5 * (a[6 + n] + a[9 + n]), 0.5 * (a[6 + n] - a[9 + n])
                pq, qp = u[3 * i + p] * v[3 * j + q], u[3 * i + q] * v[3 * j + p]
                first, second = half * pq + cross * qp, half * qp + cross * pq
                for k in range(3):
                    for l in range(3):
                        c[at + 3 * k + l] += first * u[3 * k + p] * v[3 * l + q] + second * u[3 * k + q] * v[3 * l + p]
