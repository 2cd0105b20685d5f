# mypy: ignore-errors
"""The linear law at a point (law_kernels.py): numbers Lame's lambda, mu; d = tr F - 3."""

from sceneql.bodies.elements.laws.law_kernels import ENERGY, MODULUS, STIFFNESS, STRESS
from sceneql.compiled.kernels import lean


@lean(STRESS)
def stress(f, numbers, p, m, scratch):
    """P = mu (F + F^T - 2)."""
    for i in range(3):
        for j in range(3):
            one = 1.0 if i == j else 0.0
            p[3 * i + j] = numbers[MODULUS] * ((f[3 * i + j] - one) + (f[3 * j + i] - one))
            m[3 * i + j] = one
    return (f[0] - 1.0) + (f[4] - 1.0) + (f[8] - 1.0)


@lean(ENERGY)
def energy(f, numbers, out, scratch):
    """Mu |strain|^2."""
    total = 0.0
    for i in range(3):
        for j in range(3):
            one = 1.0 if i == j else 0.0
            strain = 0.5 * ((f[3 * i + j] - one) + (f[3 * j + i] - one))
            total += strain * strain
    out[0], out[1] = numbers[MODULUS] * total, (f[0] - 1.0) + (f[4] - 1.0) + (f[8] - 1.0)


@lean(STIFFNESS)
def stiffness(f, numbers, pressure, bulk, definite, c, scratch):
    """The same for all F, and never negative."""
    for k in range(81):
        c[k] = 0.0
    for i in range(3):
        for j in range(3):
            c[9 * (3 * i + j) + 3 * i + j] += numbers[MODULUS]
            c[9 * (3 * i + j) + 3 * j + i] += numbers[MODULUS]
            c[9 * 4 * i + 4 * j] += bulk
