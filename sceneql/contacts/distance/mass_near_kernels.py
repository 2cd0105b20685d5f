# mypy: ignore-errors
"""Masses near the shapes of rigid bodies, and their paths in the axes that a body has at the start of the step."""

import math

import numpy as np
from numba import types

from sceneql.bodies.rigid.rigid_kernels import to_body, to_world
from sceneql.compiled.integers_kernels import filled, longer
from sceneql.compiled.kernels import kernel, lean, lean_inlined
from sceneql.contacts import layout
from sceneql.contacts.distance.convex import SHAPE
from sceneql.contacts.distance.rigid_layout import BODIES, MASSES_AT, SHAPES_AT
from sceneql.contacts.distance.rigid_rows_kernels import MOTION, PLACE
from sceneql.contacts.shape_kernels import near_at
from sceneql.system.signatures_kernels import A, F, I, N

MODELS, THICKNESS_AT, MEMORY_AT, TALLY_AT, SURFACES, SURFACES_AT, HEAD = range(7)
"""Integers from MASSES_AT on: number of models of masses; offsets of the distance to keep besides the radii, of the
memory (END, WHOLE, CUTS of contacts/layout.py, then LONGEST, LONGER), of the tally of impacts; number of the shapes
that masses may touch, and where their integers begin, which follow the models'."""
FIRST, COUNT, POSITION, VELOCITY, INVERSE, MASS, RADIUS, WORK, MODEL = range(9)
"""Integers of a model: the number of its first mass among the bodies, how many, offsets of what they have."""
NUMBER, RELATIVE_AT, OBJECT_AT, TOUCHED = range(4)
"""Integers of a shape: its number, the offset of the place of its surface in its body's axes, from the center (7), and
where the integers of its surface (contacts/layout.py) begin."""


@lean(types.void(A, I, N, A))
def pose(floats, ints, record, places):
    """Put the surface of a shape where its body is."""
    at, p, r = ints[record + OBJECT_AT], PLACE * ints[record + NUMBER], ints[record + RELATIVE_AT]
    x, q = ints[at + layout.PLACE], ints[at + layout.ROTATION]
    u, v, w = to_world(places, p + 3, floats[r], floats[r + 1], floats[r + 2])
    floats[x], floats[x + 1], floats[x + 2] = places[p] + u, places[p + 1] + v, places[p + 2] + w
    a, b, c, d = places[p + 3], places[p + 4], places[p + 5], places[p + 6]
    e, f, g, k = floats[r + 3], floats[r + 4], floats[r + 5], floats[r + 6]
    floats[q] = a * e - b * f - c * g - d * k
    floats[q + 1] = a * f + b * e + c * k - d * g
    floats[q + 2] = a * g + c * e + d * f - b * k
    floats[q + 3] = a * k + d * e + b * g - c * f


@lean(F(F, A, I, N, A, A))
def way(h, floats, ints, number, motions, before):
    """How far a step may take any point of a shape [m]."""
    reach, most = floats[ints[ints[SHAPES_AT] + SHAPE * number + 1] + 1], 0.0
    for speeds in (motions, before):
        at = MOTION * number
        spin = math.sqrt(speeds[at + 3] ** 2 + speeds[at + 4] ** 2 + speeds[at + 5] ** 2)
        speed = math.sqrt(speeds[at] ** 2 + speeds[at + 1] ** 2 + speeds[at + 2] ** 2)
        most = max(most, speed + (spin * reach if spin > 0.0 else 0.0))
    return h * most


@kernel(I(F, A, I, A, A, A, A, A))
def candidates(h, floats, ints, y0, y1, places, motions, before):
    """Masses that may touch shapes in the step, by mass, then by shape: twice the mass's number, its model's, the
    shape's record."""
    own = ints[MASSES_AT]
    codes, some, shapes = filled(0, 0), 0, ints[own + SURFACES]
    first = ints[own + HEAD + FIRST]
    last = own + HEAD + MODEL * (ints[own + MODELS] - 1)
    masses = ints[last + FIRST] + ints[last + COUNT] - first
    counts = filled(masses + 1, 0)
    for j in range(shapes):
        record = ints[own + SURFACES_AT] + TOUCHED * j
        pose(floats, ints, record, places)
        at = ints[record + OBJECT_AT]
        near = near_at(ints[at + layout.NEAR])
        more = floats[ints[own + THICKNESS_AT]] + way(h, floats, ints, ints[record + NUMBER], motions, before)
        for m in range(ints[own + MODELS]):
            model = own + HEAD + MODEL * m
            n, x, v, r = (
                ints[model + COUNT], ints[model + POSITION], ints[model + VELOCITY], ints[model + RADIUS]
            )  # fmt: skip
            found = np.zeros(n)
            near(
                floats, ints, at, h, y0[x : x + 3 * n], y0[v : v + 3 * n], y1[x : x + 3 * n], y1[v : v + 3 * n],
                floats[r : r + n], more, found,
            )  # fmt: skip
            for k in range(n):
                still = floats[ints[model + INVERSE] + k] == 0.0
                if found[k] == 0.0 or floats[ints[model + MASS] + k] == 0.0:
                    continue
                if still and ints[record + NUMBER] >= ints[BODIES]:
                    continue
                if 3 * (some + 1) > codes.size:
                    codes = longer(codes, 3 * some, 6 * some + 48)
                codes[3 * some], codes[3 * some + 1], codes[3 * some + 2] = ints[model + FIRST] + k, model, record
                counts[codes[3 * some] - first + 1] += 1
                some += 1
    ordered = filled(3 * some, 0)
    for k in range(masses):
        counts[k + 1] += counts[k]
    for k in range(some):
        to = counts[codes[3 * k] - first]
        counts[codes[3 * k] - first] += 1
        for c in range(3):
            ordered[3 * to + c] = codes[3 * k + c]
    return ordered


@lean_inlined
def seen_from(places, ends, p, x, y, z):
    """A vector at the end of the step, turned back with the body's axes to the start."""
    return to_world(places, p + 3, *to_body(ends, p + 3, x, y, z))


@lean(types.void(F, A, A, A, A, N, N, N, A, A, N, A), inner=True)
def set_path(h, y0, y1, places, ends, x, v, number, motions, before, straight, path):
    """The path (body_path_kernels) of the mass with these offsets in the axes that a shape has at the start.

    ``straight`` 1: a line, of a mass that impulses move in the step.
    """
    p, of = PLACE * number, MOTION * number
    a, b, c = seen_from(
        places, ends, p, y1[x] - ends[p], y1[x + 1] - ends[p + 1], y1[x + 2] - ends[p + 2]
    )  # fmt: skip
    path[6], path[7], path[8] = places[p] + a, places[p + 1] + b, places[p + 2] + c
    path[12] = h
    for k in range(3):
        path[k] = y0[x + k]
    if straight == 1:
        for k in range(3):
            path[3 + k] = path[9 + k] = (path[6 + k] - path[k]) / h
        return
    for end in range(2):
        y, speeds, here = (y0, before, places) if end == 0 else (y1, motions, ends)
        rx, ry, rz = y[x] - here[p], y[x + 1] - here[p + 1], y[x + 2] - here[p + 2]
        a = y[v] - speeds[of] - (speeds[of + 4] * rz - speeds[of + 5] * ry)
        b = y[v + 1] - speeds[of + 1] - (speeds[of + 5] * rx - speeds[of + 3] * rz)
        c = y[v + 2] - speeds[of + 2] - (speeds[of + 3] * ry - speeds[of + 4] * rx)
        if end == 1:
            a, b, c = seen_from(places, ends, p, a, b, c)
        path[6 * end + 3], path[6 * end + 4], path[6 * end + 5] = a, b, c


@lean_inlined
def size_of(floats, ints, model, k, number):
    """The length [m] that depths are compared with."""
    radius, reach = (
        floats[ints[model + RADIUS] + k], floats[ints[ints[SHAPES_AT] + SHAPE * number + 1] + 1]
    )  # fmt: skip
    return radius if radius > 0.0 else min(reach, 1.0)


@lean_inlined
def reach_to(floats, ints, model, k):
    """Distance of a mass's center from a surface that it touches."""
    return floats[ints[model + RADIUS] + k] + floats[ints[ints[MASSES_AT] + THICKNESS_AT]]
