"""Warnings of keyframes of which nothing is seen: all alike, within a frame, or delayed beyond the clock."""

from __future__ import annotations

from collections.abc import Iterator

from sceneql.compiler.meaning.facts import Facts
from sceneql.compiler.values_below import values_of
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.expression import Call, Expr, Keys, Link, Number, Symbol, each_once


def warn(facts: Facts, found: Diagnostics) -> None:
    """Warn of each such group of keyframes over the time."""
    for keys in all_keys(facts):
        texts = {key.value.span.text.strip() if key.value.span is not None else None for key in keys.keys}
        times = [float(key.time.value) for key in keys.keys if isinstance(key.time, Number)]
        alike = len(keys.keys) > 1 and len(texts) == 1 and None not in texts
        if alike and not _slopes(keys) and not _moves(keys.keys[0].value):
            text = f"all of these keys are `{texts.pop()}`: nothing moves"
            found.warning(
                "nothing-moves", text, keys.span, help="give one of them another value, or leave the keys out"
            )
            continue
        late = _delay(keys.argument)
        if late is None or len(times) < max(len(keys.keys), 2) or keys.cycle is not None:
            continue
        if times[0] == 0.0 and late == 0.0 and 0.0 < times[-1] < facts.frame:
            text = f"the last of these keys is at {times[-1]:g} s, before the second frame, at {facts.frame:.3g} s"
            help = f"times of keys are seconds of the simulation: write `{1000 * times[-1]:g} s` for the last"
            found.warning("keys-within", text, keys.span, help=help)
        elif late > 0.0 and times[0] + late >= facts.clock.end:
            text = f"these keys begin at {times[0] + late:g} s, and the clock ends at {facts.clock.end:g} s"
            help = f"write a smaller `delay`, or `clock: {{end: {times[-1] + late:g} s}}`"
            found.warning("keys-beyond", text, keys.span, help=help)


def all_keys(facts: Facts) -> Iterator[Keys]:
    """The keyframes of all parts, each once."""
    known: set[int] = set()
    for task in facts.tasks.values():
        for value in values_of(task.original or task.kind):
            if id(value.expr) not in known:
                known.add(id(value.expr))
                yield from (node for node in each_once(value.expr) if isinstance(node, Keys) and node.span is not None)


def _moves(value: Expr) -> bool:
    """Whether a key's value varies by itself, in time or with another part."""
    return any(isinstance(node, Symbol | Link) for node in each_once(value))


def _slopes(keys: Keys) -> bool:
    return any(slope is not None for key in keys.keys for slope in (key.slope_in, key.slope_out))


def _delay(argument: Expr) -> float | None:
    """By how much keys over the time are delayed [s]; None for keys over something else."""
    match argument:
        case Symbol(name="time"):
            return 0.0
        case Call(op="sub", args=(Symbol(name="time"), Number(value=late))):
            return float(late)
    return None
