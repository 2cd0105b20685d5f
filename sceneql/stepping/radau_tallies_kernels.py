# mypy: ignore-errors
"""Tallies (sums on which nothing depends) at the end of a step of radau: compiled when the first one changes."""

from sceneql.compiled.kernels import lean
from sceneql.compiled.pointers_kernels import AT_RATE, rate_at
from sceneql.stepping import radau_layout as layout
from sceneql.stepping.radau_kernels import FINISH
from sceneql.stepping.radau_stages_kernels import ROOT6, evaluate_stages


@lean(FINISH, inner=True)
def finish_tallies(functions, t, h, y0, y1, numbers, floats, ints, z, f):
    """Compute their stages z, left out of Newton's method, from the rates at the final stages; f, y1: scratch."""
    rate = rate_at(functions[AT_RATE])
    n = y0.size
    evaluate_stages(rate, t, h, y0, y1, z, f, floats, ints)
    for k in range(layout.HEAD, layout.HEAD + numbers[layout.TALLIES]):
        i = numbers[k]
        f1, f2, f3 = h * f[i], h * f[n + i], h * f[2 * n + i]
        z[i] = ((88.0 - 7.0 * ROOT6) * f1 + (59.2 - 33.8 * ROOT6) * f2) / 360.0 + (3.0 * ROOT6 - 2.0) / 225.0 * f3
        z[n + i] = ((59.2 + 33.8 * ROOT6) * f1 + (88.0 + 7.0 * ROOT6) * f2) / 360.0 - (2.0 + 3.0 * ROOT6) / 225.0 * f3
        z[2 * n + i] = ((16.0 - ROOT6) * f1 + (16.0 + ROOT6) * f2) / 36.0 + f3 / 9.0
