"""Translation of the YAML parser's errors to diagnostics in our words, with our caret."""

from __future__ import annotations

import re
from typing import Final

import yaml

from sceneql.language.behind_quotes import told_behind
from sceneql.quantities.diagnostic import Diagnostic, Note
from sceneql.quantities.spaced import ternary
from sceneql.quantities.span import Source, Span

_UNPRINTABLE = re.compile("[^\t\n\r -~\x85\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")

# (words of libyaml's or PyYAML's message, our message, our help)
_PROBLEMS: Final = (
    (
        "block sequence entries are not allowed",
        "a list item cannot begin here",
        "put `- ` on a line of its own, below its key; a text that begins with a dash goes in quotes",
    ),
    ("could not find expected :", "a key without a colon", "write `name: value`, or `name:` with its fields below"),
    ("<document start>", "this stands behind the end of the script", "put a space behind the colon of a key"),
    ("alphabetic or numeric", "a name must follow & or *", "a text that begins with & or * goes in quotes"),
    (
        "did not find expected key",
        "this does not line up with what stands above",
        "begin the keys of one mapping in the same column",
    ),
    ("<block end>", "this does not line up with what stands above", "begin the keys of one mapping in the same column"),
    ("- indicator", "this does not line up with the list above", "begin its items with `- `, in the same column"),
    ("node content", "a value is missing before this", "a text that begins so goes in quotes"),
    ("comment or", "nothing but a comment may follow | or > on its line", "put the text below, indented, or in quotes"),
    ("indentation indicator", "this cannot follow | or >", "put the text below, indented, or in quotes"),
    (
        "directive",
        "a line that begins with % is a YAML directive, and a script has none",
        "a comment begins with `#`; a text goes in quotes",
    ),
    ("tag", "a tag (!) means nothing in a script", "a text that begins with ! goes in quotes"),
)
_NO_KEY = re.compile(r"(?:^|[,{\n\r])[ \t]*\Z")
_PARTED = re.compile(r"([^{},\[;]+);\s*([^\s;,{}\[\]]+)$")
_QUOTED = re.compile(r"(['\"])[-+.\d][^'\",{}\[\]\n]*\1\s*$")
"""A number in quotes, before another."""
_KEY: Final = "write `name: value`"
_LONGEST: Final = 1024
"""Largest length of a key (YAML 1.2, 7.4: implicit keys)."""
_HOLDING = re.compile(r"\s*(?:- )?[\w.]+:\s+(?P<quote>[\"'])(?P<text>.*)(?P=quote)\s*")
"""A line whose value is a text in quotes."""


def unprintable(text: str) -> int | None:
    """Offset of the first character that YAML does not allow; None if there is none."""
    found = _UNPRINTABLE.search(text)
    return None if found is None else found.start()


def place(source: Source, error: yaml.YAMLError) -> int:
    """Offset of the character at which the parser fails."""
    size = len(source.text)
    return min(_index(error, "problem_mark", size), size)


def explain(source: Source, error: yaml.YAMLError, flow: int | None) -> Diagnostic:
    """The diagnostic for an error of the parser, `yaml-syntax` as a rule.

    ``flow`` is where the outermost flow collection that is still open begins, if there is one.
    """
    problem = str(getattr(error, "problem", None) or "")
    context = str(getattr(error, "context", None) or "")
    at = place(source, error)
    since = min(_index(error, "context_mark", at), at)
    if "quoted scalar" in context and "escape" not in problem:
        ended = re.compile(r'"[^"\n]*\\[^"\n]*"').match(source.text, since)
        if ended is not None and "\\" in ended[0]:
            plain = ended[0][1:-1].replace("\\\\", "\\")
            better = plain.replace("\\", "/") if re.match(r"[A-Za-z]:|\.", plain) else plain
            text = "in double quotes a backslash begins a sign of YAML's"
            return _syntax(text, source, since, f"write single quotes: `'{better}'`")
        return _syntax("this quote is never closed", source, since, "end the text with the same quote")
    if "escape" in problem and source.text[at - 1 : at] == "\\":
        at -= 1
    if source.text[at : at + 1] == ":" and _NO_KEY.search(source.text[max(0, at - 80) : at]) is not None:
        return Diagnostic("key-not-text", "a key is missing before this colon", Span(source, at, at + 1), _KEY)
    if (long := _long_key(source.text, at, flow)) is not None:
        help = "a name is short: say more in a comment behind it"
        return _syntax(f"a key of {at - long:,} letters; it may have {_LONGEST:,}", source, long, help)
    if (told := told_behind(source.text, at)) is not None:
        help = f"a text has its values in braces: write `{told}`"
        return _syntax("nothing can stand behind this quote", source, at, help)
    if (other := _in_quotes(source, at)) is not None:
        help = f"a text with quotes in it stands in the other ones: write `{other}`"
        return _syntax("this quote ends the text", source, at - 1, help)
    if "escape" in problem:
        start, end = source.text.rfind('"', 0, at), source.text.find('"', at)
        inside = source.text[start + 1 : end]
        help = "use single quotes: they take it as it is"
        if 0 <= start < end and "\n" not in inside:
            help = f"in single quotes it stands for itself: write `'{inside}'`"
        return _syntax("this backslash means nothing in double quotes", source, at, help)
    if flow is not None:
        return _in_flow(source, at, since if source.text[since : since + 1] in ("[", "{") else flow)
    character = source.text[at : at + 1]
    if (tab := _tab(source, at)) is not None:
        return _syntax("a tab cannot indent a line", source, tab, _spaces(source, tab))
    if character in ("}", "]"):
        return _syntax(f"this `{character}` closes nothing", source, at, "leave it out")
    if "cannot start any token" in problem:
        message = f"a text cannot begin with `{character}`"
        return _syntax(message, source, at, "put it in quotes")
    problem = problem.replace("'", "")
    if "mapping values are not allowed" in problem:
        return _misplaced_colon(source, at)
    for words, message, help in _PROBLEMS:
        if words in problem:
            return _syntax(message, source, at, help)
    return _syntax("this is not YAML", source, at, f"the parser says: {problem or error}")


def _in_quotes(source: Source, at: int) -> str | None:
    """The text of a line whose quotes end too early, for it holds some itself, ``"It's a "ball""``, as it is meant."""
    line = source.line(source.position(at)[0])
    found = _HOLDING.fullmatch(line)
    if found is None or source.text[at - 1 : at] != found["quote"] or found["quote"] not in found["text"]:
        return None
    other = "'" if found["quote"] == '"' else '"'
    if found["text"].count(found["quote"]) % 2 or ":" in found["text"]:  # two texts side by side
        return None
    inner = found["text"].replace("'", "''") if other == "'" else found["text"].replace('"', '\\"')
    return f"{other}{inner}{other}"


def _long_key(text: str, at: int, flow: int | None) -> int | None:
    """Offset of a key that ends at the colon ``at`` and is too long for the parser; None for other colons."""
    if text[at : at + 1] != ":" or at - 1 <= _LONGEST or text[at - 1].isspace():
        return None
    if text[at - 1] in "'\"":
        start = text.rfind(text[at - 1], 0, at - 1)
    else:
        start = 1 + max(text.rfind(one, 0, at) for one in ("\n" if flow is None else "\n,[{"))
        start += len(text[start:at]) - len(text[start:at].lstrip())
    return start if at - start > _LONGEST else None


CLOSING = {"[": "]", "{": "}", "(": ")", "]": "[", "}": "{"}
"""Brackets and those that go with them."""


def _innermost(text: str) -> str | None:
    """The last bracket of a text that is open, outside of quotes; None for none."""
    opened: list[str] = []
    for character in re.sub(r"\"[^\"]*\"|'[^']*'", "", text):
        if character in "[{":
            opened.append(character)
        elif character in "]}" and opened:
            opened.pop()
    return opened[-1] if opened else None


def _in_flow(source: Source, at: int, opening: int) -> Diagnostic:
    if at < len(source.text) and source.position(at)[0] == source.position(opening)[0]:
        if (braces := _for_braces(source.text[opening:at])) is not None:
            return _syntax("fields stand in braces, not in parentheses", source, at, braces)
        if source.text[at : at + 1] in CLOSING and (open_one := _innermost(source.text[opening:at])) is not None:
            close = CLOSING[open_one]
            help = f"write `{close}` before it, which closes `{open_one}`"
            return _syntax(f"'{source.text[at]}' closes no '{open_one}'", source, at, help)
        if (named := re.match(r"[%@`]([^\W\d]\w*)", source.text[at:])) is not None:
            return _syntax("a name stands by itself", source, at, f"write `{named[1]}`")
        if source.text[at : at + 1] == ":":
            help = "a text that holds a colon goes in quotes; items are separated by commas"
            value = source.text[opening:at].rpartition(": ")[2]
            rest = re.split(r"[,}\n]", source.text[at + 1 :], maxsplit=1)[0]
            if (chosen := ternary(f"{value}:{rest}")) is not None:
                return _syntax("a choice is written otherwise", source, at, f'write `"{chosen}"`')
            if re.fullmatch(r"[A-Z][\w ]*", value.strip()) is not None and source.text[at + 1 : at + 2] == " ":
                help = f'a text that holds a colon goes in quotes: write `"{value.strip()}:{rest.rstrip()}"`'
            if (parted := _PARTED.search(source.text[opening:at])) is not None:
                help = f"fields are separated by commas: write `{parted[1].strip()}, {parted[2]}: ...`"
            return _syntax("a second colon in this value, where no key can stand", source, at, help)
        if (quoted := _QUOTED.search(source.text[opening:at])) is not None:
            more = re.match(r"(?:\s*['\"][^'\",{}\[\]\n]*['\"])+", source.text[at:])
            items = re.findall(r"['\"]([^'\"]*)['\"]", quoted[0] + (more[0] if more else ""))
            help = f"a vector stands without quotes: write `{' '.join(items)}`, its unit behind the last number"
            return _syntax("this does not belong here, or a comma is missing before it", source, at, help)
        help = "separate the items by commas; an expression with brackets goes in quotes"
        return _syntax("this does not belong here, or a comma is missing before it", source, at, help)
    bracket = source.text[opening : opening + 1]
    note = Note("reading stopped here", Span(source, at, at + 1))
    closing = "]" if bracket == "[" else "}"
    return _syntax(f"this `{bracket}` is never closed", source, opening, f"close it with `{closing}`", note)


def _for_braces(before: str) -> str | None:
    """The help for a colon behind the first of some fields that stand in parentheses."""
    found = re.search(r"\(\s*(\w+)\s*$", before)
    return None if found is None else f"write `{{{found[1]}: ...}}`"


def _misplaced_colon(source: Source, at: int) -> Diagnostic:
    number, column = source.position(at)
    before = source.line(number)[: column - 1]
    if (braces := _for_braces(before)) is not None:
        return _syntax("fields stand in braces, not in parentheses", source, at, braces)
    if ": " in before:
        help = "put a text that holds a colon in quotes, or begin a new line after the first colon"
        return _syntax("a second colon on this line, where no key can stand", source, at, help)
    help = "begin it in the column of the keys above, or end the line above with a colon"
    start = at - len(before.lstrip())
    span = Span(source, start, at)
    return Diagnostic("yaml-syntax", "no key can stand here: the line above ends in a value", span, help)


def _index(error: yaml.YAMLError, name: str, default: int) -> int:
    mark = getattr(error, name, None)
    return default if mark is None else int(mark.index)


def _tab(source: Source, at: int) -> int | None:
    """Offset of a tab in the indentation of the line of ``at``, or of the line before; None if there is none."""
    line = source.position(at)[0]
    for number in (line, line - 1):
        if number >= 1:
            text = source.line(number)
            blank = text[: len(text) - len(text.lstrip())]
            if "\t" in blank:
                return source.line_starts[number - 1] + blank.index("\t")
    return None


def _spaces(source: Source, tab: int) -> str:
    """The help for a tab in an indentation: as many spaces as the line above tells."""
    above = [line for line in source.text[:tab].split("\n")[:-1] if line.strip() and not line.lstrip().startswith("#")]
    if not above or "\t" in above[-1]:
        return "use spaces: two for each level"
    own = len(above[-1]) - len(above[-1].lstrip())
    inside = above[-1].rstrip().endswith(":")
    why = "two more than the line above" if inside else "as many as the line above"
    return f"use spaces: write {own + 2 * inside} of them before this line, {why} has"


def _syntax(message: str, source: Source, at: int, help: str, *notes: Note) -> Diagnostic:
    return Diagnostic("yaml-syntax", message, Span(source, at, at + 1), help, notes)
