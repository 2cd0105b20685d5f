"""Evaluation of formulas of the position at many points."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.quantities.derivative import components
from sceneql.quantities.evaluate import evaluate

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.kinds import Formula


def at_points(formula: Formula, points: Floats, **more: Any) -> Floats:
    """Values (k,) of a formula of x, y, z (and of the symbols in ``more``) at points (k, 3) [m]."""
    known = {"x": points[:, 0], "y": points[:, 1], "z": points[:, 2], **more}

    def look_up(node: Any) -> Any:
        return known[node.name]

    value = evaluate(components(formula.expr)[0], look_up, arrays=True)
    return np.array(np.broadcast_to(np.asarray(value, dtype=np.float64), len(points)))
