# mypy: ignore-errors
"""How tensions grow as sides become longer, and couples as they turn, as a square root: K = R R', sides by sides.

Tensions grow by the law; couples by the tension times the length, and by bending, which resists one side turning more
than the next. Unknowns of a linear system are these changes by R, so that a law that never grows, or without bound, is
as good as any: first ``alongs`` of lengths, then ``acrosses`` of turns, each as many as sides or none.

``roots`` (4, sides): of tensions the root; of couples of each line the diagonal of R, what is below it, and the last
row.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.skins.bend_line_kernels import corner
from sceneql.skins.closed_line_kernels import slope
from sceneql.skins.skin_layout import COUNT, LENGTHS_AT, POSITION_AT
from sceneql.skins.stiff.stiff_lines_kernels import BENT, FIRST, HEAD, LINE, LINES, SIDES
from sceneql.system.signatures_kernels import A, I, N

FREE = 1e-6
"""What is added to a diagonal, in parts of bending: a line that turns as a whole bends nowhere."""


@lean(types.void(A, A, A, A, A, I))
def find_roots(y, tensions, sizes, roots, floats, lines):
    """The roots of lines with vertices at places in y, tensions (sides,) [N], and sides of ``sizes`` (sides,) [m].

    A line that is pressed together turns by itself: that is left out.
    """
    sides = lines[SIDES]
    for number in range(lines[LINES]):
        line = lines[HEAD + LINE * number : HEAD + LINE * (number + 1)]
        count, first = line[COUNT], line[FIRST]
        for v in range(count):
            s, rest = first + v, floats[line[LENGTHS_AT] + v]
            roots[s] = math.sqrt(slope(sizes[s] / rest, floats, line) / rest)
        last = first + count - 1
        diagonal = roots[sides + first : sides + last + 1]
        below, row = roots[2 * sides + first : 2 * sides + last + 1], roots[3 * sides + first : 3 * sides + last + 1]
        for v in range(count):
            diagonal[v], below[v], row[v] = max(tensions[first + v], 0.0) * sizes[first + v], 0.0, 0.0
        if line[BENT] >= 0:
            for v in range(count):
                before = v - 1 if v > 0 else count - 1
                grows = corner(y, line[POSITION_AT], count, v, floats[line[BENT]])[4]
                diagonal[v] += (1.0 + FREE) * grows
                diagonal[before] += (1.0 + FREE) * grows
                below[before] -= grows
        row[0] = below[count - 1]
        below[count - 1] = 0.0
        row[count - 2] += below[count - 2]
        total = 0.0
        for v in range(count - 1):
            diagonal[v] = math.sqrt(diagonal[v])
            part = 1.0 / diagonal[v] if diagonal[v] > 0.0 else 0.0
            row[v] *= part
            total += row[v] * row[v]
            if v < count - 2:
                below[v] *= part
                diagonal[v + 1] -= below[v] * below[v]
                row[v + 1] -= below[v] * row[v]
            else:
                below[v] = 0.0
        diagonal[count - 1] = math.sqrt(max(diagonal[count - 1] - total, 0.0))


@lean(types.void(A, N, N, A, A, I))
def by_roots(x, alongs, acrosses, roots, out, lines):
    """out (2, sides): R x, changes of tensions [N] and of couples [N m] by unknowns."""
    sides = lines[SIDES]
    for s in range(sides):
        out[s] = roots[s] * x[s] if alongs > 0 else 0.0
        out[sides + s] = 0.0
    if acrosses == 0:
        return
    for number in range(lines[LINES]):
        first, count = lines[HEAD + LINE * number + FIRST], lines[HEAD + LINE * number + COUNT]
        last = count - 1
        diagonal, below, row = roots[sides + first :], roots[2 * sides + first :], roots[3 * sides + first :]
        z, found = x[alongs + first :], out[sides + first :]
        total = diagonal[last] * z[last]
        for v in range(last):
            found[v] = diagonal[v] * z[v] + (below[v - 1] * z[v - 1] if v > 0 else 0.0)
            total += row[v] * z[v]
        found[last] = total


@lean(types.void(A, A, A, I))
def turned(x, roots, out, lines):
    """out (sides,): R' x of turns alone; may be x."""
    sides = lines[SIDES]
    for number in range(lines[LINES]):
        first, count = lines[HEAD + LINE * number + FIRST], lines[HEAD + LINE * number + COUNT]
        last = count - 1
        diagonal, below, row = roots[sides + first :], roots[2 * sides + first :], roots[3 * sides + first :]
        end = x[first + last]
        for v in range(last):
            found = diagonal[v] * x[first + v] + row[v] * end
            out[first + v] = found + (below[v] * x[first + v + 1] if v < last - 1 else 0.0)
        out[first + last] = diagonal[last] * end


@lean(types.void(A, N, N, A, A, I))
def by_roots_across(strains, alongs, acrosses, roots, out, lines):
    """out: R' strains, which are (2, sides): of lengths and of turns. May be ``strains`` in place where alongs > 0."""
    sides = lines[SIDES]
    for s in range(alongs):
        out[s] = roots[s] * strains[s]
    if acrosses > 0:
        turned(strains[sides:], roots, out[alongs:], lines)


@lean(types.void(A, A, A, A, A, I))
def in_parts(changes, along, sizes, out, floats, lines):
    """(sides, 2) what sides pull at their ends [N] by changes (2, sides) of tensions [N] and couples [N m]."""
    sides = lines[SIDES]
    for s in range(sides):
        across = changes[sides + s] / sizes[s]
        out[2 * s] = changes[s] * along[2 * s] - across * along[2 * s + 1]
        out[2 * s + 1] = changes[s] * along[2 * s + 1] + across * along[2 * s]


@lean(types.void(A, N, N, N, A, I))
def between_roots(matrix, alongs, acrosses, unknowns, roots, lines):
    """1 + R' M R in place of M (unknowns, unknowns) by lengths and turns, its lower half; all of it by turns is
    written."""
    for i in range(unknowns):
        row = matrix[unknowns * i : unknowns * (i + 1)]
        for j in range(min(i + 1, alongs)):
            row[j] *= roots[j]
        if i < alongs:
            for j in range(i + 1):
                row[j] *= roots[i]
        else:
            for j in range(alongs, i):
                matrix[unknowns * j + i] = row[j]
    for i in range(alongs, unknowns):
        own = matrix[unknowns * i + alongs : unknowns * (i + 1)]
        turned(own, roots, own, lines)
    sides = lines[SIDES]
    for number in range(lines[LINES] if acrosses > 0 else 0):
        first, count = lines[HEAD + LINE * number + FIRST], lines[HEAD + LINE * number + COUNT]
        last = count - 1
        end = matrix[unknowns * (alongs + first + last) : unknowns * (alongs + first + last + 1)]
        for v in range(count):
            row = matrix[unknowns * (alongs + first + v) : unknowns * (alongs + first + v + 1)]
            d, r = roots[sides + first + v], roots[3 * sides + first + v]
            if v == last:
                for j in range(unknowns):
                    row[j] *= d
            elif v < last - 1:
                b, next = roots[2 * sides + first + v], matrix[unknowns * (alongs + first + v + 1) :]
                for j in range(unknowns):
                    row[j] = d * row[j] + r * end[j] + b * next[j]
            else:
                for j in range(unknowns):
                    row[j] = d * row[j] + r * end[j]
    for i in range(unknowns):
        matrix[unknowns * i + i] += 1.0
