# mypy: ignore-errors
"""Sine, exponential, logarithm and arctangent in float32 by arithmetic alone: the same bits on every machine.

Range reductions and polynomials with the coefficients of Moshier's Cephes (1992).
"""

import numba
import numpy as np

from sceneql.compiled.kernels import HELPER

lane = numba.njit(forceinline=True, **HELPER)
"""Decorator of functions of one lane: always inlined, since a loop with a call is not vectorized."""

F = np.float32
WAVE_ERROR = F(4.0e-7)
"""Absolute error of sine and cosine for arguments up to FARTHEST; that of atan2 is a little larger."""
FARTHEST = F(4096.0)
EXP_ERROR = F(8.0e-7)
"""Relative error of the exponential."""
LOG_ERROR = F(4.0e-7)
"""Error of the logarithm, relative to 1 + |log|."""
ZERO, HALF, ONE, TWO = F(0.0), F(0.5), F(1.0), F(2.0)
TWO_OVER_PI = F(0.63661977)
HALF_PI_1, HALF_PI_2, HALF_PI_3 = F(1.5703125), F(4.837512969970703e-4), F(7.549789948768648e-8)
S1, S2, S3 = F(-1.6666654611e-1), F(8.3321608736e-3), F(-1.9515295891e-4)
C1, C2, C3 = F(4.166664568298827e-2), F(-1.388731625493765e-3), F(2.443315711809948e-5)
LOG2_E, LN2_1, LN2_2 = F(1.44269504), F(0.693359375), F(-2.12194440e-4)
E0, E1, E2 = F(5.0000001201e-1), F(1.6666665459e-1), F(4.1665795894e-2)
E3, E4, E5 = F(8.3334519073e-3), F(1.3981999507e-3), F(1.9875691500e-4)
ROOT_HALF = F(0.70710678)
L0, L1, L2 = F(3.3333331174e-1), F(-2.4999993993e-1), F(2.0000714765e-1)
L3, L4, L5 = F(-1.6668057665e-1), F(1.4249322787e-1), F(-1.2420140846e-1)
L6, L7, L8 = F(1.1676998740e-1), F(-1.1514610310e-1), F(7.0376836292e-2)
A0, A1, A2, A3 = F(-3.33329491539e-1), F(1.99777106478e-1), F(-1.38776856032e-1), F(8.05374449538e-2)
TAN_PI_8 = F(0.41421356)
QUARTER_PI, HALF_PI, PI = F(0.78539816), F(1.57079633), F(3.14159265)
LEAST_NORMAL = F(1.2e-38)


WHOLE_NUMBERS = F(4.0e6)
"""Up to here half the sum of two integers is exact in float32."""


@lane
def below(x):
    """floor x, clamped to +- WHOLE_NUMBERS: the library's floor is a call, which does not vectorize."""
    x = x if x < WHOLE_NUMBERS else WHOLE_NUMBERS
    x = x if x > -WHOLE_NUMBERS else -WHOLE_NUMBERS
    cut = F(np.int32(x))
    return cut - ONE if cut > x else cut


@lane
def sine_cosine(x):
    """(sin x, cos x); meaningless beyond FARTHEST."""
    x = x if abs(x) < FARTHEST else ZERO
    turns = below(x * TWO_OVER_PI + HALF)
    r = ((x - turns * HALF_PI_1) - turns * HALF_PI_2) - turns * HALF_PI_3
    z = r * r
    s = r + r * z * (S1 + z * (S2 + z * S3))
    c = ONE - HALF * z + z * z * (C1 + z * (C2 + z * C3))
    quadrant = np.int32(turns)
    odd = (quadrant & 1) != 0
    first = c if odd else s
    second = s if odd else c
    return -first if (quadrant & 2) != 0 else first, -second if ((quadrant + 1) & 2) != 0 else second


@lane
def exponential(x):
    """exp x for -87 < x < 88; arguments beyond are clamped to this range."""
    x = x if x < F(88.0) else F(88.0)
    x = x if x > F(-87.0) else F(-87.0)
    turns = below(x * LOG2_E + HALF)
    r = (x - turns * LN2_1) - turns * LN2_2
    y = ONE + (r + r * r * (E0 + r * (E1 + r * (E2 + r * (E3 + r * (E4 + r * E5))))))
    return y * np.int32((np.int32(turns) + np.int32(127)) << np.int32(23)).view(np.float32)


@lane
def logarithm(x):
    """log x of a positive normal number."""
    bits = np.float32(x).view(np.int32)
    turns = F(np.int32((bits >> np.int32(23)) & np.int32(255)) - np.int32(126))
    m = np.int32((bits & np.int32(0x7FFFFF)) | np.int32(0x3F000000)).view(np.float32)
    small = m < ROOT_HALF
    turns = turns - ONE if small else turns
    m = m + m - ONE if small else m - ONE
    z = m * m
    p = L0 + m * (L1 + m * (L2 + m * (L3 + m * (L4 + m * (L5 + m * (L6 + m * (L7 + m * L8)))))))
    y = m * z * p + turns * LN2_2 - HALF * z
    return m + y + turns * LN2_1


@lane
def angle(y, x):
    """atan2(y, x); 0 at the origin."""
    ay = abs(y)
    ax = abs(x)
    low = ay if ay < ax else ax
    high = ax if ay < ax else ay
    t = low / (high if high > LEAST_NORMAL else LEAST_NORMAL)
    far = t > TAN_PI_8
    base = QUARTER_PI if far else ZERO
    t = (t - ONE) / (t + ONE) if far else t
    z = t * t
    found = base + (t + t * z * (A0 + z * (A1 + z * (A2 + z * A3))))
    found = HALF_PI - found if ay > ax else found
    found = PI - found if x < ZERO else found
    return -found if y < ZERO else found
