# mypy: ignore-errors
"""What a closed sheet of triangles resists bending with: energy bend/2 (2 H)^2 a square meter, H its mean curvature
(Helfrich 1973, Z. Naturforsch. C 28, 693-703).

The integral of 2 H over what belongs to a vertex is half the sum of length times angle over its sides, the angle that
between the normals of the two triangles there; its area is a third of its triangles' (Julicher 1996, J. Phys. II France
6, 1797-1824).
"""

import math

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.skins.closed_sheet_kernels import add, away, cross
from sceneql.skins.skin_layout import BEND_AT, COUNT, FACES, FOLDS, FORCE_AT, POSITION_AT, SUMS_AT
from sceneql.system.signatures_kernels import TERM


@lean_inlined
def dot(a, b):
    """The inner product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@lean_inlined
def fold(y, at, ints, f):
    """Of a side: its length, the angle there, and both triangles' normals over their heights, and feet."""
    a, b = at + 3 * ints[f], at + 3 * ints[f + 1]
    e, p, q = away(y, a, b), away(y, a, at + 3 * ints[f + 2]), away(y, a, at + 3 * ints[f + 3])
    n, m = cross(e, p), cross(q, e)
    square, nn, mm = dot(e, e), dot(n, n), dot(m, m)
    length = math.sqrt(square)
    angle = math.atan2(dot(cross(n, m), e), length * dot(n, m)) if nn > 0.0 and mm > 0.0 else 0.0
    by_n, by_m = (length / nn if nn > 0.0 else 0.0), (length / mm if mm > 0.0 else 0.0)
    foot_p, foot_q = (dot(p, e) / square, dot(q, e) / square) if square > 0.0 else (0.0, 0.0)
    return length, angle, e, n, m, by_n, by_m, foot_p, foot_q


@lean(TERM, inner=True)
def bend(t, y, rate, floats, ints):
    """Adds the slopes of bend/8 sum (sum length angle)^2/area [N]."""
    count, at, force, stiffness = ints[COUNT], ints[POSITION_AT], ints[FORCE_AT], floats[ints[BEND_AT]]
    sums, areas = floats[ints[SUMS_AT] : ints[SUMS_AT] + count], floats[ints[SUMS_AT] + count :]
    first_face = FOLDS + 4 * ints[FACES]
    for v in range(count):
        sums[v] = areas[v] = 0.0
    for f in range(FOLDS, first_face, 4):
        found = fold(y, at, ints, f)
        sums[ints[f]] += found[0] * found[1]
        sums[ints[f + 1]] += found[0] * found[1]
    for c in range(first_face, ints.size, 3):
        i, j, k = ints[c], ints[c + 1], ints[c + 2]
        n = cross(away(y, at + 3 * i, at + 3 * j), away(y, at + 3 * i, at + 3 * k))
        third = math.sqrt(dot(n, n)) / 6.0
        areas[i] += third
        areas[j] += third
        areas[k] += third
    for v in range(count):  # the energy's slopes by sum and area
        part = sums[v] / areas[v] if areas[v] > 0.0 else 0.0
        sums[v], areas[v] = 0.25 * stiffness * part, -0.125 * stiffness * part * part
    for f in range(FOLDS, first_face, 4):
        length, angle, e, n, m, by_n, by_m, foot_p, foot_q = fold(y, at, ints, f)
        a, b = ints[f], ints[f + 1]
        both = sums[a] + sums[b]
        if not length > 0.0:
            continue
        add(floats, force + 3 * a, both * angle / length, e)
        add(floats, force + 3 * b, -both * angle / length, e)
        turn_n, turn_m = both * length * by_n, both * length * by_m
        add(floats, force + 3 * ints[f + 2], turn_n, n)
        add(floats, force + 3 * ints[f + 3], turn_m, m)
        add(floats, force + 3 * a, -turn_n * (1.0 - foot_p), n)
        add(floats, force + 3 * a, -turn_m * (1.0 - foot_q), m)
        add(floats, force + 3 * b, -turn_n * foot_p, n)
        add(floats, force + 3 * b, -turn_m * foot_q, m)
    for c in range(first_face, ints.size, 3):
        i, j, k = ints[c], ints[c + 1], ints[c + 2]
        ab, ac = away(y, at + 3 * i, at + 3 * j), away(y, at + 3 * i, at + 3 * k)
        n = cross(ab, ac)
        size = math.sqrt(dot(n, n))
        if size > 0.0:
            half = 0.5 * (areas[i] + areas[j] + areas[k]) / (3.0 * size)
            add(floats, force + 3 * j, half, cross(n, ac))
            add(floats, force + 3 * k, half, cross(ab, n))
            add(floats, force + 3 * i, half, cross(n, (ab[0] - ac[0], ab[1] - ac[1], ab[2] - ac[2])))
