"""Opacity of an overlay that fades in and out."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sceneql.kinds import Moment, Overlay


def strength(overlay: Overlay, moment: Moment) -> float:
    """Opacity from 0 (hidden) to 1; linear in time over `fade` [s] after `show` begins and before it ends."""
    if overlay.show is None:
        return 1.0
    if moment.at(overlay.show) == 0:
        return 0.0
    if overlay.fade == 0:
        return 1.0
    import numpy as np

    times, shown = moment.course(overlay.show)
    off = times[np.asarray(shown).reshape(len(times)) == 0]
    return float(np.clip(np.abs(off - moment.time).min(initial=overlay.fade) / overlay.fade, 0.0, 1.0))
