"""Cells of a model's domain: a box given by its sides, or the inside of an object of the script."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from sceneql.failure import LimitRefused
from sceneql.grids.domain import cells, cut
from sceneql.grids.domain.boundary import held_by
from sceneql.grids.domain.mesh import mesh_level
from sceneql.island.start import Start
from sceneql.quantities.diagnostic import Diagnostic, ScriptError

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats, Tape
    from sceneql.grids.medium import Medium
    from sceneql.kinds import Moment, Ref
    from sceneql.system import Assembly


class TapeLevel:
    """The inside of an object with an implicit field, as a cut.Level; its boundary is one piece."""

    def __init__(self, tape: Tape, name: str) -> None:
        self.tape, self.names = tape, (name,)

    def values(self, points: Floats) -> Floats:
        """Values (k,) of the field at points (k, 3) [m]."""
        from sceneql.field.tape.tape_solid import field_values

        return field_values(self.tape, points)

    def pieces(self, points: Floats) -> NDArray[int64]:
        """(k,) zeros."""
        return np.zeros(len(points), dtype=np.int64)


def cells_of(model: Medium, assembly: Assembly) -> cells.Cells:
    """The cells of a model's domain.

    Raises ScriptError where the domain is an object without an inside, or contains no cell, LimitRefused for too many.
    """
    if model.size is not None:
        corner = model.corner or (0.0,) * len(model.size)
        return cells.box(model.size, corner, model.cell, model.depth)
    assert model.domain is not None
    try:
        level, low, high, flat = inside(model.domain, model.flat, cast("Moment", Start(assembly)))
    except (TypeError, ValueError) as error:
        message = f"'{model.domain.name}' cannot be a domain: {error}"
        raise ScriptError([Diagnostic("no-domain", message, model.domain.span)]) from error
    sides = (high - low)[: 2 if flat else 3]
    count = float(np.prod(np.ceil(sides / model.cell)))
    if not count <= cells.MOST_CELLS:
        raise LimitRefused(
            f"{count:.3g} cells: at most {cells.MOST_CELLS:,} are possible", assembly.line(), "take a larger `cell`"
        )
    grid = _of_flow(model, flat, assembly) or cut.frame(low, high, model.cell, model.depth, flat)
    if model.edges == "cut_cell":
        found = cut.cut(level, grid, held_by(tuple(model.boundaries()), level.names))
    else:
        found = cut.staircase(level, grid)
    if not (found.volumes > 0.0).any():
        message = f"no cell of {model.cell:g} m lies inside '{model.domain.name}'"
        raise ScriptError([Diagnostic("no-cell", message, model.domain.span, "take a smaller `cell`")])
    return replace(found, around=(low, high))


def _of_flow(model: Medium, flat: bool, assembly: Assembly) -> cut.Frame | None:
    """The grid of the flow that carries a model in the same domain; None where there is no such flow.

    Raises ScriptError where the model's cell, section or depth differs from the flow's.
    """
    by = getattr(getattr(model, "drift", None), "by", None)
    if by is None or model.domain is None:
        return None
    carrier: Any = assembly.object(by)
    if not getattr(carrier, "flows", False) or carrier.domain is None or carrier.domain.name != model.domain.name:
        return None
    box = carrier.box(assembly)
    said = {
        "cell": (model.cell, carrier.cell, f"{carrier.cell:.12g} m"),
        "flat": (flat, box.flat, "yes" if box.flat else "no"),
        "depth": (model.depth, carrier.depth, f"{carrier.depth:.12g} m"),
    }
    other = {name: its for name, (mine, flows, its) in said.items() if mine != flows and (box.flat or name != "depth")}
    if other:
        text = f"the field has another `{'`, `'.join(other)}` than the flow '{by.name}' in the same domain"
        help = "give it the flow's " + ", ".join(f"`{name}: {its}`" for name, its in other.items())
        raise ScriptError([Diagnostic("other-domain", text, by.span, help)])
    return cut.Frame(box.shape, box.low, box.spacing)


def inside(ref: Ref, flat: bool, start: Moment) -> tuple[Any, Floats, Floats, bool]:
    """(level set of an object at the start, low and high corner (3,) [m] of its box, whether it is two-dimensional).

    Raises TypeError or ValueError for an object without an inside, or an unbounded one.
    """
    from sceneql.field.tape.builder import TapeBuilder

    kind = start.object(ref)
    triangles = getattr(kind, "triangles_at", None)
    own = kind.domain() if triangles is None else mesh_level(triangles(start), ref.name)
    if own is not None:
        low, high = own.bounds
        return own, low, high, flat or own.flat
    build = TapeBuilder()
    tape = build.finish(kind.implicit(build, build.x, build.y, build.z, start))
    low, high = kind.extent(np.eye(3, 4), start)
    if not (np.isfinite(low).all() and np.isfinite(high).all()):
        raise ValueError("it is unbounded")
    return TapeLevel(tape, ref.name), low, high, flat
