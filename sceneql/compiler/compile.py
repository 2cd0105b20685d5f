"""Compilation of a script to a simulation graph: the check, then the passes in order."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from sceneql.compiler.catalogue import Catalogue
from sceneql.compiler.check import KEYS, check
from sceneql.compiler.magnitudes.amiss import warn_of_magnitudes
from sceneql.compiler.meaning.doubtful import warn_of_meaning, warn_of_unused_parts
from sceneql.compiler.meaning.facts import Facts
from sceneql.compiler.meaning.listed_masses import report_masses
from sceneql.compiler.names import Parsed
from sceneql.compiler.over_time import check_latest
from sceneql.compiler.passes.as_balls import warn_of_balls, warn_of_two_models
from sceneql.compiler.passes.boundary_names import report_boundary_names
from sceneql.compiler.passes.bounds import warn_of_bounds
from sceneql.compiler.passes.circles import report_circles
from sceneql.compiler.passes.contact_words import report_contacts, warn_of_nothing_hit
from sceneql.compiler.passes.doubts import warn_of_constants, warn_of_doubts
from sceneql.compiler.passes.empty_holds import report_empty_holds
from sceneql.compiler.passes.expand import expand
from sceneql.compiler.passes.fall_through import warn_of_falling_through, warn_of_unheld, warn_of_unpulled
from sceneql.compiler.passes.far_joints import warn_of_far_joints, warn_of_unturned
from sceneql.compiler.passes.fillings import check_fillings
from sceneql.compiler.passes.insides import report_hollow, warn_of_open_meshes
from sceneql.compiler.passes.islands import islands
from sceneql.compiler.passes.keys_beyond import warn_of_keys
from sceneql.compiler.passes.layouts import check_layouts
from sceneql.compiler.passes.left_behind import warn_of_left_behind, warn_of_one_place
from sceneql.compiler.passes.outside_flows import report_outside_flows, warn_of_sections
from sceneql.compiler.passes.overlaps import report_overlaps
from sceneql.compiler.passes.own_shapes import report_placeless
from sceneql.compiler.passes.probes import report_probes
from sceneql.compiler.passes.prune import prune
from sceneql.compiler.passes.readable import report_unreadable
from sceneql.compiler.passes.sizes import check_sizes
from sceneql.compiler.passes.slopes import warn_of_values
from sceneql.compiler.passes.stable_steps import warn_of_steps
from sceneql.compiler.passes.unforced import warn_of_even, warn_of_outside, warn_of_slow, warn_of_unforced, warn_of_weak
from sceneql.compiler.passes.unmoved import report_moving
from sceneql.compiler.passes.unseen import warn_of_buried, warn_of_dim, warn_of_unseen
from sceneql.compiler.passes.unshown import warn_of_unshown, warn_of_unused_cameras
from sceneql.compiler.passes.unused import warn_of_unused_defines
from sceneql.compiler.passes.upward import warn_of_rising, warn_of_z_high, warn_of_z_up
from sceneql.compiler.studies import check_studies
from sceneql.compiler.values_below import values_of
from sceneql.doing import duration
from sceneql.graph import Origin, SimulationGraph, Task, Variants
from sceneql.kinds import Camera, Clock, Exceeds, Model, Object, Output, Picture
from sceneql.language.script import Script
from sceneql.language.tree import unsure
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.span import Span

LONG = 10_000
"""Number of frames of a film from which on there is a warning."""
FILM, ROWS = 10.0, 1000
"""Seconds of a film, and rows of a table, that are told in place of too many."""
SHORTER = "a larger `speed` of the `clock`, or an `end` that is sooner, makes fewer; `render --draft` draws them sooner"


def compile_script(
    script: Script, catalogue: Catalogue, found: Diagnostics, *, pruned: bool = True, parsed: Parsed | None = None
) -> SimulationGraph:
    """The graph of a script. ``pruned=False`` keeps every part (its pictures must be the same).

    ``parsed``: cache of texts parsed for other variants. Raises ScriptError with all errors, including those already in
    ``found``.
    """
    checked = check(script, catalogue, found, parsed)
    check_studies(checked.settings.studies, script.root, catalogue, KEYS, found)
    report_circles(checked.tasks, found)
    report_placeless(checked.tasks, checked.settings.expect, found)
    background = checked.settings.background is not None
    tasks = expand(checked.tasks, catalogue, without=checked.without, implied=checked.implied, background=background)
    report_hollow(tasks, found)
    report_moving(tasks, found)
    check_sizes(tasks, found)
    groups = islands(tasks, found)
    report_unreadable(tasks, groups, found)
    report_contacts(tasks, groups, found)
    drawn = _drawn(tasks)
    cameras = _cameras(tasks)
    clock = script.settings.get("clock")
    written = script.root.entries.get("variants", script.root)
    known = not unsure(written) and (bool(script.variants) or written is script.root)
    check_layouts(tasks, script.variants if known else None, found)
    if checked.timed:
        check_latest(script, tasks, checked.settings.clock.end, found)
        _check_outputs(tasks, drawn, checked.settings.clock, None if clock is None else clock.span, found)
    check_fillings(tasks, found)
    report_probes(script, tasks, found)
    report_boundary_names(script, tasks, found)
    report_empty_holds(tasks, found)
    report_overlaps(tasks, groups, found)
    report_masses(tasks, groups, found)
    report_outside_flows(tasks, found)
    found.raise_errors()
    warn_of_sections(tasks, found)
    warn_of_open_meshes(tasks, groups, found)
    warn_of_bounds(tasks, found)
    warn_of_far_joints(tasks, found)
    warn_of_unturned(tasks, groups, found)
    warn_of_doubts(tasks, checked.settings.clock, found)
    warn_of_constants(tasks, found)
    warn_of_keys(tasks, checked.settings.clock, found)
    warn_of_steps(script, tasks, groups, checked.settings.clock.end, found)
    warn_of_values(tasks, groups, found)
    warn_of_unforced(tasks, groups, found)
    warn_of_even(tasks, found)
    warn_of_outside(tasks, found)
    warn_of_slow(tasks, checked.settings.clock.end, found)
    warn_of_weak(tasks, groups, checked.settings.clock.end, found)
    warn_of_balls(tasks, groups, found)
    warn_of_nothing_hit(tasks, groups, found)
    warn_of_falling_through(tasks, groups, checked.settings.clock.end, found)
    warn_of_unpulled(tasks, groups, found)
    warn_of_unheld(tasks, groups, found)
    warn_of_two_models(checked.tasks, found)
    warn_of_left_behind(tasks, found)
    warn_of_one_place(tasks, found)
    warn_of_z_up(tasks, found)
    warn_of_z_high(tasks, found)
    warn_of_rising(tasks, found)
    warn_of_unseen(tasks, drawn, cameras, found)
    warn_of_buried(tasks, found)
    warn_of_dim(checked.tasks, found)
    facts = Facts(script, checked.settings, tasks, groups, drawn, cameras)
    warn_of_meaning(facts, found)
    warn_of_magnitudes(facts, found)
    found.raise_errors()
    order, needed_by, left_out = prune(tasks, groups, drawn, cameras)
    expected = {link.task for value in values_of(checked.settings.expect) for link in value.links}
    warn_of_unshown(tasks, order, expected, found)
    warn_of_unused_cameras(tasks, order, found)
    warn_of_unused_defines(script, found)
    warn_of_unused_parts(facts, order, found)
    if not pruned:
        order = {**order, **{name: task for name, task in tasks.items() if name not in order}}
    return SimulationGraph(
        name=script.name,
        settings=checked.settings,
        tasks=order,
        needed_by=needed_by,
        islands=tuple(group for group in groups if group.models[0] in order),
        drawn=drawn,
        cameras=cameras,
        palette=_palette(tasks),
        left_out=tuple(
            replace(part, reason="only `expect` measures it") if part.name in expected else part for part in left_out
        ),
        warnings=found.warnings,
        origin=Origin(script.hash, (*(source.name for source in script.sources), *checked.files)),
        variants=Variants(script.variants, script.may_fail),
    )


def _drawn(tasks: Mapping[str, Task]) -> dict[str, tuple[str, ...]]:
    """By output, what it draws: objects neither hidden nor members of others, and models that no object shows.

    An object that decorates (a trail, an arrow) does not show the model that it reads; neither does an object at a
    single mass of a net. Models are drawn in any case where the script says how they look.
    """
    inner = {ref.name for t in tasks.values() if isinstance(t.kind, Object) for ref in t.kind.members()}
    objects = [
        t.name for t in tasks.values() if isinstance(t.kind, Object) and not t.kind.hidden and t.name not in inner
    ]
    shown: set[str] = set()
    shown_by = {t.name for t in tasks.values() if isinstance(t.kind, Object) and not t.kind.decorates}
    stack = [name for name in objects if name in shown_by]
    while stack:
        one = tasks[stack.pop()]
        for need in one.needs:
            if need not in shown and _shows(one, tasks[need]):
                shown.add(need)
                stack.append(need)
    models = [
        t.name
        for t in tasks.values()
        if isinstance(t.kind, Model) and type(t.kind).lower is not Model.lower
        if t.name not in shown or t.kind.asked_to_draw()
    ]
    result = {}
    for task in tasks.values():
        if isinstance(task.kind, Output) and task.kind.draws:
            only = task.kind.shown()
            result[task.name] = (*objects, *models) if only is None else tuple(ref.name for ref in only)
    return result


def _shows(task: Task, read: Task) -> bool:
    """Whether a part shows the part that it reads: an object at one mass of a net shows none of its springs."""
    if not (isinstance(task.kind, Object) and isinstance(read.kind, Model)):
        return True
    placed = values_of(getattr(task.kind, "position", None))
    there = {link.output for value in placed for link in value.links if link.task == read.name}
    elsewhere = [value for value in values_of(task.kind) if value not in placed]
    return any(link.task == read.name for value in elsewhere for link in value.links) or read.kind.shown_at(there)


def _check_outputs(
    tasks: Mapping[str, Task],
    drawn: Mapping[str, tuple[str, ...]],
    clock: Clock,
    place: Span | None,
    found: Diagnostics,
) -> None:
    """Report outputs with more instants than a run can have; warn of long films, and of pictures of nothing."""
    for task in tasks.values():
        if isinstance(task.kind, Output):
            try:
                instants = len(task.kind.times(clock))
                if isinstance(task.kind, Picture) and (frames := instants // task.kind.parts) > LONG:
                    text = f"'{task.name}' is of {frames:,} frames: a second for each would be {duration(frames)}"
                    found.warning("long-film", text, task.span or place, help=SHORTER)
            except Exceeds as error:
                help = f"the clock makes it a film of {FILM:g} s with `speed: {clock.end / FILM:.3g}`"
                help = help if isinstance(task.kind, Picture) else f"take fewer: `every: {clock.end / ROWS:.3g} s`"
                found.error("limit-refused", f"{task.name}: {error}", task.span or place, help=help)
            if not drawn.get(task.name, (task.name,)):
                found.warning("nothing-drawn", f"there is nothing to draw in '{task.name}'", task.span)


def _palette(tasks: Mapping[str, Task]) -> tuple[str, ...]:
    """Parts without a material in the script's order, so that default colors do not depend on pruning."""
    kinds = (Object, Model)
    return tuple(t.name for t in tasks.values() if isinstance(t.kind, kinds) and getattr(t.kind, "material", 0) is None)


def _cameras(tasks: Mapping[str, Task]) -> dict[str, str]:
    """The camera of each picture: the one that it names, else the script's first."""
    first = next((t.name for t in tasks.values() if isinstance(t.kind, Camera)), "")
    return {
        t.name: t.kind.camera.name if t.kind.camera is not None else first
        for t in tasks.values()
        if isinstance(t.kind, Picture)
    }
