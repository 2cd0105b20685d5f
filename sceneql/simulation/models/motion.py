"""motion: a place and a rotation as functions of time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from sceneql.kinds import Gives, Model, Position, Rotation, field, quantity_type
from sceneql.quantities import dimension as dim
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.expression import Expr, Type
from sceneql.simulation.shift import rate_of_change


class Motion(Model):
    """A kinematic motion: the script says where it is, by an expression of `time` or by keyframes.

    Other parts link to it: an object's `position: lift.position`. The velocity is the central difference over 0.2 ms.
    """

    kinematic: ClassVar[bool] = True
    has_bodies: ClassVar[bool] = False
    gives: ClassVar[Mapping[str, Gives]] = {
        "position": Gives(quantity_type(dim.LENGTH, (3,)), "Where it is."),
        "rotation": Gives(Type((4,)), "How it is turned: quaternion [w, x, y, z]."),
        "velocity": Gives(quantity_type(dim.VELOCITY, (3,)), "How fast it moves."),
    }

    position: Position = field("Where it is.", "0 0 0 m")
    rotation: Rotation = field("How it is turned.", "1 0 0 0")

    def formula(self, output: str) -> Expr:
        """An output as an expression of time. Raises ScriptError for the velocity of one that follows another part."""
        match output:
            case "position":
                return self.position.expr
            case "rotation":
                return self.rotation.expr
            case "velocity":
                try:
                    return rate_of_change(self.position.expr)
                except ValueError as error:
                    message = f"the velocity of this motion cannot be found: {error}"
                    raise ScriptError([Diagnostic("no-velocity", message, self.position.span)]) from None
        raise KeyError(output)
