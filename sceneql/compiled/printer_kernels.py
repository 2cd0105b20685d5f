# mypy: ignore-errors
"""Functions that printed kernels call."""

from sceneql.compiled.kernels import inlined


@inlined
def smoothstep(a, b, x):
    """0 below a, 1 above b, 3s^2 - 2s^3 between, s = (x - a)/(b - a)."""
    s = min(max((x - a) / (b - a), 0.0), 1.0)
    return s * s * (3.0 - 2.0 * s)


@inlined
def ease(x):
    """Smoothstep from 0 to 1."""
    return smoothstep(0.0, 1.0, x)


@inlined
def truth(condition):
    """1 where the condition holds, else 0."""
    return 1.0 if condition else 0.0
