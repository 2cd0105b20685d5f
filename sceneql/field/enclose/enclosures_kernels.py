# mypy: ignore-errors
"""Enclosures of a tape on segments of single rays, for Python callers: see ``packet_kernels``."""

from sceneql.compiled.kernels import lean
from sceneql.field.enclose.affine_kernels import F
from sceneql.field.packets.packet_kernels import LANES, PACKET, enclose, load_constants, place


@lean(f"void({PACKET}, float32[::1], float64[:, ::1], float64[:, ::1], float64[::1], float64[::1], float64[:, ::1])")
def enclose_rays(code, constants, parts, registers, point, status, origins, directions, t0, t1, out):
    """(c0, c1, e, status) of f on segments o + t d, t in [t0, t1], into ``out`` (4, n); rays are (n, 3)."""
    load_constants(code, constants, registers)
    last = registers[code.shape[0] - 1]
    for start in range(0, len(t0), LANES):
        count = min(LANES, len(t0) - start)
        for i in range(LANES):
            j = start + min(i, count - 1)
            for axis in range(3):
                o, d = origins[j, axis], directions[j, axis]
                middle, half = 0.5 * (t0[j] + t1[j]), 0.5 * (t1[j] - t0[j])
                place(point[axis], i, F(o), F(d), F(middle), F(half))
        enclose(code, constants, parts, registers, point, status, LANES)
        for i in range(count):
            for column in range(3):
                out[column, start + i] = last[column * LANES + i]
            out[3, start + i] = status[i]
