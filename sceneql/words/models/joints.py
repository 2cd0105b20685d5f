"""joints: places that rotate about each other, such as the joints of a creature or a machine."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, ClassVar

from sceneql.kinds import Gives, Model, Position, Problem, Record, Rotation, field, quantity_type
from sceneql.quantities import dimension as dim
from sceneql.quantities.expression import Call, Expr, Type
from sceneql.quantities.turned import rotated

PLACE = Type((3,), dim.LENGTH)
TURN = Type((4,))


class Joint(Record):
    """A joint in the coordinates of the one that it hangs on."""

    of: str | None = field("The joint that it hangs on, listed before it; by default the world.", None)
    at: Position = field("Where it is, in that one's coordinates.", "0 0 0 m")
    turn: Rotation = field("How it turns what hangs on it.", "1 0 0 0")


class Joints(Model):
    """A tree of joints, moved by expressions of `time` and keyframes: each turns all that hangs on it.

    A joint at p in the coordinates of one with the place P and the rotation Q stands at P + Q p, and turns by Q times
    its own rotation. Objects link to `name.position` and `name.rotation`.
    """

    kinematic: ClassVar[bool] = True
    has_bodies: ClassVar[bool] = False
    JOINT: ClassVar[Mapping[str, Gives]] = {
        "position": Gives(quantity_type(dim.LENGTH, (3,)), "Where it is in the world."),
        "rotation": Gives(TURN, "How what hangs on it is turned: quaternion [w, x, y, z]."),
    }

    joints: dict[str, Joint] = field("The joints by name, each behind the one that it hangs on.")

    def problems(self) -> Iterator[Problem]:
        """Joints that hang on none before them."""
        known: list[str] = []
        for name, joint in self.joints.items():
            if joint.of is not None and joint.of not in known:
                listed = ", ".join(known) or "none"
                message = f"'{name}' hangs on '{joint.of}', which is not listed before it; those are {listed}"
                later = f"list '{joint.of}' before '{name}'" if joint.of in self.joints and joint.of != name else None
                yield Problem(message, ("joints", name, "of"), help=later)
            known.append(name)

    @classmethod
    def outputs(cls, written: Mapping[str, Any]) -> Mapping[str, Gives]:
        """``name.position`` and ``name.rotation`` of every joint."""
        joints = written.get("joints")
        names = joints if isinstance(joints, Mapping) else ()
        return {f"{name}.{output}": gives for name in names for output, gives in cls.JOINT.items()}

    def formula(self, output: str) -> Expr:
        """A joint's place or rotation as an expression of time."""
        name, _, what = output.rpartition(".")
        chain = [self.joints[name]]
        while chain[-1].of is not None:
            chain.append(self.joints[chain[-1].of])
        place: Expr = chain[-1].at.expr
        rotation: Expr = chain[-1].turn.expr
        for joint in reversed(chain[:-1]):
            place = Call("add", (place, rotated(rotation, joint.at.expr)), PLACE)
            rotation = Call("turn", (rotation, joint.turn.expr), TURN)
        return place if what == "position" else rotation
