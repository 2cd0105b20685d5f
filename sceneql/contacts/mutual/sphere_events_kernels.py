# mypy: ignore-errors
"""Masses that collide with one another in `exact` mode: gaps of all pairs, elastic impacts.

floats[ints[POINTS] + 7 k:] has the last accepted instant of mass k, its place and velocity then.
"""

import math

from sceneql.compiled.kernels import inlined, kernel
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.contacts.mutual import sphere_pair_kernels as spheres
from sceneql.contacts.mutual.sphere_pair_kernels import of, radii
from sceneql.system.signatures_kernels import GAP, IMPACT, A, F, I, N

NO_EVENT = 1e300
INSTANT = 7

hit = lazy("sceneql.contacts.mutual.sphere_hit_kernels:hit", IMPACT)


@kernel(F(N, N, F, A, A, I), inner=True)
def passed(i, j, t, y, floats, ints):
    """Minus the distance [m] traveled since two masses met on a straight relative path; 0 if they did not meet."""
    a, b = ints[spheres.POINTS] + INSTANT * i, ints[spheres.POINTS] + INSTANT * j
    h = t - floats[a]
    if not h > 0.0:
        return 0.0
    reach = radii(i, j, floats, ints)
    square, along, way2 = -reach * reach, 0.0, 0.0
    for c in range(3):
        r = floats[a + 1 + c] - floats[b + 1 + c]
        w = y[of(ints, i, spheres.X) + c] - y[of(ints, j, spheres.X) + c] - r
        square += r * r
        along += r * w
        way2 += w * w
    inside = along * along - way2 * square
    if along >= 0.0 or square <= 0.0 or inside <= 0.0:
        return 0.0
    s = square / (math.sqrt(inside) - along)
    return -(1.0 - s) * math.sqrt(way2) if s < 1.0 else 0.0


@kernel(GAP, inner=True)
def gap(t, y, gaps, floats, ints):
    """Distances [m] between the surfaces of all pairs; negative also where two passed through each other."""
    pair = 0
    for i in range(ints[spheres.COUNT]):
        for j in range(i + 1, ints[spheres.COUNT]):
            square = 0.0
            for c in range(3):
                square += (y[of(ints, i, spheres.X) + c] - y[of(ints, j, spheres.X) + c]) ** 2
            d = math.sqrt(square) - radii(i, j, floats, ints)
            if d > 0.0:
                through = passed(i, j, t, y, floats, ints)
                d = through if through < 0.0 else d
            gaps[pair] = (
                d if floats[of(ints, i, spheres.INVERSE)] + floats[of(ints, j, spheres.INVERSE)] > 0.0 else NO_EVENT
            )
            pair += 1


@inlined
def note(t, y, floats, ints):
    """Store places and velocities at an accepted instant."""
    for k in range(ints[spheres.COUNT]):
        at = ints[spheres.POINTS] + INSTANT * k
        floats[at] = t
        for c in range(3):
            floats[at + 1 + c] = y[of(ints, k, spheres.X) + c]
            floats[at + 4 + c] = y[of(ints, k, spheres.V) + c]


@kernel(IMPACT, inner=True)
def impact(t, y, pair, floats, ints):
    """The impulse of a pair that approaches; pair -1: store the accepted instant."""
    note(t, y, floats, ints)
    if pair >= 0:
        hit(t, y, pair, floats, ints)
