# mypy: ignore-errors
"""The rate of a wave on a grid, as a system of first order in the field and its velocity.

The state holds the field in every cell and a tally, then the velocity in every cell and a tally, in one block: what
`diffusion_kernels.spread` adds to the rates of a field is added to those of the velocity, so many entries later.
"""

from sceneql.compiled.kernels import lean
from sceneql.grids import diffusion_kernels as diffusion
from sceneql.system.signatures_kernels import TERM

CELLS, DECAYS, SPREAD_AT = range(3)
"""Integers of `wave`: the number of cells; offset of the decays (cells,) [1/s]; from here on those of
`diffusion_kernels.spread`, whose conductances are those of the square of the speed."""


@lean(TERM, inner=True)
def wave(t, y, rate, floats, ints):
    """du/dt = v, V dv/dt = sum of g (neighbor - u) + fed - sink u - V decay v; the tallies likewise."""
    n, spread = ints[CELLS], ints[SPREAD_AT:]
    at, shift = spread[diffusion.AT], n + 1
    decays = floats[ints[DECAYS] : ints[DECAYS] + n]
    for c in range(n):
        speed = y[at + shift + c]
        rate[at + c] += speed
        rate[at + shift + c] -= decays[c] * speed
    rate[at + n] += y[at + shift + n]
    diffusion.spread(t, y, rate[shift:], floats, spread)
