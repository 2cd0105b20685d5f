# mypy: ignore-errors
"""What a closed line in the plane z = 0 resists bending with: energy bend/2 c^2 a meter, c its curvature."""

import math

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.skins.skin_layout import BEND_AT, BENT_HELD_AT, COUNT, FORCE_AT, POSITION_AT
from sceneql.system.signatures_kernels import TERM


@lean_inlined
def corner(y, at, count, v, stiffness):
    """What both sides at a vertex pull by its angle at the vertex where they begin, and the other way where they end
    (px, py, qx, qy) [N]; stiffness over half their lengths [N m]: how much energy/angle grows by the angle."""
    a, b, c = 3 * (v - 1 if v > 0 else count - 1), 3 * v, 3 * (v + 1 if v < count - 1 else 0)
    ux, uy = y[at + b] - y[at + a], y[at + b + 1] - y[at + a + 1]
    wx, wy = y[at + c] - y[at + b], y[at + c + 1] - y[at + b + 1]
    u, w = ux * ux + uy * uy, wx * wx + wy * wy
    if not (u > 0.0 and w > 0.0):
        return 0.0, 0.0, 0.0, 0.0, 0.0
    length_u, length_w = math.sqrt(u), math.sqrt(w)
    length = 0.5 * (length_u + length_w)
    angle = math.atan2(ux * wy - uy * wx, ux * wx + uy * wy)
    by_angle, by_length = stiffness * angle / length, -0.25 * stiffness * (angle / length) ** 2
    # Slopes by each side: of the angle across it, of the length along it.
    px, py = by_angle * uy / u + by_length * ux / length_u, -by_angle * ux / u + by_length * uy / length_u
    qx, qy = -by_angle * wy / w + by_length * wx / length_w, by_angle * wx / w + by_length * wy / length_w
    return px, py, qx, qy, stiffness / length


@lean(TERM, inner=True)
def bend(t, y, rate, floats, ints):
    """Adds the slopes of bend/2 sum angle^2/length, by the angle at each vertex and half the sides beside it [N],
    unless a solver has found what sides pull."""
    count, at, force, stiffness = ints[COUNT], ints[POSITION_AT], ints[FORCE_AT], floats[ints[BEND_AT]]
    if floats[ints[BENT_HELD_AT]] != 0.0:
        return
    for v in range(count):
        a, b, c = 3 * (v - 1 if v > 0 else count - 1), 3 * v, 3 * (v + 1 if v < count - 1 else 0)
        px, py, qx, qy, _ = corner(y, at, count, v, stiffness)
        floats[force + a] += px
        floats[force + a + 1] += py
        floats[force + b] += qx - px
        floats[force + b + 1] += qy - py
        floats[force + c] -= qx
        floats[force + c + 1] -= qy
