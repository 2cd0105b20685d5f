# mypy: ignore-errors
"""Dense output of Dormand & Prince's pair."""

from sceneql.compiled.kernels import lean
from sceneql.system.signatures_kernels import DENSE


@lean(DENSE)
def dopri5_dense(theta, h, y0, rate0, y1, rate1, work, settings, numbers, out):
    """The interpolant of order 4 (Hairer, Norsett & Wanner 1993, II.6, code DOPRI5)."""
    n = y0.size
    for k in range(n):
        last = work[6 * n + k]
        difference = y1[k] - y0[k]
        bend = h * rate0[k] - difference
        quartic = h * (
            -12715105075.0 / 11282082432.0 * rate0[k]
            + 87487479700.0 / 32700410799.0 * work[2 * n + k]
            - 10690763975.0 / 1880347072.0 * work[3 * n + k]
            + 701980252875.0 / 199316789632.0 * work[4 * n + k]
            - 1453857185.0 / 822651844.0 * work[5 * n + k]
            + 69997945.0 / 29380423.0 * last
        )
        inner = difference - h * last - bend + (1.0 - theta) * quartic
        out[k] = y0[k] + theta * (difference + (1.0 - theta) * (bend + theta * inner))
