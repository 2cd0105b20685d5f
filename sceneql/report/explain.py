"""The plan of a scene: what runs, in which order, for which output, by which solver; what is left out and why."""

from __future__ import annotations

import math
from collections.abc import Mapping
from contextlib import suppress
from typing import TYPE_CHECKING, Any, cast

from sceneql.compiler.catalogue import ROOT, Catalogue
from sceneql.compiler.passes.stable_steps import duration, later_bound
from sceneql.failure import RunFailure
from sceneql.graph import SimulationGraph, Task
from sceneql.kinds import (
    Camera,
    Contact,
    Formula,
    Interaction,
    Model,
    Object,
    Output,
    Overlay,
    Picture,
    Record,
    Ref,
    Tie,
    Value,
)

if TYPE_CHECKING:
    from sceneql.run.run import IslandRun


def explain(graph: SimulationGraph) -> dict[str, Any]:
    """The plan as plain data (the form of ``explain --json``)."""
    catalogue = Catalogue()
    words = {(family, word) for family in catalogue.families for word in catalogue.words(family)}
    used = {(task.family, task.word) for task in graph.tasks.values()}
    libraries = {name for pair in words for name in getattr(catalogue.load(*pair), "imports", ())}
    needed = {name for task in graph.tasks.values() for name in task.kind.imports}
    return {
        "scene": graph.name,
        "about": graph.settings.about,
        "outputs": [
            {"name": name, "word": task.word, "moments": len(task.kind.times(graph.settings.clock))}
            for name, task in graph.tasks.items()
            if isinstance(task.kind, Output)
        ],
        "parts": [
            {
                "name": name,
                "family": task.family,
                "word": task.word,
                "line": None if task.span is None else str(task.span),
                "needed_by": list(graph.needed_by.get(name, ())),
            }
            for name, task in graph.tasks.items()
        ],
        "ahead": [name for name in dict.fromkeys(graph.cameras.values()) if _looks_ahead(graph, name)],
        "ahead_objects": _objects_ahead(graph),
        "ahead_overlays": _placed(graph),
        "changing": _changing(graph),
        **_solved(graph),
        "left_out": [{"name": part.name, "word": part.word, "why": part.reason} for part in graph.left_out],
        "avoided": {
            "words": len(words - used),
            "kernels": sorted(_kernels(words - used)),
            "libraries": sorted(libraries - needed),
        },
    }


def _looks_ahead(graph: SimulationGraph, camera: str) -> bool:
    """Whether a camera needs a dry run of the physics before the film."""
    task = graph.tasks.get(camera)
    return bool(graph.islands) and task is not None and cast(Camera, task.kind).looks_ahead()


def _objects_ahead(graph: SimulationGraph) -> dict[str, str]:
    """What objects need from a dry run of the physics, as texts by name."""
    objects = {name: task.kind for name, task in graph.tasks.items() if isinstance(task.kind, Object)}
    return {name: why for name, kind in objects.items() if graph.islands and (why := kind.looks_ahead())}


def _changing(graph: SimulationGraph) -> dict[str, list[str]]:
    """By object, the fields whose values may change from frame to frame; empty: its shapes are made once."""
    tasks = graph.tasks
    objects = {name: task.kind for name, task in tasks.items() if isinstance(task.kind, Object)}
    return {name: [field for field, value in kind if not _constant(value, tasks)] for name, kind in objects.items()}


def _constant(value: Any, tasks: Mapping[str, Task]) -> bool:
    """Whether a field's value, and the parts to which it refers, are the same at all times."""
    if isinstance(value, Value | Formula):
        return value.constant
    if isinstance(value, Ref):
        return isinstance(tasks[value.name].kind, Object) and _constant(tasks[value.name].kind, tasks)
    if isinstance(value, Object | Record):
        return all(_constant(part, tasks) for _, part in value)
    if isinstance(value, dict):
        value = list(value.values())
    return not isinstance(value, list | tuple) or all(_constant(part, tasks) for part in value)


def _placed(graph: SimulationGraph) -> list[str]:
    """The overlays that seek a place which is free over the whole run."""
    over = {name: task.kind for name, task in graph.tasks.items() if isinstance(task.kind, Overlay)}
    pictures = [task.kind for task in graph.tasks.values() if isinstance(task.kind, Picture)]
    drawn = {name for kind in pictures for name in over if name not in {ref.name for ref in kind.laid_out}}
    return [name for name, kind in over.items() if graph.islands and name in drawn and len(kind.places()) > 1]


def _kernels(words: set[tuple[str, str]]) -> set[str]:
    """Words among the given ones with compiled code in a file of their name; kernels of renderers stand elsewhere."""
    files = (*ROOT.glob("words/*/*_kernels.py"), *ROOT.glob("*/*_kernels.py"))
    own = {word for family, word in words if family != "renderers"}
    return own & {path.stem.removesuffix("_kernels") for path in files}


def _solved(graph: SimulationGraph) -> dict[str, Any]:
    """The islands, and the objects that need a dry run for ranges over the whole run."""
    if not graph.islands:
        return {"islands": [], "ranges": []}
    from sceneql.run.dry_run import asked_by_objects
    from sceneql.run.run import Run

    run = Run(graph)
    islands, ranges = [_island(graph, one) for one in run.islands], []
    with suppress(RunFailure):
        ranges = list(asked_by_objects(run.at(0.0)))
    return {"islands": islands, "ranges": ranges}


def _later(bound: tuple[float, str] | None) -> str:
    """Text on stability bounds that apply after the start."""
    if bound is None:
        return ""
    return f"; after the start stable up to a step of {duration(bound[0])}, set by {bound[1]}"


def _island(graph: SimulationGraph, run: IslandRun) -> dict[str, Any]:
    from sceneql.march.stability import stability

    island = run.island
    order, control = run.march.stepper.method.order, run.march.stepper.control
    bound = stability(run.march, run.methods.bounding)
    touching = sorted({contact for contact, _, _ in island.contacts})
    later = later_bound(island, graph.tasks, graph.settings.clock.end)
    return {
        "models": list(island.models),
        "model_remarks": _model_remarks(graph, run),
        "forces": sorted({force for force, _ in island.forces if not isinstance(graph.tasks[force].kind, Tie)}),
        "force_remarks": _remarks(graph, run),
        "ties": sorted({force for force, _ in island.forces if isinstance(graph.tasks[force].kind, Tie)}),
        "redundant": _redundant(run),
        "singular": _singular(run),
        "drives": [tie.name for tie in run.assembly.ties if tie.drive],
        "drive_mode": "exact" if run.assembly.driven else "local",
        "drive_why": f"as {' and '.join(touching)}" if touching else run.assembly.contact_why,
        "contacts": touching,
        "contact_mode": run.assembly.contact_mode,
        "contact_why": _contact_why(graph, run),
        "contact_remarks": _contact_remarks(graph, run),
        "states": len(run.march.system.y),
        "solver": graph.tasks[island.solver].word,
        "solver_name": island.solver,
        "why": "; ".join(filter(None, _why(run))),
        "order": order,
        "adaptive": control.adaptive,
        "step": None if control.adaptive else control.first_step,
        "tolerance": control.tolerance if control.adaptive else None,
        "measure": run.solver.measure() if control.adaptive and run.march.system.fields.single is None else "",
        "step_bound": bound.step if math.isfinite(bound.step) else None,
        "bound_text": bound.text + _later(later),
    }


def _chosen(run: IslandRun) -> list[str]:
    """The first method of an automatic solver and the reason; empty where the start fails."""
    own = run.graph.tasks[run.island.solver].kind
    if run.solver is not own and type(run.solver) is type(own):
        return [run.methods.remark]
    if run.solver is not own:
        word = type(run.solver).__module__.rpartition(".")[2]
        return [f"{word} takes its place " + (run.methods.remark or "on a field on a grid")]
    with suppress(RunFailure):
        return [f"begins with {why}" for _, why in run.march.choices()[:1]]
    return []


def _why(run: IslandRun) -> tuple[str, ...]:
    """Texts: why the island is solved by itself, what its solver chose, how that works, what takes over and when."""
    march, methods = run.march, run.methods
    remark = methods.remark if run.solver is run.graph.tasks[run.island.solver].kind else ""
    return run.island.reason, run.solver.explanation(), *_chosen(run), march.prepared_text, remark


def _remarks(graph: SimulationGraph, run: IslandRun) -> dict[str, str]:
    """Remarks of mutual forces at the start."""
    from sceneql.system import ModelState

    march = run.march
    found = {}
    for force in dict.fromkeys(force for force, _ in run.island.forces):
        kind = cast(Interaction, graph.tasks[force].kind)
        if kind.mutual:
            rate = march.rate(0.0, march.system.y)
            state = ModelState(0.0, march.system.y, rate, march.floats, None, run.assembly.remembered(force))
            found[force] = kind.remark(state)
    return {force: remark for force, remark in found.items() if remark}


def _model_remarks(graph: SimulationGraph, run: IslandRun) -> dict[str, str]:
    """Remarks of models at the start."""
    from sceneql.system import ModelState

    march, found = run.march, {}
    for model in run.island.models:
        y, ints = march.system.y, run.assembly.remembered(model)
        state = ModelState(0.0, y, y, march.floats, run.bodies.get(model), ints)
        found[model] = cast(Model, graph.tasks[model].kind).remark(state)
    return {model: remark for model, remark in found.items() if remark}


def _redundant(run: IslandRun) -> list[int]:
    """[number of constraints of ties at the start, number of redundant ones]; empty without ties."""
    if not run.assembly.ties:
        return []
    from sceneql.bodies.rigid.tie_system import redundant

    run.march.rate(0.0, run.march.system.y)
    return list(redundant(run.assembly.ties, run.march.floats))


def _singular(run: IslandRun) -> dict[str, list[str]]:
    """The ties that are singular at the start, by a description of the singularity."""
    if not run.assembly.ties:
        return {}
    from sceneql.bodies.rigid.singular import singular

    taut, folded = singular(run.assembly)
    found = {"a chain that is taut": taut, "a linkage folded flat": folded}
    return {like: [tie.name for tie in ties] for like, ties in found.items() if ties}


def _contact_remarks(graph: SimulationGraph, run: IslandRun) -> dict[str, str]:
    """Remarks of contacts at the start."""
    from sceneql.system import ModelState

    march, found = run.march, {}
    for contact in dict.fromkeys(contact for contact, _, _ in run.island.contacts):
        state = ModelState(0.0, march.system.y, march.system.y, march.floats, None, run.assembly.remembered(contact))
        found[contact] = cast(Contact, graph.tasks[contact].kind).remark(state)
    return {contact: remark for contact, remark in found.items() if remark}


def _contact_why(graph: SimulationGraph, run: IslandRun) -> str:
    """The reason for the mode of an island's contacts."""
    if run.assembly.contact_why:
        return run.assembly.contact_why
    if run.assembly.contact_mode == "barrier":
        return "the one that elastic solids, and rigid bodies beside them, have"
    kinds = [graph.tasks[contact].kind for contact, _, _ in run.island.contacts]
    if all(getattr(kind, "mode", "auto") == "auto" for kind in kinds):
        return f"chosen for {run.assembly.body_count()} masses"
    return "asked for by the script"


def _control(island: dict[str, Any]) -> str:
    """Text on the order and steps of an island's solver; empty for a solver without steps."""
    if island["order"] == 0:
        return ""
    steps = f"steps by the tolerance {island['tolerance']:g}" if island["adaptive"] else f"step {island['step']:g} s"
    steps += f" {island['measure']}" if island["measure"] else ""
    return f" of order {island['order']}, {steps}"


def text(plan: dict[str, Any]) -> str:
    """The plan as text."""
    lines = [f"{plan['scene']}: {plan['about']}".rstrip(": "), "", "will run, in this order:"]
    width = max((len(part["name"]) for part in plan["parts"]), default=0)
    for part in plan["parts"]:
        origin = f"({part['line']})" if part["line"] else "(default)"
        lines.append(
            f"  {part['name']:<{width}}  {part['family']}/{part['word']}, for {', '.join(part['needed_by'])} {origin}"
        )
    for island in plan["islands"]:
        lines += ["", f"solved together: {', '.join(island['models'])} ({island['states']} numbers)"]
        lines += [f"  {model}: {remark}" for model, remark in island["model_remarks"].items()]
        if island["ties"]:
            rows, more = island["redundant"]
            twice = f", of which the others imply {more}: these share the least forces" if more else ""
            lines.append(f"  ties: {', '.join(island['ties'])}, {rows} conditions{twice}")
        for like, ties in island["singular"].items():
            lines.append(f"    {', '.join(ties)}: singular at the start, as {like}")
        if island["drives"]:
            mode = f"{island['drive_mode']}, {island['drive_why']}"
            lines.append(f"    stops, motors and friction of {', '.join(island['drives'])}: {mode}")
        if island["forces"]:
            lines.append(f"  forces: {', '.join(island['forces'])}")
        lines += [f"    {force}: {remark}" for force, remark in island["force_remarks"].items()]
        if island["contacts"]:
            lines.append(
                f"  contacts: {', '.join(island['contacts'])}, {island['contact_mode']}: {island['contact_why']}"
            )
        lines += [f"    {contact}: {remark}" for contact, remark in island["contact_remarks"].items()]
        lines.append(f"  solver: {island['solver']}{_control(island)}; {island['why']}")
        lines.append(f"  stability: {island['bound_text']}")
    ahead = [f"{', '.join(plan['ahead'])} frames all of it"] if plan["ahead"] else []
    ahead += [f"{name} {why}" for name, why in plan["ahead_objects"].items()]
    ahead += [f"{name} stands where it hides none of it" for name in plan["ahead_overlays"]]
    ahead += [f"the range of {', '.join(plan['ranges'])} is all of it"] if plan["ranges"] else []
    lines += ["", f"the physics runs once ahead of the film: {'; '.join(ahead)}"] if ahead else []
    once = [name for name, fields in plan["changing"].items() if not fields]
    again = [f"{name} by its {', '.join(fields)}" for name, fields in plan["changing"].items() if fields]
    lines += ["", f"made once: {', '.join(once) or 'no object'}"] if once or again else []
    lines += [f"each frame anew: {'; '.join(again)}"] if again else []
    if plan["left_out"]:
        lines += ["", "left out:"]
        lines += [f"  {part['name']} ({part['word']}): {part['why']}" for part in plan["left_out"]]
    avoided = plan["avoided"]
    lines += ["", f"not loaded: {avoided['words']} words; libraries {', '.join(avoided['libraries']) or 'none'}"]
    lines.append(f"not compiled: {', '.join(avoided['kernels']) or 'nothing left out'}")
    return "\n".join(lines)
