# mypy: ignore-errors
"""Triangles in lanes of float32: 1 - d^2/R^2 along a segment, d the distance.

d^2 to a convex set has a continuous slope along a line, and its second derivative lies between those of the set's
features: for a triangle between that of the face and that of a vertex.
"""

from sceneql.compiled.kernels import inlined
from sceneql.compiled.lanes_kernels import below
from sceneql.field.packets import packet_rows as rows
from sceneql.field.packets.packet_curve_kernels import held, least_of
from sceneql.field.packets.packet_density_kernels import HALF, ONE, PAD, THREE, TWO, ZERO


@inlined
def from_edge(wx, wy, wz, sx, sy, sz):
    """(vector w from the nearest point of a segment from 0 to s, |w|^2)."""
    t = held((wx * sx + wy * sy + wz * sz) / (sx * sx + sy * sy + sz * sz))
    vx, vy, vz = wx - t * sx, wy - t * sy, wz - t * sz
    return vx, vy, vz, vx * vx + vy * vy + vz * vz


@inlined
def nearer(a, b):
    """The shorter of two vectors as ``from_edge`` gives them."""
    ax, ay, az, a2 = a
    bx, by, bz, b2 = b
    return below(a2, b2, ax, bx), below(a2, b2, ay, by), below(a2, b2, az, bz), below(a2, b2, a2, b2)


@inlined
def triangle(parts, k, px, py, pz, ux, uy, uz, speed, way, loose):
    """1 - d^2/R^2 at p + u tau +- loose, tau in [-1, 1], for triangle k: a0 + a1 tau - a2 tau^2 +- the last one."""
    wx, wy, wz = px - parts[rows.AX, k], py - parts[rows.AY, k], pz - parts[rows.AZ, k]
    sx, sy, sz = parts[rows.SX, k], parts[rows.SY, k], parts[rows.SZ, k]
    cx, cy, cz = parts[rows.CX, k + 1], parts[rows.CY, k + 1], parts[rows.CZ, k + 1]
    gx, gy, gz = parts[rows.GX, k + 1], parts[rows.GY, k + 1], parts[rows.GZ, k + 1]
    hx, hy, hz = parts[rows.HX, k + 1], parts[rows.HY, k + 1], parts[rows.HZ, k + 1]
    nx, ny, nz = parts[rows.NX, k + 1], parts[rows.NY, k + 1], parts[rows.NZ, k + 1]
    b0, b1 = wx * gx + wy * gy + wz * gz, ux * gx + uy * gy + uz * gz
    c0, c1 = wx * hx + wy * hy + wz * hz, ux * hx + uy * hy + uz * hz
    height, climb = wx * nx + wy * ny + wz * nz, ux * nx + uy * ny + uz * nz
    within = least_of(least_of(b0, c0), ONE - b0 - c0)
    ahead = least_of(least_of(b0 - abs(b1), c0 - abs(c1)), ONE - b0 - c0 - abs(b1 + c1))
    edge = nearer(from_edge(wx, wy, wz, sx, sy, sz), from_edge(wx, wy, wz, cx, cy, cz))
    last = from_edge(wx - sx, wy - sy, wz - sz, cx - sx, cy - sy, cz - sz)
    vx, vy, vz, _ = nearer(edge, last)
    vx = below(within, ZERO, vx, height * nx)
    vy = below(within, ZERO, vy, height * ny)
    vz = below(within, ZERO, vz, height * nz)
    inverse = parts[rows.INVERSE, k]
    slow = climb * climb
    fast = below(ahead, ZERO, speed, slow)
    a0 = ONE - (vx * vx + vy * vy + vz * vz) * inverse
    a1 = (vx * ux + vy * uy + vz * uz) * (-TWO * inverse)
    bent = HALF * (fast - slow)
    off = loose + parts[rows.BLUR, k]
    # As in packet_density_kernels.around.
    error = (bent + off * (TWO * (parts[rows.RADIUS, k] + way) + THREE * off)) * inverse
    return a0, a1, HALF * (slow + fast) * inverse, error + PAD * (abs(a1) + ONE + speed * inverse)
