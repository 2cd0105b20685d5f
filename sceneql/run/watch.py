"""Monitor of energy, momentum, stretch and colors between frames: conserved quantities, and divergence."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, cast

import numpy as np

from sceneql.island.breakpoints import MOST
from sceneql.kinds import Contact, Interaction, Model, Tie
from sceneql.quantities.diagnostic import Diagnostic
from sceneql.run.crossing import Crossing
from sceneql.run.extremes import watched
from sceneql.run.falling import falling
from sceneql.run.invariants import invariants_of
from sceneql.run.paints import painted
from sceneql.run.ringing import ringing

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.run.instant import Instant
    from sceneql.run.run import IslandRun, Run

COST, AT_LEAST = 0.008, 0.005
"""Fraction of the run's time that the monitor may take, and seconds that it may take in any case."""
MOST_STATES = 20_000
"""Largest state of an island that is always observed from start to end; larger ones only if the run's time allows
it."""
FIRST = 4e-7
"""Predicted seconds of a first observation, for each number of the state; later ones are predicted by the last."""
MOST_PAIRED = 256
"""Largest number of bodies of an observed island with forces between all pairs."""
GAINED = 0.5
"""Energy gained, relative to the largest kinetic energy or that taken by forces, from which on there is a warning."""
UNSEEN = 1e-9
"""Part of the bodies' extent that rounding may move them over the film."""
MADE = 0.05
"""The same of rigid bodies in contact, which forbids gains: in thrown boxes mode `local` makes up to 0.006."""
FORBIDDEN = 1e-6
"""Change of velocities by ties at the start, relative to the velocities, from which on there is a warning."""
ROUNDED = 1e-12
"""Change of velocities, relative to the largest number that ties changed, below which it is rounding."""
OVERSTRETCHED = 4.0
"""Strain (L - L0)/L0 of a spring from which on there is a warning, unless half of it was there at the start."""


@dataclass
class Balance:
    """Energy and momentum of an island as observed so far."""

    island: IslandRun
    models: tuple[str, ...]
    """The models that have an energy."""
    times: list[float] = field(default_factory=list)
    energies: list[float] = field(default_factory=list)
    """[J]"""
    turned_over: float = 0.0
    """Largest kinetic energy, or energy taken or given by forces, so far [J]."""
    momentum: float = 0.0
    """Largest change of momentum so far [kg m/s]."""
    impulse: float = 0.0
    """Largest sum of the magnitudes of the masses' momenta [kg m/s]."""
    cost: float = 0.0
    """Predicted seconds of an observation; 0 where it is made in any case."""
    stretch: dict[str, tuple[float, float]] = field(default_factory=dict)
    """By model, the largest (L - L0)/L0 of its springs at the start and over all times."""
    rounding: float = 0.0
    """Energy below which all motion is rounding [J]: that of speeds at which nothing would be seen to move."""
    at_start: Floats | None = None
    """(3,) momentum at the start [kg m/s]."""

    @property
    def drifts(self) -> list[float]:
        """Change of energy since the start at each time, relative to what was turned over or there at the start."""
        if not self.energies:
            return []
        scale = max(self.turned_over, abs(self.energies[0])) or 1.0
        return [(energy - self.energies[0]) / scale for energy in self.energies]

    @property
    def isolated(self) -> bool:
        """Whether no outside force acts, so that momentum is conserved."""
        island = self.island.island
        free = all(
            bodies is None or (self.island.march.floats[bodies.inverse_at : bodies.inverse_at + bodies.count] > 0).all()
            for bodies in self.island.bodies.values()
        )
        tasks = self.island.graph.tasks
        forces = [cast(Interaction, tasks[force].kind) for force, _ in island.forces]
        within = all(force.internal() and {*(force.targets() or ())} <= {*island.models} for force in forces)
        carried = any(one is not None and one.immersed is not None for one in self.island.bodies.values())
        return free and within and not carried and not any(objects for _, _, objects in island.contacts)

    @property
    def touching(self) -> bool:
        """Whether these are rigid bodies in contact."""
        bodies = self.island.bodies.values()
        return bool(self.island.island.contacts) and any(b is not None and b.turning is not None for b in bodies)

    @property
    def closed(self) -> bool:
        """Whether energy is conserved, apart from the work that forces count.

        So it is where no value varies in time, no body is born or dies, and no flow carries any.
        """
        lasting = all(cast(Model, self.island.graph.tasks[name].kind).lasts() for name in self.models)
        carried = any(one is not None and one.immersed is not None for one in self.island.bodies.values())
        return lasting and not carried and not self.island.march.system.structure.varying


class Watch:
    """Observes a run's moments as often as the time allows; ``always``: all moments, and islands of any size."""

    def __init__(self, run: Run, *, always: bool = False) -> None:
        self.always = always
        islands = [island for island in run.islands if always or _alone(island)]
        self.balances = [
            Balance(island, models, cost=0.0 if always else _foretold(island))
            for island in islands
            if (models := _telling(island))
        ]
        self.invariants = [one for island in islands for one in invariants_of(island)]
        self._ringing = [found for island in run.islands if (found := ringing(island)) is not None]
        self._fields = [(island, fields) for island in run.islands if (fields := watched(island))]
        self._crossing = [Crossing(island) for island in run.islands if island.island.contacts]
        self._falling = [one for island in run.islands for one in falling(island)]
        self._islands, self._painted = run.islands, painted(run.graph)
        self._turning = [
            span for island in run.islands if _adaptive(island) for span in island.assembly.breakpoints.beyond
        ]
        self._started, self._spent = time.perf_counter(), 0.0

    def look(self, moment: Instant, *, last: bool = False) -> None:
        """Record energies and momenta at a moment, unless the monitor has used up its share of the time.

        The start is always recorded, since gains are measured from it; so is the last moment, except of the largest
        islands.
        """
        started = time.perf_counter()
        free = self.always or last or self._spent < AT_LEAST + COST * (started - self._started)
        for balance in self.balances:
            if balance.cost > 0.0:
                begun = time.perf_counter()
                if not balance.times or self._spent + balance.cost < COST * (begun - self._started):
                    _note(balance, moment)
                    balance.cost = time.perf_counter() - begun or balance.cost
            elif free or not balance.times:
                _note(balance, moment)
        for invariant in self.invariants if free else ():
            invariant.look(moment)
        for island, fields in self._fields if free else ():
            for extremes in fields:
                extremes.look(moment.time, island.y)
        for one in self._falling if free else ():
            one.look(moment)
        for crossing in self._crossing:
            allowed = AT_LEAST + COST * (time.perf_counter() - self._started)
            if self.always or self._spent + crossing.cost < allowed:
                crossing.look(moment)
        for color in self._painted:
            color.look(moment)
        self._spent += time.perf_counter() - started

    def warnings(self) -> tuple[Diagnostic, ...]:
        """All warnings of the run.

        Contacts that gave way or are lacking, energy gained, springs overstretched, fields ringing or overshooting,
        breakpoints, halved steps, singular ties, troubles of models.
        """
        found = [*self._ringing, *(note for island in self._islands for note in island.notes)]
        for span in self._turning:
            message = f"this turns more than {MOST:,} times in the run: steps that a tolerance chooses go over some"
            help = "choose a solver of given steps, or bound its `largest_step`"
            found.append(Diagnostic("many-turns", message, span, help, severity="warning"))
        found += [warning for island in self._islands if (warning := _halved(island)) is not None]
        found += [warning for island in self._islands if (warning := _forbidden(island)) is not None]
        found += [warning for island in self._islands for warning in _singular(island)]
        found += [warning for island in self._islands for warning in _troubled(island)]
        for island, fields in self._fields:
            for extremes in fields:
                found += extremes.warnings(island)
        for one in self.invariants:
            found += one.warnings()
        found += [falls.found for falls in self._falling if falls.found is not None]
        for crossing in self._crossing:
            found += crossing.warnings()
        for color in self._painted:
            found += color.warnings()
        for balance in self.balances:
            tasks, title = balance.island.graph.tasks, ", ".join(balance.models)
            span = tasks[balance.models[0]].span
            gained = max(balance.drifts, default=0.0)
            seen = bool(gained) and max(balance.energies) - balance.energies[0] > balance.rounding
            if balance.closed and seen and gained > (MADE if balance.touching else GAINED):
                at = balance.times[int(np.argmax(balance.drifts))]
                message = (
                    f"the energy of {title} has grown from {balance.energies[0]:.3g} J to {max(balance.energies):.3g} J"
                    f" at {at:.4g} s, more than its forces can give"
                )
                help = "the step is too large: see `explain` for its bound"
                if balance.touching:
                    help = "contacts made it: take shorter steps, or `mode: exact` where it can be"
                found.append(Diagnostic("energy-gained", message, span, help, severity="warning"))
            found += [
                Diagnostic(
                    "over-stretched",
                    f"a spring of '{name}' was stretched by {stretch:.3g} times its length at rest",
                    tasks[name].span,
                    severity="warning",
                )
                for name, (first, stretch) in balance.stretch.items()
                if stretch > max(OVERSTRETCHED, 2.0 * first)
            ]
        return tuple(found)

    def account(self) -> list[str]:
        """A line for each invariant and each island with an energy: its drift, and a conserved momentum's."""
        lines = [one.account() for one in self.invariants if one.times]
        for balance in self.balances:
            drifts = balance.drifts
            if not drifts:
                continue
            largest = max(drifts, key=abs)
            line = f"{', '.join(balance.models)}: energy {balance.energies[-1]:.6g} J"
            line += f", drift {drifts[-1]:.2e} at the end, {largest:.2e} at most"
            if not balance.closed:
                line += " (it is driven)"
            if balance.isolated and balance.impulse > 0:
                line += f"; momentum drift {balance.momentum / balance.impulse:.2e}"
            lines.append(line)
        return lines


def _alone(island: IslandRun) -> bool:
    """Whether observing the island needs no sum over very many pairs, which takes as long as their forces."""
    forces = (cast(Interaction, island.graph.tasks[force].kind) for force, _ in island.island.forces)
    bodies = sum(0 if one is None else one.count for one in island.bodies.values())
    return bodies <= MOST_PAIRED or not any(force.mutual for force in forces)


def _foretold(island: IslandRun) -> float:
    """Predicted seconds of a first observation; 0 for a small state, which is observed in any case."""
    states = len(island.march.system.y)
    return FIRST * states if states > MOST_STATES else 0.0


def _adaptive(island: IslandRun) -> bool:
    """Whether the solver of an island is adaptive."""
    return island.solver.stepper().control.adaptive


def _halved(island: IslandRun) -> Diagnostic | None:
    """A warning for fixed steps that were halved where Newton's method found no solution."""
    control, tries = island.solver.stepper().control, island.march.statistics.rejected
    if not control.halves or tries == 0:
        return None
    times = "once" if tries == 1 else f"{tries:,} times"
    message = f"Newton's method found no solution {times}: steps of {control.first_step:.4g} s were halved there"
    span = island.graph.tasks[island.island.solver].span
    return Diagnostic("steps-halved", message, span, "shorter steps are more exact there", severity="warning")


def _telling(island: IslandRun) -> tuple[str, ...]:
    """Models of an island that have an energy."""
    kinds = {name: cast(Model, island.graph.tasks[name].kind) for name in island.island.models}
    return tuple(name for name, kind in kinds.items() if {"energy", "kinetic"} <= set(type(kind).gives))


def _note(balance: Balance, moment: Instant) -> None:
    read = moment.read
    if not balance.times:
        balance.rounding = _rounding(balance, moment)
    balance.times.append(moment.time)
    balance.energies.append(sum(float(read(name, "energy")) for name in balance.models))
    kinetic = sum(float(read(name, "kinetic")) for name in balance.models)
    taken = [abs(float(read(name, "dissipated"))) for name in balance.models if _tells_losses(balance, name)]
    balance.turned_over = max(balance.turned_over, kinetic, *taken)
    if balance.isolated:
        total = sum(read(name, "momentum") for name in balance.models)
        if balance.at_start is None:
            balance.at_start = np.asarray(total)
        balance.momentum = max(balance.momentum, float(np.linalg.norm(total - balance.at_start)))
        balance.impulse = max(balance.impulse, _impulse(balance, moment))
    for name in balance.models:
        if "stretch" in type(balance.island.graph.tasks[name].kind).gives:
            now = float(read(name, "stretch"))
            first, most = balance.stretch.get(name, (now, now))
            balance.stretch[name] = first, max(most, now)


def _tells_losses(balance: Balance, name: str) -> bool:
    """Whether a model tells the energy that forces took from it."""
    return "dissipated" in type(balance.island.graph.tasks[name].kind).gives


def _rounding(balance: Balance, moment: Instant) -> float:
    """Energy of moving masses, each as the lightest, that go through UNSEEN of their extent in the film [J]."""
    from sceneql.bodies.bodies import moving_masses, positions

    total = 0.0
    for name in balance.models:
        state = moment.state(name)
        if state.bodies is not None and state.bodies.count:
            moving = moving_masses(state.bodies, state)
            moving = moving[moving > 0.0]
            extent = float(np.ptp(positions(state.bodies, state), axis=0).max())
            speed = UNSEEN * extent / max(balance.island.graph.settings.clock.end, 1e-300)
            total += 0.5 * len(moving) * float(moving.min()) * speed**2 if len(moving) else 0.0
    return total


def _impulse(balance: Balance, moment: Instant) -> float:
    """Sum of the magnitudes of the masses' momenta [kg m/s]."""
    from sceneql.bodies.bodies import masses, velocities

    total = 0.0
    for name in balance.models:
        state = moment.state(name)
        if state.bodies is not None:
            total += float(masses(state.bodies, state) @ np.linalg.norm(velocities(state.bodies, state), axis=1))
    return total


def _forbidden(island: IslandRun) -> Diagnostic | None:
    """A warning where ties changed the velocities that the script gives bodies at the start."""
    march, tasks = island.march, island.graph.tasks
    ties = [name for name, _ in island.island.forces if isinstance(tasks[name].kind, Tie)]
    if march.corrected is None or not ties:
        return None
    for name, bodies in island.bodies.items():
        if bodies is None:
            continue
        own = slice(bodies.velocity_at, bodies.velocity_at + 3 * bodies.count)
        change = np.linalg.norm(march.corrected[own].reshape(-1, 3), axis=1)
        given = np.linalg.norm(march.system.y[own].reshape(-1, 3), axis=1)
        k = int(np.argmax(change)) if bodies.count else 0
        rounded = ROUNDED * np.abs(march.corrected).max(initial=0.0)  # where spins alone are forbidden
        if bodies.count and change[k] > max(FORBIDDEN * (given.max() + change[k]), rounded):
            x, y, z = march.system.y[own].reshape(-1, 3)[k] + march.corrected[own].reshape(-1, 3)[k]
            which = f"body {k + 1} of '{name}'" if bodies.count > 1 else f"'{name}'"
            text = f"ties forbid the velocities at the start: {which} starts at {x:.3g} {y:.3g} {z:.3g} m/s"
            help = "give all bodies that ties hold the velocity and the spin that they have together"
            return Diagnostic("forbidden-start", text, tasks[name].span, help, severity="warning")
    return None


def _singular(island: IslandRun) -> Iterator[Diagnostic]:
    """Warnings of ties in a singular position, which bodies cannot leave, or can leave in more than one way."""
    if not island.assembly.ties:
        return
    from sceneql.bodies.rigid.singular import singular

    found = singular(island.assembly)
    told = (
        (
            "a chain that is taut: {} let bodies begin to move, and not go on",
            "forces without bound would hold them there: give the chain some slack, or let one end slide",
        ),
        (
            "a linkage folded flat: {} let bodies go on in more than one way",
            "rounding may decide which way they go: begin a little beside that position",
        ),
    )
    for ties, (text, help) in zip(found, told, strict=True):
        if ties:
            names = ", ".join(f"'{tie.name}'" for tie in ties)
            message = f"singular at the start, as {text.format(names)}"
            yield Diagnostic("singular-ties", message, ties[0].span, help, severity="warning")


def _troubled(island: IslandRun) -> Iterator[Diagnostic]:
    """Warnings of models, contacts and ties at the end of the run."""
    tasks = island.graph.tasks
    for name in island.island.models:
        text, help = cast(Model, tasks[name].kind).trouble(island.state(name))
        if text:
            yield Diagnostic("model-trouble", text, tasks[name].span, help, severity="warning")
    for name in dict.fromkeys(force for force, _ in island.island.forces if isinstance(tasks[force].kind, Tie)):
        if text := cast(Tie, tasks[name].kind).trouble(island.state(name)):
            yield Diagnostic("tie-trouble", text, tasks[name].span, severity="warning")
    for name in dict.fromkeys(contact for contact, _, _ in island.island.contacts):
        if text := cast(Contact, tasks[name].kind).trouble(island.state(name)):
            yield Diagnostic("contact-trouble", text, tasks[name].span, severity="warning")
