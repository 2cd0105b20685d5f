"""neo_hookean: rubber and flesh, that may be squeezed to nothing and come back."""

from __future__ import annotations

from sceneql.bodies.elements.laws.law import Law


class NeoHookean(Law):
    """Energy mu/2 (I_C - 3) - mu (J - 1) + lambda/2 (J - 1)^2, which no squeezing makes infinite.

    Smith, De Goes & Kim, Stable neo-Hookean flesh simulation (2018), without their logarithm, so that it tends to
    Treloar's rubber (1943) where the volume stays; lambda is larger by mu than Lame's, so that small strains have the
    Poisson ratio that is asked for.
    """

    kernels = "sceneql.bodies.elements.laws.neo_hookean_kernels"
