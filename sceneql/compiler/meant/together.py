"""Help for fields that are one here: two ends, the sides of a box, an axis and its angle, frames of a clock."""

from __future__ import annotations

import re
from collections.abc import Collection
from collections.abc import Sequence as Sequenced

from sceneql.compiler.meant.own_values import in_si, numbers_with_unit
from sceneql.compiler.meant.worked_out import worked_out
from sceneql.language.one_line import one_line
from sceneql.language.tree import Mapping, Node, Scalar, Sequence
from sceneql.quantities.diagnostic import same_as
from sceneql.quantities.literal import vector_meant

_FIRST = re.compile(r"\{(\w+): [<\[]")
_BLANK = re.compile(r"<(\w+)(#?)\|([^>]*)>")
_FIRST_OF, _LAST = re.compile(r"([^\W\d][\w.]*)\[0\]"), re.compile(r"([^\W\d][\w.]*)\[-1\]")
"""A value at the first and at the last moment, as other languages write it."""
_BELOW = re.compile(r"([^<>=]+)(<=?|>=?|==)([^<>=]+)")
CELLS = ("cells", "resolution", "grid", "n", "divisions", "nodes", "points")
"""Fields of other programs for a number of cells."""
_RATE = re.compile(r"d\(?(\w+)\)?\s*/\s*dt")
CORNERS = (
    ("corner1", "corner2"), ("min", "max"), ("low", "high"), ("from", "to"), ("p1", "p2"), ("start", "end"),
    ("lower", "upper"), ("corner_1", "corner_2"), ("a", "b"),
)  # fmt: skip
"""Fields of other programs for the corners of a box."""
FEWEST = 2
"""Least number of members of what is made of several."""
BEGINS, ENDS = ("start", "from", "begin", "t0", "after"), ("end", "to", "until", "stop", "t1", "before")
"""Fields of other programs for the times between which something is to be seen."""
DRAGS, AIR = ("cd", "c_d", "cw", "drag_coefficient", "coefficient"), "1.2 kg/m^3"
"""Fields of other programs for a drag coefficient, and the density of air."""
KEYED = ("curve", "cycle", "delay", "then")
"""Fields of keyframes."""
SLOW = ("slowmo", "slowmotion", "slowdown", "slow")
STRENGTHS = ("value", "strength", "magnitude", "torque", "force", "size", "amount", "moment")
TYPES = ("type", "kind", "model", "name")
"""Fields by which other programs tell which of several groups the others are in."""
WAYS = ("axis", "direction", "about", "dir")
"""Fields of other programs for a vector's size and its direction."""
STARTS = ("initial", "start", "init", "y0", "x0", "initialvalue", "initialcondition", "ic", "atstart")
"""Fields of other programs for what a state starts with."""
SIZES = ("width", "height", "depth", "length")
TURNS = ("rotation", "turn")
"""Fields that turn a part."""
FIRST, LAST = (
    ("frame_start", "start_frame", "first_frame"),
    ("frame_end", "end_frame", "last_frame", "frames", "nframes"),
)
"""Fields of other programs for the numbers of a film's first and last frame."""
SHOWN = 160
"""Longest value that a message repeats."""
USUAL = 30.0
"""Frames a second of a clock that says nothing else."""


def together(name: str, unknown: Sequenced[str], node: Mapping, known: Collection[str]) -> str | None:
    """The help for fields that are one here: ``from: a, to: b``, and items of a list without brackets."""
    told = _turned(name, unknown, node, known) or _by_frames(name, node, known) or _by_cells(name, node, known)
    told = told or _corners(name, unknown, node, known) or _members(name, unknown, node, known)
    told = told or _states(name, unknown, node, known) or _slower(name, node, known)
    told = told or _along(name, unknown, node, known) or _shown(name, unknown, node, known)
    told = told or _typed(name, unknown, node, known) or worked_out(name, unknown, node, known)
    told = told or _of_keys(name, node) or _drag(name, unknown, node, known) or _two_places(name, node, known)
    told = told or _panels(name, unknown, node, known) or _compared(name, node, known)
    if told is not None:
        return told
    ours = same_as(name, known)
    same = [other for other in unknown if same_as(other, known) == ours]
    if ours == "between" and len(same) == 2 and ours not in node.entries:
        return f"write `{ours}: [{', '.join(node.entries[other].span.text for other in same)}]`"
    sides = [other for other in SIZES if other in unknown]
    flat = "rotation" not in known or "cells" in known  # of a box there are three
    if name in sides and len(sides) > (1 if flat else 2) and "size" in known and "size" not in node.entries:
        texts = [node.entries[other].span.text for other in sides]
        if (size := vector_meant(", ".join(texts))) is not None:
            return f"write `size: {size}`"
    whole, _, part = name.rpartition(".")
    parts = [other for other in unknown if other.rpartition(".")[0] == whole and other[-1:] in "xyz"]
    if (whole or "position") in known and part in ("x", "y", "z"):
        values = (f"{each[-1]}: {node.entries[each].span.text}" for each in parts)
        return f"write `{whole or 'position'}: {{{', '.join(values)}}}`"
    names = list(node.entries)
    first = names.index(name)
    while first and names[first] not in known and _empty(node.entries[names[first]]):
        first -= 1
    items = [node.entries[names[first]].span.text, *names[first + 1 : names.index(name) + 1]]
    field = names[first] if names[first] in known else same_as(names[first], known)
    if len(items) > 1 and field is not None and isinstance(node.entries[names[first]], Scalar):
        return f"a list stands in brackets: write `{field}: [{', '.join(items)}]`"
    return None


def _compared(name: str, node: Mapping, known: Collection[str]) -> str | None:
    """The help for a comparison under a name of other programs, where its sides stand apart: ``assert: a < b``."""
    sides = _BELOW.fullmatch(node.entries[name].span.text.strip("\"'"))
    value, others = node.entries[name], node.entries.keys() & {*known}
    if isinstance(value, Scalar) and value.quoted:
        return None  # told as one value, one level further in
    if sides is None or not {"of", "below"} <= {*known} or not others or others & {"of", "below", "value"}:
        return None
    of, sign, limit = sides[1].strip(), sides[2], sides[3].strip()
    of, limit = (limit, of) if ">" in sign else (of, limit)
    of = _LAST.sub(r"final(\1)", _FIRST_OF.sub(r"initial(\1)", of))
    return f'the two sides stand apart: write `of: "{of}", {"value" if sign == "==" else "below"}: {limit}`'


def _empty(node: Node) -> bool:
    return isinstance(node, Scalar) and node.kind == "null" and not node.quoted


def filled(help: str, value: Node, known: Collection[str]) -> str:
    """A help text in which `<position|0 1 0 m>` is the text of the value's field `position`, or what stands behind.

    `<radii#|1 1 1>` is its numbers in SI, without their unit.

    Its other fields that are among the ``known`` ones, by another name too, stand behind those of the text.
    """
    fields = dict(value.entries) if isinstance(value, Mapping) else {}
    if "<own|" in help and isinstance(value, Scalar) and value.text.isidentifier():
        return re.sub(r"<own[|]\w+>", value.text, help)
    if "<" in help and value.span.text and not isinstance(value, Mapping) and (own := _FIRST.search(help)) is not None:
        return f"write `{own[1]}: {value.span.text}`"
    if "<" not in help:
        return help

    def fill(blank: re.Match[str]) -> str:
        key = next((one for one in fields if one == blank[1] or same_as(one, [blank[1]]) is not None), None)
        text = None if key is None else fields.pop(key).span.text
        if text is None or not blank[2]:
            return text or blank[3]
        return " ".join(f"{number:.6g}" for number in in_si(text)) or blank[3]

    text = _BLANK.sub(fill, help)
    more = {one if one in known else same_as(one, known): node.span.text for one, node in fields.items()}
    told = "".join(f", {one}: {own}" for one, own in more.items() if one is not None and f"{one}:" not in text)
    return text.replace("}`", f"{told}}}`", 1) if told else text


def _turned(name: str, unknown: Sequenced[str], node: Mapping, known: Collection[str]) -> str | None:
    """The help for an axis and an angle beside the other fields of what has a field for both."""
    field = next((one for one in TURNS if one in known), None)
    if field is None or name not in ("axis", "angle") or field in node.entries or not {"axis", "angle"} <= {*unknown}:
        return None
    axis, angle = (node.entries[one].span.text for one in ("axis", "angle"))
    axis = axis if axis.strip("-") in "xyz" else f"[{', '.join(axis.strip('[]').replace(',', ' ').split())}]"
    return f"write `{field}: {{about: {axis}, angle: {angle}}}`"


def _by_frames(name: str, node: Mapping, known: Collection[str]) -> str | None:
    """The help for the numbers of a film's frames in place of its length."""
    if not {"end", "fps"} <= {*known} or name not in (*FIRST, *LAST):
        return None
    if name in FIRST:
        return "a film begins at 0 s: leave it out"
    try:
        rate = float(node.entries["fps"].span.text) if "fps" in node.entries else USUAL
        frames = float(node.entries[name].span.text)
    except ValueError:
        return None
    return f"`end` is a time: for {frames:g} frames, {rate:g} of them a second, write `end: {frames / rate:.6g} s`"


def _by_cells(name: str, node: Mapping, known: Collection[str]) -> str | None:
    """The help for the number of cells along the sides of a box that has the size of a cell."""
    size = node.entries.get("size")
    if "cell" not in known or "cell" in node.entries or name not in CELLS or size is None:
        return None
    counts, sides = numbers_with_unit(node.entries[name].span.text), numbers_with_unit(size.span.text)
    if counts is None or sides is None or counts[0][0] <= 0.0 or not sides[1]:
        return None
    return f"it has the size of a cell: write `cell: {sides[0][0] / counts[0][0]:.6g} {sides[1]}`"


def _corners(name: str, unknown: Sequenced[str], node: Mapping, known: Collection[str]) -> str | None:
    """The help for two corners of a box, which has a size and a middle."""
    pair = next((pair for pair in CORNERS if name in pair and {*pair} <= {*unknown}), None)
    if pair is None or not {"size", "position"} <= {*known} or "size" in node.entries:
        return None
    both = [numbers_with_unit(node.entries[one].span.text) for one in pair]
    if both[0] is None or both[1] is None:
        return "it has a size and the place of its middle: write `size: ...` and `position: ...`"
    (low, unit), (high, other) = both[0], both[1]
    if len(low) != len(high) or len(low) not in (2, 3) or (unit and other and unit != other):
        return None
    unit = unit or other or "m"
    size = " ".join(f"{abs(b - a):.6g}" for a, b in zip(low, high, strict=True))
    middle = " ".join(f"{0.0 + (a + b) / 2:.6g}" for a, b in zip(low, high, strict=True))
    return f"write `size: {size} {unit}`, and of its middle `position: {middle} {unit}`"


def _members(name: str, unknown: Sequenced[str], node: Mapping, known: Collection[str]) -> str | None:
    """The help for parts under names of their own where a list holds them."""
    texts = [node.entries[one].span.text for one in unknown]
    if "of" not in known or "of" in node.entries or "blend" not in known or len(texts) < FEWEST:
        return None
    if all(one.isidentifier() for one in texts):
        return f"write `of: [{', '.join(texts)}]`"
    words = [node.entries[one] for one in unknown]
    if not all(
        isinstance(one, Mapping) and len(one.entries) == 1 and isinstance(next(iter(one.entries.values())), Mapping)
        for one in words
    ):
        return None
    return f"write `of: [{', '.join(one_line(one) for one in words)}]`"


def _states(name: str, unknown: Sequenced[str], node: Mapping, known: Collection[str]) -> str | None:
    """The help for states and their rates without the fields around them: ``theta: 1, d(theta)/dt: omega``."""
    both = ("start", "rate")
    if not {*both} <= {*known} or "rate" in node.entries:
        return None
    if isinstance(begun := node.entries.get("start"), Mapping):
        told = {one: (_RATE.fullmatch(one) or [one, one])[1] for one in unknown}
        if not all(of.rstrip("'") in begun.entries for of in told.values()):
            return None
        return f"write `rate: {{{', '.join(f'{of}: {node.entries[one].span.text}' for one, of in told.items())}}}`"
    if "start" in node.entries or any(same_as(one, both) for one in unknown):
        return None
    if (entries := [_state(node.entries[one]) for one in unknown]) and all(entries):  # `y: {initial: 1, rate: -y}`
        given = [(one, *pair) for one, pair in zip(unknown, entries, strict=True) if pair is not None]
        start, rate = (", ".join(f"{one[0]}: {one[at]}" for one in given) for at in (1, 2))
        return f"write `start: {{{start}}}` and `rate: {{{rate}}}`"
    rates = {one: (_RATE.fullmatch(one) or [one, ""])[1] for one in unknown if _RATE.fullmatch(one)}
    start = ", ".join(f"{one}: {node.entries[one].span.text}" for one in unknown if one not in rates)
    rate = ", ".join(f"{of}: {node.entries[one].span.text}" for one, of in rates.items())
    return f"write `start: {{{start or '...'}}}` and `rate: {{{rate or '...'}}}`"


def _state(node: Node) -> tuple[str, str] | None:
    """What a state starts with and its rate, of an entry that holds just these; None for other entries."""
    fields = node.entries if isinstance(node, Mapping) else {}
    starts = [one for one in fields if one.replace("_", "").lower() in STARTS]
    starts = starts or [one for one in fields if one == "value"]
    if len(fields) != 2 or len(starts) != 1:
        return None
    (rate,) = fields.keys() - {*starts}
    return fields[starts[0]].span.text, fields[rate].span.text


def _slower(name: str, node: Mapping, known: Collection[str]) -> str | None:
    """The help for how many times slower a film is."""
    if name.replace("_", "").lower() not in SLOW or not {"speed", "fps"} <= {*known}:
        return None
    try:
        times = float(node.entries[name].span.text.strip("x "))
    except ValueError:
        return None
    slower = 1.0 / times if times > 1.0 else times
    return f"`speed` is seconds of simulation in a second of film: write `speed: {slower:.6g}`" if times > 0 else None


def _along(name: str, unknown: Sequenced[str], node: Mapping, known: Collection[str]) -> str | None:
    """The help for the size and the axis of a vector of formulas: ``value: 2 N*m, axis: y``."""
    size = next((one for one in unknown if one in STRENGTHS), None)
    axis = next((one for one in unknown if one in WAYS), None)
    if "components" not in known or "components" in node.entries or size is None or axis is None:
        return None
    text, way = node.entries[size].span.text, node.entries[axis].span.text
    letters = {"x": "1 0 0", "y": "0 1 0", "z": "0 0 1"}
    numbers = letters.get(way, way).strip("[]").replace(",", " ").split()
    if len(numbers) != len(letters) or sorted(numbers) != ["0", "0", "1"]:
        return None
    return f"write `components: [{', '.join(text if one == '1' else '0' for one in numbers)}]`"


def _shown(name: str, unknown: Sequenced[str], node: Mapping, known: Collection[str]) -> str | None:
    """The help for the times from when and to when something is to be seen."""
    if not {"show", "fade"} <= {*known} or "show" in node.entries or name not in (*BEGINS, *ENDS):
        return None
    first = next((node.entries[one].span.text for one in unknown if one in BEGINS), None)
    last = next((node.entries[one].span.text for one in unknown if one in ENDS), None)
    after = None if first is None or first.strip("0. ") in ("", "s") else f"(time > {first})"
    before = None if last is None else f"(time < {last})"
    if after is None and before is None:
        return "it is there from the start: leave it out"
    return f"from when to when it is there is said by `show`: write `show: {'*'.join(filter(None, (after, before)))}`"


def _drag(name: str, unknown: Sequenced[str], node: Mapping, known: Collection[str]) -> str | None:
    """The help for a drag coefficient and an area: with the density of air, or the one that is written."""
    lower = {one.lower(): one for one in unknown}
    factor = next((node.entries[lower[one]].span.text for one in DRAGS if one in lower), None)
    if "quadratic" not in known or "quadratic" in node.entries or factor is None or "area" not in lower:
        return None
    if name.lower() not in (*DRAGS, "area", "density", "rho"):
        return None
    dense = next((node.entries[lower[one]].span.text for one in ("density", "rho") if one in lower), AIR)
    return f"write `quadratic: 0.5*{dense}*{factor}*{node.entries[lower['area']].span.text}`"


def _two_places(name: str, node: Mapping, known: Collection[str]) -> str | None:
    """The help for two names in a list where there are two places: those of the named."""
    value = node.entries[name]
    texts = [item.span.text for item in value.items] if isinstance(value, Sequence) else []
    if not {"from", "to", "rest"} <= {*known} or len(texts) != FEWEST or {"from", "to"} & node.entries.keys():
        return None
    first, second = (f"{text}.position" if text.replace(".", "_").isidentifier() else text for text in texts)
    return f"write `from: {first}, to: {second}`"


def _panels(name: str, unknown: Sequenced[str], node: Mapping, known: Collection[str]) -> str | None:
    """The help for panels and the numbers of rows and columns of a layout, which is a list of rows."""
    lists = [one for key, one in node.entries.items() if isinstance(one, Sequence) and key in unknown]
    if not {"each", "share"} <= {*known} or len(lists) != 1:
        return None
    names = [one.span.text for one in lists[0].items]
    counts = {key.lower(): one.span.text for key, one in node.entries.items()}
    columns = next((counts[one] for one in ("columns", "cols", "ncols") if counts.get(one, "").isdecimal()), "")
    rows = next((counts[one] for one in ("rows", "nrows") if counts.get(one, "").isdecimal()), "")
    width = int(columns) if columns else -(-len(names) // max(int(rows), 1)) if rows else len(names)
    told = ", ".join(f"[{', '.join(names[k : k + width])}]" for k in range(0, len(names), max(width, 1)))
    return f"a layout is a list of rows of names: write `layout: [{told}]`"


def _of_keys(name: str, node: Mapping) -> str | None:
    """The help for a field of keyframes that stands beside them."""
    keyed = next((key for key, one in node.entries.items() if isinstance(one, Mapping) and "keys" in one.entries), None)
    if name not in KEYED or keyed is None:
        return None
    whole = one_line(node.entries[keyed]).removesuffix("}")
    whole = whole if len(whole) <= SHOWN else "{keys: {...}"
    told = f"{keyed}: {whole}, {name}: {node.entries[name].span.text}}}"
    return f"it stands beside `keys`, in the same braces: write `{told}`"


def _typed(name: str, unknown: Sequenced[str], node: Mapping, known: Collection[str]) -> str | None:
    """The help for a field that tells which of the record's groups the others are in: ``type: linear, modulus: ..``."""
    told = next((one for one in unknown if one in TYPES and node.entries[one].span.text in known), None)
    if told is None or (name != told and name not in unknown):
        return None
    inner = ", ".join(f"{one}: {node.entries[one].span.text}" for one in unknown if one != told)
    return f"its fields stand inside of its name: write `{{{node.entries[told].span.text}: {{{inner}}}}}`"
