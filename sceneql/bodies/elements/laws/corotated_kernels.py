# mypy: ignore-errors
"""The corotated law at a point (law_kernels.py): numbers Lame's lambda, mu; d = tr S - 3 of F = R S."""

from sceneql.bodies.elements.laws.law_kernels import ENERGY, MODULUS, STIFFNESS, STRESS
from sceneql.bodies.elements.laws.principal_kernels import MODES, U, V, from_modes, principal
from sceneql.compiled.kernels import lean

LEAST = 1e-6
"""The sum of two stretches is taken for no less: where it is 0 the rotation jumps."""


@lean(STRESS)
def stress(f, numbers, p, m, scratch):
    """P = 2 mu (F - R)."""
    principal(f, scratch)
    u, v = scratch[U : U + 9], scratch[V : V + 9]
    for i in range(0, 9, 3):
        for j in range(0, 9, 3):
            at = i + j // 3
            m[at] = u[i] * v[j] + u[i + 1] * v[j + 1] + u[i + 2] * v[j + 2]
            p[at] = 2.0 * numbers[MODULUS] * (f[at] - m[at])
    return (scratch[0] - 1.0) + (scratch[1] - 1.0) + (scratch[2] - 1.0)


@lean(ENERGY)
def energy(f, numbers, out, scratch):
    """Mu |S - 1|^2."""
    principal(f, scratch)
    x, y, z = scratch[0] - 1.0, scratch[1] - 1.0, scratch[2] - 1.0
    out[0], out[1] = numbers[MODULUS] * (x * x + y * y + z * z), x + y + z


@lean(STIFFNESS)
def stiffness(f, numbers, pressure, bulk, definite, c, scratch):
    """By its modes: p_i = 2 mu (s_i - 1) + pressure."""
    principal(f, scratch)
    two, x, y, z = 2.0 * numbers[MODULUS], scratch[0], scratch[1], scratch[2]
    a = scratch[MODES : MODES + 12]
    for k in range(3):
        a[k], a[3 + k], a[6 + k] = two + bulk, bulk, two
    q = 2.0 * (pressure - two)
    a[9], a[10], a[11] = two + q / max(y + z, LEAST), two + q / max(x + z, LEAST), two + q / max(x + y, LEAST)
    from_modes(definite, c, scratch)
