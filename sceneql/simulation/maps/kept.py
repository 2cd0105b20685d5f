"""The sheet that a field is seen on, made once for all frames: domains do not move."""

from __future__ import annotations

from collections import OrderedDict
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.simulation.maps import domains
from sceneql.simulation.maps.seen import level_of
from sceneql.simulation.maps.sheets import Sheet, joined

if TYPE_CHECKING:
    from sceneql.kinds import Moment
    from sceneql.simulation.maps.domains import Plane
    from sceneql.simulation.maps.seen import Seen

MOST = 8

Numbers = tuple[tuple[tuple[float, ...], tuple[float, ...]], ...]
"""A point and a direction of each plane."""

_kept: OrderedDict[Any, tuple[Any, Sheet]] = OrderedDict()
"""By the model's identity and the planes; the model is held, so that its identity stays its own."""


def sheet_of(field: Seen, moment: Moment, cut: Numbers, surface: bool) -> Sheet:
    """A flat domain; or the surface of a deep one, cut open by planes; without it their whole sections."""
    key = id(field.model), field.layout, cut, surface
    if key not in _kept:
        planes = [(np.array(through), np.array(normal) / np.linalg.norm(normal)) for through, normal in cut]
        _kept[key] = field.model, _made(field, level_of(field, moment), planes, surface)
        while len(_kept) > MOST:
            _kept.popitem(last=False)
    _kept.move_to_end(key)
    return _kept[key][1]


def _made(field: Seen, level: Any, planes: list[Plane], surface: bool) -> Sheet:
    layout = field.layout
    if layout.shape[2] == 1:
        return domains.flat(layout, level)
    sections = [domains.section(layout, level, plane) for plane in planes]
    if not surface:
        return joined(sections)
    whole = domains.surface(layout, level)
    return domains.cut_open(whole, sections, planes) if planes else whole
