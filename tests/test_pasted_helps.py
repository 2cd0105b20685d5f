"""What a help writes, in its place in the script, mends it: no new error arises there.

Helps of tests/errors and tests/newcomers.yaml that write a field with its value, ``write `radius: 2 m` ``, or what it
is in all. One of the places that a reader may mean must do: that of the field, of the word around it, or beside it.
"""

import re
from pathlib import Path

from sceneql import pipeline
from sceneql.language.compose import compose_node
from sceneql.language.tree import Mapping, Scalar, Sequence
from sceneql.quantities.diagnostic import ScriptError
from sceneql.quantities.span import Source
from test_errors import FOLDER
from test_newcomers import MISTAKES

IN_ALL = re.compile(r"in all `([^`]+)`")
OFFER = re.compile(r"(?:write|did you mean|in all) `([\w']+: [^`]+)`")
LONGEST, MOST = 900, 8
"""Longest script, and the largest number of places that are tried."""
ERRORS = sorted(path for path in FOLDER.glob("*.yaml") if b"# options" not in path.read_bytes().partition(b"\n")[0])
NOT_ALONE = {
    "an example's own name": (
        "a list of variants",
        "no-variants",
        "a body without its object",
        "geom of a body",
        "invalid.rigid",
        "joints",
    ),
    "what belongs there is dots": (
        "ball_{i}",
        "for i in range",
        "a name with its number in brackets",
        "part-name.grid",
        "missing-field.template",
        "unknown-field.corners-mixed",
        "unknown-field.own-numbers",
        "unknown-field.third-day",
        "entry-shape.dashes",
    ),
    "it stands in another part, which the help names": (
        "invalid.collisions",
        "invalid.tied",
        "no-collider.mutual-rigid",
        "zoom",
        "a side of a domain",
        "for at the margin",
        "a contact without a name",
        "coefficient of drag",
        "unknown-section.block",
        "unknown-section.misplaced",
        "unknown-output.speed",
        "entry-shape.cameras",
        "unknown-word.template",
        "entry-shape.difference",
        "unknown-word.first-day",
        "unknown-word.other-programs",
        "a list item of words",
        "a spring to a place",
    ),
}
"""Why, and which scripts and mistakes have a help that does not stand alone."""
LEFT_OUT = {one for each in NOT_ALONE.values() for one in each}


def errors(script):
    """The errors and warnings of a script."""
    try:
        return list(pipeline.load(script).warnings)
    except ScriptError as error:
        return list(error.diagnostics)


def entries(node, at):
    """The mappings, and the keys in them, around a place, from the outside in."""
    inner = []
    if isinstance(node, Mapping):
        inner = [(node, key, value) for key, value in node.entries.items()]
    elif isinstance(node, Sequence):
        inner = [(None, None, value) for value in node.items]
    for owner, key, value in inner:
        start = value.start if key is None else owner.keys[key].start
        if start <= at <= max(value.end, start if key is None else owner.keys[key].end):
            return [*([] if key is None else [(owner, key)]), *(entries(value, at) if at >= value.start else [])]
    return []


def put(text, owner, key, snippet, drop=()):
    """The script with a field, and those in ``drop``, replaced by the snippet, and where that stands."""
    spans = [(owner.keys[one].start, max(owner.keys[one].end, owner.entries[one].end)) for one in (key, *drop)]
    (start, end), *others = spans
    if not owner.entries[key].span.text:
        end = text.find(":", owner.keys[key].end) + 1 or end
    if not owner.flow:
        column = start - text.rfind("\n", 0, start) - 1
        snippet = ("\n" + " " * column).join(fields(snippet))
    for low, high in sorted([(start, end), *others], reverse=True):
        own = low == start
        if not own and owner.flow:
            comma = re.compile(r"\s*,\s*").match(text, high)
            low, high = (low, comma.end()) if comma else (len(text[:low].rstrip(" ,")), high)
        text = text[:low] + (snippet if own else "") + text[high:]
        start += low - high if low < start else 0
    return text, start, start + len(snippet)


def fields(snippet):
    """The fields of a snippet, ``a: 1, b: [2, 3]``, one by one."""
    pieces, depth = [""], 0
    for piece in re.split(r"([\[{(]|[\]})]|, (?=[\w']+: ))", snippet):
        depth += (piece in ("[", "{", "(")) - (piece in ("]", "}", ")"))
        if piece == ", " and depth == 0:
            pieces.append("")
        else:
            pieces[-1] += piece
    return pieces


def beside(text, owner, snippet):
    """The script with the snippet behind the last field of a mapping, and where that stands."""
    last = [*owner.entries][-1]
    end = max(owner.keys[last].end, owner.entries[last].end)
    start = owner.keys[last].start
    comma = ", " if owner.flow else "\n" + " " * (start - text.rfind("\n", 0, start) - 1)
    return text[:end] + comma + snippet + text[end:], end, end + len(comma + snippet)


def places(text, told, snippet):
    """The scripts with the snippet in the places that a reader may mean, and where it stands there."""
    field = snippet.partition(":")[0]
    try:
        root = compose_node(Source("script", text))
    except ScriptError:  # the text has to be read before it can be changed
        return
    around = entries(root, told.span.start)[::-1]
    if isinstance(root, Mapping) and field in root.entries:
        around = [*around, (root, field)]
    names = re.findall(r"'([^']+)'", told.message) if " has no field" in told.message else []
    for owner, key in around:
        if key == field:  # what stands beside it and is no field is left out
            yield put(text, owner, key, snippet, [one for one in names if one in owner.entries and one != key])
    for owner, key in around:
        if owner.keys[key].start == told.span.start or key in names:
            drop = [one for one in names if one in owner.entries and one != key]
            yield put(text, owner, key, snippet, drop)
            break
    for owner, key in around:
        value = owner.entries[key]
        if isinstance(value, Scalar) and value.start <= told.span.start <= value.end:
            yield put(text, owner, key, f"{key}: {{{snippet}}}")
            yield put(text, owner, key, snippet)
    for owner, _ in around:
        drop = [one for one in names if one in owner.entries and one != field]
        yield put(text, owner, field, snippet, drop) if field in owner.entries else beside(text, owner, snippet)
    if isinstance(root, Mapping) and field not in root.entries:
        whole = text if text.endswith("\n") else f"{text}\n"
        yield whole + snippet + "\n", len(whole), len(whole + snippet)


def not_mended(script, text):
    """What helps of a script write that gives another error where it stands, with that error."""
    script.write_text(text)
    found = errors(script)
    if all(one.severity == "warning" for one in found):
        return
    before = {(one.code, one.message) for one in found}
    for told in found:
        if told.severity == "warning" or told.span is None or told.help is None or told.span.source.text != text:
            continue
        for snippet in IN_ALL.findall(told.help) or OFFER.findall(told.help):
            wrong, tried = [], []
            for new, start, end in [*places(text, told, snippet)][:MOST]:
                if new in tried:
                    continue
                tried.append(new)
                script.write_text(new)
                wrong = [
                    one.message
                    for one in errors(script)
                    if one.severity == "error"
                    and ((one.code, one.message) not in before or (one.code, one.message) == (told.code, told.message))
                    and (one.span is None or (one.span.start <= end and one.span.end >= start))
                ]
                if not wrong:
                    break
            if wrong:
                yield snippet, wrong


def offers(told: str) -> bool:
    """Whether an error of a text has a help that writes a field."""
    return "error[" in told and any(OFFER.search(line) for line in told.split("\n") if line.startswith("help: "))


def load(path: Path) -> str:
    try:
        return path.read_text()
    except UnicodeDecodeError:
        return ""


def test_what_a_help_of_the_errors_writes_mends_its_place(tmp_path):
    """In the folder of the scripts, whose files they name."""
    wrong = {}
    for path in ERRORS:
        text = load(path)
        if len(text) < LONGEST and offers(path.with_suffix(".txt").read_text()):
            wrong |= {(path.stem, snippet): why for snippet, why in not_mended(tmp_path / "scene.yaml", text)}
    assert {one: why for one, why in wrong.items() if one[0] not in LEFT_OUT} == {}


def test_what_a_help_for_newcomers_writes_mends_its_place(tmp_path):
    wrong = {}
    for name, one in MISTAKES.items():
        found = not_mended(tmp_path / "scene.yaml", one["wrong"])
        wrong |= {(name, snippet): why for snippet, why in found}
    assert {one: why for one, why in wrong.items() if one[0] not in LEFT_OUT} == {}
