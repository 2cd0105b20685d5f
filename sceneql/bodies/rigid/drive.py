"""The single degree of freedom of a hinge or slider: motor, limits, friction, spring, and outputs along it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from sceneql.bodies.rigid.joint import Joint, Side
from sceneql.kinds import Problem, Value

if TYPE_CHECKING:
    from sceneql.system import Assembly, Bodies, Drive, ModelState


Follows = Literal["nothing", "speed", "place"]


@dataclass(frozen=True, slots=True)
class Motor:
    """A motor: its largest force and the speed or place that it follows; or, following nothing, its force alone."""

    most: Value
    follows: Follows
    target: Value | None
    settling: float


class Driven(Joint):
    """A tie with one degree of freedom, and the fields common to all such ties."""

    if TYPE_CHECKING:
        limits: tuple[float, float] | None
        restitution: Value
        friction: Value | None
        stiffness: Value | None
        rest: float
        damping: Value | None

    def motion(self, first: Side, second: Side, assembly: Assembly) -> tuple[str, tuple[Any, ...]]:
        """The kind of its degree of freedom, `turn` or `shift`, and the vectors of its row (drive_kernels)."""
        raise NotImplementedError

    def driver(self) -> Motor | None:
        """Motor of the tie; None without one."""
        raise NotImplementedError

    def problems(self) -> Iterator[Problem]:
        """Problems of a tie; limits that do not include the start."""
        yield from super().problems()
        if self.limits is not None and not self.limits[0] <= 0.0 <= self.limits[1]:
            help = "the smaller one stands first" if self.limits[0] > self.limits[1] else None
            yield Problem("it starts at 0, which must lie between the limits", ("limits",), help=help)

    def assemble_motion(
        self, first: Side, second: Side, holds: int, assembly: Assembly
    ) -> tuple[tuple[int, ...], Drive | None]:
        """Add forces, motor, limits and friction along the motion (as of Joint)."""
        import numpy as np

        from sceneql.bodies.rigid.ties.tie_rows_kernels import ANGLE, MOVED, POINT, ROW
        from sceneql.bodies.rigid.ties.tie_slopes import drive_slopes
        from sceneql.bodies.rigid.ties.tie_system import integers
        from sceneql.system import Place

        kind, vectors = self.motion(first, second, assembly)
        numbers, scratch = assembly.floats(vectors), assembly.scratch(2 * MOVED)
        row = (POINT if kind == "shift" else ANGLE, 0, 0, numbers, assembly.floats(np.zeros(ROW)), holds)
        motor = self.driver()
        force = motor.most if motor is not None and motor.follows == "nothing" else None
        none = assembly.floats([0.0])
        values = [none if value is None else assembly.value(value) for value in (force, self.stiffness, self.damping)]
        held = next(side.mover for side in (first, second) if isinstance(side.mover, Place))
        given = -1 if force is None else assembly.state([0.0])
        acting = (values[0], values[1], assembly.floats([self.rest]), values[2])
        law = (*acting, held.bodies.work_at, given, assembly.floats([0.0]))
        effort = assembly.floats([0.0, 0.0, 0.0, 0.0])
        ints = (*integers(first.mover), *integers(second.mover), *row, scratch, *law)
        if kind == "turn":
            assembly.after_step("sceneql.bodies.rigid.drive_kernels:follow", ints, samples=True)
        if any(value is not None for value in (force, self.stiffness, self.damping)):
            assembly.term("force", "sceneql.bodies.rigid.drive_kernels:drive", ints, lambda: drive_slopes(ints))
        return (effort, *ints), self._bounds(ints, motor, effort, assembly)

    def _bounds(self, motion: tuple[int, ...], motor: Motor | None, effort: int, assembly: Assembly) -> Drive | None:
        """The bounded forces along the motion: limits, motor and friction; None where there are none."""
        from sceneql.system import Drive

        limits, friction = self.limits, self.friction
        follows: Follows = "nothing" if motor is None else motor.follows
        if limits is None and friction is None and follows == "nothing":
            return None
        target, most, settling, reached = -1, -1, -1, -1
        if motor is not None and motor.target is not None:
            target, most = assembly.value(motor.target), assembly.value(motor.most)
            settling = assembly.floats([motor.settling])
            reached = assembly.floats(assembly.initial(motor.target))
        return Drive(
            along=motion,
            limits_at=-1 if limits is None else assembly.floats(limits),
            restitution_at=-1 if limits is None else assembly.value(self.restitution),
            follows=follows,
            target=None if motor is None else motor.target,
            target_at=target,
            most_at=most,
            settling_at=settling,
            reached_at=reached,
            friction_at=-1 if friction is None else assembly.value(friction),
            effort_at=effort,
        )

    def read(self, output: str, state: ModelState) -> Any:
        """Value of an output: displacement and speed of the motion, effort, energy given, and those of Joint."""
        if output == "effort":
            return self._effort(state)
        if output == "given":
            return self._given(state)
        if output not in ("angle", "shift", "speed"):
            return super().read(output, state)
        far, fast = self._motion(state)
        return fast if output == "speed" else far

    def remark(self, state: ModelState) -> str:
        """Text on the order of accuracy with which limits, motor and friction act."""
        from sceneql.bodies.rigid.drive_kernels import LAST_AT

        motor = self.driver()
        parts = [
            *(["stops"] if self.limits is not None else []),
            *(["friction"] if self.friction is not None else []),
            *(["its motor"] if motor is not None and motor.follows != "nothing" else []),
        ]
        acts = "acts" if parts in (["friction"], ["its motor"]) else "act"
        told = "on the velocities at the end of a step (mode local), of order 1 in the step where they do"
        if parts and state.floats[state.ints[-(LAST_AT + 2)] + 3] == 1.0:
            told = "by mode exact: their changes are located, forces have the solver's order"
        return f"{' and '.join(parts)} {acts} {told}" if parts else ""

    def trouble(self, state: ModelState) -> str:
        """Trouble of a tie, or the number of steps in which limits, motors and friction were not solved to rounding."""
        from sceneql.bodies.rigid.drive_kernels import LAST_AT

        told, loose = super().trouble(state), float(state.floats[state.ints[-(LAST_AT + 2)] + 1])
        if told or not loose:
            return told
        return f"in {loose:.0f} steps stops, motors and friction were not solved to rounding"

    def _effort(self, state: ModelState) -> float:
        """Force [N] or torque [N m] of motor, limits and friction along the motion."""
        from sceneql.bodies.rigid.drive_kernels import FORCE_AT, LAST_AT

        own = state.ints[-(LAST_AT + 1) :]
        force = 0.0 if self.read("broken", state) else float(state.floats[own[FORCE_AT]])
        return force + float(state.floats[state.ints[-(LAST_AT + 2)]])

    def _given(self, state: ModelState) -> float:
        """Energy [J] that its motor has given to the bodies."""
        from sceneql.bodies.rigid.drive_kernels import GIVEN_AT, LAST_AT

        at = state.ints[-(LAST_AT + 1) :][GIVEN_AT]
        return float(state.y[at]) if at >= 0 else float(state.floats[state.ints[-(LAST_AT + 2)] + 2])

    def _motion(self, state: ModelState) -> tuple[float, float]:
        import numpy as np

        from sceneql.bodies.rigid.drive_kernels import LAST_AT, motion

        ints = np.array(state.ints[-(LAST_AT + 1) :], dtype=np.int64)
        far, fast = motion(state.y, np.array(state.floats), ints)
        return float(far), float(fast)

    def potential(self, bodies: Bodies, state: ModelState) -> float:
        """Energy stiffness (s - rest)^2 / 2 [J] of its spring, counted for the model of one of its bodies alone."""
        from sceneql.bodies.rigid.drive_kernels import LAST_AT, REST_AT, STIFFNESS_AT, WORK_AT

        own = state.ints[-(LAST_AT + 1) :]
        if bodies.work_at != own[WORK_AT] or self.read("broken", state):
            return 0.0
        far, _ = self._motion(state)
        return 0.5 * float(state.floats[own[STIFFNESS_AT]]) * (far - float(state.floats[own[REST_AT]])) ** 2
