# mypy: ignore-errors
"""Capsules thinner than a pixel, as the camera sees them: blurred to about a pixel, and as faint as they are widened.

Most rays a pixel apart would miss such a line, and a film of it would crawl and break. Across it, its coverage is that
of its own width under a tent filter; the integral over the line is the same, and smooth enough for few rays a pixel.
Its ends are round and blurred as well: the whole line is dimmed by the light that they would add, which is little of a
long line, and most of one that is short or points to the camera.
"""

import numpy as np

from renderers.tracing import layout
from renderers.tracing.scene_kernels import part
from renderers.tracing.solids.solids_kernels import NONE, round_solid, round_span

TENT = 1.5
"""Half of the filter's width for the thinnest lines [half pixels]: sums over 8 rays of a pixel are then within 2 % of
the integral; of narrower filters and of wider ones they are farther."""
APART = 4.0
"""Drawn radii behind a line within which another is taken for its continuation: pieces of a trail overlap, and those
shorter than a pixel would be counted several times."""

LINE = 10
"""Place in a THIN item's reals of the length [m] of the line that it is a piece of."""


@part
def passes(r, k, radius, spread, ox, oy, oz, dx, dy, dz):
    """(half a pixel's width [m] where a ray, the axis of a cone ``radius`` + ``spread`` t, passes a capsule's axis, and
    the distance from that)."""
    ux, uy, uz = r[k + 3], r[k + 4], r[k + 5]
    px, py, pz = ox - r[k], oy - r[k + 1], oz - r[k + 2]
    uu = ux * ux + uy * uy + uz * uz
    du = dx * ux + dy * uy + dz * uz
    pd = px * dx + py * dy + pz * dz
    rest = uu - du * du
    along = 0.0
    if rest > 1e-12 * uu:
        along = min(max((px * ux + py * uy + pz * uz - du * pd) / rest, 0.0), 1.0)
    t = max(along * du - pd, 0.0)
    px, py, pz = px + t * dx - along * ux, py + t * dy - along * uy, pz + t * dz - along * uz
    return radius + spread * t, np.sqrt(px * px + py * py + pz * pz)


@part
def slant(r, k, dx, dy, dz):
    """Sine of the angle between a ray and a capsule's axis, 1 of a ball."""
    ux, uy, uz = r[k + 3], r[k + 4], r[k + 5]
    uu = ux * ux + uy * uy + uz * uz
    du = dx * ux + dy * uy + dz * uz
    return np.sqrt(max(1.0 - du * du / uu, 0.0)) if uu > 0.0 else 1.0


@part
def blur(own, pixel):
    """Half of the tent's width by a capsule's radius and half a pixel's width: 0 from a pixel's width on."""
    return TENT * np.sqrt(max(pixel * pixel - own * own, 0.0))


@part
def below_tent(x):
    """Part of a tent of half width 1 that is below x."""
    rest = max(1.0 - abs(x), 0.0)
    return 0.5 * rest * rest if x < 0.0 else 1.0 - 0.5 * rest * rest


@part
def blurred_end(own, tent):
    """Length [m] of a capsule's blurred middle that covers as much as its blurred ends, without blur 0.5 pi ``own``.

    It is pi times the mean of |u + v|, u even over +-``own``, v of a tent of half width ``tent``: the ends together
    are the round figure with that profile.
    """
    if own < tent:
        mean = tent / 3.0 + own * own / (3.0 * tent) - own * own * own / (12.0 * tent * tent)
    else:
        mean = (tent * tent / 12.0 + 0.5 * own * own) / own
    return np.pi * mean


@part
def thin_round(scene, scratch, k, ox, oy, oz, dx, dy, dz, near, far):
    """Crossing of a THIN capsule: by a camera's ray its entry as it is drawn, by others as of any capsule."""
    last = scratch.shape[0] - 1
    radius, spread = scratch[last, layout.WIDE_RADIUS], scratch[last, layout.WIDE_SPREAD]
    near = max(near, scratch[last, layout.WIDE_FROM])
    if radius + spread == 0.0:
        return round_solid(scene.reals, k, ox, oy, oz, dx, dy, dz, near, far)
    pixel, _ = passes(scene.reals, k, radius, spread, ox, oy, oz, dx, dy, dz)
    wide = scene.reals[k + 6] + blur(scene.reals[k + 6], pixel)
    enter, leave = round_span(scene.reals, k, wide * wide, ox, oy, oz, dx, dy, dz)
    return enter if enter < leave and near < enter < far else NONE


@part
def coverage(scene, item, radius, spread, ox, oy, oz, dx, dy, dz):
    """(share of a camera's ray that an item covers which it meets, distance at which the ray is through with it).

    The share is 1 of items that are not THIN, and of those that are a pixel wide here.
    """
    if scene.ints[layout.ITEMS + 4 * item + layout.KIND] != layout.THIN:
        return 1.0, 0.0
    k = scene.ints[layout.ITEMS + 4 * item + layout.REALS_AT]
    own = scene.reals[k + 6]
    pixel, off = passes(scene.reals, k, radius, spread, ox, oy, oz, dx, dy, dz)
    tent = blur(own, pixel)
    if tent == 0.0:
        return 1.0, 0.0
    wide = own + tent
    _, leave = round_span(scene.reals, k, wide * wide, ox, oy, oz, dx, dy, dz)
    across = below_tent((off + own) / tent) - below_tent((off - own) / tent)
    length = scene.reals[k + LINE] * slant(scene.reals, k, dx, dy, dz)
    return across * (length + 0.5 * np.pi * own) / (length + blurred_end(own, tent)), leave + APART * wide
