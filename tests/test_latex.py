"""Formulas of LaTeX as messages tell them: the same value."""

import pytest

from sceneql.quantities.latex import from_latex


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        (r"2/\frac{1}{2}", "2/(1/2)"),
        (r"4^\frac{1}{2}", "4^(1/2)"),
        (r"\frac{a}{b}^2", "(a/b)^2"),
        (r"\frac{1}{2}x^2", "1/2*x^2"),
        (r"\frac{a}{b}\frac{c}{d}", "a/b*c/d"),
        (r"2\pi r", "2*pi*r"),
        (r"\sqrt{x}y", "sqrt(x)*y"),
        (r"\frac{1}{2} m", "1/2 m"),
        (r"\frac{1}{2} \cdot x^{2}", "1/2*x^2"),
        (r"2\cos(x)", "2*cos(x)"),
    ],
)
def test_what_stands_side_by_side_is_a_product(text, meant):
    assert from_latex(text) == meant
