"""Colors of objects that are joined into one: each point has the color of the member visible there, mixed in blends."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from sceneql.frame import Surface
    from sceneql.kinds import FieldBuilder, Moment, Shaped

    Registers = tuple[int, int, int]

Bare = Literal["apart", "shared", "first"]


def joined(
    build: FieldBuilder, members: Sequence[tuple[str, Shaped]], gaps: Sequence[int], at: Registers,
    surface: Surface, bare: Bare, width: float, moment: Moment,
) -> Registers | None:  # fmt: skip
    """Registers of linear RGB at the point ``at`` in the parent's coordinates.

    None where no member has a color or material, or all have the color of ``surface``, the parent's. ``gaps``:
    registers of one number a member, smallest for the visible member. The mean is weighted by
    max(width - gap + smallest gap, 0): colors mix exactly where a blend of this ``width`` [m] joins members, in any
    order. A ``bare`` member, without color and material, has a default color of its own (apart), the color of
    ``surface`` (shared), or that of the first member (first).
    """
    hues: list[Registers | None] = []
    colors: list[tuple[float, float, float]] = []
    given = False
    for name, member in members:
        plain = member.color is None and member.material is None
        own = moment.surface(name, member.material, member.color) if bare == "apart" or not plain else surface
        hue = member.hues(build, *at, own, moment)
        first = bare == "first" and plain and hue is None and bool(colors)
        given |= not plain
        colors.append(colors[0] if first else own.color)
        hues.append(hues[0] if first else hue)
    if not any(hues) and len(set(colors)) < 2:
        if not given or colors[0] == surface.color:
            return None
        red, green, blue = (build.constant(part) for part in colors[0])
        return red, green, blue
    r, g, b = (
        [build.constant(color[k]) if hue is None else hue[k] for hue, color in zip(hues, colors, strict=True)]
        for k in range(3)
    )
    shares = _shares(build, gaps, width)
    return _mean(build, shares, r), _mean(build, shares, g), _mean(build, shares, b)


def _shares(build: FieldBuilder, values: Sequence[int], width: float) -> list[int]:
    """Registers of the members' weights max(width - value + least value, 0); with width 0, 1 for the least value."""
    least = values[0]
    for value in values[1:]:
        least = build.op("min", least, value)
    gaps = [build.op("sub", value, least) for value in values]
    if width == 0.0:
        return [build.op("sub", build.constant(1.0), build.op("sign", gap)) for gap in gaps]
    return [build.op("max", build.op("sub", build.constant(width), gap), build.constant(0.0)) for gap in gaps]


def _mean(build: FieldBuilder, shares: list[int], values: list[int]) -> int:
    """Register of the mean of the values, weighted by the shares."""
    total, parts = shares[0], build.op("mul", shares[0], values[0])
    for share, value in zip(shares[1:], values[1:], strict=True):
        total, parts = build.op("add", total, share), build.op("add", parts, build.op("mul", share, value))
    return build.op("div", parts, total)
