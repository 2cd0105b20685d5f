"""Helps for fields that are likely to be tried of a solid and are none."""

SAID = {
    **dict.fromkeys(
        ("modulus", "young", "youngs_modulus", "stiffness", "poisson", "poisson_ratio"),
        "a law has it, `law: {neo_hookean: {modulus: 10 kPa, poisson: 0.45}}`",
    ),
    **dict.fromkeys(
        ("expansion", "thermal_expansion", "thermal_strain", "temperature"),
        "heat strains no solid: there is no word for thermal strain yet",
    ),
    **dict.fromkeys(("mass", "weight"), "write its density, `density: 1000 kg/m^3`"),
}
"""By the field that was written."""
