"""Convection between plates: how rolls decay and grow beside the eigenvalues of the linear equations."""

import math
from pathlib import Path

import numpy as np
import pytest

from flows import Air
from rolls import nusselt

WIDE, PRANDTL = 2.0158, 0.71
GROWTH = {1680: -0.186398, 1740: 0.214635}
"""[1/s] of a roll of that width, by Chebyshev polynomials of degree 50 (equations: Chandrasekhar 1961, chapter II)."""


def growth(folder, rayleigh, cells):
    """Of the energy's root, of a roll of small amplitude, once it has its shape."""
    box = f"size: {WIDE} 1 m, cell: 1/{cells} m"
    heat = (
        f"  heat: {{diffusion: {{{box}, of: temperature, coefficient: 1 m^2/s, drift: {{by: air}}, "
        f'initial: "1 - y + 1e-4*sin(pi*y)*cos(2*pi*x/{WIDE})", '
        "boundary: {bottom: {value: 1}, top: {value: 0}, left: {periodic: yes}}}}\n"
    )
    lift = f"{{by: heat.temperature, expansion: {PRANDTL * rayleigh} 1/K, reference: 0.5 K, gravity: 0 -1 0 m/s^2}}"
    air = Air(
        folder, "{sbdf2: {step: 4 ms}}", 1.2, heat, size=f"{WIDE} 1 m", cell=f"1/{cells} m", buoyancy=lift,
        viscosity=f"{PRANDTL} Pa*s", advection="central", boundary="{left: {periodic: yes}}",
    )  # fmt: skip
    before, after = (air.at(now).read("kinetic_energy") for now in (0.8, 1.2))
    return 0.5 * math.log(after / before) / 0.4


@pytest.mark.parametrize("rayleigh", GROWTH)
def test_rolls_decay_below_the_critical_rayleigh_number_and_grow_above_it(tmp_path, rayleigh):
    """It is 1707.762; the eigenvalue is met at order 2 of the cells."""
    found = np.array([growth(tmp_path, rayleigh, cells) for cells in (12, 24)])
    assert np.sign(found[1]) == np.sign(GROWTH[rayleigh])
    assert found[1] + (found[1] - found[0]) / 3.0 == pytest.approx(GROWTH[rayleigh], abs=0.01)


def test_the_scene_of_rolls_expects_the_heat_of_series():
    script = (Path(__file__).parent.parent / "scenes" / "benard.yaml").read_text()
    assert nusselt(1e4, 0.71, 2.0158) == pytest.approx(2.6525, abs=1e-4)
    assert "value: 2.6525" in script
