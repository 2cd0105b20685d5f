# mypy: ignore-errors
"""The tensions of closed lines of springs as unknowns: what they do to a fluid, and what the fluid does to lengths.

Sides of all lines are numbered one after another. ``lines``: [number of lines, of sides, DIRECTIONS, TENSIONS], then of
each LINE integers: those of its tension term (skin_layout), then the first ones of what ties it to the flow, its first
side. All offsets are into the floats.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.flows import layout as flow
from sceneql.skins.skin_layout import (
    BOX_AT,
    COUNT,
    DENSITY_AT,
    HELD_AT,
    LENGTHS_AT,
    PESKIN,
    POSITION_AT,
    PRETENSION_AT,
    STIFFNESS_AT,
)
from sceneql.skins.spline_kernels import through
from sceneql.system.signatures_kernels import A, F, I

LINES, SIDES, HEAD = 0, 1, 2
TIE, FIRST, LINE = 8, 16, 17
"""Of a line: where the integers of its tie to the flow begin (BOX_AT, DENSITY_AT, PESKIN by their places there), the
number of its first side; how many integers."""


@lean(types.void(A, A, I))
def directions(y, out, lines):
    """Unit vectors (sides, 2) along sides, of vertices at places in y."""
    for number in range(lines[LINES]):
        one = lines[HEAD + LINE * number : HEAD + LINE * (number + 1)]
        count, at = one[COUNT], one[POSITION_AT]
        for v in range(count):
            w, s = (v + 1 if v < count - 1 else 0), 2 * (one[FIRST] + v)
            dx, dy = y[at + 3 * w] - y[at + 3 * v], y[at + 3 * w + 1] - y[at + 3 * v + 1]
            length = math.sqrt(dx * dx + dy * dy)
            out[s], out[s + 1] = dx / length, dy / length


@lean(types.void(A, A, F, A, A, A, I, I))
def pull(tensions, along, factor, y, out, floats, lines, one):
    """out += factor times the acceleration of faces by tensions (sides,) [N] of sides ``along`` (sides, 2), of vertices
    at places in y."""
    for number in range(lines[LINES]):
        line = lines[HEAD + LINE * number : HEAD + LINE * (number + 1)]
        tie = line[TIE:]
        box, count, at, first = tie[BOX_AT], line[COUNT], line[POSITION_AT], line[FIRST]
        work = floats[one[flow.WORK] : one[flow.WORK] + one[flow.FACES]]
        for face in range(one[flow.FACES]):
            work[face] = 0.0
        for v in range(count):
            s, r = first + v, first + (v - 1 if v > 0 else count - 1)
            x = (y[at + 3 * v] - floats[box]) / floats[box + 3]
            z = (y[at + 3 * v + 1] - floats[box + 1]) / floats[box + 4]
            if math.isfinite(x + z):
                for k in range(2):
                    force = tensions[s] * along[2 * s + k] - tensions[r] * along[2 * r + k]
                    through(work[one[flow.STARTS + k] :], k, x, z, 0.0, force, True, tie[PESKIN] == 1, one)
        density = floats[tie[DENSITY_AT]]
        for face in range(one[flow.FACES]):
            out[one[flow.AT] + face] += factor * work[face] * floats[one[flow.INVERSES] + face] / density


@lean(types.void(A, A, A, A, I, I))
def read(u, y, out, floats, lines, one):
    """Velocities (vertices, 2) of the vertices at places in y, in a fluid of velocities u."""
    for number in range(lines[LINES]):
        line = lines[HEAD + LINE * number : HEAD + LINE * (number + 1)]
        tie = line[TIE:]
        box, at = tie[BOX_AT], line[POSITION_AT]
        for v in range(line[COUNT]):
            x = (y[at + 3 * v] - floats[box]) / floats[box + 3]
            z = (y[at + 3 * v + 1] - floats[box + 1]) / floats[box + 4]
            for k in range(2):
                faces = u[one[flow.AT] + one[flow.STARTS + k] :]
                near = math.isfinite(x + z)
                found = through(faces, k, x, z, 0.0, 0.0, False, tie[PESKIN] == 1, one) if near else math.nan
                out[2 * (line[FIRST] + v) + k] = found


@lean(types.void(A, F, A, A, I))
def move(velocities, factor, y, out, lines):
    """out = y + factor times velocities (vertices, 2), at the places of vertices in y."""
    for number in range(lines[LINES]):
        line = lines[HEAD + LINE * number : HEAD + LINE * (number + 1)]
        for v in range(line[COUNT]):
            for k in range(2):
                place = line[POSITION_AT] + 3 * v + k
                out[place] = y[place] + factor * velocities[2 * (line[FIRST] + v) + k]


@lean(types.void(A, A, A, I))
def lengthened(velocities, along, out, lines):
    """How fast sides (sides,) become longer."""
    for number in range(lines[LINES]):
        line = lines[HEAD + LINE * number : HEAD + LINE * (number + 1)]
        count, first = line[COUNT], line[FIRST]
        for v in range(count):
            s, w = first + v, first + (v + 1 if v < count - 1 else 0)
            found = 0.0
            for k in range(2):
                found += (velocities[2 * w + k] - velocities[2 * s + k]) * along[2 * s + k]
            out[s] = found


@lean(types.float64(A, A, A, A, A, I))
def missing(y, tensions, soft, out, floats, lines):
    """(sides,) how much longer sides are than their tensions say [m]; the most, in parts of what is between vertices.

    ``soft``: (sides,) length over stiffness, which is written [m/N].
    """
    most = 0.0
    for number in range(lines[LINES]):
        line = lines[HEAD + LINE * number : HEAD + LINE * (number + 1)]
        count, at = line[COUNT], line[POSITION_AT]
        for v in range(count):
            w, s = (v + 1 if v < count - 1 else 0), line[FIRST] + v
            dx, dy = y[at + 3 * w] - y[at + 3 * v], y[at + 3 * w + 1] - y[at + 3 * v + 1]
            rest = floats[line[LENGTHS_AT] + v]
            soft[s] = rest / floats[line[STIFFNESS_AT]]
            out[s] = math.sqrt(dx * dx + dy * dy) - rest - soft[s] * (tensions[s] - floats[line[PRETENSION_AT]])
            part = abs(out[s]) / rest
            most = part if not part <= most else most
    return most


@lean(types.void(A, A, A, I))
def by_law(y, tensions, floats, lines):
    """Tensions (sides,) [N] by the lengths of sides."""
    for number in range(lines[LINES]):
        line = lines[HEAD + LINE * number : HEAD + LINE * (number + 1)]
        count, at = line[COUNT], line[POSITION_AT]
        for v in range(count):
            w = v + 1 if v < count - 1 else 0
            dx, dy = y[at + 3 * w] - y[at + 3 * v], y[at + 3 * w + 1] - y[at + 3 * v + 1]
            part = math.sqrt(dx * dx + dy * dy) / floats[line[LENGTHS_AT] + v] - 1.0
            tensions[line[FIRST] + v] = floats[line[PRETENSION_AT]] + floats[line[STIFFNESS_AT]] * part


@lean(types.void(A, A, I))
def hold(tensions, floats, lines):
    """Have the terms of lines pull by tensions (sides,), whatever their lengths."""
    for number in range(lines[LINES]):
        line = lines[HEAD + LINE * number : HEAD + LINE * (number + 1)]
        held = floats[line[HELD_AT] : line[HELD_AT] + 1 + line[COUNT]]
        held[0] = 1.0
        for v in range(line[COUNT]):
            held[1 + v] = tensions[line[FIRST] + v]


@lean(types.void(A, I))
def release(floats, lines):
    """Have the terms of lines pull by the lengths of sides again."""
    for number in range(lines[LINES]):
        floats[lines[HEAD + LINE * number + HELD_AT]] = 0.0


@lean(types.float64(A, A, A, I))
def apart(x, y, floats, lines):
    """How far vertices are from each other at most, in parts of sides; not finite where one is nowhere."""
    most = 0.0
    for number in range(lines[LINES]):
        line = lines[HEAD + LINE * number : HEAD + LINE * (number + 1)]
        for v in range(line[COUNT]):
            for k in range(2):
                place = line[POSITION_AT] + 3 * v + k
                part = abs(x[place] - y[place]) / floats[line[LENGTHS_AT] + v]
                most = part if not part <= most else most
    return most


@lean(types.void(A, A, I))
def hand_over(own, mine, lines):
    """The rates of vertices go from one array to the other."""
    for number in range(lines[LINES]):
        line = lines[HEAD + LINE * number : HEAD + LINE * (number + 1)]
        for k in range(line[POSITION_AT], line[POSITION_AT] + 3 * line[COUNT]):
            mine[k], own[k] = own[k], 0.0
