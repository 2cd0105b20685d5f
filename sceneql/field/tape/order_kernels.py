# mypy: ignore-errors
"""The smaller and the larger of two numbers, and the sign of one, where NaN stays NaN."""

from sceneql.compiled.kernels import inlined


@inlined
def smaller(a, b):
    """The smaller of two; NaN if either is."""
    return a if a < b or a != a else b


@inlined
def larger(a, b):
    """The larger of two; NaN if either is."""
    return a if a > b or a != a else b


@inlined
def sign_of(a):
    """-1, 0 or 1; NaN of NaN."""
    if a > 0.0:
        return 1.0
    return -1.0 if a < 0.0 else 0.0 * a
