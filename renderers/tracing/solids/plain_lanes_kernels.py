# mypy: ignore-errors
"""Listed rays against a scene's few half-spaces and quadrics, in lanes: bit for bit as ``walk`` finds them."""

import numpy as np
from numba import types

from renderers.tracing import layout
from renderers.tracing.scene_kernels import ASKED, SCENE, part
from renderers.tracing.solids.intersect_kernels import misses
from renderers.tracing.solids.solids_kernels import along_ray, box_span, inverse, local_point
from sceneql.compiled.kernels import lean

LANES = 128
OX, OY, OZ, DX, DY, DZ, IX, IY, IZ, ANY, BEST, WHERE, ITEM, LIGHT, AT = (LANES * row for row in range(15))
PX, PY, PZ, UX, UY, UZ, ENTER, LEAVE, ROOM = (LANES * row for row in range(15, 24))
"""Offsets in the memory of a batch, LANES numbers each: origins, directions and their inverses, whether any hit will
do; least distance so far, distance, item and light as ``walk`` returns them; the crossings with an item; origins,
directions and spans in a quadric's coordinates; its size."""


@part
def load(asked, first, n, lanes):
    """Copy n listed rays into lanes."""
    for i in range(n):
        ray = asked[first + i]
        for column in range(6):
            lanes[OX + column * LANES + i] = ray[column]
        lanes[BEST + i] = ray[layout.FAR]
        lanes[ANY + i] = 1.0 if ray[layout.WANT] == layout.ANYWHERE else 0.0
    for i in range(n):
        lanes[IX + i], lanes[IY + i], lanes[IZ + i] = (
            inverse(lanes[DX + i]),
            inverse(lanes[DY + i]),
            inverse(lanes[DZ + i]),
        )
        lanes[WHERE + i], lanes[ITEM + i], lanes[LIGHT + i] = np.inf, -1.0, 1.0


@part
def roots_lane(a, b, c):
    """``solids_kernels.roots`` without branches."""
    curved, rest = a > 1e-14 * abs(b), b * b - 4.0 * a * c
    q = -0.5 * (b + np.copysign(np.sqrt(rest), b))
    one, two, edge = q / a, c / q, -c / b
    none = curved & ((rest <= 0.0) | (q == 0.0))
    all_of_it = c <= 0.0
    low = -np.inf if b > 0.0 else (edge if b < 0.0 else (-np.inf if all_of_it else 1.0))
    high = edge if b > 0.0 else (np.inf if b < 0.0 else (np.inf if all_of_it else 0.0))
    low, high = (min(one, two) if curved else low), (max(one, two) if curved else high)
    return (1.0 if none else low), (0.0 if none else high)


@part
def span_lane(low, high, origin, direction):
    """``solids_kernels.box_span`` by a direction."""
    per = 1.0 / direction if abs(direction) > 1e-300 else 1e300
    return box_span(low, high, origin, per)


@part
def cross_quadric(u, k, n, lanes):
    """Crossings of n rays with the quadric whose reals ``u`` begin at k: as ``solids_kernels.quadric``, no branches.

    Where AT is inf already it stays so.
    """
    for i in range(n):
        lanes[PX + i], lanes[PY + i], lanes[PZ + i] = local_point(
            u, k, lanes[OX + i], lanes[OY + i], lanes[OZ + i], 1.0
        )
        lanes[UX + i], lanes[UY + i], lanes[UZ + i] = local_point(
            u, k, lanes[DX + i], lanes[DY + i], lanes[DZ + i], 0.0
        )
    for i in range(n):
        px, py, pz, d = lanes[PX + i], lanes[PY + i], lanes[PZ + i], (lanes[UX + i], lanes[UY + i], lanes[UZ + i])
        a, b, c = along_ray(u, k, (px, py, pz), d)
        curved = a > 1e-14 * abs(b)
        begin = -0.5 * b / a if curved else 0.0
        e, f, g = along_ray(u, k, (px + begin * d[0], py + begin * d[1], pz + begin * d[2]), d)
        low, high = roots_lane((e if curved else a), (f if curved else b), (g if curved else c))
        lanes[ENTER + i], lanes[LEAVE + i] = begin + low, begin + high
    for i in range(n):
        enter, leave, far = lanes[ENTER + i], lanes[LEAVE + i], lanes[BEST + i]
        e, f = span_lane(u[k + 19], u[k + 22], lanes[PX + i], lanes[UX + i])
        enter, leave = max(enter, e), min(leave, f)
        e, f = span_lane(u[k + 20], u[k + 23], lanes[PY + i], lanes[UY + i])
        enter, leave = max(enter, e), min(leave, f)
        e, f = span_lane(u[k + 21], u[k + 24], lanes[PZ + i], lanes[UZ + i])
        enter, leave = max(enter, e), min(leave, f)
        out = leave if (enter <= 0.0) & (0.0 < leave) & (leave < far) else np.inf
        t = enter if (0.0 < enter) & (enter < far) else out
        lanes[AT + i] = np.inf if (enter >= leave) | (lanes[AT + i] == np.inf) else t


@part
def cross(scene, node, kind, k, n, lanes):
    """Write crossings of n rays with an item of a node into lanes, as ``intersect_kernels.meet``; False: there is none.

    Most batches miss the boxes of small things, and then nothing more is computed.
    """
    u = scene.reals
    if kind == layout.HALF_SPACE:  # of the first node, which is everywhere
        for i in range(n):
            slope = u[k] * lanes[DX + i] + u[k + 1] * lanes[DY + i] + u[k + 2] * lanes[DZ + i]
            t = (u[k + 3] - u[k] * lanes[OX + i] - u[k + 1] * lanes[OY + i] - u[k + 2] * lanes[OZ + i]) / slope
            lanes[AT + i] = t if (slope != 0.0) & (0.0 < t) & (t < lanes[BEST + i]) else np.inf
        return True
    near = 0
    for i in range(n):
        missed = misses(
            u, node, lanes[OX + i], lanes[OY + i], lanes[OZ + i], lanes[IX + i], lanes[IY + i], lanes[IZ + i], 0.0,
            lanes[BEST + i],
        )  # fmt: skip
        lanes[AT + i] = np.inf if missed else 0.0
        near += 0 if missed else 1
    if near == 0:
        return False
    cross_quadric(u, k, n, lanes)
    return True


@part
def take(scene, item, n, lanes):
    """Enter the crossings of n rays with an item where they come before those found."""
    s = scene.ints[layout.ITEMS + 4 * item + layout.SURFACE_AT]
    u = scene.reals
    clear = 0.95 * u[s + layout.TRANSMISSION]
    shade = (u[s] + u[s + 1] + u[s + 2]) / 3.0
    for i in range(n):
        t, best, anywhere = lanes[AT + i], lanes[BEST + i], lanes[ANY + i] != 0.0
        light = lanes[LIGHT + i] * clear
        ended = light == 0.0
        hit = t < best
        lanes[WHERE + i] = t if hit else lanes[WHERE + i]
        lanes[ITEM + i] = float(item) if hit else lanes[ITEM + i]
        lanes[LIGHT + i] = (light if ended else light * shade) if hit & anywhere else lanes[LIGHT + i]
        # A shadow ray that no light comes through ends there, before any other item.
        lanes[BEST + i] = ((-np.inf if ended else best) if anywhere else t) if hit else best


@lean(types.void(SCENE, ASKED, types.float64[::1]))
def meet_plain(scene, asked, lanes):
    """What ``walk`` returns for all listed rays past what packets know, of scenes of nothing but that and these items.

    ``lanes`` (ROOM,) is working memory. Boxes of inner nodes hold those of their leaves, which alone are looked at.
    """
    rows = int(asked[0, layout.NEXT])
    for first in range(1, rows, LANES):
        n = min(LANES, rows - first)
        load(asked, first, n, lanes)
        for number in range(scene.ints[layout.NODE_COUNT]):
            link = scene.ints[layout.LINKS_AT] + layout.LINK * number
            node = scene.ints[layout.NODES_AT] + 6 * number
            for item in range(scene.ints[link + 1], scene.ints[link + 1] + scene.ints[link + 2]):
                kind = scene.ints[layout.ITEMS + 4 * item + layout.KIND]
                at = scene.ints[layout.ITEMS + 4 * item + layout.REALS_AT]
                if kind != layout.IMPLICIT and cross(scene, node, kind, at, n, lanes):
                    take(scene, item, n, lanes)
        for i in range(n):
            row = asked[first + i]
            row[layout.REST_AT], row[layout.REST_ITEM], row[layout.REST_LIGHT] = (
                lanes[WHERE + i],
                lanes[ITEM + i],
                lanes[LIGHT + i],
            )
