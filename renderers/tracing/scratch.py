"""Working memory of the tracer's kernels."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sceneql.field.tape.tape_ops import SCRATCH_COLUMNS

if TYPE_CHECKING:
    from sceneql.frame import Floats


def scratch(rows: int) -> Floats:
    """Working memory of one thread for kernels on a scene."""
    return np.zeros((rows, SCRATCH_COLUMNS))
