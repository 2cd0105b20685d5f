"""linear: small strains."""

from __future__ import annotations

from sceneql.bodies.elements.laws.law import Law


class Linear(Law):
    """Stress in proportion to the small strain (F + F^T)/2 - 1: a body that turns is strained by that (Hooke 1678)."""

    kernels = "sceneql.bodies.elements.laws.linear_law_kernels"

    recovers = False
    turns = False
