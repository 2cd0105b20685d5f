# mypy: ignore-errors
"""Invariants of the deformation gradient."""

from sceneql.compiled.kernels import lean_inlined


@lean_inlined
def cofactor(f, m):
    """Write dJ/dF, the cofactors of F (9,); returns J."""
    m[0], m[1], m[2] = f[4] * f[8] - f[5] * f[7], f[5] * f[6] - f[3] * f[8], f[3] * f[7] - f[4] * f[6]
    m[3], m[4], m[5] = f[2] * f[7] - f[1] * f[8], f[0] * f[8] - f[2] * f[6], f[1] * f[6] - f[0] * f[7]
    m[6], m[7], m[8] = f[1] * f[5] - f[2] * f[4], f[2] * f[3] - f[0] * f[5], f[0] * f[4] - f[1] * f[3]
    return f[0] * m[0] + f[1] * m[1] + f[2] * m[2]


@lean_inlined
def squares(f):
    """I_C - 3 and J - 1."""
    one = -3.0
    for k in range(9):
        one += f[k] * f[k]
    j = f[0] * (f[4] * f[8] - f[5] * f[7]) - f[1] * (f[3] * f[8] - f[5] * f[6]) + f[2] * (f[3] * f[7] - f[4] * f[6])
    return one, j - 1.0
