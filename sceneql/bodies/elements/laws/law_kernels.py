# mypy: ignore-errors
"""The kernels of a law as terms call them by address, at one point of the material.

``stress(f, numbers, p, m, scratch)`` writes the first Piola stress of the law's shape part and the derivative of its
dilatation d by F, and returns d. ``energy(f, numbers, out, scratch)`` writes the energy of the shape part [Pa] and d.
``stiffness(f, numbers, pressure, bulk, definite, c, scratch)`` writes the derivative c (81,) of p + pressure m by F,
pressure held, with bulk m m added; where ``definite`` is 1 what is negative of it is left out. F, p and m are (9,), row
by row; the first of the numbers is the bulk number, by which pressure = bulk d (laws/law.py); ``scratch`` is of SCRATCH
numbers.
"""

from numba import types

from sceneql.compiled.kernels import function_at
from sceneql.system.signatures_kernels import A, F, N

STRESS = types.float64(A, A, A, A, A)
ENERGY = types.void(A, A, A, A)
STIFFNESS = types.void(A, A, F, F, N, A, A)
STRESS_FUNCTION, ENERGY_FUNCTION, STIFFNESS_FUNCTION = map(types.FunctionType, (STRESS, ENERGY, STIFFNESS))
SCRATCH = 48
BULK, MODULUS, SECOND = range(3)
"""Numbers of a law: the bulk number, its modulus, a second one (laws/law.py)."""


stress_at, energy_at, stiffness_at = map(function_at, (STRESS_FUNCTION, ENERGY_FUNCTION, STIFFNESS_FUNCTION))
