# mypy: ignore-errors
"""The law of mooney_rivlin at a point (law_kernels.py): numbers Lame's lambda, a, b; d = J - 1, as in neo_hookean."""

from sceneql.bodies.elements.laws.law_kernels import ENERGY, MODULUS, SECOND, STIFFNESS, STRESS
from sceneql.bodies.elements.laws.principal_kernels import MODES, from_modes, principal
from sceneql.bodies.elements.volume_kernels import cofactor, squares
from sceneql.compiled.kernels import lean, lean_inlined


@lean_inlined
def cauchy(f, i, j):
    """A component of C = F^T F."""
    return f[i] * f[j] + f[3 + i] * f[3 + j] + f[6 + i] * f[6 + j]


@lean(STRESS)
def stress(f, numbers, p, m, scratch):
    """P = a F + b (I_C F - F C) - (a + 2 b - a (J - 1)) cof F."""
    j = cofactor(f, m)
    xx, yy, zz = cauchy(f, 0, 0), cauchy(f, 1, 1), cauchy(f, 2, 2)
    yz, xz, xy = cauchy(f, 1, 2), cauchy(f, 0, 2), cauchy(f, 0, 1)
    one, two, trace = numbers[MODULUS], numbers[SECOND], xx + yy + zz
    for k in range(0, 9, 3):
        a, b, c = f[k], f[k + 1], f[k + 2]
        x = trace * a - (a * xx + b * xy + c * xz) - 2.0 * m[k]
        y = trace * b - (a * xy + b * yy + c * yz) - 2.0 * m[k + 1]
        z = trace * c - (a * xz + b * yz + c * zz) - 2.0 * m[k + 2]
        p[k] = one * (a + (j - 2.0) * m[k]) + two * x
        p[k + 1] = one * (b + (j - 2.0) * m[k + 1]) + two * y
        p[k + 2] = one * (c + (j - 2.0) * m[k + 2]) + two * z
    return j - 1.0


@lean(ENERGY)
def energy(f, numbers, out, scratch):
    """a/2 (I_C - 3) + b/2 (II_C - 3) - (a + 2 b)(J - 1) + a/2 (J - 1)^2."""
    first, dilatation = squares(f)
    xx, yy, zz = cauchy(f, 0, 0), cauchy(f, 1, 1), cauchy(f, 2, 2)
    yz, xz, xy = cauchy(f, 1, 2), cauchy(f, 0, 2), cauchy(f, 0, 1)
    second = xx * yy + yy * zz + xx * zz - yz * yz - xz * xz - xy * xy - 3.0
    own = numbers[MODULUS] * (0.5 * first - dilatation + 0.5 * dilatation * dilatation)
    out[0] = own + numbers[SECOND] * (0.5 * second - 2.0 * dilatation)
    out[1] = dilatation


@lean(STIFFNESS)
def stiffness(f, numbers, pressure, bulk, definite, c, scratch):
    """By its modes: p_i = a s_i + b s_i (s_j^2 + s_k^2) + (pressure + a (J - 2) - 2 b) s_j s_k."""
    principal(f, scratch)
    one, two, x, y, z = numbers[MODULUS], numbers[SECOND], scratch[0], scratch[1], scratch[2]
    q, bulk = pressure + one * (x * y * z - 2.0) - 2.0 * two, bulk + one
    xx, yy, zz = x * x, y * y, z * z
    coupled = q + bulk * x * y * z
    a = scratch[MODES : MODES + 12]
    a[0] = one + two * (yy + zz) + bulk * yy * zz
    a[1] = one + two * (xx + zz) + bulk * xx * zz
    a[2] = one + two * (xx + yy) + bulk * xx * yy
    a[3], a[4], a[5] = 2.0 * two * y * z + coupled * x, 2.0 * two * x * z + coupled * y, 2.0 * two * x * y + coupled * z
    a[6], a[9] = one + two * (xx - y * z) - q * x, one + two * (xx + y * z) + q * x
    a[7], a[10] = one + two * (yy - x * z) - q * y, one + two * (yy + x * z) + q * y
    a[8], a[11] = one + two * (zz - x * y) - q * z, one + two * (zz + x * y) + q * z
    from_modes(definite, c, scratch)
