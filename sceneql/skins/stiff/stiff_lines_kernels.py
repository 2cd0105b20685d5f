# mypy: ignore-errors
"""Closed lines of stiff sides in a fluid: what they pull, what that does to the fluid, and what the fluid does to them.

Sides of all lines are numbered one after another. ``lines``: [number of lines, of sides], then of each LINE integers:
those of its tension term (skin_layout), where its stiffness against bending is (-1: it has none), then the first ones
of what ties it to the flow, its first side. All offsets are into the floats.
"""

import math

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.flows import layout as flow
from sceneql.skins.bend_line_kernels import corner
from sceneql.skins.closed_line_kernels import by_stretch, slope
from sceneql.skins.elasticity import ACROSS
from sceneql.skins.elasticity import BENT as BENDING
from sceneql.skins.skin_layout import (
    BOX_AT,
    COUNT,
    DENSITY_AT,
    HELD_AT,
    LENGTHS_AT,
    PESKIN,
    POSITION_AT,
)
from sceneql.skins.spline_kernels import through
from sceneql.system.signatures_kernels import A, F, I

LINES, SIDES, HEAD = 0, 1, 2
BENT, TIE, FIRST, LINE = 8, 9, 17, 18
"""Of a line: the place of its stiffness against bending [N m^2], -1 where it has none; where the integers of its tie to
the flow begin (BOX_AT, DENSITY_AT, PESKIN by their places there), the number of its first side; how many integers."""


@lean(types.void(A, A, A, I))
def directions(y, out, sizes, lines):
    """Unit vectors (sides, 2) along sides, of vertices at places in y; their lengths (sides,)."""
    for number in range(lines[LINES]):
        one = lines[HEAD + LINE * number : HEAD + LINE * (number + 1)]
        count, at = one[COUNT], one[POSITION_AT]
        for v in range(count):
            w, s = (v + 1 if v < count - 1 else 0), one[FIRST] + v
            dx, dy = y[at + 3 * w] - y[at + 3 * v], y[at + 3 * w + 1] - y[at + 3 * v + 1]
            sizes[s] = math.sqrt(dx * dx + dy * dy)
            out[2 * s], out[2 * s + 1] = dx / sizes[s], dy / sizes[s]


@lean(types.void(A, A, A, A, A, I))
def pulls(y, tensions, along, out, floats, lines):
    """(sides, 2) what sides pull at where they begin, and the other way where they end [N]: by tensions (sides,) of
    sides ``along`` (sides, 2), and by bending."""
    for s in range(lines[SIDES]):
        out[2 * s], out[2 * s + 1] = tensions[s] * along[2 * s], tensions[s] * along[2 * s + 1]
    for number in range(lines[LINES]):
        line = lines[HEAD + LINE * number : HEAD + LINE * (number + 1)]
        if line[BENT] >= 0:
            count, first = line[COUNT], line[FIRST]
            for v in range(count):
                r, s = first + (v - 1 if v > 0 else count - 1), first + v
                px, py, qx, qy, _ = corner(y, line[POSITION_AT], count, v, floats[line[BENT]])
                out[2 * r] += px
                out[2 * r + 1] += py
                out[2 * s] += qx
                out[2 * s + 1] += qy


@lean(types.void(A, F, A, A, A, I, I))
def pull(sides, factor, y, out, floats, lines, one):
    """out += factor times the acceleration of faces by what ``sides`` (sides, 2) pull [N], of vertices at places in
    y."""
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
                    force = sides[2 * s + k] - sides[2 * r + k]
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


@lean(types.void(A, A, I))
def places(y, out, lines):
    """(vertices, 2) the places of vertices in y."""
    for number in range(lines[LINES]):
        line = lines[HEAD + LINE * number : HEAD + LINE * (number + 1)]
        for v in range(line[COUNT]):
            for k in range(2):
                out[2 * (line[FIRST] + v) + k] = y[line[POSITION_AT] + 3 * v + k]


@lean(types.void(A, F, A, A, I))
def move(velocities, factor, y, out, lines):
    """out = y + factor times velocities (vertices, 2), at the places of vertices in y."""
    for number in range(lines[LINES]):
        line = lines[HEAD + LINE * number : HEAD + LINE * (number + 1)]
        for v in range(line[COUNT]):
            for k in range(2):
                place = line[POSITION_AT] + 3 * v + k
                out[place] = y[place] + factor * velocities[2 * (line[FIRST] + v) + k]


@lean(types.void(A, A, A, A, I))
def strained(velocities, along, sizes, out, lines):
    """How fast sides become longer [m/s], and turn [1/s]: (2, sides), by velocities (vertices, 2)."""
    sides = lines[SIDES]
    for number in range(lines[LINES]):
        line = lines[HEAD + LINE * number : HEAD + LINE * (number + 1)]
        count, first = line[COUNT], line[FIRST]
        for v in range(count):
            s, w = first + v, first + (v + 1 if v < count - 1 else 0)
            x, z = velocities[2 * w] - velocities[2 * s], velocities[2 * w + 1] - velocities[2 * s + 1]
            out[s] = x * along[2 * s] + z * along[2 * s + 1]
            out[sides + s] = (z * along[2 * s] - x * along[2 * s + 1]) / sizes[s]


@lean(types.float64(A, A, A, A, A, I))
def missing(y, tensions, along, out, floats, lines):
    """(2, sides) how much longer sides are than their tensions say [m], and how far they are turned from ``along``; the
    most of the former, in parts of what is between vertices."""
    most, sides = 0.0, lines[SIDES]
    for number in range(lines[LINES]):
        line = lines[HEAD + LINE * number : HEAD + LINE * (number + 1)]
        count, at = line[COUNT], line[POSITION_AT]
        for v in range(count):
            w, s = (v + 1 if v < count - 1 else 0), line[FIRST] + v
            dx, dy = y[at + 3 * w] - y[at + 3 * v], y[at + 3 * w + 1] - y[at + 3 * v + 1]
            rest = floats[line[LENGTHS_AT] + v]
            part = math.sqrt(dx * dx + dy * dy) / rest
            grows = slope(part, floats, line)
            part = (by_stretch(part, floats, line) - tensions[s]) / grows if grows > 0.0 else 0.0
            out[s] = part * rest
            x, z = along[2 * s], along[2 * s + 1]
            out[sides + s] = math.atan2(x * dy - z * dx, x * dx + z * dy)
            most = abs(part) if not abs(part) <= most else most
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
            part = math.sqrt(dx * dx + dy * dy) / floats[line[LENGTHS_AT] + v]
            tensions[line[FIRST] + v] = by_stretch(part, floats, line)


@lean(types.float64(A, A, I))
def steep(tensions, floats, lines):
    """How fast tensions (sides,) [N] and bending turn a line in cells, squared [1/s^2] (skins/elasticity.py)."""
    most = 0.0
    for number in range(lines[LINES]):
        line = lines[HEAD + LINE * number : HEAD + LINE * (number + 1)]
        box, tension = line[TIE + BOX_AT], 0.0
        cell = min(floats[box + 3], floats[box + 4])
        for s in range(line[FIRST], line[FIRST] + line[COUNT]):
            tension = max(tension, tensions[s])
        across = ACROSS * tension + (BENDING * floats[line[BENT]] / cell**2 if line[BENT] >= 0 else 0.0)
        most = max(most, across / (floats[box + 5] * floats[line[TIE + DENSITY_AT]] * cell**3))
    return most


@lean(types.void(A, A, I))
def hold(sides, floats, lines):
    """Have the terms of lines pull what ``sides`` (sides, 2) do [N], wherever they are."""
    for number in range(lines[LINES]):
        line = lines[HEAD + LINE * number : HEAD + LINE * (number + 1)]
        held = floats[line[HELD_AT] : line[HELD_AT] + 1 + 2 * line[COUNT]]
        held[0] = 1.0
        for k in range(2 * line[COUNT]):
            held[1 + k] = sides[2 * line[FIRST] + k]


@lean(types.void(A, I))
def release(floats, lines):
    """Have the terms of lines pull by where sides are again."""
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


@lean(types.float64(A, I))
def shortest(floats, lines):
    """The least of the sides' own lengths [m]."""
    least = math.inf
    for number in range(lines[LINES]):
        line = lines[HEAD + LINE * number : HEAD + LINE * (number + 1)]
        for v in range(line[COUNT]):
            least = min(least, floats[line[LENGTHS_AT] + v])
    return least


@lean(types.void(A, A, I))
def hand_over(own, mine, lines):
    """The rates of vertices go from one array to the other."""
    for number in range(lines[LINES]):
        line = lines[HEAD + LINE * number : HEAD + LINE * (number + 1)]
        for k in range(line[POSITION_AT], line[POSITION_AT] + 3 * line[COUNT]):
            mine[k], own[k] = own[k], 0.0
