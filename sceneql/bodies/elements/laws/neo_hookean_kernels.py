# mypy: ignore-errors
"""The law of neo_hookean at a point (law_kernels.py): numbers Lame's lambda, mu; d = J - 1.

Of the energy's (lambda + mu)/2 d^2 lambda's part may act on the mean of d; mu's is of the shape, which without it would
resist less than nothing where d differs within an element.
"""

from sceneql.bodies.elements.laws.law_kernels import ENERGY, MODULUS, STIFFNESS, STRESS
from sceneql.bodies.elements.laws.principal_kernels import MODES, from_modes, principal
from sceneql.bodies.elements.volume_kernels import cofactor, squares
from sceneql.compiled.kernels import lean


@lean(STRESS)
def stress(f, numbers, p, m, scratch):
    """P = mu (F + (J - 2) cof F), with cof F = dJ/dF."""
    j = cofactor(f, m)
    for k in range(9):
        p[k] = numbers[MODULUS] * (f[k] + (j - 2.0) * m[k])
    return j - 1.0


@lean(ENERGY)
def energy(f, numbers, out, scratch):
    """mu/2 (I_C - 3) - mu (J - 1) + mu/2 (J - 1)^2."""
    one, dilatation = squares(f)
    out[0], out[1] = numbers[MODULUS] * (0.5 * one - dilatation + 0.5 * dilatation * dilatation), dilatation


@lean(STIFFNESS)
def stiffness(f, numbers, pressure, bulk, definite, c, scratch):
    """By its modes: p_i = mu s_i + (pressure + mu (J - 2)) s_j s_k."""
    principal(f, scratch)
    mu, x, y, z = numbers[MODULUS], scratch[0], scratch[1], scratch[2]
    q, bulk = pressure + mu * (x * y * z - 2.0), bulk + mu
    a = scratch[MODES : MODES + 12]
    a[0], a[1], a[2] = mu + bulk * (y * z) ** 2, mu + bulk * (x * z) ** 2, mu + bulk * (x * y) ** 2
    a[3], a[4], a[5] = (q + bulk * x * y * z) * x, (q + bulk * x * y * z) * y, (q + bulk * x * y * z) * z
    a[6], a[7], a[8] = mu - q * x, mu - q * y, mu - q * z
    a[9], a[10], a[11] = mu + q * x, mu + q * y, mu + q * z
    from_modes(definite, c, scratch)
