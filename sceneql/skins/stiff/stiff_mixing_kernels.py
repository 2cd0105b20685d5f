# mypy: ignore-errors
"""Anderson's mixing of the latest updates of closed lines, where these converge slowly.

An update leaves out how pulls that move push the fluid elsewhere, which the lowest modes of a line feel: few, and so
the updates before tell what is left of them. Source: Anderson (1965), J. ACM 12, 547-560; Walker & Ni (2011), SIAM J.
Numer. Anal. 49, 1715-1735.

``past``: of each of LATEST updates what vertices moved by (sides, 2), where they came to (sides, 2), and the tensions
(sides,); then the Gram matrix (DEEP, DEEP), its right side and the solution.
"""

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.skins.skin_layout import COUNT, POSITION_AT
from sceneql.skins.stiff.stiff_lines_kernels import FIRST, HEAD, LINE, LINES, SIDES
from sceneql.skins.stiff.stiff_matrix_kernels import factor, substitute
from sceneql.system.signatures_kernels import A, I, N

DEEP = 5
"""Differences of updates that are mixed."""
LATEST = DEEP + 1
PAST, GRAM = 5 * LATEST, DEEP * (DEEP + 2)
"""Numbers a side of what is remembered; numbers besides."""
ROUNDING = 1e-12
"""Added to the diagonal of a Gram matrix, in parts of it."""


@lean(types.void(N, A, A, A, A, I))
def remember(turn, before, y, tensions, past, lines):
    """Remember an update from places ``before`` of vertices to those in y, and the tensions (sides,) there."""
    sides = lines[SIDES]
    own = past[5 * sides * (turn % LATEST) :]
    for number in range(lines[LINES]):
        line = lines[HEAD + LINE * number : HEAD + LINE * (number + 1)]
        for v in range(line[COUNT]):
            s = line[FIRST] + v
            for k in range(2):
                place = line[POSITION_AT] + 3 * v + k
                own[2 * s + k], own[2 * (sides + s) + k] = y[place] - before[2 * s + k], y[place]
            own[4 * sides + s] = tensions[s]


@lean(types.void(N, A, A, A, I))
def mix(turn, y, tensions, past, lines):
    """Vertices in y and tensions (sides,) by which the latest updates would move the least."""
    sides, deep = lines[SIDES], min(turn, DEEP)
    size, beside = 5 * sides, past[5 * sides * LATEST :]
    gram, right, parts = beside[: DEEP * DEEP], beside[DEEP * DEEP : DEEP * (DEEP + 1)], beside[DEEP * (DEEP + 1) :]
    now = past[size * (turn % LATEST) :]
    for i in range(deep):
        p, q = past[size * ((turn - i) % LATEST) :], past[size * ((turn - i - 1) % LATEST) :]
        for j in range(i + 1):
            u, w = past[size * ((turn - j) % LATEST) :], past[size * ((turn - j - 1) % LATEST) :]
            total = 0.0
            for k in range(2 * sides):
                total += (p[k] - q[k]) * (u[k] - w[k])
            gram[deep * i + j] = total
        gram[deep * i + i] *= 1.0 + ROUNDING
        right[i] = 0.0
        for k in range(2 * sides):
            right[i] += (p[k] - q[k]) * now[k]
    if not factor(gram, deep):
        return
    substitute(gram, deep, right, parts)
    for number in range(lines[LINES]):
        line = lines[HEAD + LINE * number : HEAD + LINE * (number + 1)]
        for v in range(line[COUNT]):
            s = line[FIRST] + v
            for i in range(deep):
                p, q = past[size * ((turn - i) % LATEST) :], past[size * ((turn - i - 1) % LATEST) :]
                for k in range(2):
                    at = 2 * (sides + s) + k
                    y[line[POSITION_AT] + 3 * v + k] -= parts[i] * (p[at] - q[at])
                tensions[s] -= parts[i] * (p[4 * sides + s] - q[4 * sides + s])
