"""Contacts of skins in flows with one another, and of each with itself. Imports numpy."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.skins.touch import touch_pairs_layout as layout
from sceneql.skins.touch.touch_layout import STEEPER

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.skins.deep import Sheet
    from sceneql.skins.flat import Line
    from sceneql.system import Assembly, Flow

KERNELS = "sceneql.skins.touch.touch_pairs_kernels"


NEAR = 0.01
"""Fraction of the gap below which skins count as touching at the start."""


def add_pairs(
    assembly: Assembly, made: Sequence[tuple[str, Line | Sheet]], friction_at: int, rubs: bool, gap: float
) -> None:
    """Add contacts between skins and of each with itself. Raises ScriptError for skins that touch at the start."""
    skins = [one.membrane for _, one in made]
    counts = [skin.count for skin in skins]
    firsts, count, corners = np.cumsum([0, *counts]), sum(counts), skins[0].faces.shape[1]
    faces = np.concatenate([first + skin.faces for first, skin in zip(firsts, skins, strict=False)])
    numbers = [np.arange(one) for one in counts]
    table = [
        np.column_stack([skin.position_at + 3 * own, skin.force_at + 3 * own, np.full(skin.count, k)])
        for k, (skin, own) in enumerate(zip(skins, numbers, strict=True))
    ]
    start = assembly.start()
    rest = [start[skin.position_at :][: 3 * skin.count] for skin in skins]
    weights = [np.column_stack([skin.areas, np.full(skin.count, skin.stiffness)]) for skin in skins]
    order = np.argsort(faces[:, 0], kind="stable")
    begins = np.searchsorted(faces[order, 0], np.arange(count + 1))
    head = [0] * layout.HEAD
    head[layout.VERTICES], head[layout.FACES] = count, len(faces)
    head[layout.CORNERS], head[layout.SKINS] = corners, len(skins)
    head[layout.NUMBERS] = assembly.floats([gap, 0.0, STEEPER, 0.0, *_periods(made[0][1].flow)])
    head[layout.FRICTION] = friction_at
    head[layout.WEIGHTS] = assembly.floats(np.concatenate(weights))
    head[layout.REST] = assembly.floats(np.concatenate(rest))
    room = layout.STARTS + (layout.CELLS + 1) * count + 1
    head[layout.ROOM] = assembly.floats(np.zeros(room))
    head[layout.BEST] = assembly.floats(np.zeros(layout.FOUND * len(skins)))
    rows = np.tile([-1.0, 0.0, 0.0, 0.0], count * len(skins) if rubs else 0)
    head[layout.CLEAR] = assembly.floats(np.tile([0.0, 0.0, 0.0, np.nan], count))
    head[layout.HOLDS] = assembly.floats(rows)
    lists = (np.concatenate(table), faces, begins, order)
    ints = (*head, *(int(one) for part in lists for one in np.ravel(part)))
    d = _must_be_apart(assembly, made, rest, np.array(ints, dtype=np.int64), gap)
    if not assembly.went_on:
        assembly.write(head[layout.NUMBERS] + layout.STEEP, np.array([min(STEEPER, 0.5 * d / gap)]))
    assembly.term("force", f"{KERNELS}:force", ints)
    assembly.limit(f"{KERNELS}:limit", ints)
    if rubs:
        assembly.after_step(f"{KERNELS}:hold", ints)


def _periods(flow: Flow) -> list[float]:
    """Length of a flow along x, y and z [m] where it is periodic, else 0."""
    sides = zip(flow.cells.periodic, flow.cells.shape, flow.spacing, strict=True)
    return [n * side if around and n > 1 else 0.0 for around, n, side in sides]


def _must_be_apart(
    assembly: Assembly, made: Sequence[tuple[str, Line | Sheet]], places: Sequence[Floats], ints: Any, gap: float
) -> float:
    """Least distance between skins at the start [m], infinite beyond the gap.

    Raises ScriptError for a skin that crosses or touches another; one may lie inside another.
    """
    from sceneql.skins.touch.touch_start_kernels import least

    all_points = [place.reshape(-1, 3) for place in places]
    help = f"leave a distance between them: forces begin at the gap of {gap:.3g} m"
    offsets = np.array(list(product(*((-one, 0.0, one) if one else (0.0,) for one in _periods(made[0][1].flow)))))
    pairs = product(zip(made, all_points, strict=True), zip(made, all_points, strict=True), offsets)
    for ((name, skin), points), ((other, _), whole), offset in pairs:
        others = whole + offset
        apart = (others.min(axis=0) > points.max(axis=0)) | (others.max(axis=0) < points.min(axis=0))
        if (name != other or offset.any()) and not apart.any():
            held = skin.encloses(others, points)
            if held.any() and not held.all():
                x, y, z = others[np.argmax(held != held[0])]
                text = f"'{other}' crosses '{name}' at the start, near ({x:.4g}, {y:.4g}, {z:.4g}) m"
                raise ScriptError([Diagnostic("starts-inside", text, assembly.line(), help)])
    d, vertex, skin = least(assembly.start(), assembly.numbers(), ints, gap)
    if d < NEAR * gap:
        own = int(ints[layout.HEAD + layout.VERTEX * vertex + layout.SKIN])
        x, y, z = np.concatenate(all_points)[vertex]
        what = f"'{made[skin][0]}'" if own != skin else "itself"
        text = f"'{made[own][0]}' touches {what} at the start, at ({x:.4g}, {y:.4g}, {z:.4g}) m"
        raise ScriptError([Diagnostic("starts-inside", text, assembly.line(), help)])
    return float(d)
