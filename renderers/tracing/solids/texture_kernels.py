# mypy: ignore-errors
"""Color of a painted mesh by the place of its material."""

from renderers.tracing.scene_kernels import TEXTURE
from renderers.tracing.solids.ranges_kernels import tape_at
from sceneql.compiled.kernels import kernel
from sceneql.field.tape.tape_kernels import value


@kernel(TEXTURE.signature, _nrt=False, inner=True)
def texture(scene, scratch, ranges, x, y, z):
    """Color (3) at a place of the material by the tape with ``ranges`` at that place of the ints; NaN: undefined."""
    code, constants, parts = tape_at(scene, ranges)
    last = code.shape[0] - 1
    value(code, constants, parts, scratch, x, y, z)
    return scratch[last - 2, 0], scratch[last - 1, 0], scratch[last, 0]
