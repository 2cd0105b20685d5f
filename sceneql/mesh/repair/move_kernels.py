# mypy: ignore-errors
"""A vertex moved along the surface so that the triangles around it face outward."""

from sceneql.compiled.kernels import inlined, lean
from sceneql.field.tape.gradient_kernels import gradient
from sceneql.field.tape.tape_ops import TAPE

STEPS = 4
"""Newton steps towards the surface."""
SLIVER = 1.0e-6
"""Twice a triangle's area over its squared longest side, below which its normal is rounding noise."""


@inlined
def onto(code, constants, parts, scratch, at):
    """Move ``at`` (3,) [m] to the surface by Newton's method along the gradient; return the unit gradient, or zeros."""
    for step in range(STEPS + 1):
        f, gx, gy, gz = gradient(code, constants, parts, scratch, at[0], at[1], at[2])
        square = gx * gx + gy * gy + gz * gz
        if not 0.0 < square < 1.0e300:
            return 0.0, 0.0, 0.0
        if step == STEPS:
            break
        if abs(f) < 1.0e300:
            at[0] -= f / square * gx
            at[1] -= f / square * gy
            at[2] -= f / square * gz
    size = square**0.5
    return gx / size, gy / size, gz / size


@inlined
def least_facing(code, constants, parts, scratch, places, star, vertex, at):
    """The least cosine between the normals of the triangles ``star`` (n, 3), with ``vertex`` at ``at``, and gradients.

    Of a triangle as `flips.facing` tells it.
    """
    least = 1.0
    for t in range(star.shape[0]):
        a, b, c = star[t, 0], star[t, 1], star[t, 2]
        ax, ay, az = places[a, 0], places[a, 1], places[a, 2]
        bx, by, bz = places[b, 0], places[b, 1], places[b, 2]
        cx, cy, cz = places[c, 0], places[c, 1], places[c, 2]
        if a == vertex:
            ax, ay, az = at[0], at[1], at[2]
        if b == vertex:
            bx, by, bz = at[0], at[1], at[2]
        if c == vertex:
            cx, cy, cz = at[0], at[1], at[2]
        ux, uy, uz, vx, vy, vz = bx - ax, by - ay, bz - az, cx - ax, cy - ay, cz - az
        wx, wy, wz = cx - bx, cy - by, cz - bz
        nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        area = (nx * nx + ny * ny + nz * nz) ** 0.5
        longest = max(max(ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz), wx * wx + wy * wy + wz * wz)
        _, gx, gy, gz = gradient(
            code, constants, parts, scratch, (ax + bx + cx) / 3.0, (ay + by + cy) / 3.0, (az + bz + cz) / 3.0
        )
        size = area * (gx * gx + gy * gy + gz * gz) ** 0.5
        cosine = (nx * gx + ny * gy + nz * gz) / size if size > 0.0 and area > SLIVER * longest else 0.0
        least = min(least, cosine)
    return least


@lean(f"boolean({TAPE}, float64[:, ::1], float64[:, ::1], int64[:, ::1], int64, float64[::1], float64[:, ::1])")
def move(code, constants, parts, scratch, places, normals, star, vertex, shares, room):
    """Move a vertex of the triangles ``star`` (n, 3) if that improves the worst of them; returns whether it moved.

    To the surface from ``shares`` (k,) of its way to the mean of its neighbors; a point that Newton's method moves by
    more than the longest edge at the vertex stays where it began. ``room`` (4, 3) is working memory.
    """
    at, middle, best, slope = room[0], room[1], room[2], room[3]
    for axis in range(3):
        at[axis] = places[vertex, axis]
        middle[axis] = 0.0
    before = least_facing(code, constants, parts, scratch, places, star, vertex, at)
    if before > 0.0:
        return False
    count, reach = 0, 0.0
    for t in range(star.shape[0]):
        for k in range(3):
            other = star[t, k]
            if other == vertex:
                continue
            count += 1
            square = 0.0
            for axis in range(3):
                middle[axis] += places[other, axis]
                square += (places[other, axis] - places[vertex, axis]) ** 2
            reach = max(reach, square)
    most = before
    for n in range(shares.shape[0]):
        for axis in range(3):
            at[axis] = places[vertex, axis] + shares[n] * (middle[axis] / count - places[vertex, axis])
        x, y, z = at[0], at[1], at[2]
        gx, gy, gz = onto(code, constants, parts, scratch, at)
        if not (at[0] - x) ** 2 + (at[1] - y) ** 2 + (at[2] - z) ** 2 <= reach:
            at[0], at[1], at[2] = x, y, z
            _, gx, gy, gz = gradient(code, constants, parts, scratch, x, y, z)
            size = (gx * gx + gy * gy + gz * gz) ** 0.5
            scale = 1.0 / size if 0.0 < size < 1.0e300 else 0.0
            gx, gy, gz = gx * scale, gy * scale, gz * scale
        far = 0.0
        for t in range(star.shape[0]):
            for k in range(3):
                other = star[t, k]
                if other != vertex:
                    x, y, z = places[other, 0] - at[0], places[other, 1] - at[1], places[other, 2] - at[2]
                    far = max(far, x * x + y * y + z * z)
        if far > reach:  # lest edges grow from move to move
            continue
        found = least_facing(code, constants, parts, scratch, places, star, vertex, at)
        if found > most:
            most = found
            for axis in range(3):
                best[axis] = at[axis]
            slope[0], slope[1], slope[2] = gx, gy, gz
    if most > before:
        for axis in range(3):
            places[vertex, axis] = best[axis]
            normals[vertex, axis] = slope[axis]
    return most > before
