# mypy: ignore-errors
"""Saint Venant's law at a point (law_kernels.py): numbers Lame's lambda, mu; d = tr E, E = (F^T F - 1)/2."""

from sceneql.bodies.elements.laws.law_kernels import ENERGY, MODULUS, STIFFNESS, STRESS
from sceneql.bodies.elements.laws.principal_kernels import MODES, from_modes, principal
from sceneql.compiled.kernels import lean, lean_inlined


@lean_inlined
def green(f, i, j):
    """A component of E."""
    total = -1.0 if i == j else 0.0
    for k in range(0, 9, 3):
        total += f[k + i] * f[k + j]
    return 0.5 * total


@lean(STRESS)
def stress(f, numbers, p, m, scratch):
    """P = 2 mu F E."""
    xx, yy, zz, yz, xz, xy = (
        green(f, 0, 0),
        green(f, 1, 1),
        green(f, 2, 2),
        green(f, 1, 2),
        green(f, 0, 2),
        green(f, 0, 1),
    )
    for k in range(0, 9, 3):
        a, b, c = f[k], f[k + 1], f[k + 2]
        p[k] = 2.0 * numbers[MODULUS] * (a * xx + b * xy + c * xz)
        p[k + 1] = 2.0 * numbers[MODULUS] * (a * xy + b * yy + c * yz)
        p[k + 2] = 2.0 * numbers[MODULUS] * (a * xz + b * yz + c * zz)
    for k in range(9):
        m[k] = f[k]
    return xx + yy + zz


@lean(ENERGY)
def energy(f, numbers, out, scratch):
    """Mu |E|^2."""
    total = 0.0
    for i in range(3):
        for j in range(3):
            total += green(f, i, j) ** 2
    out[0], out[1] = numbers[MODULUS] * total, green(f, 0, 0) + green(f, 1, 1) + green(f, 2, 2)


@lean(STIFFNESS)
def stiffness(f, numbers, pressure, bulk, definite, c, scratch):
    """By its modes: p_i = mu s_i (s_i^2 - 1) + pressure s_i."""
    principal(f, scratch)
    mu, x, y, z = numbers[MODULUS], scratch[0], scratch[1], scratch[2]
    q = pressure - mu
    a = scratch[MODES : MODES + 12]
    a[0], a[1], a[2] = q + (3.0 * mu + bulk) * x * x, q + (3.0 * mu + bulk) * y * y, q + (3.0 * mu + bulk) * z * z
    a[3], a[4], a[5] = bulk * y * z, bulk * x * z, bulk * x * y
    a[6], a[9] = mu * (y * y + y * z + z * z) + q, mu * (y * y - y * z + z * z) + q
    a[7], a[10] = mu * (x * x + x * z + z * z) + q, mu * (x * x - x * z + z * z) + q
    a[8], a[11] = mu * (x * x + x * y + y * y) + q, mu * (x * x - x * y + y * y) + q
    from_modes(definite, c, scratch)
