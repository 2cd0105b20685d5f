"""Reading of keyframes: ``{keys: {time: value, ...}, curve: smooth, cycle: 2 s, delay: 1 s}``."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from sceneql.compiler.meant.by_clock import in_parts
from sceneql.kinds import Value
from sceneql.language.tree import Mapping as MappingNode
from sceneql.language.tree import Node, Scalar, broken, unsure
from sceneql.language.tree import Sequence as SequenceNode
from sceneql.quantities.diagnostic import Diagnostics, suggestion
from sceneql.quantities.dimension import TIME
from sceneql.quantities.expression import Call, Expr, Key, Keys, Symbol, Type
from sceneql.quantities.instead import instead

_CURVES = (
    (("bezier", "spline", "hermite", "elastic", "back"), "cubic"),
    (("constant", "hold", "discrete"), "step"),
    (("ease", "sine", "quad", "smooth", "inout"), "smooth"),
)
"""Parts of names of curves in other programs, and what is nearest here."""
CURVES = ("step", "linear", "smooth", "cubic")
KEY_FIELDS = ("value", "slope", "slope_in", "slope_out")

Read = Callable[[Node], Expr | None]
"""Function that reads the value or the slope of one key; None after reporting an error."""
ReadTime = Callable[[Node, str], Value | None]
"""Function that reads a time, which messages call by the given name."""


def read_keys(
    node: MappingNode, what: str, value: Read, slope: Read | None, time: ReadTime, type_: Type, found: Diagnostics
) -> Expr | None:
    """The keyframe expression of a node; None after reporting errors. Key times must be constant and increase.

    ``value`` and ``slope`` read those of one key, ``time`` a time.
    """
    ok = True
    for key in node.entries:
        if key not in ("keys", "curve", "cycle", "delay"):
            hint = _curve_meant(key, node.entries[key]) or instead("keys", key)
            table = node.entries["keys"]
            if hint is not None and isinstance(table, MappingNode) and table.entries:  # as long as the keys last
                hint = hint.replace("`cycle: 2 s`", f"`cycle: {[*table.entries][-1]}`")
            hint = hint or suggestion(key, ("keys", "curve", "cycle", "delay"))
            found.error("unknown-field", f"keyframes have no field '{key}'", node.keys[key].span, help=hint)
            ok = False
    table = node.entries["keys"]
    if unsure(table):
        return None
    if not isinstance(table, MappingNode) or not table.entries:
        listed = table.items if isinstance(table, SequenceNode) else []
        better = ", ".join(_key_meant(second, item) for second, item in enumerate(listed))
        help = f"write `{{{better}}}`, at the times that are meant" if listed else None
        found.error("wrong-shape", "keys are written `{time: value, ...}`", table.span, help=help)
        return None
    fields = KEY_FIELDS if slope is not None else KEY_FIELDS[:1]
    if (parts := in_parts(table)) is not None:
        found.error("dimension-mismatch", "keys stand at times, not at parts", table.span, help=f"write `{parts}`")
        return None
    keys: list[Key] = []
    last = -math.inf
    for name, item in table.entries.items():
        at = time(table.keys[name], "a key's time")
        slopes: dict[str, Expr | None] = {}
        if isinstance(item, MappingNode) and "value" in item.entries:
            for extra in [key for key in item.entries if key not in fields]:
                hint = suggestion(extra, fields)
                found.error("unknown-field", f"a key has no field '{extra}'", item.keys[extra].span, help=hint)
                ok = False
            if slope is not None:
                slopes = {key: slope(item.entries[key]) for key in KEY_FIELDS[1:] if key in item.entries}
            item = item.entries["value"]
        read = value(item)
        if at is None or read is None or any(s is None for s in slopes.values()):
            ok = False
            continue
        if not at.constant:
            found.error("not-constant", "a key's time must be constant", table.keys[name].span)
            ok = False
            continue
        now = at.number()
        if now <= last:
            help = _in_order(table, time) if last > -math.inf else None
            found.error("keys-order", "the times of keys must increase", table.keys[name].span, help=help)
            ok = False
        last = now
        both = slopes.get("slope")
        keys.append(Key(at.expr, read, slopes.get("slope_in", both), slopes.get("slope_out", both)))
    curve = _curve(node, found)
    cycled = node.entries.get("cycle")
    if isinstance(cycled, Scalar) and cycled.text.lower() in ("yes", "true", "on"):
        help = f"write the time after which they begin anew, `cycle: {last:g} s`"
        found.error("wrong-shape", "cycle is a time (s)", cycled.span, help=help)
        return None
    cycle, delay = (time(node.entries[name], name) if name in node.entries else None for name in ("cycle", "delay"))
    if not ok or curve is None:
        return None
    argument: Expr = Symbol("time", Type((), TIME))
    if delay is not None:
        argument = Call("sub", (argument, delay.expr), Type((), TIME))
    return Keys(argument, tuple(keys), curve, None if cycle is None else cycle.expr, type_, node.span)


def _in_order(table: MappingNode, time: ReadTime) -> str | None:
    """The help with the keys in the order of their times; None where two stand at one time, or a time is not known."""
    ats = [(time(key, ""), key.text, table.entries[name].span.text) for name, key in table.keys.items()]
    numbers = [at.number() for at, _, _ in ats if at is not None and at.constant]
    texts = [text for _, _, text in ats]
    if len({*numbers}) < len(ats) or any("\n" in text for text in texts):
        return "two keys stand at one time: leave one of them out, or write a time between" if numbers else None
    told = sorted(zip(numbers, ats, strict=True), key=lambda one: one[0])
    return f"write `{{{', '.join(f'{name}: {text}' for _, (_, name, text) in told)}}}`"


def _key_meant(second: int, item: Node) -> str:
    """A key of a list as a script writes it; ``{time: 1 s, value: 2 m}`` and a pair have their time."""
    match item:
        case MappingNode(entries={"value": value, **rest}) if len(rest) == 1:
            return f"{next(iter(rest.values())).span.text}: {value.span.text}"
        case SequenceNode(items=[at, value]):
            return f"{at.span.text}: {value.span.text}"
    return f"{second} s: {item.span.text}"


def _curve_meant(key: str, node: Node) -> str | None:
    """The help for a curve by another program's name of it, ``easing: easeInOutQuad``."""
    text = node.text.lower() if isinstance(node, Scalar) else ""
    if key not in ("interpolation", "ease", "easing", "mode", "type", "timing"):
        return None
    plain = next((one for one in ("linear", "step", "cubic") if one in text), "")
    curve = plain or next((ours for words, ours in _CURVES if any(one in text for one in words)), "")
    return f"write `curve: {curve}`" if curve else None


def _curve(node: MappingNode, found: Diagnostics) -> Any:
    if "curve" not in node.entries:
        return "smooth"
    item = node.entries["curve"]
    if broken(item):
        return None
    text = item.text if isinstance(item, Scalar) else ""
    if text in CURVES:
        return text
    hint = suggestion(text, CURVES) or "one of " + ", ".join(CURVES)
    found.error("unknown-choice", f"curve cannot be '{text}'", item.span, help=hint)
    return None
