"""A solid by other kinds and sizes of elements, which `bench` compares."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.bodies.elements.element import elements

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from sceneql.frame import Floats
    from sceneql.system import ModelState


class Resized:
    """What the model of a solid of elements is for `bench`."""

    def by_methods(self: Any) -> Mapping[str, Any]:
        """Itself by every kind of elements, last the one that suits its law best; none of a file."""
        if self.file is not None:
            return {}
        best, spacing = self.model_copy(update={"element": None}).chosen_element(), _spacing(self)
        kinds = sorted(elements().items(), key=lambda one: (one[1] is best, one[1].edges))
        return {one: self.model_copy(update={"element": one, "spacing": spacing}) for one, _ in kinds}

    def spaced(self: Any) -> float:
        """The spacing [m], or the mean side of a block's cells."""
        return (_spacing(self) or 0.0) if self.block is None else float(self.block.mean_side())

    def sides(self: Any, state: ModelState) -> tuple[float, ...]:
        """How large its elements are [m]: along each side of a block, else the cube root of their mean volume."""
        if self.block is not None:
            low, high = self.block.box()
            return tuple((b - a) / count for a, b, count in zip(low, high, self.block.cells, strict=True))
        sizes = self.samples(state)[2]
        return (float(sizes.sum() / len(self.solid.mesh.cells)) ** (1 / 3),)

    def resized(self: Any, part: float) -> Any:
        """Itself with elements of a part of their size."""
        finer = {name: one.model_copy(update={"spacing": part * one.spacing}) for name, one in self.finer.items()}
        spacing, block = self.spacing, self.block
        if block is not None:
            block = block.model_copy(update={"cells": tuple(max(1, round(count / part)) for count in block.cells)})
        spacing = None if spacing is None else part * spacing
        return self.model_copy(update={"spacing": spacing, "finer": finer, "block": block})

    def samples(self: Any, state: ModelState) -> tuple[Floats, Floats, Floats]:
        """Places of the material (k, 3) [m], displacements there (k, 3) [m], and volumes (k,) [m^3] they stand for."""
        from sceneql.bodies.elements.element_mesh import fine_rule

        mesh, (places, weights) = self.solid.mesh, fine_rule()
        moved = mesh.element.functions(places) @ self.read("displacements", state)[mesh.cells]
        return mesh.at(places).reshape(-1, 3), moved.reshape(-1, 3), (mesh.sizes(places) * weights / 6.0).ravel()

    def along(self: Any, name: str, state: ModelState) -> tuple[int, Callable[[Floats], Floats]]:
        """How many unknowns it has, and its displacements [m] as a function of places (k, 3) of the material [m]."""
        from sceneql.galerkin.between import within

        moved = self.read("displacements", state)
        return moved.size, within(self.solid.mesh, moved)


def _spacing(model: Any) -> float | None:
    """The spacing [m] of a solid, also where the script gives none and it was assembled."""
    from sceneql.bodies.elements.filled import default_spacing

    if model.of is None or model.spacing is not None or model._made is None:
        given: float | None = model.spacing
        return given
    points = model.solid.mesh.points
    return default_spacing(points.min(axis=0), points.max(axis=0), model.chosen_element())
