# mypy: ignore-errors
"""Polynomials on [-1, 1] enclosed by parabolas +- e, in one lane: multiples of lower powers replace the higher ones."""

from sceneql.field.tape.single_kernels import lane


@lane
def enclosed_4(c0, c1, c2, c3, c4):
    """(q0, q1, q2, e, bound of the derivative): sigma^3 is within 1/4 of 3/4 sigma, sigma^4 within 1/8 of
    sigma^2 - 1/8."""
    e = 0.25 * abs(c3) + 0.125 * abs(c4)
    steep = c1 + 2.0 * abs(c2) + (3.0 * c3 if c3 > 0.0 else 0.0) + 4.0 * abs(c4)
    return c0 - 0.125 * c4, c1 + 0.75 * c3, c2 + c4, e, steep


@lane
def enclosed_6(c0, c1, c2, c3, c4, c5, c6):
    """sigma^5 is within 0.3275 of 0.675 sigma, sigma^6 within 0.1925 of sigma^2 - 0.1925."""
    q0, q1, q2, e, steep = enclosed_4(c0, c1, c2, c3, c4)
    e += 0.3275 * abs(c5) + 0.1925 * abs(c6)
    steep += (5.0 * c5 if c5 > 0.0 else 0.0) + 6.0 * abs(c6)
    return q0 - 0.1925 * c6, q1 + 0.675 * c5, q2 + c6, e, steep


@lane
def enclosed_8(c0, c1, c2, c3, c4, c5, c6, c7, c8):
    """sigma^7 is within 0.3661 of 0.634 sigma, sigma^8 within 0.2363 of sigma^2 - 0.2363."""
    q0, q1, q2, e, steep = enclosed_6(c0, c1, c2, c3, c4, c5, c6)
    e += 0.3661 * abs(c7) + 0.2363 * abs(c8)
    steep += (7.0 * c7 if c7 > 0.0 else 0.0) + 8.0 * abs(c8)
    return q0 - 0.2363 * c8, q1 + 0.634 * c7, q2 + c8, e, steep
