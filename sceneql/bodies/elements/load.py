"""Loads on the surface of a solid: traction, pressure, force, torque."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from sceneql.bodies.elements.hold import HELD, LOADED, Hold, Part
from sceneql.kinds import Problem, Quantity, Value, field
from sceneql.quantities import dimension as dim
from sceneql.quantities.diagnostic import Diagnostic, ScriptError

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.bodies.elements.element_mesh import ElementMesh
    from sceneql.bodies.elements.on_faces import Spread
    from sceneql.quantities.span import Span
    from sceneql.system import Assembly, Bodies, Slopes

HOW = ("traction", "pressure", "force", "torque")
FOUND_AND_SCRATCH = 33
"""Working memory [numbers] after the weights of a torque's nodes (load_kernels.turning, load_slopes_kernels.torque)."""
MOST_TURNED = 700
"""Most nodes that a torque acts on, since its Jacobian couples each node with all others."""


class Load(Part):
    """What presses or pulls on a part of the surface: faces with all corners in it, or what is `within` a distance."""

    said_by: ClassVar[Mapping[str, str]] = {
        "traction": "a traction acts on an area, in Pa; along a line write the force in all, `force: 0 -1 0 N`"
    }

    traction: Annotated[Value, Quantity(dim.PRESSURE, (3,))] | None = field(
        "Force over the area that the part has at rest; it keeps its direction.", None
    )
    pressure: Annotated[Value, Quantity(dim.PRESSURE)] | None = field(
        "Force over the area that it has, against its outer side: it follows the surface.", None
    )
    force: Annotated[Value, Quantity(dim.FORCE, (3,))] | None = field(
        "The force in all, spread evenly, or at the point of the surface that is nearest to `near`.", None
    )
    torque: Annotated[Value, Quantity(dim.FORCE * dim.LENGTH, (3,))] | None = field(
        "The torque in all, by forces of no sum that grow from the middle of the part; its direction stays.", None
    )

    def problems(self) -> Iterator[Problem]:
        """Problems: more or less than one load; a load on an area that is given as a point."""
        yield from super().problems()
        given = [name for name in HOW if getattr(self, name) is not None]
        if len(given) != 1:
            said = f", not {' and '.join(given)}" if given else ""
            text = f"a load is one of {', '.join(f'`{name}`' for name in HOW)}{said}"
            yield Problem(text, tuple(given[1:2]), at_key=True)
        elif self.near is not None and self.within is None and given != ["force"]:
            yield Problem(f"a {given[0]} acts on an area: say `within`, how far from there", ("near",), at_key=True)

    def line(self, name: str, mesh: ElementMesh) -> Any:
        """The edges (m, 2 or 3) of the line on which it acts; None where it acts on faces."""
        import numpy as np

        on = mesh.lines.get(LOADED.format(name))
        if on is None or not len(on.edges):
            return None
        size = len(mesh.points)
        keys = np.sort(on.edges[:, :2], axis=1) @ (size, 1)
        corners = mesh.faces[:, :3].astype(np.int64)
        sides = np.sort(np.stack([corners, np.roll(corners, -1, axis=1)], axis=2), axis=2) @ (size, 1)
        return None if np.isin(sides, keys).all(axis=1).any() else on.edges

    def spread(self, name: str, mesh: ElementMesh, assembly: Assembly, line: Span | None) -> Spread:
        """The quadrature points on the loaded faces. Raises ScriptError where no part of the surface is loaded."""
        import numpy as np

        from sceneql.bodies.elements.on_faces import nearest, spread

        faces, points = mesh.faces, mesh.points
        if self.near is not None and self.within is None:
            return nearest(points, faces, np.asarray(self.near))
        if self.within is not None:
            found = spread(np.arange(len(faces)), finely=True)
            found = found.some(self.holds(found.at(points, faces), assembly))
        else:
            inside = self.holds(points, assembly)
            if (on := mesh.lines.get(LOADED.format(name))) is not None:
                inside[on.nodes] = True
            found = spread(np.flatnonzero(inside[faces[:, :3]].all(axis=1)), finely=False)
        if not len(found.faces):
            raise ScriptError([self._lost(name, line)])
        return found

    def _lost(self, name: str, line: Span | None) -> Diagnostic:
        """The error of a load that acts on no face."""
        from sceneql.bodies.filling.held_lines import line_of

        message, help = f"'{name}' acts on no part of the surface", None
        how = next(one for one in HOW if getattr(self, one) is not None)
        if how != "force" and line_of(self, None) is not None:
            message = f"an equality selects a line, or a point, and the {how} of '{name}' acts on an area"
            help = "write the force in all, `force: 0 -1 0 N`, or a part with a width, `where: abs(y - 0.1) < 0.02`"
        elif self.within is None:
            help = "a face of the surface is loaded where all its corners lie in the part"
            help += "" if how == "force" or self.where is None else "; on a line, `where: y == 0`, a `force` acts"
        return Diagnostic("no-mass", message, self.place() or line, help)

    def assemble(
        self, name: str, mesh: ElementMesh, held: Any, assembly: Assembly, bodies: Bodies, line: Span | None
    ) -> None:
        """Add the load's term to an island; ``held`` (n, 3) bool: components of nodes that are held.

        The work of the load is subtracted from the dissipated energy.
        """
        import numpy as np

        from sceneql.bodies.elements.on_faces import functions, line_shares

        faces = mesh.faces
        head = (bodies.position_at, bodies.velocity_at, bodies.work_at)
        if (edges := self.line(name, mesh)) is not None:
            assert self.force is not None
            _add_dead(self.force, line_shares(mesh.points, edges), head, assembly)
            return
        where = self.spread(name, mesh, assembly, line)
        if self.pressure is not None:
            _add_pressure(self.pressure, where, faces, held, head, assembly)
            return
        shapes = functions(where.places, faces.shape[1])
        areas = where.areas(mesh.points, faces)
        shares = areas if self.force is None else areas / areas.sum()
        weights = np.bincount(faces[where.faces].ravel(), (shares[:, None] * shapes).ravel(), len(mesh.points))
        if self.torque is not None:
            _add_torque(self.torque, faces[where.faces], areas, shapes, held, head, assembly, f"'{name}'")
            return
        value = self.traction if self.force is None else self.force
        assert value is not None
        _add_dead(value, weights, head, assembly)


def parts_on_lines(holds: Mapping[str, Hold], loads: Mapping[str, Load]) -> dict[str, Part]:
    """The parts that may be lines or points, by their names in a mesh: holds, and forces at a `where`."""
    parts: dict[str, Part] = {HELD.format(name): one for name, one in holds.items()}
    return parts | {LOADED.format(name): one for name, one in loads.items() if one.force is not None and one.where}


def _add_dead(value: Value, weights: Any, head: tuple[int, int, int], assembly: Assembly) -> None:
    """Add the term of a force or traction that keeps its direction, with its weights (n,) on the nodes."""
    import numpy as np

    from sceneql.system import Slopes

    nodes = np.flatnonzero(weights)
    ints = (*head, assembly.value(value), assembly.floats(weights[nodes]), len(nodes), *nodes.tolist())
    energy = "sceneql.bodies.elements.load_energy_kernels:dead"
    assembly.term("internal", "sceneql.bodies.elements.load_kernels:dead", ints, Slopes("", (), ()), energy=energy)


def _add_pressure(
    pressure: Value, where: Spread, faces: Any, held: Any, head: tuple[int, int, int], assembly: Assembly
) -> None:
    """Add the term of a pressure, which acts against the deformed surface, with its Jacobian."""
    import numpy as np

    from sceneql.bodies.elements.on_faces import functions, slopes
    from sceneql.system import Slopes

    nodes = faces[where.faces].astype(np.int64)
    count, each = nodes.shape
    tables = (functions(where.places, each), slopes(where.places, each), where.shares)
    numbers = [assembly.floats(np.ravel(table)) for table in tables]
    ints: NDArray[int64] = np.concatenate([[*head, assembly.value(pressure), *numbers, count, each], nodes.ravel()])

    def derivatives() -> Slopes:
        at = 3 * nodes
        rows, columns = np.repeat(at, each, axis=1).ravel() + head[1], np.tile(at, each).ravel() + head[0]
        own = np.concatenate([ints, np.ravel(held)])
        return Slopes("sceneql.bodies.elements.load_slopes_kernels:pressure", rows, columns, own, blocks=True)

    assembly.term("internal", "sceneql.bodies.elements.load_kernels:pressure", ints, derivatives)


def _add_torque(
    torque: Value,
    faces: Any,
    areas: Any,
    shapes: Any,
    held: Any,
    head: tuple[int, int, int],
    assembly: Assembly,
    name: str,
) -> None:
    """Add the term of a torque on the nodes (k, each) of faces, by areas (k,) and functions (k, each) of places there.

    Raises LimitRefused for too many nodes.
    """
    import numpy as np

    from sceneql.failure import LimitRefused
    from sceneql.system import Slopes

    nodes, own = np.unique(faces, return_inverse=True)
    count = len(nodes)
    if count > MOST_TURNED:
        message = f"the torque {name} acts on {count} nodes; at most {MOST_TURNED}, for it couples each with all"
        raise LimitRefused(message, torque.span, "let it act on a smaller part, or make the elements larger")
    own = own.reshape(faces.shape)
    products = areas[:, None, None] * shapes[:, :, None] * shapes[:, None, :]
    at = count * own[:, :, None] + own[:, None, :]
    between = np.bincount(at.ravel(), products.ravel(), count * count).reshape(count, count)
    working = np.zeros(FOUND_AND_SCRATCH + 3 * count)
    numbers = assembly.floats(np.concatenate([between.sum(axis=1), working, between.ravel()]))
    ints = (*head, assembly.value(torque), numbers, count, *nodes.tolist())

    def derivatives() -> Slopes:
        at = 3 * nodes
        rows, columns = np.repeat(at, count) + head[1], np.tile(at, count) + head[0]
        own = (*ints, *(int(k) for k in np.ravel(held[nodes])))
        return Slopes("sceneql.bodies.elements.load_slopes_kernels:torque", rows, columns, own, blocks=True)

    assembly.term("internal", "sceneql.bodies.elements.load_kernels:torque", ints, derivatives)
