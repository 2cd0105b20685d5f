# mypy: ignore-errors
"""One sign of f throughout a box, proved by bounds of its slopes and second derivatives and by its corners."""

import numpy as np

from sceneql.compiled.kernels import inlined
from sceneql.field.tape.batch_kernels import evaluate
from sceneql.field.tape.curvature_kernels import bulge, curvature
from sceneql.field.tape.steepness_kernels import steepness, turning
from sceneql.field.tape.tape_ops import MAX, MIN

WIDER = 1.0 + 1.0e-12
"""Factor of a cube's side for its rounding."""
UNKNOWN = 1.0e300
"""In place of a bound where there is none."""


@inlined
def deciding(code, scratch):
    """The row whose sign is that of the last in the box for which ``box`` left WHOLE in scratch, and no nearer to zero.

    As where the faces that cut a solid are far away: max(f, g) has the sign of f where g < 0.
    """
    row = code.shape[0] - 1
    while code[row, 0] == MAX or code[row, 0] == MIN:
        left, right = code[row, 1], code[row, 2]
        if scratch[right, 1] < 0.0 if code[row, 0] == MAX else scratch[right, 0] > 0.0:
            row = left
        elif scratch[left, 1] < 0.0 if code[row, 0] == MAX else scratch[left, 0] > 0.0:
            row = right
        else:
            break
    return row


@inlined
def steep_and_bent(code, constants, parts, scratch, second):
    """What ``enough`` takes for cubes in the box for which ``box`` left WHOLE in scratch; infinite where unknown.

    (how steep f is along the axes in which it may rise and fall, how bent it is upward, how bent it is downward).
    """
    gx, gy, gz = steepness(code, constants, parts, scratch)
    if not gx + gy + gz < UNKNOWN:
        return np.inf, np.inf, np.inf
    last = code.shape[0] - 1
    turn = 0.5 * turning(scratch, last) * (1.0 + 1.0e-9)
    if turn == 0.0 or not curvature(code, parts, scratch, second):
        return turn, np.inf, np.inf
    below, above = bulge(second, last)
    return turn, below * (1.0 + 1.0e-9), above * (1.0 + 1.0e-9)


@inlined
def enough(steep, bent, h):
    """The least |f| at the corners of a cube of side ``h``, all of one sign, that proves its inside to have this sign.

    By the axes along which f is monotone, or by its second derivatives, which bound how far it lies from what is linear
    along each axis between the corners.
    """
    return min(min(steep * h, bent * h * h), UNKNOWN)


@inlined
def one_sign(code, constants, parts, scratch, second, registers, points, x, y, z, h):
    """Whether f is proved to have one sign in the cube of side ``h`` from (x, y, z) on, as in ``enough``.

    Of the cube for which ``box`` left WHOLE in scratch. The corners come first: where their signs differ, bounds of
    derivatives are not asked for.
    """
    for c in range(8):
        points[0, c] = x + (h if c & 1 else 0.0)
        points[1, c] = y + (h if c >> 1 & 1 else 0.0)
        points[2, c] = z + (h if c >> 2 else 0.0)
    evaluate(code, constants, parts, registers, points, 8)
    values, least = registers[code.shape[0] - 1], np.inf
    negative = values[0] < 0.0
    for c in range(8):
        if (values[c] < 0.0) != negative:
            return False
        least = min(least, abs(values[c]))
    steep, upward, downward = steep_and_bent(code, constants, parts, scratch, second)
    return enough(steep, downward if negative else upward, h * WIDER) < least
