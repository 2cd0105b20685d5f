# mypy: ignore-errors
"""What lanes are told of a polynomial on a segment, for tests."""

from sceneql.compiled.kernels import kernel
from sceneql.field.roots.hull_kernels import hull_4, hull_6, hull_8


@kernel("UniTuple(float64, 6)(float64[::1], int64, float64, float64, float64)")
def hull(c, form, m, h, off):
    """``hull_4``, ``hull_6`` or ``hull_8`` of c (9,)."""
    if form == 4:
        return hull_4(c[0], c[1], c[2], c[3], c[4], m, h, off)
    if form == 6:
        return hull_6(c[0], c[1], c[2], c[3], c[4], c[5], c[6], m, h, off)
    return hull_8(c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7], c[8], m, h, off)
