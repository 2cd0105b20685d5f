# mypy: ignore-errors
"""The first contact of a body on its path (body_path_kernels)."""

from numba import types

from sceneql.compiled.kernels import lean, lean_inlined
from sceneql.contacts import layout
from sceneql.contacts.body_path_kernels import NEVER, first_contact, place
from sceneql.contacts.shape_kernels import velocity
from sceneql.system.signatures_kernels import A, F, I, N


@lean_inlined
def shift(path, ux, uy, uz, h):
    """Add a constant velocity to the path, about its end."""
    if ux != 0.0 or uy != 0.0 or uz != 0.0:
        path[0] -= ux * h
        path[1] -= uy * h
        path[2] -= uz * h
        path[3] += ux
        path[4] += uy
        path[5] += uz
        path[9] += ux
        path[10] += uy
        path[11] += uz


@lean_inlined
def seen(path, s, floats, ints, at):
    """The body's place at s in the frame of an object, as `earliest` uses it: the object's pose at the path's end."""
    x, y, z = place(path, s)
    left = (1.0 - s) * path[12]
    ux, uy, uz = velocity(floats, ints, at, path[0], path[1], path[2])
    return x + left * ux, y + left * uy, z + left * uz


@lean(types.Tuple((F, N))(N, F, A, A, I), inner=True)
def earliest(k, reach, path, floats, ints):
    """The first contact on the path with an object that the body does not rest on: (s, the object), by the path in the
    moving frame of each object."""
    best = NEVER
    first = 0
    h = path[12]
    for j in range(ints[layout.OBJECTS]):
        if floats[ints[layout.PAIRS] + layout.PAIR * (k * ints[layout.OBJECTS] + j)] != layout.FREE:
            continue
        at = layout.HEAD + layout.OBJECT * j
        ux, uy, uz = velocity(floats, ints, at, path[0], path[1], path[2])
        shift(path, -ux, -uy, -uz, h)
        s = first_contact(path, floats, ints, at, reach)
        shift(path, ux, uy, uz, h)
        if s < best:
            best, first = s, j
    return best, first
