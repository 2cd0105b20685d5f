# mypy: ignore-errors
"""Polynomials about another middle (Taylor shift), in one lane: Horner's scheme, coefficients in registers.

The remainder of division by tau - m is p(m); that of the quotient is the next coefficient, and so on.
"""

from sceneql.field.tape.single_kernels import lane


@lane
def moved_1(c0, c1, m):
    """Coefficients of c0 + c1 tau in powers of tau - m."""
    return c0 + m * c1, c1


@lane
def moved_2(c0, c1, c2, m):
    """As ``moved_1``, of degree 2."""
    c1 += m * c2
    c0 += m * c1
    return c0, *moved_1(c1, c2, m)


@lane
def moved_3(c0, c1, c2, c3, m):
    """As ``moved_1``, of degree 3."""
    c2 += m * c3
    c1 += m * c2
    c0 += m * c1
    return c0, *moved_2(c1, c2, c3, m)


@lane
def moved_4(c0, c1, c2, c3, c4, m):
    """As ``moved_1``, of degree 4."""
    c3 += m * c4
    c2 += m * c3
    c1 += m * c2
    c0 += m * c1
    return c0, *moved_3(c1, c2, c3, c4, m)


@lane
def moved_5(c0, c1, c2, c3, c4, c5, m):
    """As ``moved_1``, of degree 5."""
    c4 += m * c5
    c3 += m * c4
    c2 += m * c3
    c1 += m * c2
    c0 += m * c1
    return c0, *moved_4(c1, c2, c3, c4, c5, m)


@lane
def moved_6(c0, c1, c2, c3, c4, c5, c6, m):
    """As ``moved_1``, of degree 6."""
    c5 += m * c6
    c4 += m * c5
    c3 += m * c4
    c2 += m * c3
    c1 += m * c2
    c0 += m * c1
    return c0, *moved_5(c1, c2, c3, c4, c5, c6, m)


@lane
def moved_7(c0, c1, c2, c3, c4, c5, c6, c7, m):
    """As ``moved_1``, of degree 7."""
    c6 += m * c7
    c5 += m * c6
    c4 += m * c5
    c3 += m * c4
    c2 += m * c3
    c1 += m * c2
    c0 += m * c1
    return c0, *moved_6(c1, c2, c3, c4, c5, c6, c7, m)


@lane
def moved_8(c0, c1, c2, c3, c4, c5, c6, c7, c8, m):
    """As ``moved_1``, of degree 8."""
    c7 += m * c8
    c6 += m * c7
    c5 += m * c6
    c4 += m * c5
    c3 += m * c4
    c2 += m * c3
    c1 += m * c2
    c0 += m * c1
    return c0, *moved_7(c1, c2, c3, c4, c5, c6, c7, c8, m)
