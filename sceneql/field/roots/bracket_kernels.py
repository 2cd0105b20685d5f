# mypy: ignore-errors
"""Roots and minima in brackets along a ray, by point values."""

from sceneql.compiled.kernels import woven
from sceneql.field.tape.gradient_kernels import gradient
from sceneql.field.tape.tape_kernels import value

FINE = 5.0e-13
"""Half width of a bracket, relative to its place on the ray, down to which a root is polished."""


@woven
def along(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t):
    """f at the parameter t of a ray."""
    return value(code, constants, parts, scratch, ox + t * dx, oy + t * dy, oz + t * dz)


@woven
def polished(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, a, b, sign):
    """The root in a..b, where sign f goes from >= 0 at a to < 0 at b: bisection and secant steps in turn."""
    fa = sign * along(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, a)
    fb = sign * along(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, b)
    for turn in range(100):
        if not b - a > FINE * (abs(a) + abs(b)):
            break
        t = 0.5 * (a + b)
        if turn % 2 == 0 and fa > fb:
            t = a + (b - a) * (fa / (fa - fb))
        if t <= a or t >= b:
            t = 0.5 * (a + b)
            if t <= a or t >= b:
                break
        f = sign * along(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t)
        if f < 0.0:
            b = t
            fb = f
        else:
            a = t
            fa = f
    return b


@woven
def slope(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t):
    """df/dt at the parameter t of a ray."""
    _, gx, gy, gz = gradient(code, constants, parts, scratch, ox + t * dx, oy + t * dy, oz + t * dz)
    return gx * dx + gy * dy + gz * dz


@woven
def lowest(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, a, b, sign):
    """The minimum of sign f in a..b, where sign df/dt goes from < 0 at a to >= 0 at b: bisection and secant in turn."""
    fa = sign * slope(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, a)
    fb = sign * slope(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, b)
    for turn in range(100):
        if not b - a > FINE * (abs(a) + abs(b)):
            break
        t = 0.5 * (a + b)
        if turn % 2 == 0 and fa < fb:
            t = a + (b - a) * (fa / (fa - fb))
        if t <= a or t >= b:
            t = 0.5 * (a + b)
            if t <= a or t >= b:
                break
        f = sign * slope(code, constants, parts, scratch, ox, oy, oz, dx, dy, dz, t)
        if f < 0.0:
            a = t
            fa = f
        else:
            b = t
            fb = f
    return b
