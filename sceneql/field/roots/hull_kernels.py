# mypy: ignore-errors
"""Polynomials on a segment in Bernstein's basis, in one lane: the hull of the coefficients contains the polynomial.

About the middle of the segment, sigma in [-1, 1], coefficient k of d stands at 2 k/d - 1; the first and the last are
the values at the ends, and d/2 times the differences are the coefficients of the derivative (Farouki 2012, The
Bernstein polynomial basis: a centennial retrospective). All factors of the change of basis are at most 1.
"""

from sceneql.field.enclose.moved_kernels import moved_4, moved_6, moved_8
from sceneql.field.tape.single_kernels import lane


@lane
def bernstein_4(c0, c1, c2, c3, c4):
    """Bernstein coefficients of a polynomial of degree 4 or less."""
    ends, end = c0 + c2 + c4, c1 + c3
    even, odd = c0 - c4, 0.5 * (c1 - c3)
    return ends - end, even - odd, c0 - c2 * (1.0 / 3.0) + c4, even + odd, ends + end


@lane
def bernstein_6(c0, c1, c2, c3, c4, c5, c6):
    """As ``bernstein_4``, of degree 6 or less."""
    ends, end = c0 + c2 + c4 + c6, c1 + c3 + c5
    less, more, last, first = c2 - c4, c2 + c4, c0 - c6, c0 + c6
    even_1, odd_1 = last + less * (1.0 / 3.0), (c1 - c5) * (2.0 / 3.0)
    even_2, odd_2 = first - more * (1.0 / 15.0), (c1 + c5) * (1.0 / 3.0) - 0.2 * c3
    return ends - end, even_1 - odd_1, even_2 - odd_2, last - 0.2 * less, even_2 + odd_2, even_1 + odd_1, ends + end


@lane
def bernstein_8(c0, c1, c2, c3, c4, c5, c6, c7, c8):
    """As ``bernstein_4``, of degree 8 or less."""
    ends, end = c0 + c2 + c4 + c6 + c8, c1 + c3 + c5 + c7
    less, more, last, first = c2 - c6, c2 + c6, c0 - c8, c0 + c8
    outer, inner = c1 - c7, c3 - c5
    even_1, odd_1 = last + 0.5 * less, 0.75 * outer + 0.25 * inner
    even_2, odd_2 = first + (more - c4) * (1.0 / 7.0), 0.5 * (c1 + c7) - (c3 + c5) * (1.0 / 14.0)
    even_3, odd_3 = last - less * (1.0 / 14.0), 0.25 * outer - inner * (3.0 / 28.0)
    middle = first - more * (1.0 / 7.0) + c4 * (3.0 / 35.0)
    return (
        ends - end, even_1 - odd_1, even_2 - odd_2, even_3 - odd_3, middle,
        even_3 + odd_3, even_2 + odd_2, even_1 + odd_1, ends + end,
    )  # fmt: skip


@lane
def lower(a, b):
    """The lower of two numbers."""
    return a if a < b else b


@lane
def higher(a, b):
    """The higher of two numbers."""
    return a if a > b else b


@lane
def hull_4(c0, c1, c2, c3, c4, m, h, off):
    """(first, last, lowest, highest, steepest descent from the first to another, largest rise to the next) of the
    Bernstein coefficients of p - off, degrees up to 4, on m - h..m + h; descents are per length of the segment."""
    c0, c1, c2, c3, c4 = moved_4(c0, c1, c2, c3, c4, m)
    h2 = h * h
    b0, b1, b2, b3, b4 = bernstein_4(c0 - off, h * c1, h2 * c2, h * h2 * c3, h2 * h2 * c4)
    lowest, highest, steepest, rise = lower(b0, b1), higher(b0, b1), (b0 - b1) * 4.0, b1 - b0
    lowest, highest = lower(lowest, b2), higher(highest, b2)
    steepest, rise = higher(steepest, (b0 - b2) * 2.0), higher(rise, b2 - b1)
    lowest, highest = lower(lowest, b3), higher(highest, b3)
    steepest, rise = higher(steepest, (b0 - b3) * (4.0 / 3.0)), higher(rise, b3 - b2)
    lowest, highest = lower(lowest, b4), higher(highest, b4)
    steepest, rise = higher(steepest, b0 - b4), higher(rise, b4 - b3)
    return b0, b4, lowest, highest, steepest, rise


@lane
def hull_6(c0, c1, c2, c3, c4, c5, c6, m, h, off):
    """As ``hull_4``, degrees up to 6."""
    c0, c1, c2, c3, c4, c5, c6 = moved_6(c0, c1, c2, c3, c4, c5, c6, m)
    h2 = h * h
    h4 = h2 * h2
    b0, b1, b2, b3, b4, b5, b6 = bernstein_6(c0 - off, h * c1, h2 * c2, h * h2 * c3, h4 * c4, h * h4 * c5, h2 * h4 * c6)
    lowest, highest, steepest, rise = lower(b0, b1), higher(b0, b1), (b0 - b1) * 6.0, b1 - b0
    lowest, highest = lower(lowest, b2), higher(highest, b2)
    steepest, rise = higher(steepest, (b0 - b2) * 3.0), higher(rise, b2 - b1)
    lowest, highest = lower(lowest, b3), higher(highest, b3)
    steepest, rise = higher(steepest, (b0 - b3) * 2.0), higher(rise, b3 - b2)
    lowest, highest = lower(lowest, b4), higher(highest, b4)
    steepest, rise = higher(steepest, (b0 - b4) * (6.0 / 4.0)), higher(rise, b4 - b3)
    lowest, highest = lower(lowest, b5), higher(highest, b5)
    steepest, rise = higher(steepest, (b0 - b5) * (6.0 / 5.0)), higher(rise, b5 - b4)
    lowest, highest = lower(lowest, b6), higher(highest, b6)
    steepest, rise = higher(steepest, b0 - b6), higher(rise, b6 - b5)
    return b0, b6, lowest, highest, steepest, rise


@lane
def hull_8(c0, c1, c2, c3, c4, c5, c6, c7, c8, m, h, off):
    """As ``hull_4``, degrees up to 8."""
    c0, c1, c2, c3, c4, c5, c6, c7, c8 = moved_8(c0, c1, c2, c3, c4, c5, c6, c7, c8, m)
    h2 = h * h
    h4 = h2 * h2
    b0, b1, b2, b3, b4, b5, b6, b7, b8 = bernstein_8(
        c0 - off, h * c1, h2 * c2, h * h2 * c3, h4 * c4, h * h4 * c5, h2 * h4 * c6, h * h2 * h4 * c7, h4 * h4 * c8
    )
    lowest, highest, steepest, rise = lower(b0, b1), higher(b0, b1), (b0 - b1) * 8.0, b1 - b0
    lowest, highest = lower(lowest, b2), higher(highest, b2)
    steepest, rise = higher(steepest, (b0 - b2) * 4.0), higher(rise, b2 - b1)
    lowest, highest = lower(lowest, b3), higher(highest, b3)
    steepest, rise = higher(steepest, (b0 - b3) * (8.0 / 3.0)), higher(rise, b3 - b2)
    lowest, highest = lower(lowest, b4), higher(highest, b4)
    steepest, rise = higher(steepest, (b0 - b4) * 2.0), higher(rise, b4 - b3)
    lowest, highest = lower(lowest, b5), higher(highest, b5)
    steepest, rise = higher(steepest, (b0 - b5) * (8.0 / 5.0)), higher(rise, b5 - b4)
    lowest, highest = lower(lowest, b6), higher(highest, b6)
    steepest, rise = higher(steepest, (b0 - b6) * (8.0 / 6.0)), higher(rise, b6 - b5)
    lowest, highest = lower(lowest, b7), higher(highest, b7)
    steepest, rise = higher(steepest, (b0 - b7) * (8.0 / 7.0)), higher(rise, b7 - b6)
    lowest, highest = lower(lowest, b8), higher(highest, b8)
    steepest, rise = higher(steepest, b0 - b8), higher(rise, b8 - b7)
    return b0, b8, lowest, highest, steepest, rise
