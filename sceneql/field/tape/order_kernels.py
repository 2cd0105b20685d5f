# mypy: ignore-errors
"""Minimum, maximum and sign with NaN propagated."""

from sceneql.compiled.kernels import inlined


@inlined
def smaller(a, b):
    """The smaller of two numbers; NaN if either is."""
    return a if a < b or a != a else b


@inlined
def larger(a, b):
    """The larger of two numbers; NaN if either is."""
    return a if a > b or a != a else b


@inlined
def sign_of(a):
    """-1, 0 or 1; NaN for NaN."""
    if a > 0.0:
        return 1.0
    return -1.0 if a < 0.0 else 0.0 * a
