# mypy: ignore-errors
"""The derivatives of the rate of a wave on a grid."""

from sceneql.compiled.kernels import lean
from sceneql.grids import diffusion_slopes_kernels as diffusion
from sceneql.system.signatures_kernels import TERM
from sceneql.waves import wave_kernels as term


@lean(TERM, inner=True)
def wave(t, y, entries, floats, ints):
    """Slopes of the term `wave`: of each cell those by the velocity, of u and of v; then those of `spread`."""
    n = ints[term.CELLS]
    for c in range(n):
        entries[c] += 1.0
        entries[n + c] -= floats[ints[term.DECAYS] + c]
    diffusion.spread(t, y, entries[2 * n :], floats, ints[term.SPREAD_AT :])
