"""Colors of what is joined of several objects: each member's where it is, mixed where a blend runs between them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sceneql.frame import Surface
    from sceneql.kinds import FieldBuilder, Moment, Object

    Registers = tuple[int, int, int]


def joined(
    build: FieldBuilder, members: Sequence[tuple[str, Object]], at: Registers, surface: Surface, shared: bool,
    width: float, moment: Moment,
) -> Registers | None:  # fmt: skip
    """Registers of linear RGB at a point of the members' parent's coordinates; None where they have the one color of
    their parent's ``surface``, or no member is given one.

    With ``shared``, members without a color or material have that surface, else a default of their own. A member's
    share is max(width - gap, 0), its gap that of its field to the least one: so colors run over into each other just
    where a blend of this width [m] joins the members, whatever their order.
    """
    hues: list[Registers | None] = []
    colors = []
    given = False
    for name, member in members:
        plain = member.color is None and member.material is None
        own = surface if shared and plain else moment.surface(name, member.material, member.color)
        given |= not plain
        colors.append(own.color)
        hues.append(member.hues(build, *at, own, moment))
    if not any(hues) and len(set(colors)) < 2:
        if not given or colors[0] == surface.color:
            return None
        red, green, blue = (build.constant(part) for part in colors[0])
        return red, green, blue
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
