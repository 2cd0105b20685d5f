"""Values mended in several steps: what a value is in all, where mending it as its message says shows the next mistake.

``reader`` is the `Reader` (`sceneql.compiler.read`) that met the value.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from collections.abc import Mapping as Naming
from contextlib import suppress
from dataclasses import replace
from typing import Any

from pydantic import BaseModel

from sceneql import kinds
from sceneql.compiler.annotations import marks_of, quantities
from sceneql.compiler.meant import quantity_help as helped
from sceneql.compiler.meant.by_size import by_own_size, in_own_box
from sceneql.compiler.meant.listed_states import listed_states
from sceneql.compiler.meant.values_elsewhere import along_default, elsewhere, first_of, middle_of_ends
from sceneql.compiler.names import Names
from sceneql.compiler.problems import Unreadable
from sceneql.language.compose import compose_node
from sceneql.language.sections import empty
from sceneql.language.tree import Mapping, Node, Scalar, Sequence
from sceneql.quantities.diagnostic import Diagnostic, Diagnostics, ScriptError, same_as
from sceneql.quantities.instead import instead
from sceneql.quantities.literal import vector_meant
from sceneql.quantities.spaced import between_times, mean_and_more, per_unit
from sceneql.quantities.span import Source
from sceneql.quantities.units import format_quantity

LONGEST = 160
"""Largest length of a value that is mended."""
STEPS, TRIES = 6, 24
"""Largest numbers of mistakes in a row, and of texts that are read, until a value is mended."""
_FRAMES = re.compile(r"(\d+(?:\.\d+)?)\s*(?:frames?|f)")
_SHOWN = re.compile(r"`([^`]+)`")
_NUMBER = re.compile(r"(?<![\w.])\d+\.?\d*(?:[eE][-+]?\d+)?")
_PLACE = re.compile(r"(?<![\w.])[xyz](?![\w.(])")
_TIMES = re.compile(r"(?<=\d)[x×](?=\d)")  # 1920x1080
_WRITTEN = re.compile(r"(?:write|is written|did you mean) [`']([^`]+?)[`'](?:\?|;|,|:|$| )")


AXES = {
    f"{sign}{axis}": " ".join(f"{sign}1" if one == axis else "0" for one in "xyz")
    for sign in ("", "-")
    for axis in "xyz"
}
"""Directions by the names of axes."""
THREE = 3
"""Rows of a matrix in space."""
TORQUES = ("torque", "moment")
"""Fields of an energy that is measured in N*m."""
FORCE = "is a force (N)"
PLANAR = "is a vector of 3, not a vector of 2"
"""What is told of a vector without one of its components."""
SINGLE = " is a single value, not a vector"
"""What is told of several numbers where one stands."""


def improve(reader: Any, written: Naming[str, Node], cls: type[BaseModel], name: str, title: str, before: int) -> None:
    """Let the errors of a record's field, those from number ``before`` on, say what to write by the whole record.

    ``title``: what messages call the record.
    """
    better_alone(reader, written, cls, name, title, before)
    found = reader.found.found
    turns = any(isinstance(mark, kinds.Turn) for mark in marks_of(field_of(cls, name)))
    if (isinstance(written[name], Mapping) and not turns) or len(found) == before:
        return
    if (final := mended(reader, written[name], cls, name)) is not None and final[1] > 1:
        help = found[before].help
        help = f"{help}; in" if not (help or "").endswith("?") else f"{help} In"
        found[before] = replace(found[before], help=f"{help} all `{name}: {final[0]}`")


def better_alone(
    reader: Any, written: Naming[str, Node], cls: type[BaseModel], name: str, title: str, before: int
) -> None:
    """Let a single error, number ``before``, say what to write by its field and the record."""
    node, found = written[name], reader.found.found
    info = field_of(cls, name)
    helped.by_own_density(reader, written, before)
    by_own_size(reader, written, cls, name, before)
    in_own_box(reader, written, before)
    if len(found) == before:
        return
    told = [(one.code, one.help) for one in found[before:]]
    if (states := listed_states(reader, written, name)) is not None:
        found[before:] = [replace(found[before], help=states)]
        return
    known = [kinds.written_name(key) for key in cls.model_fields]
    varies = "variation" in known and name in (field_of(cls, "variation").description or "")
    if varies and (varied := middle_of_ends(name, node, known)) is not None:
        found[before:] = [replace(found[before], help=varied)]
        return
    about = mean_and_more(node.span.text) if "tolerance" in known and "tolerance" not in written else None
    if about is not None:
        told_apart = f"{name}: {about[0]} {about[2]}".rstrip() + f", tolerance: {about[1]} {about[2]}".rstrip()
        found[before] = replace(found[before], help=f"how far it may be off stands apart: `{told_apart}`")
        return
    other = instead(f"place.{title}", name) if _PLACE.search(node.span.text) else None
    if other is not None and {code for code, _ in told} == {"unknown-name"}:
        found[before:] = [replace(found[before], help=other)]
        return
    if len(told) != 1:
        return
    code, help = told[0]
    if code == "out-of-range" and "fixed" in known and help is not None and help == instead("zero", name):
        found[before] = replace(found[before], help=helped.of_fixed(written, name))
    if name == "color" and "aging" in known and "emit" in written and "`{keys: " in (help or ""):
        aged = f"write `aging: {{color: {(help or '').split('`')[1]}}}`"
        found[before] = replace(found[before], help=f"what changes with their age stands there: {aged}")
    if code == "unknown-choice" and (other := helped.field_of_part(reader, node, written, cls)) is not None:
        found[before] = replace(found[before], help=other)
    if code == "unknown-name" and isinstance(node, Sequence) and len(node.items) == 1 and places_one(info):
        one = helped.other_output(reader, node.items[0], info, name)
        whole = (one or "").replace("write `", f"it is one place, without brackets: write `{name}: ", 1)
        found[before] = replace(found[before], help=whole or help)
    elif code == "unknown-name" and isinstance(node, Sequence) and (item := helped.of_item(reader, node, info, name)):
        found[before] = replace(found[before], help=item)
    elif code == "unknown-name" and helped.is_part(reader, node):
        found[before] = replace(found[before], help=helped.other_output(reader, node, info, name) or help)
    elif code == "unknown-name" and any(mark.direction for mark in quantities(info)) and node.span.text in AXES:
        found[before] = replace(found[before], help=f"write `{name}: {AXES[node.span.text]}`")
    elif code == "unknown-name" and (plain := _one_for_all(node, info, name, title)) is not None:
        found[before] = replace(found[before], help=plain)
    elif code in ("unknown-name", "unknown-unit"):
        found[before] = replace(found[before], help=helped.number_meant(node, info, name, code, help) or help)
    if name == "sweep" and code == "wrong-shape" and isinstance(node, Scalar):
        found[before] = replace(found[before], help=swept(reader, written, node.text) or help)
    if code == "unknown-unit" and (frames := _FRAMES.fullmatch(node.span.text.strip())) is not None:
        rate = written["fps"].span.text if "fps" in written else str(helped.FRAMES)
        if rate.replace(".", "", 1).isdecimal() and float(rate) > 0:
            time = f"{float(frames[1]) / float(rate):.6g} s"
            found[before] = replace(
                found[before], help=f"it is a time: at {rate} frames a second write `{name}: {time}`"
            )
    if code == "wrong-count" and isinstance(node, Scalar) and (more := _behind(written, name)):
        whole = f"{name}: [{', '.join([node.span.text, *more])}]"
        found[before] = replace(found[before], help=f"a list stands in brackets: write `{whole}`")
    counted = re.fullmatch(r"([\d.]+(?:e[-+]?\d+)?)\s*[a-z]+\s*(?:/\s*|per )(\w+)", node.span.text.strip())
    if code == "unknown-unit" and counted is not None and "is counted has no unit" in (help or ""):
        unit = (per_unit(f"1 per {counted[2]}") or f"1/{counted[2]}")[2:]
        found[before] = replace(found[before], help=f"what is counted has no unit: write `{counted[1]} /{unit}`")
    single = [mark.shape == () for mark in quantities(info)]
    if (help or "").startswith("two ends stand") and single and all(single):
        mean = middle_of_ends(name, node, ())
        fits = mean is not None and not _errors(reader, mean.split("`")[1].partition(": ")[2], cls, name)
        found[before] = replace(found[before], help=mean if fits else between_times(node.span.text) or help)
    if (help or "").endswith("a number for each axis"):
        found[before] = replace(found[before], help=along_default(node, info) or help)
    if help is not None or code not in ("wrong-shape", "dimension-mismatch"):
        return
    shaped, pointing = code == "wrong-shape", any(mark.direction for mark in quantities(info))
    rest = {key: more for key, more in cls.model_fields.items() if kinds.written_name(key) not in written}
    better = elsewhere(reader, node, info, rest) if shaped or pointing else None
    if better is None and shaped:
        better = helped.other_output(reader, node, info, name)
    if better is None and name in TORQUES and found[before].message.endswith(FORCE) and isinstance(node, Scalar):
        better = f"a torque is a force times the length of its lever: write `{name}: {node.span.text}*m`"
    better = better or helped.for_each(reader, node, cls, name, title)
    if better is None and (diagonal := _diagonal(node)) is not None:
        better = f"it has the three on the diagonal: write `{name}: {diagonal}`"
    if better is None and found[before].message.endswith(PLANAR):
        better = "a number is missing: it has one for each of x, y and z"
        better += "; at a side of the picture it stands by `place: top left`" if "place" in known else ""
    if better is None and found[before].message.startswith(f"{name}{SINGLE}"):
        better = first_of(name, node)
    if better is None and pointing and not shaped:
        better = helped.direction_alone(node)
    if better is None and not shaped:
        better = helped.plain_define(reader, node) or helped.in_other_unit(reader, node, info, rest, name)
        if better is None or better.startswith(helped.BY_UNIT):
            better = (cls.said_by if issubclass(cls, kinds.Record) else {}).get(name, better)
    found[before] = replace(found[before], help=better)


def _one_for_all(node: Node, info: Any, name: str, title: str) -> str | None:
    """The help for a formula of x, y and z where a field is one quantity; None for others."""
    marks = [mark for mark in quantities(info) if mark.shape == () and mark.dimension is not None]
    if not marks or not isinstance(node, Scalar) or not _PLACE.search(node.text):
        return None
    more = f"; `sceneql words {title}` tells what goes by place" if title.isidentifier() else ""
    return f"it is one value, the same at all places, as `{name}: {format_quantity(1.0, marks[0].dimension)}`{more}"


def _diagonal(node: Node) -> str | None:
    """The numbers on the diagonal of a matrix of three rows; None of other values."""
    rows = node.items if isinstance(node, Sequence) else []
    cells = [row.items for row in rows if isinstance(row, Sequence)]
    if len(rows) != THREE or [len(row) for row in cells] != [THREE] * THREE:
        return None
    return vector_meant(", ".join(row[k].span.text for k, row in enumerate(cells)))


def _behind(written: Naming[str, Node], name: str) -> list[str]:
    """The keys without values directly behind a field, which YAML makes of the items of a list without brackets."""
    keys = [*written]
    found: list[str] = []
    for key in keys[keys.index(name) + 1 :]:
        if not empty(written[key]):
            break
        found.append(key)
    return found


def swept(reader: Any, written: Naming[str, Node], what: str) -> str | None:
    """The help for a study's sweep that names what is varied, without its path: a define, or a solver's step."""
    values = next((one.span.text for key, one in written.items() if key in ("values", "range", "over")), "[..., ...]")
    parts = reader.names.parts.items()
    steps = [part for part, entry in parts if isinstance(entry.fields, Mapping) and "step" in entry.fields.entries]
    having = [part for part, entry in parts if isinstance(entry.fields, Mapping) and what in entry.fields.entries]
    path = f"define.{what}" if what in reader.names.defines else what if "." in what else ""
    path = path or (f"{having[0]}.{what}" if len(having) == 1 else "")
    path = path or (f"{steps[0]}.step" if steps and same_as(what, ["step"]) is not None else "")
    return f"what is varied stands by its path: write `sweep: {{{path}: {values}}}`" if path else None


def field_of(cls: type[BaseModel], name: str) -> Any:
    """The field of a record by its name in scripts."""
    return next(info for key, info in cls.model_fields.items() if kinds.written_name(key) == name)


def places_one(info: Any) -> bool:
    """Whether a field is a vector of three, not a list."""
    return bool(marks := quantities(info)) and all(mark.shape == (THREE,) for mark in marks)


def mended(reader: Any, node: Node, cls: type[BaseModel], name: str) -> tuple[str, int] | None:
    """The text that a field takes in place of a wrong value, and in how many steps one comes there; None for none.

    In each step all mistakes are mended as their messages say.
    """
    text = node.span.text
    if "\n" in text or not 0 < len(text) <= LONGEST:
        return None
    return _search(reader, text, _errors(reader, text, cls, name), cls, name, [TRIES], set())


def _search(
    reader: Any, text: str, errors: list[Diagnostic], cls: type[BaseModel], name: str, budget: list[int], seen: set[str]
) -> tuple[str, int] | None:
    """The text that is right, and the number of steps to it, those in ``seen`` included."""
    seen.add(text)
    tried: list[tuple[str, list[Diagnostic]]] = []
    for better in _candidates(text, errors, name) if errors and len(seen) <= STEPS else ():
        if better in seen or budget[0] <= 0 or len(better) > LONGEST or not _keeps(text, better, reader.names):
            continue
        budget[0] -= 1
        left = _errors(reader, better, cls, name)
        if not left:
            return better, len(seen)
        if not set(map(_told, left)) & set(map(_told, errors)):
            tried.append((better, left))
    for better, left in tried:
        if (found := _search(reader, better, left, cls, name, budget, {*seen})) is not None:
            return found
    return None


def _told(one: Diagnostic) -> tuple[str, str, int]:
    """What an error says, and where: the same again is no step further."""
    return one.code, one.message, -1 if one.span is None else one.span.start


def _candidates(text: str, errors: list[Diagnostic], name: str) -> Iterator[str]:
    """The text with the mistakes mended in their places; and what the first message says as the whole of it.

    None where a message shows several texts, or one that is but an example.
    """
    told = []
    for one in errors:
        shown = [text for text in _SHOWN.findall(one.help or "") if not text.startswith("sceneql words")]
        meant = _WRITTEN.search(one.help or "")
        either = one.code == "unit-needed" or ", in degrees" in (one.help or "")
        if meant is None or one.span is None or (shown and shown != [meant[1]] and not either):
            return
        whole = meant[1]
        if one.code == "unknown-output" and "." not in whole and "." in one.span.text:
            whole = f"{one.span.text.rpartition('.')[0]}.{whole}"  # of the same model
        told.append((*_shown_from(text, one.span.start, one.span.end, whole), whole))
    of_field = [meant.removeprefix(f"{name}: ") for _, _, meant in told if meant.startswith(f"{name}: ")]
    if not of_field:
        yield _replaced(text, told)
        with suppress(ScriptError):
            node = compose_node(Source("value", text))
            yield _replaced(text, [(*_around(node, start, end), meant) for start, end, meant in told])
    if of_field or not text.startswith("[") or told[0][2].startswith("["):  # else the other items would be lost
        yield (of_field or [meant for _, _, meant in told])[0]


def _shown_from(text: str, start: int, end: int, meant: str) -> tuple[int, int]:
    """Start and end of what a help shows anew: with a call that stands around the wrong piece, as ``cos(time)``."""
    call = re.search(r"\w+\($", text[:start])
    if call is not None and meant.startswith(call[0]) and meant.endswith(")") and text[end : end + 1] == ")":
        return call.start(), end + 1
    return start, end


def _replaced(text: str, told: Collection[tuple[int, int, str]]) -> str:
    """A text with pieces of it, from a start to an end, replaced.

    What stands for a piece may have what is around it, too, as ``sin(time/(1 s))`` for ``time`` in ``sin(time)``: it
    stands for as much of the text as it repeats.
    """
    for start, end, meant in sorted(told, reverse=True):
        found = meant.find(text[start:end])
        at = max((k for k in range(found + 1) if text[:start].endswith(meant[:k])), default=0)
        if at > 0:
            rest = meant[found + end - start :]
            again = next(rest[k:] for k in range(len(rest) + 1) if text[end:].startswith(rest[k:]))
            text = text[: start - at] + meant + text[end + len(again) :]
        else:
            text = text[:start] + meant + text[end:]
    return text


def _around(node: Node, start: int, end: int) -> tuple[int, int]:
    """Start and end of the smallest value in a node that has all of a piece of its text."""
    inner = node.items if isinstance(node, Sequence) else []
    inner = [*node.entries.values()] if isinstance(node, Mapping) else inner
    for one in inner:
        if one.span.start <= start and end <= one.span.end:
            return _around(one, start, end)
    return (node.content.start, node.content.end) if isinstance(node, Scalar) else (node.start, node.end)


def _keeps(text: str, better: str, names: Names) -> bool:
    """Whether a text has all numbers of another in their order, no others but 0 and 1, and its names that are known."""
    left = iter(own := _NUMBER.findall(better))
    before = _NUMBER.findall(_TIMES.sub(" ", text))
    words = [one for one in re.findall(r"[^\W\d]\w*", text) if one in names.defines or one in names.parts]
    spare = {one: own.count(one) for one in own if one not in ("0", "1")}
    known = all(spare[one] <= before.count(one) for one in spare) and all(
        re.search(rf"\b{re.escape(one)}\b", better) for one in words
    )
    return known and all(number in left for number in before) and {*own} <= {*before, "0", "1"}


def _errors(reader: Any, text: str, cls: type[BaseModel], name: str) -> list[Diagnostic]:
    """The errors of a text as the value of a field; one without a remedy where it is no value at all."""
    nothing = Diagnostics()
    names = replace(reader.names, found=nothing)

    def refer(node: Node, mark: kinds.Refers, anonymous: str) -> kinds.Ref | None:
        return kinds.Ref(node.text, node.span) if isinstance(node, Scalar) and node.text in names.parts else None

    trial = replace(reader, found=nothing, names=names, refer=refer, files=[])
    try:
        node = compose_node(Source("value", text))
        if not isinstance(node, Mapping) or "keys" not in node.entries:
            trial.field(node, field_of(cls, name), name)
    except Unreadable:
        better_alone(trial, {name: node}, cls, name, "", 0)
        return [*nothing.errors] or [Diagnostic("syntax", "", None)]
    except ScriptError as error:
        return [*error.diagnostics]
    return [*nothing.errors]
