# mypy: ignore-errors
"""Sliding in `local` mode: in the rest of a step after an impact, and in whole steps."""

import math

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts.impact_kernels import STILL
from sceneql.system.signatures_kernels import A, F


@lean_inlined
def start_with(path, x, y, z):
    """Set the velocity at the path's start; the decrease of kinetic energy per mass [J/kg]."""
    before = path[3] ** 2 + path[4] ** 2 + path[5] ** 2
    path[3], path[4], path[5] = x, y, z
    return 0.5 * (before - x * x - y * y - z * z)


@lean_inlined
def fly_on(path, ax, ay, az, h):
    """End the path after a time h of constant acceleration."""
    path[6] = path[0] + h * (path[3] + 0.5 * h * ax)
    path[7] = path[1] + h * (path[4] + 0.5 * h * ay)
    path[8] = path[2] + h * (path[5] + 0.5 * h * az)
    path[9] = path[3] + h * ax
    path[10] = path[4] + h * ay
    path[11] = path[5] + h * az


@lean_inlined
def along(ax, ay, az, vx, vy, vz, speed):
    """The acceleration's component along the velocity."""
    return (ax * vx + ay * vy + az * vz) / speed if speed > 0.0 else math.sqrt(ax * ax + ay * ay + az * az)


@lean_inlined
def tangential(x, y, z, nx, ny, nz):
    """A vector without its part along the unit normal n."""
    part = x * nx + y * ny + z * nz
    return x - part * nx, y - part * ny, z - part * nz


@lean(F(A, A, F, F, F, F, F, F, F, F), inner=True)
def slide(path, mean, nx, ny, nz, ux, uy, uz, press, friction):
    """The rest of the path along the surface, with Coulomb friction; friction's work per mass [J/kg]."""
    normal = mean[0] * nx + mean[1] * ny + mean[2] * nz
    away = max(0.0, normal)
    ax, ay, az = mean[0] - normal * nx, mean[1] - normal * ny, mean[2] - normal * nz
    vx, vy, vz = path[3] - ux, path[4] - uy, path[5] - uz
    most = -friction * press
    speed = math.sqrt(vx * vx + vy * vy + vz * vz)
    pull = math.sqrt(ax * ax + ay * ay + az * az)
    h = path[12]
    sliding = h
    if speed < STILL and pull <= most:
        sliding = 0.0
    else:
        dx, dy, dz, size = (vx, vy, vz, speed) if speed >= STILL else (ax, ay, az, pull)
        if size > 0.0:
            drag = most / size
            ax, ay, az = ax - drag * dx, ay - drag * dy, az - drag * dz
            slowing = -(ax * dx + ay * dy + az * dz) / size
            if most > 0.0 and slowing * h > speed:
                sliding = speed / slowing
    lost = 0.0
    if sliding > 0.0:
        fly_on(path, ax, ay, az, sliding)
        lost = most * sliding * (speed + 0.5 * sliding * along(ax, ay, az, vx, vy, vz, speed))
    else:
        path[6], path[7], path[8] = path[0], path[1], path[2]
    if sliding < h:
        path[9], path[10], path[11] = ux, uy, uz
        path[6] += (h - sliding) * ux
        path[7] += (h - sliding) * uy
        path[8] += (h - sliding) * uz
    path[6] += 0.5 * h * h * away * nx
    path[7] += 0.5 * h * h * away * ny
    path[8] += 0.5 * h * h * away * nz
    path[9] += h * away * nx
    path[10] += h * away * ny
    path[11] += h * away * nz
    return lost
