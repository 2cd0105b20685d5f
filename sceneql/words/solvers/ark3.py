"""ark3: an additive Runge-Kutta pair of order 3(2) for flows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

from sceneql.kinds import FixedScalar, FixedTime, Methods, Solver, field

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import IslandFacts, Stepper


class Ark3(Solver):
    """Order 3 for flows, by an additive pair 3(2): viscosity implicit, advection explicit, each stage projected.

    Steps follow the error, in parts of the largest velocity (and of the largest value of each other field), unless
    ``step`` gives their length. The pressure belongs to each stage, so the order stays beside walls, for several
    projections a stage. Diffusion of fields that are solved with the flow is implicit too; all else is explicit.
    Source: Kennedy & Carpenter (2003), Appl. Numer. Math. 44, 139-181, ARK3(2)4L[2]SA.

    What flat skins pull, by any law and by `bend`, is explicit up to the step that they bear, and beyond it
    implicit, too, at some solves of the fluid a stage: a skin that is so stiff that it hardly stretches then takes
    steps as long as the flow's own, once its first swings are over. With a tolerance they become implicit where
    stability, not the error, holds the steps, and as long as a step is worth what it costs. Source: Ceniceros,
    Fisher & Roma (2009), J. Comput. Phys. 228, 7137-7158. Deep skins, and those in flows with a `filling`, are
    explicit.
    """

    marches = "a flow"

    tolerance: FixedScalar = field("Error of a step, in parts of the largest value.", "1e-4", at_least=1e-12, below=1)
    step: FixedTime | None = field("Length of a step, in place of a tolerance.", None, above=0)
    largest_step: FixedTime | None = field("No step is longer.", None, above=0)
    skins: Literal["auto", "explicit", "implicit"] = field(
        "How the tensions of flat skins are marched: auto is implicit beyond their bound.", "auto"
    )

    def stepper(self) -> Stepper:
        """By the tolerance, or fixed steps."""
        from sceneql.flows.schemes import additive

        made = additive.stepper(self.tolerance, self.step, self.largest_step)
        if self.skins == "implicit":
            from sceneql.skins.stiff import stiff_step

            return stiff_step.implicit(made)
        return made

    def choose(self, island: IslandFacts) -> Methods:
        """With skins implicit where its step is beyond what they bear, or a tolerance's steps may be."""
        flow = island.fields.flow
        if self.skins != "auto" or not island.fields.stiff or flow is None or island.floats is None:
            return super().choose(island)
        from sceneql.skins.stiff import stiff_step

        found = stiff_step.lines_of(island.fields.stiff, flow)
        if found is None:
            return super().choose(island)
        floats, made = island.floats(), self.stepper()
        remark = stiff_step.remark(found, flow, floats, self.step)
        if found.why or (self.step is not None and self.step <= found.bound(flow, floats)):
            return Methods(self.model_copy(update={"skins": "explicit"}), made, remark=remark)
        implicit = stiff_step.chosen(made) if self.step is None else stiff_step.implicit(made)
        return Methods(self.model_copy(update={"skins": "implicit"}), implicit, remark=remark)

    def solves_tensions(self) -> bool:
        """Unless they are to be explicit."""
        return self.skins != "explicit"

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """Largest of the modes', whose decay is implicit and whose turning explicit, or with implicit skins is, too."""
        from sceneql.flows.schemes import additive, multistep

        if self.skins == "implicit":
            return multistep.largest_growth(jacobian, lambda decay, turn: additive.growth(decay - 1j * turn, 0.0, step))
        return multistep.largest_growth(jacobian, lambda decay, turn: additive.growth(decay, turn, step))

    def oscillation(self, frequency: float, decay: float, step: float, turn: float = 0.0) -> float | None:
        """What decays is implicit, what turns explicit; none is told of swings, nor of turns with implicit skins."""
        from sceneql.flows.schemes import additive

        return (
            None
            if frequency > 0.0 or (turn != 0.0 and self.skins == "implicit")
            else additive.growth(decay, turn, step)
        )

    def measure(self) -> str:
        """In parts of the largest."""
        return "of the largest value of each field" if self.step is None else ""
