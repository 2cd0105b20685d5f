# mypy: ignore-errors
"""The derivatives of how rigid bodies turn."""

from sceneql.bodies.rigid import rigid_kernels as term
from sceneql.bodies.rigid.rigid_kernels import times_symmetric, to_body
from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import TERM

ENTRIES = 28
"""Of each body, row by row, its quaternion's rates by the quaternion (4) and the momentum (3)."""


@lean(TERM, inner=True)
def close(t, y, entries, floats, ints):
    """dq/dt = q (0, J R^T L) / 2 with J the inverse inertia, R the rotation by q/|q|, L the angular momentum."""
    for k in range(ints[term.COUNT]):
        at, momentum = ints[term.ROTATION_AT] + 4 * k, ints[term.MOMENTUM_AT] + 3 * k
        inverse, first = ints[term.INVERSE_AT] + 6 * k, ENTRIES * k
        lx, ly, lz = y[momentum], y[momentum + 1], y[momentum + 2]
        ux, uy, uz = to_body(y, at, lx, ly, lz)
        wx, wy, wz = times_symmetric(floats, inverse, ux, uy, uz)
        a, b, c, d = y[at], y[at + 1], y[at + 2], y[at + 3]
        square = a * a + b * b + c * c + d * d
        for i in range(7):
            if i < 4:
                # R^T L = conj(q) L q / |q|^2, so that its derivative by q is (conj(e) L q + conj(q) L e - 2 q u)/|q|^2.
                ea, eb, ec, ed = 1.0 * (i == 0), 1.0 * (i == 1), 1.0 * (i == 2), 1.0 * (i == 3)
                # p = L q, then the vector part of conj(e) p; doubled, since the other product has the same one.
                pa = -(lx * b + ly * c + lz * d)
                px, py, pz = a * lx + ly * d - lz * c, a * ly + lz * b - lx * d, a * lz + lx * c - ly * b
                vx = ea * px - eb * pa - (ec * pz - ed * py)
                vy = ea * py - ec * pa - (ed * px - eb * pz)
                vz = ea * pz - ed * pa - (eb * py - ec * px)
                own = 2.0 * y[at + i] / square
                vx, vy, vz = 2.0 * vx / square - own * ux, 2.0 * vy / square - own * uy, 2.0 * vz / square - own * uz
            else:
                ea = eb = ec = ed = 0.0
                vx, vy, vz = to_body(y, at, 1.0 * (i == 4), 1.0 * (i == 5), 1.0 * (i == 6))
            gx, gy, gz = times_symmetric(floats, inverse, vx, vy, vz)
            entries[first + i] += 0.5 * (-(eb * wx + ec * wy + ed * wz) - (b * gx + c * gy + d * gz))
            entries[first + 7 + i] += 0.5 * (ea * wx + ec * wz - ed * wy + a * gx + c * gz - d * gy)
            entries[first + 14 + i] += 0.5 * (ea * wy + ed * wx - eb * wz + a * gy + d * gx - b * gz)
            entries[first + 21 + i] += 0.5 * (ea * wz + eb * wy - ec * wx + a * gz + b * gy - c * gx)
