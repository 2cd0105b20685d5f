"""Emitters: births and deaths of particles during a run."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar

from sceneql import kinds
from sceneql.bodies.filling.fill import Fill, chance_key, draws, filled
from sceneql.island.memory import bounded
from sceneql.kinds import Clock, Doubt, Exceeds, Problem, Record, Value, field
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Link, Number, Type, Vector, walk

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Assembly, Bodies, ModelState

SAMPLES, COLORS = 257, 32
"""Number of ages at which radii are evaluated, and of age classes with one color each."""

STEPS = 50
"""Least number of steps in a particle's lifetime: the error of a birth within a step is of third order in the step."""

POOL = 4096
"""Random points in an object, from which the positions of births are drawn."""


def _aged(value: Value, age: float) -> Any:
    """The value of a field whose `time` is an age [s]."""
    return evaluate(value.expr, lambda node: age, arrays=True)


class Aging(Record):
    """How a particle changes with its age: here `time` counts from its birth, in values and keyframes alike."""

    own_time: ClassVar[bool] = True

    color: kinds.Color | None = field("Its color, in place of the model's.", None)
    radius: kinds.Length | None = field("Its radius in the picture, in place of the model's.", None)

    def problems(self) -> Iterator[Problem]:
        """Problems: values that depend on more than the age."""
        for name in ("color", "radius"):
            value = getattr(self, name)
            if value is not None and any(isinstance(node, Link) for node in walk(value.expr)):
                yield Problem(f"the {name} of an age reads no other part", (name,))

    def classes(self, ages: Floats, radii: Floats) -> Iterable[tuple[Value | None, Any, Floats]]:
        """Particles grouped by age into classes of one color: (color or None, indices, radii [m]) of each class.

        ``ages`` [s] and ``radii`` [m], each (n,); the radii are replaced if the age has one.
        """
        import numpy as np

        if not len(ages):
            return
        samples = np.linspace(0.0, float(ages.max()), SAMPLES)
        if self.radius is not None:
            sizes = [_aged(self.radius, age) for age in samples]
            radii = np.maximum(np.interp(ages, samples, sizes), 0.0)
        if self.color is None:
            yield None, slice(None), radii
            return
        width = max(samples[-1], 1e-300) / COLORS
        which = np.minimum((ages / width).astype(int), COLORS - 1)
        for k in np.unique(which):
            some = np.flatnonzero(which == k)
            shade = tuple(Number(float(c)) for c in _aged(self.color, (k + 0.5) * width))
            yield Value(Vector(shade, Type((3,)))), some, radii[some]


class Emit(Record):
    """Births and deaths. Birth j is at `start` + j/`rate` exactly, wherever the frames and the steps of the solver lie.

    Chance is counter-based: what birth j draws depends on the part's name, the seed and j alone.
    """

    rate: kinds.FixedFrequency = field("Births a second.", "100 Hz", above=0)
    from_: kinds.Position = field("Where they are born.", "0 0 0 m")
    within: kinds.ObjectRef | None = field(
        "An object within which they are born, as it stands at the start; `from` is added.", None
    )
    velocity: kinds.Velocity = field("Their mean velocity at birth.", "0 3 0 m/s")
    spread: kinds.FixedAngle = field(
        "Half angle of the cone that they are thrown into, evenly.", "0 deg", at_least=0, at_most=math.pi
    )
    variation: kinds.FixedScalar = field(
        "Largest relative deviation of the speed and of the lifetime.", "0", at_least=0, below=1
    )
    lifetime: kinds.FixedTime = field("How long they live.", "4 s", above=0)
    start: kinds.FixedTime = field("Time of the first birth.", "0 s", at_least=0)
    until: kinds.FixedTime | None = field("No births after it.", None, above=0)
    count: int | None = field("No more births than that.", None, at_least=1)
    most: int | None = field(
        "How many may live at once; the oldest goes for one too many. By default as many as will.", None, at_least=1
    )
    seed: int = field("Another number, another shower.", 0, at_least=0)

    def doubts(self, clock: Clock) -> Iterator[Doubt]:
        """Particles that are born after the film, one alone, or ones that die before they are seen."""
        end, frame = clock.end, clock.speed / clock.fps
        if self.start >= end:
            text = f"none is born: they come from {self.start:g} s on, and the clock ends at {end:g} s"
            yield Doubt(
                "nothing-born", text, None, f"write an earlier `start`, or `clock: {{end: {self.start + end:g} s}}`"
            )
        elif (self.count or 2) > 1 and (min(self.until or end, end) - self.start) * self.rate < 1.0:
            text = f"one alone is born until {end:g} s, at a rate of {self.rate:g} a second"
            yield Doubt("nothing-born", text, None, f"write a larger rate, as `rate: {100.0 / end:.3g} /s`")
        elif self.lifetime < frame:
            text = f"they live for {self.lifetime:g} s, less than from frame to frame, {frame:.3g} s"
            yield Doubt(
                "short-lived", text, None, f"a second of the film is {clock.speed:g} s: `lifetime: {clock.speed:g} s`"
            )

    def problems(self) -> Iterator[Problem]:
        """Problems: `until` not after `start`; more particles than memory allows."""
        if self.until is not None and self.until <= self.start:
            yield Problem("`until` must be after `start`", ("until",))
        try:
            bounded(self.capacity())
        except Exceeds as error:
            yield Problem(str(error), code="limit-refused")

    def total(self) -> float:
        """Total number of births; may be infinite."""
        births = math.inf if self.until is None else (self.until - self.start) * self.rate * (1 + 1e-12)
        births = math.floor(births) + 1 if math.isfinite(births) else births
        return min(births, math.inf if self.count is None else self.count)

    def capacity(self) -> float:
        """Largest number of particles alive at once, which is the number of slots."""
        alive = self.rate * self.lifetime * (1 + self.variation)
        alive = math.ceil(alive) + 1 if math.isfinite(alive) else alive
        return min(alive, self.total(), math.inf if self.most is None else self.most)

    def assemble(self, name: str, assembly: Assembly, bodies: Bodies, mass: float, radius: float) -> None:
        """Add births and deaths to an island; ``bodies`` are the particles' slots, ``mass`` [kg], ``radius`` [m]."""
        import numpy as np

        pool = np.zeros((1, 3))
        if self.within is not None:
            pool = filled(Fill(object=self.within, count=POOL, seed=self.seed), name, assembly)
        spec = [self.rate, self.start, self.total(), self.lifetime, self.variation, 1 - math.cos(self.spread)]
        # The position at time 0 of a source that is solved is unknown here: the first step uses that at its end.
        solved = [
            link for value in (self.from_, self.velocity) for link in value.links if assembly.formula(link) is None
        ]
        before = [-1.0] * 7 if solved else [0.0, *assembly.initial(self.from_), *assembly.initial(self.velocity)]
        self._act(name, assembly, bodies, [*spec, mass, radius], pool, before, 0, bodies.count)

    def assemble_part(self, name: str, assembly: Assembly, bodies: Bodies, start: ModelState, first: int) -> None:
        """As ``assemble``, for a block of an island whose bodies are the slots from ``first`` on of ``start``."""
        from sceneql.bodies.emitter_kernels import BEFORE, MEMORY, MEMORY_AT, POOL, POOL_AT, SPEC, SPEC_AT

        assert start.bodies is not None
        ints, floats = start.ints, start.floats
        spec = floats[ints[SPEC_AT] : ints[SPEC_AT] + SPEC]
        pool = floats[ints[POOL_AT] : ints[POOL_AT] + 3 * ints[POOL]].reshape(-1, 3)
        before = floats[ints[MEMORY_AT] + BEFORE : ints[MEMORY_AT] + MEMORY]
        self._act(name, assembly, bodies, spec, pool, before, first, start.bodies.count)

    def _act(
        self,
        name: str,
        assembly: Assembly,
        bodies: Bodies,
        spec: Any,
        pool: Floats,
        before: Any,
        first: int,
        slots: int,
    ) -> None:
        """Add the kernel of births and deaths (emitter_kernels)."""
        import numpy as np

        memory_at = assembly.floats([0.0, 0.0, *before])
        ints = (
            bodies.position_at,
            bodies.velocity_at,
            bodies.count,
            bodies.mass_at,
            bodies.inverse_at,
            bodies.radius_at,
            assembly.floats(spec),
            assembly.value(self.from_),
            assembly.value(self.velocity),
            assembly.floats(pool),
            len(pool),
            memory_at,
            assembly.floats(np.full(bodies.count, np.inf)),
            chance_key(name, self.seed),
            first,
            slots,
        )
        assembly.step_at_most(self.lifetime / STEPS)
        assembly.after_step("sceneql.bodies.emitter_kernels:emit", ints, apart=True)
        assembly.changing(memory_at, 2 + len(before))
        assembly.remember(*ints)

    def living(self, bodies: Bodies, state: ModelState) -> tuple[Bodies, ModelState, Floats]:
        """The particles alive at the state's time: (bodies, state with these bodies alone, ages (n,) [s])."""
        import numpy as np

        from sceneql.bodies.emitter_kernels import AGE, BORN, FIRST, KEY, MEMORY_AT

        ints, n = state.ints, bodies.count
        first, born = (int(state.floats[ints[MEMORY_AT] + k]) for k in (FIRST, BORN))
        births = np.arange(max(0, born - n), born)
        ages = state.t - self.start - births / self.rate
        luck = draws(births.astype(np.uint64), AGE, ints[KEY])
        alive = (ages >= 0) & (ages < self.lifetime * (1 + self.variation * (2 * luck - 1)))
        births, ages = births[alive], ages[alive]
        slots = births % n
        x, v = (state.y[at : at + 3 * n].reshape(-1, 3)[slots] for at in (bodies.position_at, bodies.velocity_at))
        a = state.rate[bodies.velocity_at : bodies.velocity_at + 3 * n].reshape(-1, 3)[slots]
        # Particles born in the last step have not been accelerated since their births yet (emitter_kernels.emit).
        owed = np.where(births >= first, ages, 0.0)[:, None]
        x, v = x + 0.5 * a * owed**2, v + a * owed
        m = len(births)
        numbers = [state.floats[at : at + n][slots] for at in (bodies.mass_at, bodies.inverse_at, bodies.radius_at)]
        compact = replace(bodies, count=m, position_at=0, velocity_at=3 * m, work_at=6 * m)
        compact = replace(compact, mass_at=0, inverse_at=m, radius_at=2 * m)
        y = np.concatenate([x.ravel(), v.ravel(), state.y[bodies.work_at : bodies.work_at + 1]])
        rate = np.concatenate([v.ravel(), a.ravel(), [0.0]])
        return compact, replace(state, y=y, rate=rate, floats=np.concatenate(numbers)), ages
