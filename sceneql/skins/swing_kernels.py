# mypy: ignore-errors
"""How a flow gives way to forces on masses that it carries: for bounds on how fast these swing."""

from numba import types

from sceneql.compiled.kernels import lean
from sceneql.flows import layout as flow
from sceneql.skins.immersed_kernels import place
from sceneql.skins.immersed_layout import BOX_AT, COUNT, DENSITY_AT, EXCESS_AT, FLOW_AT, INVERSE_AT, POSITION_AT
from sceneql.skins.spline_kernels import through
from sceneql.system.signatures_kernels import A, I


@lean(types.void(A, A, A, A, A, A, I))
def give_way(newtons, out, masses, faces, y, floats, ints):
    """out (3 n): accelerations by newtons (3 n), as if there were no pressure. ``masses``, ``faces``: room by face."""
    one = ints[ints[FLOW_AT] :]
    for f in range(masses.size):
        inverse = floats[one[flow.INVERSES] + f]
        masses[f] = floats[ints[DENSITY_AT]] / inverse if inverse > 0.0 else 0.0
        faces[f] = 0.0
    for turn in range(3):
        for k in range(ints[COUNT]):
            x, y_, z = place(y, ints[POSITION_AT] + 3 * k, ints[BOX_AT], floats)
            free = floats[ints[INVERSE_AT] + k] > 0.0
            for component in range(one[flow.AXES] if free else 0):
                start = one[flow.STARTS + component]
                if turn == 0:
                    through(masses[start:], component, x, y_, z, floats[ints[EXCESS_AT] + k], True, False, one)
                elif turn == 1:
                    through(faces[start:], component, x, y_, z, newtons[3 * k + component], True, False, one)
                else:
                    some = faces[start:]
                    out[3 * k + component] = through(some, component, x, y_, z, 0.0, False, False, one)
        for f in range(masses.size if turn == 1 else 0):
            faces[f] = faces[f] / masses[f] if masses[f] > 0.0 and floats[one[flow.INVERSES] + f] > 0.0 else 0.0
