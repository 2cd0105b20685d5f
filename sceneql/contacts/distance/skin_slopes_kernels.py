# mypy: ignore-errors
"""A field and its slopes at many points."""

import sceneql.field.tape.tape_ops as ops
from sceneql.compiled.kernels import kernel
from sceneql.field.tape.gradient_kernels import gradient


@kernel(f"void({ops.TAPE}, float64[:, ::1], float64[:, ::1])")
def slopes(code, constants, parts, scratch, points, found):
    """Write f and its gradient at points (n, 3) to ``found`` (n, 4)."""
    for k in range(points.shape[0]):
        f, a, b, c = gradient(code, constants, parts, scratch, points[k, 0], points[k, 1], points[k, 2])
        found[k, 0], found[k, 1], found[k, 2], found[k, 3] = f, a, b, c
