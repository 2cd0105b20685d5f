"""Contacts of skins in flows with one another, and of each with itself. Imports numpy."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from sceneql.skins import touch_pairs_layout as layout

if TYPE_CHECKING:
    from sceneql.system import Assembly, Membrane

KERNELS = "sceneql.skins.touch_pairs_kernels"


def add_pairs(assembly: Assembly, skins: Sequence[Membrane], friction_at: int, gap: float) -> None:
    """Add what keeps skins apart, and each from itself."""
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
    impedance = min((skin.stiffness * skin.density) ** 0.5 for skin in skins)
    order = np.argsort(faces.ravel(), kind="stable")
    begins = np.searchsorted(faces.ravel()[order], np.arange(count + 1))
    head = [0] * layout.HEAD
    head[layout.VERTICES], head[layout.FACES] = count, len(faces)
    head[layout.CORNERS], head[layout.SKINS] = corners, len(skins)
    head[layout.NUMBERS] = assembly.floats([gap, impedance, 0.0])
    head[layout.FRICTION] = friction_at
    head[layout.WEIGHTS] = assembly.floats(np.concatenate(weights))
    head[layout.REST] = assembly.floats(np.concatenate(rest))
    room = layout.STARTS + (layout.CELLS + 1) * count + 1
    head[layout.ROOM] = assembly.floats(np.zeros(room))
    head[layout.BEST] = assembly.floats(np.zeros(layout.FOUND * len(skins)))
    lists = (np.concatenate(table), faces, begins, order // corners)
    ints = (*head, *(int(one) for part in lists for one in np.ravel(part)))
    assembly.term("force", f"{KERNELS}:force", ints)
    assembly.limit(f"{KERNELS}:limit", ints)
