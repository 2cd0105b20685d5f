"""saint_venant: large rotations, small strains."""

from __future__ import annotations

from sceneql.bodies.elements.laws.law import Law


class SaintVenant(Law):
    """Stress in proportion to Green's strain (F^T F - 1)/2: it softens where it is squeezed (Kirchhoff 1852)."""

    kernels = "sceneql.bodies.elements.laws.saint_venant_kernels"

    recovers = False
