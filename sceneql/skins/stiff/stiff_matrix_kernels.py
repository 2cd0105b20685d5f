# mypy: ignore-errors
"""What pulls of closed lines do to lengths and turns, as a dense matrix: by the answer to one force, and its factor.

In a box of one fluid, periodic and without solids, the answer to a force depends on where it is read from there alone:
so one answer to each component of a force, at a face in the middle, is that to all, read and spread by each vertex's
own splines. Beside walls and solids it is near enough to precondition. All offsets are into the floats.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.flows import layout as flow
from sceneql.grids.multigrid.stencil_kernels import dot
from sceneql.skins.skin_layout import BOX_AT, COUNT, DENSITY_AT, PESKIN, POSITION_AT
from sceneql.skins.spline_kernels import stencil
from sceneql.skins.stiff.stiff_lines_kernels import FIRST, HEAD, LINE, LINES, SIDES, TIE
from sceneql.system.signatures_kernels import A, F, I, N

WEIGHTS = 20
"""Of a vertex: of each component the weights of four faces along x and along y, the numbers of the first ones."""
PAIRS, MATRIX_ROOM = 7, WEIGHTS + 12
"""Faces between those of two stencils along an axis; numbers a vertex that the matrix takes besides."""


@lean(types.void(N, F, A, A, I, I))
def poke(component, amount, out, floats, lines, one):
    """out: the acceleration by a force [N] at the middle face of a component."""
    for face in range(one[flow.AT], one[flow.AT] + one[flow.FACES]):
        out[face] = 0.0
    size = one[flow.CELLS] + (component == 0 and one[flow.PERIODIC] == 0)
    middle = one[flow.STARTS + component] + one[flow.CELLS] // 2 + size * (one[flow.CELLS + 1] // 2)
    density = floats[lines[HEAD + TIE + DENSITY_AT]]
    out[one[flow.AT] + middle] = amount * floats[one[flow.INVERSES] + middle] / density


@lean(types.boolean(A, A, A, I, I))
def weigh(y, out, floats, lines, one):
    """The WEIGHTS of all vertices at places in y; whether these are finite."""
    for number in range(lines[LINES]):
        line = lines[HEAD + LINE * number : HEAD + LINE * (number + 1)]
        tie = line[TIE:]
        box, at = tie[BOX_AT], line[POSITION_AT]
        for v in range(line[COUNT]):
            x = (y[at + 3 * v] - floats[box]) / floats[box + 3]
            z = (y[at + 3 * v + 1] - floats[box + 1]) / floats[box + 4]
            if not math.isfinite(x + z):
                return False
            own = out[WEIGHTS * (line[FIRST] + v) :]
            for component in range(2):
                (i, j, _), (wx, wy, _), _, _, _ = stencil(component, x, z, 0.0, tie[PESKIN] == 1, one)
                for a in range(4):
                    own[8 * component + a], own[8 * component + 4 + a] = wx[a], wy[a]
                own[16 + 2 * component], own[17 + 2 * component] = i, j
    return True


@lean_inlined
def both(v, w, out):
    """out (PAIRS,): products of four weights and four, by how far their faces are apart, from -3 to 3."""
    a, b, c, d = v[0], v[1], v[2], v[3]
    e, f, g, h = w[0], w[1], w[2], w[3]
    out[0] = a * h
    out[1] = a * g + b * h
    out[2] = a * f + b * g + c * h
    out[3] = a * e + b * f + c * g + d * h
    out[4] = b * e + c * f + d * g
    out[5] = c * e + d * f
    out[6] = d * e


@lean_inlined
def beyond(place, size, periodic):
    """The number of a face on an axis of so many; beyond a wall the last one's."""
    return place % size if periodic else min(max(place, 0), size - 1)


@lean(types.void(N, N, A, A, A, A, A, I))
def answers(v, last, weights, by_x, by_y, pairs, out, one):
    """out (last, 4): velocities of vertex v, x by x, x by y, y by x, y by y, by forces at each vertex before ``last``.

    ``by_x``, ``by_y``: velocities of the flow by a force at the middle face of either component; ``pairs``: scratch.
    """
    at, nx, ny = one[flow.AT], one[flow.CELLS], one[flow.CELLS + 1]
    px, py = one[flow.PERIODIC] == 1, one[flow.PERIODIC + 1] == 1
    own, across, up = weights[WEIGHTS * v : WEIGHTS * (v + 1)], pairs[:PAIRS], pairs[PAIRS : 2 * PAIRS]
    for w in range(last):
        other = weights[WEIGHTS * w : WEIGHTS * (w + 1)]
        for reading in range(2):
            wide, high = nx + (reading == 0 and not px), ny + (reading == 1 and not py)
            for pushing in range(2):
                found = by_x if pushing == 0 else by_y
                faces = found[at + one[flow.STARTS + reading] :]
                both(own[8 * reading :], other[8 * pushing :], across)
                both(own[8 * reading + 4 :], other[8 * pushing + 4 :], up)
                left = nx // 2 - 3 + int(own[16 + 2 * reading] - other[16 + 2 * pushing])
                low = ny // 2 - 3 + int(own[17 + 2 * reading] - other[17 + 2 * pushing])
                left = left % wide if px else left
                total = 0.0
                if 0 <= left <= wide - PAIRS:
                    for b in range(PAIRS):
                        if up[b] == 0.0:
                            continue
                        row = faces[wide * beyond(low + b, high, py) + left :]
                        s = across[0] * row[0] + across[1] * row[1] + across[2] * row[2] + across[3] * row[3]
                        total += up[b] * (s + across[4] * row[4] + across[5] * row[5] + across[6] * row[6])
                else:
                    for b in range(PAIRS):
                        row = faces[wide * beyond(low + b, high, py) :]
                        for a in range(PAIRS):
                            total += up[b] * across[a] * row[beyond(left + a, wide, px)]
                out[4 * w + 2 * reading + pushing] = total


@lean(types.boolean(F, A, A, A, N, N, A, A, A, A, A, A, I, I))
def by_one_answer(a, along, sizes, y, alongs, acrosses, by_x, by_y, room, pairs, matrix, floats, lines, one):
    """matrix (unknowns, unknowns), its lower half: a times how fast sides become shorter and turn back by each other's
    tensions and couples, by the answers to one force along x and along y. Whether vertices are anywhere.

    ``alongs``, ``acrosses``: unknowns, as of stiff_roots_kernels; ``room``: MATRIX_ROOM numbers a side; ``pairs``: 2
    PAIRS numbers.
    """
    sides, unknowns = lines[SIDES], alongs + acrosses
    weights = room[: WEIGHTS * sides]
    here, there = room[WEIGHTS * sides : (WEIGHTS + 4) * sides], room[(WEIGHTS + 4) * sides : (WEIGHTS + 8) * sides]
    begin = room[(WEIGHTS + 8) * sides : (WEIGHTS + 12) * sides]
    if not weigh(y, weights, floats, lines, one):
        return False
    for number in range(lines[LINES]):
        line = lines[HEAD + LINE * number : HEAD + LINE * (number + 1)]
        first, count = line[FIRST], line[COUNT]
        answers(first, first + count, weights, by_x, by_y, pairs, begin, one)
        for k in range(4 * (first + count)):
            there[k] = begin[k]
        for s in range(first, first + count):
            here, there = there, here
            if s + 1 < first + count:
                answers(s + 1, min(s + 3, first + count), weights, by_x, by_y, pairs, there, one)
            else:
                for k in range(4 * (s + 1)):
                    there[k] = begin[k]
            row = matrix[unknowns * s :]
            turns = matrix[unknowns * (alongs + s) :] if acrosses > 0 else row
            p, q = a * along[2 * s], a * along[2 * s + 1]
            p_across, q_across = -q / sizes[s], p / sizes[s]
            for other in range(number + 1):
                start = lines[HEAD + LINE * other + FIRST]
                end = start + lines[HEAD + LINE * other + COUNT]
                for r in range(start, min(end, s + 1)):
                    n = r + 1 if r + 1 < end else start
                    xx, xy = there[4 * n] - there[4 * r], there[4 * n + 1] - there[4 * r + 1]
                    yx, yy = there[4 * n + 2] - there[4 * r + 2], there[4 * n + 3] - there[4 * r + 3]
                    xx, xy = xx + here[4 * r] - here[4 * n], xy + here[4 * r + 1] - here[4 * n + 1]
                    yx, yy = yx + here[4 * r + 2] - here[4 * n + 2], yy + here[4 * r + 3] - here[4 * n + 3]
                    c, d = along[2 * r], along[2 * r + 1]
                    x, z = c * xx + d * xy, c * yx + d * yy
                    if alongs > 0:
                        row[r] = p * x + q * z
                    if acrosses > 0:
                        c, d = -along[2 * r + 1] / sizes[r], along[2 * r] / sizes[r]
                        x_across, z_across = c * xx + d * xy, c * yx + d * yy
                        turns[alongs + r] = p_across * x_across + q_across * z_across
                        if alongs > 0:
                            turns[r] = p_across * x + q_across * z
                            matrix[unknowns * (alongs + r) + s] = p * x_across + q * z_across
    return True


@lean(types.boolean(A, types.int64))
def factor(matrix, n):
    """Cholesky's factor of a matrix (n, n), in its lower half; whether there is one."""
    for i in range(n):
        row = matrix[n * i : n * i + n]
        for j in range(i + 1):
            other = matrix[n * j : n * j + n]
            total = row[j] - dot(row[:j], other[:j])
            if j < i:
                row[j] = total / other[j]
            elif not total > 0.0:
                return False
            else:
                row[i] = math.sqrt(total)
    return True


@lean(types.void(A, types.int64, A, A))
def substitute(matrix, n, x, out):
    """out: the solution by Cholesky's factor."""
    for i in range(n):
        row = matrix[n * i : n * i + n]
        out[i] = (x[i] - dot(row[:i], out[:i])) / row[i]
    for i in range(n - 1, -1, -1):
        row = matrix[n * i : n * i + n]
        out[i] /= row[i]
        for k in range(i):
            out[k] -= row[k] * out[i]
