# mypy: ignore-errors
"""The states within a step that contacts have changed; compiled where these are read between the ends of steps."""

from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import DENSE


@lean(DENSE)
def straightened(theta, h, y0, rate0, y1, rate1, work, settings, numbers, out):
    """As `hermite`, but a line for entries whose end rates do not fit a smooth curve through the end states.

    For states that contacts have changed after a stiff step: that step may be far longer than the transients after an
    impact, whose rates say nothing of its interior. For most smooth curves (y1 - y0)/h differs from the mean of the end
    rates by far less than these differ from each other.
    """
    for k in range(y0.size):
        difference, first, last = y1[k] - y0[k], h * rate0[k], h * rate1[k]
        bend = (1.0 - 2.0 * theta) * difference + (theta - 1.0) * first + theta * last
        if abs(difference - 0.5 * (first + last)) > 0.25 * abs(last - first):
            bend = 0.0
        out[k] = (1.0 - theta) * y0[k] + theta * y1[k] + theta * (theta - 1.0) * bend
