"""corotated: small strains of a body that turns."""

from __future__ import annotations

from sceneql.bodies.elements.laws.law import Law


class Corotated(Law):
    """Stress in proportion to the stretch S - 1 of F = R S, R the rotation (Mueller & Gross 2004; Sifakis 2012)."""

    kernels = "sceneql.bodies.elements.laws.corotated_kernels"
