# mypy: ignore-errors
"""Masses that collide with one another in `exact` mode: gaps of all pairs, impacts, and rest.

A pair that touches and neither approaches nor parts by more than rounding rests: it has no events, and a force where it
is pressed together (sphere_support_kernels), until it parts.
"""

import math

from sceneql.compiled.kernels import inlined, kernel
from sceneql.compiled.numba.lazy_kernels import lazy
from sceneql.contacts.mutual import sphere_pair_kernels as spheres
from sceneql.contacts.mutual.sphere_pair_kernels import distance, extent, of, radii
from sceneql.contacts.pair_kernels import NEAR
from sceneql.system.signatures_kernels import GAP, IMPACT, TERM, A, F, I, N

NO_EVENT = 1e300

hit = lazy("sceneql.contacts.mutual.sphere_hit_kernels:hit", IMPACT)
hold = lazy("sceneql.contacts.mutual.sphere_hold_kernels:hold", IMPACT)
support = lazy("sceneql.contacts.mutual.sphere_support_kernels:support", TERM)


@kernel(F(N, N, F, A, A, I), inner=True)
def passed(i, j, t, y, floats, ints):
    """Minus the distance [m] traveled since two masses met on a straight relative path; 0 if they did not meet."""
    a, b = ints[spheres.POINTS] + spheres.INSTANT * i, ints[spheres.POINTS] + spheres.INSTANT * j
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
            fixed = floats[of(ints, i, spheres.INVERSE)] + floats[of(ints, j, spheres.INVERSE)] == 0.0
            if fixed or floats[ints[spheres.PAIRS] + spheres.PAIR * pair + spheres.RESTS] != 0.0:
                gaps[pair] = NO_EVENT
            else:
                d = distance(i, j, y, ints) - radii(i, j, floats, ints)
                through = passed(i, j, t, y, floats, ints) if d > 0.0 else 0.0
                gaps[pair] = through if through < 0.0 else d
            pair += 1


@inlined
def note(t, y, floats, ints):
    """Store places and velocities at an accepted instant."""
    for k in range(ints[spheres.COUNT]):
        at = ints[spheres.POINTS] + spheres.INSTANT * k
        floats[at] = t
        for c in range(3):
            floats[at + 1 + c] = y[of(ints, k, spheres.X) + c]
            floats[at + 4 + c] = y[of(ints, k, spheres.V) + c]


@inlined
def some_near(y, floats, ints):
    """Whether any pair rests, or is near enough to touching for the acceleration of its distance to matter."""
    pair = 0
    for i in range(ints[spheres.COUNT]):
        near = NEAR * extent(i, y, ints)
        for j in range(i + 1, ints[spheres.COUNT]):
            if floats[of(ints, i, spheres.INVERSE)] + floats[of(ints, j, spheres.INVERSE)] > 0.0:
                if floats[ints[spheres.PAIRS] + spheres.PAIR * pair + spheres.RESTS] != 0.0:
                    return True
                if distance(i, j, y, ints) < radii(i, j, floats, ints) + near:
                    return True
            pair += 1
    return False


@kernel(IMPACT, inner=True)
def impact(t, y, pair, floats, ints):
    """The impulses of a pair that approaches and of what touches it; pair -1: keep pairs at rest, store the instant."""
    if pair >= 0:
        hit(t, y, pair, floats, ints)
    elif some_near(y, floats, ints):
        hold(t, y, pair, floats, ints)
    note(t, y, floats, ints)


@kernel(TERM, inner=True)
def constrain(t, y, rate, floats, ints):
    """Add the forces that keep resting masses apart."""
    if some_near(y, floats, ints):
        support(t, y, rate, floats, ints)
