"""Colors of what is joined of several objects: each member's where it is, mixed where a blend runs between them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sceneql.frame import Surface
    from sceneql.kinds import FieldBuilder, Moment, Object

    Registers = tuple[int, int, int]


def joined(
    build: FieldBuilder, members: Sequence[tuple[str, Object]], at: Registers, own: Surface | None, width: float,
    moment: Moment,
) -> Registers | None:  # fmt: skip
    """Registers of linear RGB at a point of the members' parent's coordinates; None where there is but one color.

    ``own`` is the surface of members without a color or material, where they have no default of their own. A member's
    share is max(width - gap, 0), its gap that of its field to the least one: so colors run over into each other just
    where a blend of this width [m] joins the members, whatever their order.
    """
    hues: list[Registers | None] = []
    colors = []
    for name, member in members:
        plain = own is not None and member.color is None and member.material is None
        surface = own if own is not None and plain else moment.surface(name, member.material, member.color)
        colors.append(surface.color)
        hues.append(member.hues(build, *at, surface, moment))
    if not any(hues) and len(set(colors)) < 2:
        return None
    r, g, b = (
        [build.constant(color[k]) if hue is None else hue[k] for hue, color in zip(hues, colors, strict=True)]
        for k in range(3)
    )
    shares = _shares(build, [member.implicit(build, *at, moment) for _, member in members], width)
    return _mean(build, shares, r), _mean(build, shares, g), _mean(build, shares, b)


def _shares(build: FieldBuilder, values: list[int], width: float) -> list[int]:
    """Of members by their fields' values; without a width those of the least alone are above 0."""
    least = values[0]
    for value in values[1:]:
        least = build.op("min", least, value)
    gaps = [build.op("sub", value, least) for value in values]
    if width == 0.0:
        return [build.op("sub", build.constant(1.0), build.op("sign", gap)) for gap in gaps]
    return [build.op("max", build.op("sub", build.constant(width), gap), build.constant(0.0)) for gap in gaps]


def _mean(build: FieldBuilder, shares: list[int], values: list[int]) -> int:
    """Of values by their shares."""
    total, parts = shares[0], build.op("mul", shares[0], values[0])
    for share, value in zip(shares[1:], values[1:], strict=True):
        total, parts = build.op("add", total, share), build.op("add", parts, build.op("mul", share, value))
    return build.op("div", parts, total)
