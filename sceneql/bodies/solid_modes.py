"""Normal modes of a solid of elements: small free oscillations about its rest state."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

from sceneql.kinds import Gives, Quantity, Record, field, quantity_type
from sceneql.quantities import dimension as dim
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.expression import Type

if TYPE_CHECKING:
    from sceneql.bodies.elements.strain import Strain
    from sceneql.frame import Floats
    from sceneql.quantities.span import Span

OUTPUTS: Mapping[str, Gives] = {
    "frequencies": Gives(
        quantity_type(dim.FREQUENCY, (None,)),
        "Of its lowest modes, `modes` in number; those of motions without strain are 0.",
        computed=True,
    ),
    "mode_shapes": Gives(
        Type((None, None, 3)), "By mode, how far each node moves, relative to the one that most does.", computed=True
    ),
}


class Bent(Record):
    """A start in one of the modes."""

    mode: int = field("Which, the lowest is 1; a free solid's first six are motions without strain.", at_least=1)
    most: Annotated[float, Quantity(dim.LENGTH)] = field("How far the node moves that most does.", above=0)


@dataclass(frozen=True, slots=True, eq=False)
class SolidModes:
    """Normal modes of a solid at rest."""

    frequencies: Floats
    """(k,) [Hz], ascending."""
    shapes: Floats
    """(k, n, 3) displacements of the nodes, scaled so that the largest of each mode is 1."""

    def read(self, output: str) -> Floats:
        """Value of an output of OUTPUTS."""
        return self.frequencies if output == "frequencies" else self.shapes

    def start(self, bent: Bent, line: Span | None) -> Floats:
        """Initial displacements (n, 3) [m] of a start in a mode. Raises ScriptError where there is no such mode."""
        if bent.mode > len(self.shapes):
            message = f"there is no mode {bent.mode}: this solid has {len(self.shapes)}"
            raise ScriptError([Diagnostic("out-of-range", message, line)])
        found: Floats = bent.most * self.shapes[bent.mode - 1]
        return found


@dataclass(slots=True, eq=False)
class Resting:
    """A solid at rest, whose modes are computed on first use.

    Only its elastic forces count, without damping and loads. Modes of a multiple frequency are an arbitrary basis.
    """

    strain: Strain
    places: Floats
    """(n, 3) [m] rest positions of the nodes."""
    held: Any
    """(n, 3) bool: components of nodes that are held."""
    _found: SolidModes | None = None

    def modes(self, floats: Floats, count: int) -> SolidModes:
        """The ``count`` lowest modes; ``floats``: those of its island."""
        if self._found is None or len(self._found.frequencies) < min(count, self._free().size):
            self._found = self._sought(floats, count)
        return SolidModes(self._found.frequencies[:count], self._found.shapes[:count])

    def _free(self) -> Any:
        import numpy as np

        return np.flatnonzero(~np.ravel(self.held))

    def _sought(self, floats: Floats, count: int) -> SolidModes:
        import numpy as np
        from scipy.sparse import csr_array, eye_array, kron

        from sceneql.stepping.eigenmodes import lowest

        mass = csr_array(kron(self.strain.inertia.matrix, eye_array(3), format="csr"))
        free = self._free()
        stiffness = stiffness_at(self.strain, self.places, floats)
        squares, found = lowest(
            stiffness[free][:, free], mass[free][:, free], count, np.repeat(self.places, 3, axis=0)[free]
        )
        shapes = np.zeros((len(squares), mass.shape[0]))
        shapes[:, free] = found.T
        shapes = shapes.reshape(len(squares), -1, 3)
        most = np.linalg.norm(shapes, axis=2).max(axis=1, initial=0.0)
        return SolidModes(np.sqrt(np.maximum(squares, 0.0)) / (2.0 * np.pi), shapes / most[:, None, None])


def stiffness_at(strain: Strain, places: Floats, floats: Floats) -> Any:
    """Stiffness matrix (3 n, 3 n), sparse symmetric [N/m]: minus the Jacobian of elastic forces at places (n, 3)."""
    import numpy as np
    from scipy.sparse import coo_array, csr_array

    from sceneql.bodies.elements.strain_slopes_kernels import OWN_INTS, SLOPES_TILES, slopes_tile

    slopes, position_at = strain.slopes(), int(strain.ints[0])
    y = np.zeros(max(int(strain.ints[1]), position_at) + places.size)
    y[position_at : position_at + places.size] = np.ravel(places)
    entries = np.zeros(slopes.entries)
    numbers = floats.copy()
    for tile in range(int(slopes.ints[slopes.ints.size - OWN_INTS + SLOPES_TILES])):
        slopes_tile(tile, 0.0, y, entries, numbers, slopes.ints)
    across = np.arange(3)
    rows, columns = np.asarray(slopes.rows) - int(strain.ints[1]), np.asarray(slopes.columns) - position_at
    own = (columns >= 0) & (columns < places.size)  # without the derivatives by velocities
    at = np.broadcast_arrays(rows[own][:, None, None] + across[:, None], columns[own][:, None, None] + across)
    values = -entries.reshape(-1, 9)[own]
    found = coo_array((values.ravel(), tuple(one.ravel() for one in at)), (places.size, places.size)).tocsr()
    return csr_array((found + found.T) * 0.5)
