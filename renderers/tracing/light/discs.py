"""Light on soft discs that cover what is behind them, as smoke: what the discs leave of lamps and sky."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from renderers.tracing.mist import directions
from sceneql.frame import PointLight, Sky, Sun
from sceneql.pictures.framing import axes_towards

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from sceneql.frame import Floats, LightSource, Points

    Shadows = Callable[[Floats, Floats], Floats]
    """Shares (n,) that solids leave of light at places (n, 3), by ways (n, 4): unit vectors to a lamp and distances."""
    Leave = Callable[[Floats, Points], Floats]
    """Part (m,) of a lamp's light that a shape's discs leave at places (m, 3)."""

AROUND = 14
"""Number of directions, evenly over the sphere, from which the sky's light comes."""
FINE, WIDEST = 3.0, 512
"""Cells of a map in the median disc's radius; largest number of cells along a side, for which they are larger."""
SMALLEST = 0.75
"""Radius [cells] below which a disc is mapped larger and correspondingly fainter."""
ORDERS = (4.0 / 7.0, 2.0 / 7.0, 1.0 / 7.0)
"""Weights of the transmittance, its root, and the root of that: light that is scattered again and again fades more
slowly on its way (Wrenninge, Kulla and Lundqvist 2013, Oz: the great and volumetric)."""
STRAYS, BESIDE, SAMPLED = 0.01, 0.5, 50_000
"""Share of discs, at each side, that may lie outside of a map, so that a puff that drifts away makes it no coarser; how
far it reaches beyond the others at least, relative to their extent; number of discs by which it is laid out."""
OUT, FRONT = 0.6, 0.4
"""Distances from a disc's middle, across and towards the camera, at which its light is found [radii]."""
TURNED = np.array([(3.0, 1.0), (-1.0, 3.0)]) / 10.0**0.5
"""The ways across, to the right and up: turned so that no two places come to an edge of a shadow, upright or level, at
once; a disc then darkens by and by."""
PLACES = np.column_stack([np.concatenate([np.zeros((1, 2)), OUT * TURNED, -OUT * TURNED]), np.full(5, FRONT)])
"""Those places, to the right, up and back."""

MANY = 20_000
"""Number of discs from which on each has the same light all over: so many are small. From half of that on the places of
a disc come together, so that smoke that grows looks on as it did."""
UP = np.array([0.0, 1.0, 0.0])
ASLANT, CLOSE = 2.0**0.5, 0.5
"""Largest distance of a disc from the side of a face's pyramid that it reaches, across the face, and least depth at
which a disc is projected [radii]."""
BULB = 1.002
"""Radius of a ball that shows a lamp, at most, relative to the lamp's."""
STEEPEST = 0.8
"""Largest change of the light by a radius, relative to that in the middle: no edge of a disc is black."""


def lit(
    shape: Points, lights: Sequence[LightSource], axes: Floats, shadows: Shadows | None = None
) -> tuple[Floats, Floats, Floats]:
    """Radiance (n, 3), over the discs' colors, in the middle of discs, and its change by a radius to the right and up.

    A place of a disc is as bright as a matte wall that faces the lamp, or all of the sky; less by what the shape's
    discs hide of these, as they hide from a camera what is behind them, and of lamps by the ``shadows`` of solids.
    ``axes``: of the view.
    """
    small = min(max(2.0 - 2.0 * len(shape.centers) / MANY, 0.0), 1.0)
    offsets = (PLACES[: 5 if small > 0.0 else 1] * (small, small, 1.0)) @ axes
    places = (shape.centers[:, None] + shape.radii[:, None, None] * offsets).reshape(-1, 3)
    given = np.zeros((len(places), 3))
    skies = [light for light in lights if isinstance(light, Sky)]
    for leave, irradiance, ways in _lamps(places, lights):
        left = leave(places, shape)
        if shadows is not None:
            left *= shadows(*_beyond(places, np.repeat(shape.radii, len(offsets)), ways(places)))
        given += irradiance / np.pi * left[:, None]
    for way in directions(AROUND) if skies else ():
        radiance = np.sum([_radiance(sky, float(way[1])) for sky in skies], axis=0) / AROUND
        given += radiance * left_at(places, shape, way)[:, None]
    at = given.reshape(-1, len(offsets), 3)
    if len(offsets) == 1:
        return at[:, 0], np.zeros_like(at[:, 0]), np.zeros_like(at[:, 0])
    one, other = (at[:, 1] - at[:, 3]) / (2 * OUT), (at[:, 2] - at[:, 4]) / (2 * OUT)
    middle, (right, up) = at.mean(axis=1), (one * c + other * d for c, d in TURNED.T)
    steep = np.sqrt(right * right + up * up)
    part = np.minimum(STEEPEST * middle / np.maximum(steep, 1e-300), 1.0)
    return middle, part * right, part * up


def _lamps(places: Floats, lights: Iterable[LightSource]) -> Iterator[tuple[Leave, Any, Callable[[Floats], Floats]]]:
    """What discs leave of each lamp, its irradiance (3,), or (n, 3) at each of places (n, 3), and its ways."""
    for light in lights:
        if isinstance(light, Sun):
            way = np.array([*light.direction, np.inf])
            yield partial(left_at, towards=way[:3]), np.array(light.irradiance), partial(_to_sun, way)
        elif isinstance(light, PointLight):
            position = np.array(light.position)
            away = position - places
            square = np.maximum((away * away).sum(axis=1), max(light.radius, 1e-6) ** 2)
            ways = partial(_to_point, position, light.radius)
            yield partial(left_around, lamp=position), np.array(light.intensity) / square[:, None], ways


def _beyond(places: Floats, radii: Floats, ways: Floats) -> tuple[Floats, Floats]:
    """Where ways (n, 4) from places (n, 3) have left the discs of radii (n,), and what is left of the ways.

    So what cuts through a disc throws no shadow on it, and none is black whose middle is just under a surface.
    """
    inside = np.minimum(radii, ways[:, 3])
    rest = ways - inside[:, None] * (0.0, 0.0, 0.0, 1.0)
    return places + inside[:, None] * ways[:, :3], rest


def _to_sun(way: Floats, places: Floats) -> Floats:
    """The one way (4,) for each of places (n, 3)."""
    return np.tile(way, (len(places), 1))


def _to_point(position: Floats, radius: float, places: Floats) -> Floats:
    """Ways (n, 4) from places (n, 3) to a lamp, up to a ball that shows it."""
    away = position - places
    far = np.sqrt((away * away).sum(axis=1))
    unit = np.where(far[:, None] > 0, away / np.maximum(far, 1e-300)[:, None], UP)
    return np.column_stack([unit, np.maximum(far - BULB * radius, 0.0)])


def _radiance(sky: Sky, height: float) -> Floats:
    """Radiance (3,) of a sky in a direction of a sine of elevation."""
    end = sky.zenith if height >= 0.0 else sky.ground
    radiance: Floats = np.array(sky.horizon) + abs(height) * (np.array(end) - np.array(sky.horizon))
    return radiance


def left_at(places: Floats, shape: Points, towards: Floats) -> Floats:
    """Part (m,) of the light from a direction (3,) that the shape's discs leave at places (m, 3)."""
    axes = axes_towards(towards)
    return _left(seen_along(shape.centers, axes), seen_along(places, axes), shape.radii, shape.opacity)


def left_around(places: Floats, shape: Points, lamp: Floats) -> Floats:
    """Part (m,) of the light of a lamp (3,) [m] that the shape's discs leave at places (m, 3).

    On the faces of a cube around the lamp, of which one looks at the middle of the places. So the lamp may stand among
    the discs; of those in which it stands the half before each face counts.
    """
    left = np.ones(len(places))
    out = places.mean(axis=0) - lamp if len(places) else UP
    axes = axes_towards(out if out.any() else UP)
    discs, asked = seen_along(shape.centers - lamp, axes), seen_along(places - lamp, axes)
    main = np.abs(asked).argmax(axis=1)
    for face in range(6):
        k, side = face // 2, 1.0 - 2.0 * (face % 2)
        turned = [(k + 1) % 3, (k + 2) % 3, k]
        mine = (main == k) & (side * asked[:, k] > 0.0)
        x, y, z = discs[:, turned].T * ((1.0,), (1.0,), (side,))
        met = (z > 0.0) & (np.maximum(np.abs(x), np.abs(y)) <= z + ASLANT * shape.radii)
        if mine.any() and met.any():
            seen, before = asked[mine][:, turned] * (1.0, 1.0, side), np.maximum(z, CLOSE * shape.radii)[met]
            places_there = np.column_stack([seen[:, :2] / seen[:, 2:], -seen[:, 2]])
            aside = np.sqrt(x * x + y * y + z * z)[met] / before  # off the middle a face shows more of a disc
            discs_there = np.column_stack([x[met] / before, y[met] / before, -z[met]])
            radii = shape.radii[met] / before * np.sqrt(np.maximum(aside, 1.0))
            left[mine] = _left(discs_there, places_there, radii, shape.opacity, 1.0)
    return left


def _left(discs: Floats, asked: Floats, radii: Floats, opacity: float, most: float = np.inf) -> Floats:
    """Part (m,) of light from where depths are largest that discs (n, 3) leave at places asked for (m, 3).

    Both are across, along and in depth, with ``radii`` (n,) across; their map reaches to ``most`` on each side.
    """
    from renderers.tracing.light.discs_kernels import thin_out

    reach = float(radii.max(initial=0.0))
    if not reach > 0 or not np.isfinite(discs).all():
        return np.ones(len(asked))
    low, high = (np.clip(corner, -most, most) for corner in _framed(discs[:, :2], reach))
    cell = max(float(np.median(radii)) / FINE, float((high - low).max()) / WIDEST)
    wide, tall = (int(side) + 2 for side in (high - low) / cell)
    both = np.ascontiguousarray(np.concatenate([discs, asked]))
    order = np.argsort(-both[:, 2], kind="stable")
    covering = opacity * np.minimum(radii / cell / SMALLEST, 1.0) ** 2
    left = np.ones(len(asked))
    mapped = np.maximum(radii / cell, SMALLEST)
    thin_out(order, (both[:, :2] - low) / cell, mapped, covering, np.ones((tall, wide)), left)
    left[((asked[:, :2] < low) | (asked[:, :2] > high)).any(axis=1)] = 1.0
    root = np.sqrt(left)
    given: Floats = ORDERS[0] * left + ORDERS[1] * root + ORDERS[2] * np.sqrt(root)
    return given


def _framed(discs: Floats, reach: float) -> tuple[Floats, Floats]:
    """Low and high corner (2,) of a map of discs' middles (n, 2) of radii up to ``reach``, without a few strays."""
    low, high = discs.min(axis=0), discs.max(axis=0)
    some = discs[:: -(-len(discs) // SAMPLED)]
    inner = np.quantile(some, (STRAYS, 1.0 - STRAYS), axis=0, method="lower")
    beside = BESIDE * (inner[1] - inner[0]) + reach
    return np.maximum(low - reach, inner[0] - beside), np.minimum(high + reach, inner[1] + beside)


def seen_along(points: Floats, axes: Floats) -> Floats:
    """Coordinates (n, 3) of points along axes (3, 3): products and sums alone, so that all processors find the same."""
    x, y, z = points.T
    along: Floats = np.stack([x * a + y * b + z * c for a, b, c in axes], axis=1)
    return along
