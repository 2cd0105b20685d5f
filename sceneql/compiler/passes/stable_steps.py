"""Check of fixed steps by the script's numbers alone: unstable ones, and far too many."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cache, partial
from typing import cast

from sceneql.compiler.passes.fillings import Beginning, box_of
from sceneql.graph import Island, Task
from sceneql.kinds import Interaction, Model, Object, Solver
from sceneql.kinds.stable_step import Oscillation, StaticScene, stable_step
from sceneql.language.script import Script
from sceneql.march.pace import MOST_STEPS
from sceneql.quantities.diagnostic import Diagnostics

Growth = Callable[[float, float, float, float], float | None]
"""`Solver.oscillation`."""
SLACK = 1.0 + 1e-6
STABLE, CRAWLS = 3.0, 1e6
"""Step times the fastest rate up to which explicit methods of tolerances are stable, roughly; steps to warn of."""
NOTABLE = 10.0
"""Growth over the run from which on a method that is stable at no step gives a warning."""


def warn_of_steps(
    script: Script, tasks: Mapping[str, Task], groups: Iterable[Island], end: float, found: Diagnostics
) -> None:
    """Warn of steps beyond the stability bounds of an island's parts; report more than MOST_STEPS steps.

    ``end``: of the run [s].
    """
    for island in groups:
        solver = tasks[island.solver]
        step = getattr(solver.kind, "step", None)
        if cast(Solver, solver.kind).explicit_by_tolerance():
            _warn_of_many(script, island, tasks, end, found)
            continue
        if not isinstance(step, float):
            continue
        written = script.sections.get("solvers", {}).get(island.solver)
        at = solver.span if written is None else written.place(("step",))
        if step * MOST_STEPS < end:
            message = f"{end / step:.2g} steps of {duration(step)} are more than {MOST_STEPS:.0e}"
            found.error("limit-refused", message, at, help="take a longer step, or let auto march it")
            continue
        growth = cast(Solver, solver.kind).oscillation
        stable = _stable_steps(growth)
        damped = any(
            type(cast(Interaction, tasks[force].kind)).potential is Interaction.potential for force, _ in island.forces
        )
        for name, modes in _modes(island, tasks, end):
            entry = script.sections.get(tasks[name].family, {}).get(name)
            for fastest in modes:
                if fastest.tension and cast(Solver, solver.kind).solves_tensions():
                    continue
                wrong = _wrong(growth, stable, solver.word, step, fastest, end, damped)
                if wrong is not None:
                    message, smaller = wrong
                    place = (None if entry is None else entry.place(fastest.at)) or tasks[name].span
                    origin = "" if place is None else f" ({place.source.name}:{place.line})"
                    help = f"{'take a smaller step, or ' if smaller else ''}let auto march it"
                    text = message.format(what=f"{fastest.what}{origin}")
                    found.warning("unstable-step", text, at or place, help=help)
                    break


def _warn_of_many(script: Script, island: Island, tasks: Mapping[str, Task], end: float, found: Diagnostics) -> None:
    """Warn of a solver that is explicit, by a tolerance, where stability alone asks for more than CRAWLS steps."""
    solver = tasks[island.solver]
    all_modes = [(name, mode) for name, modes in _modes(island, tasks, end) for mode in modes]
    name, fastest = max(all_modes, key=lambda one: one[1].size, default=("", None))
    if fastest is None or not CRAWLS < end * fastest.size / STABLE < math.inf:
        return
    entry = script.sections.get(tasks[name].family, {}).get(name)
    place = (None if entry is None else entry.place(fastest.at)) or tasks[name].span
    origin = "" if place is None else f" ({place.source.name}:{place.line})"
    steps = f"some {end * fastest.size / STABLE / 1e6:.2g} million steps of {duration(STABLE / fastest.size)}"
    text = f"{solver.word} is explicit: it takes {steps}, set by {fastest.what}{origin}"
    help = "let auto march it, or an implicit method, as radau"
    found.warning("many-steps", text, solver.span or place, help=help)


def later_bound(island: Island, tasks: Mapping[str, Task], end: float) -> tuple[float, str] | None:
    """The largest stable step [s] for modes that appear only after the start, and their cause.

    None where none is known. Modes in the spectrum at the start are not included.
    """
    stable = _stable_steps(cast(Solver, tasks[island.solver].kind).oscillation)
    found = []
    for name, modes in _modes(island, tasks, end):
        for one in (mode for mode in modes if mode.later):
            try:
                step = stable(one.frequency / one.size, one.decay / one.size, one.turn / one.size) / one.size
            except TypeError:  # this method tells no growth
                continue
            if 0.0 < step < math.inf:
                span = tasks[name].span
                found.append((step, one.what if span is None else f"{one.what} ({span.source.name}:{span.line})"))
    return min(found, default=None)


def _modes(island: Island, tasks: Mapping[str, Task], end: float) -> Iterator[tuple[str, tuple[Oscillation, ...]]]:
    """Bounds on the fastest oscillations of each model and force, by name."""
    models = {name: cast(Model, tasks[name].kind) for name in island.models}
    objects = {name: task.kind for name, task in tasks.items() if isinstance(task.kind, Object)}
    start = Beginning(tasks)
    scene = StaticScene(objects, end, lambda ref: box_of(ref, start))
    carrying = {force: cast(Interaction, tasks[force].kind).carrier() for force, _ in island.forces}
    carried = {model for force, model in island.forces if carrying[force] is not None}
    for name, model in models.items():
        if name not in carried:
            yield name, _known(partial(model.fastest, name, scene))
    known = {name: model.static_masses() for name, model in models.items()}
    for force in dict.fromkeys(force for force, _ in island.forces):
        kind, on = cast(Interaction, tasks[force].kind), [model for other, model in island.forces if other == force]
        flow = kind.carrier()
        if flow is not None:
            them = {name: models[name] for name in on}
            yield force, _known(partial(kind.fastest_carried, them, models[flow.name], scene))
            continue
        yield force, _known(partial(kind.fastest, force, {model: known[model] for model in on}))


def _known(modes: Callable[[], Iterable[Oscillation]]) -> tuple[Oscillation, ...]:
    """The bounds, or none where numbers over- or underflow; the run reports more."""
    try:
        return tuple(modes())
    except ArithmeticError:
        return ()


def _stable_steps(growth: Growth) -> Callable[[float, float, float], float]:
    """Function that returns the stable step [s] by frequency, decay and turn [1/s]; cached."""

    @cache
    def stable(frequency: float, decay: float, turn: float) -> float:
        return stable_step(lambda step: cast(float, growth(frequency, decay, step, turn)))

    return stable


def _wrong(
    growth: Growth,
    stable: Callable[[float, float, float], float],
    word: str,
    step: float,
    fastest: Oscillation,
    end: float,
    damped: bool,
) -> tuple[str, bool] | None:
    """The text of a warning for an unstable step, and whether a smaller one would be stable.

    None where it is stable.
    """
    scale = fastest.size
    if scale == 0.0 or not math.isfinite(scale):
        return None
    try:
        grown = growth(fastest.frequency, fastest.decay, step, fastest.turn)
    except OverflowError:  # so far beyond the bound that no double holds it
        grown = sys.float_info.max
    if grown is None:
        return None
    # Scaled by the largest rate, oscillations of many masses become one mode, searched once.
    bound = stable(fastest.frequency / scale, fastest.decay / scale, fastest.turn / scale) / scale
    if bound > 0.0:
        if step <= bound * SLACK:
            return None
        return f"dt = {duration(step)} exceeds {duration(bound)}, set by {{what}}", True
    logarithm = math.log10(grown) * end / step
    if damped or logarithm < math.log10(NOTABLE):
        return None
    swing = f"{{what}} swings 1e{logarithm:.0f} times as far after {duration(end)}"
    return f"{word} is stable at no step: with dt = {duration(step)} {swing}", False


def duration(seconds: float) -> str:
    """``0.63 ms``: three digits, in the unit in which they are easiest to read."""
    for unit, scale in (("s", 1.0), ("ms", 1e3), ("us", 1e6)):
        if seconds * scale >= 0.1:
            return f"{seconds * scale:.3g} {unit}"
    return f"{seconds * 1e9:.3g} ns"
