"""Formulas of solids, and their meshes by each way, for the tests of polygonising."""

import numpy as np

from expressions import bound
from sceneql.field.tape.builder import TapeBuilder
from sceneql.mesh.cubes.polygonise import polygonise
from sceneql.mesh.cubes.refine import refined
from sceneql.mesh.dual.sharp import polygonise_sharp
from sceneql.mesh.measures import edge_counts
from sceneql.quantities.expression import Symbol

BALL = "sqrt(x^2 + y^2 + z^2) - 1"


TORUS = "(sqrt(x^2 + y^2) - 1)^2 + z^2 - 0.16"


CAPSULE = "sqrt((x - min(max(x, -0.5), 0.5))^2 + y^2 + z^2) - 0.4"


STEINER = "max(x^2*y^2 + y^2*z^2 + z^2*x^2 - x*y*z, sqrt(x^2 + y^2 + z^2) - 0.6)"


TANGLECUBE = "x^4 - 5*x^2 + y^4 - 5*y^2 + z^4 - 5*z^2 + 11.8"


CLOSED = {  # formula, half side of the box, Euler characteristic
    "ball": (BALL, 1.1, 2),
    "torus": (TORUS, 1.5, 0),
    "capsule": (CAPSULE, 1.0, 2),
    "tanglecube": (TANGLECUBE, 3.0, -8),
}


def tape_of(text):
    """The tape of a formula of x, y and z."""
    build = TapeBuilder()
    expr = bound(text, {name: Symbol(name) for name in "xyz"})
    return build.finish(build.expression(expr, {"x": build.x, "y": build.y, "z": build.z}))


def cut(text, half, cells):
    """The mesh of a formula in the cube of a half side, with so many cells along it."""
    return polygonise(tape_of(text), (-half,) * 3, (half,) * 3, 2 * half / cells)


PART = "max(max(abs(x), abs(y), abs(z)) - 0.7, 0.4 - sqrt(x^2 + y^2), 0.25 - sqrt((y - 0.1)^2 + z^2))"


TURN = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])


TURNED = "max(abs(0.36*x + 0.48*y - 0.8*z), abs(0.6*y - 0.8*x), abs(0.48*x + 0.64*y + 0.6*z)) - 0.7"


def cut_sharp(text, half, cells):
    """The mesh with sharp edges of a formula in the cube of a half side, with so many cells along it."""
    return polygonise_sharp(tape_of(text), (-half,) * 3, (half,) * 3, 2 * half / cells)


def assert_closed_manifold(found):
    assert edge_counts(found.triangles)[1:] == (0, 0)
    sides = found.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    assert len(np.unique(sides, axis=0)) == len(sides)  # neighbors agree on what is outside


WALL = "abs(sqrt(x^2 + y^2 + z^2) - 0.7) - 0.0005"  # of 1 mm


def cut_finer(text, half, cells):
    """As ``cut``, with cells refined where they are too coarse; what is left unresolved."""
    return refined(tape_of(text), (-half,) * 3, (half,) * 3, 2 * half / cells)
