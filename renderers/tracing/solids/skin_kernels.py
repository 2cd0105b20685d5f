# mypy: ignore-errors
"""Normal of an implicit object at a hit, and its color if it is painted."""

import numpy as np

from renderers.tracing import layout
from renderers.tracing.scene_kernels import SKIN, part
from renderers.tracing.solids.ranges_kernels import is_sheet, tape_of
from renderers.tracing.solids.surface_kernels import unit
from sceneql.compiled.kernels import kernel
from sceneql.field.tape.gradient_kernels import gradient
from sceneql.field.tape.tape_kernels import value

BESIDE = 1e-5
"""Offset from a sheet, relative to the box, at which its gradient is taken where it vanishes on the sheet."""


@part
def face_normal(b, k, x, y, z):
    """(whether a point is on a face of the box of implicit object k, its outward unit normal (3))."""
    p = (x, y, z)
    for axis in range(3):
        near = 1e-9 * (b[k + 3 + axis] - b[k + axis] + abs(p[axis]))
        side = -1.0 if abs(p[axis] - b[k + axis]) < near else 0.0
        if side == 0.0 and abs(p[axis] - b[k + 3 + axis]) < near:
            side = 1.0
        if side != 0.0:
            return True, (side if axis == 0 else 0.0), (side if axis == 1 else 0.0), (side if axis == 2 else 0.0)
    return False, 0.0, 0.0, 0.0


@part
def normal(scene, scratch, k, x, y, z):
    """Outward unit normal of implicit object k: of a face of its box if the point is on one, else of the field."""
    b = scene.reals
    on_face, fx, fy, fz = face_normal(b, k, x, y, z)
    if on_face:
        return fx, fy, fz
    code, constants, parts = tape_of(scene, k)
    _, gx, gy, gz = gradient(code, constants, parts, scratch, x, y, z)
    if not is_sheet(scene, k):
        return unit(gx, gy, gz)
    # At a root of multiplicity m > 1 the gradient, m h^(m-1) grad h, vanishes; on either side it is along grad h:
    # reversed for an even m, so that the difference of the two remains, not for an odd one.
    best = gx * gx + gy * gy + gz * gz
    step = BESIDE * (b[k + 3] - b[k] + b[k + 4] - b[k + 1] + b[k + 5] - b[k + 2])
    for axis in range(3):
        sx, sy, sz = step if axis == 0 else 0.0, step if axis == 1 else 0.0, step if axis == 2 else 0.0
        _, px, py, pz = gradient(code, constants, parts, scratch, x + sx, y + sy, z + sz)
        _, qx, qy, qz = gradient(code, constants, parts, scratch, x - sx, y - sy, z - sz)
        for sign in (-1.0, 1.0):
            ex, ey, ez = px + sign * qx, py + sign * qy, pz + sign * qz
            size = 0.01 * (ex * ex + ey * ey + ez * ez)
            if size > best:
                best = size
                gx, gy, gz = ex, ey, ez
    return unit(gx, gy, gz)


@part
def painted(scene, scratch, k, x, y, z):
    """Color (3) of implicit object k at a point by its paint; NaN where it has none, or the paint is undefined."""
    code, constants, parts = tape_of(scene, k, layout.PAINT)
    last = code.shape[0] - 1
    if last < 0:
        return np.nan, np.nan, np.nan
    value(code, constants, parts, scratch, x, y, z)
    return scratch[last - 2, 0], scratch[last - 1, 0], scratch[last, 0]


@kernel(SKIN.signature, _nrt=False, inner=True)
def skin(scene, scratch, k, x, y, z):
    """(normal, paint) of implicit object k at a point of its surface; the paint (3) is NaN where it has no color."""
    nx, ny, nz = normal(scene, scratch, k, x, y, z)
    r, g, b = painted(scene, scratch, k, x, y, z)
    return nx, ny, nz, r, g, b
