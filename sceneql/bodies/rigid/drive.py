"""The one motion that a hinge or a slider leaves: its outputs, and a force, a spring and a damping along it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.bodies.rigid.joint import Joint, Side
from sceneql.kinds import Value

if TYPE_CHECKING:
    from sceneql.system import Assembly, Bodies, ModelState


class Driven(Joint):
    """A tie that leaves one motion."""

    def motion(self, first: Side, second: Side, assembly: Assembly) -> tuple[str, tuple[Any, ...]]:
        """Its kind, `turn` or `shift`, and its vectors (drive_kernels)."""
        raise NotImplementedError

    def along(self) -> tuple[Value | None, Value | None, float, Value | None]:
        """Force, stiffness, rest and damping."""
        raise NotImplementedError

    def assemble_motion(self, first: Side, second: Side, holds: int, assembly: Assembly) -> tuple[int, ...]:
        """Add what acts along the motion."""
        import numpy as np

        from sceneql.bodies.rigid.tie_rows_kernels import ANGLE, MOVED, POINT, ROW
        from sceneql.bodies.rigid.tie_system import integers
        from sceneql.system import Place

        kind, vectors = self.motion(first, second, assembly)
        numbers, scratch = assembly.floats(vectors), assembly.floats(np.zeros(2 * MOVED + ROW))
        row = (POINT if kind == "shift" else ANGLE, 0, 0, numbers, scratch + 2 * MOVED, holds)
        force, stiffness, rest, damping = self.along()
        none = assembly.floats([0.0])
        values = [none if value is None else assembly.value(value) for value in (force, stiffness, damping)]
        held = next(side.mover for side in (first, second) if isinstance(side.mover, Place))
        law = (values[0], values[1], assembly.floats([rest]), values[2], held.bodies.work_at, assembly.floats([0.0]))
        ints = (*integers(first.mover), *integers(second.mover), *row, scratch, *law)
        assembly.remember(*ints)
        if kind == "turn":
            assembly.after_step("sceneql.bodies.rigid.drive_kernels:follow", ints, samples=True)
        if any(value is not None for value in (force, stiffness, damping)):
            assembly.term("force", "sceneql.bodies.rigid.drive_kernels:drive", ints)
        return ints

    def read(self, output: str, state: ModelState) -> Any:
        """How far and how fast it has gone; force and torque."""
        if output not in ("angle", "shift", "speed"):
            return super().read(output, state)
        far, fast = self._motion(state)
        return fast if output == "speed" else far

    def _motion(self, state: ModelState) -> tuple[float, float]:
        import numpy as np

        from sceneql.bodies.rigid.drive_kernels import LAST_AT, motion

        ints = np.array(state.ints[-(LAST_AT + 1) :], dtype=np.int64)
        far, fast = motion(state.y, np.array(state.floats), ints)
        return float(far), float(fast)

    def potential(self, bodies: Bodies, state: ModelState) -> float:
        """Half stiffness (s - rest)^2 [J], counted with one of the bodies."""
        from sceneql.bodies.rigid.drive_kernels import LAST_AT, REST_AT, STIFFNESS_AT, WORK_AT

        own = state.ints[-(LAST_AT + 1) :]
        if bodies.work_at != own[WORK_AT] or self.read("broken", state):
            return 0.0
        far, _ = self._motion(state)
        return 0.5 * float(state.floats[own[STIFFNESS_AT]]) * (far - float(state.floats[own[REST_AT]])) ** 2
