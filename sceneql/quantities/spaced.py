"""Vectors with spaces between formulas, and numbers in brackets behind a list, as others write: for messages alone."""

from __future__ import annotations

import re
from itertools import pairwise

from sceneql.quantities.diagnostic import ScriptError
from sceneql.quantities.expression import Expr, Name, Vector
from sceneql.quantities.operations import CONSTANTS, FUNCTIONS
from sceneql.quantities.span import Span
from sceneql.quantities.unit_table import UNITS
from sceneql.quantities.units import scan_unit

_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
_NAME = re.compile(r"(?<![\w.])[^\W\d][\w.]*")
_EQUATED = re.compile(r"(\w+)\s*=\s*([^={},:]+)$")
_GLUED = re.compile(r"([^\W\d]\w*):([^\s,{}:]+)\s*$")
_FORMULA = re.compile(r"[-+]?[\w.(]")
_JOINS = tuple("+*/^<>=,")
_INDEX = re.compile(r"\[\s*(\d+)\s*\](?!\.)")
_COPY = re.compile(r"\[\s*([^\[\]{}\"']+?)\s*\](\.[\w.]+)?")
_LINKED = re.compile(r"[^\W\d]\w*(?:\.\w+)+")
_DOLLAR = re.compile(r"\$(?:\{\s*)?([^\W\d][\w.]*)(?:\s*\})?")
AXES = "xyz"
VECTORS = ("position", "velocity", "acceleration", "spin", "force", "torque", "momentum", "center")
"""Outputs that are vectors of three."""
LONGEST = 200
"""Longest text in which a range is looked for, in a time that goes by the square of that."""
OVER_TIME = ("energy", "kinetic", "potential", "mass", "volume", "angle", "speed")
"""Outputs that are one number at each instant."""
_CALLED = re.compile(
    r"(?:new\s+)?(?:\w+\.)*\w*?(?:vec|vector|point|array|float3|tuple)\w*\(\s*[\[(]?([^()\[\],]+(?:,[^()\[\],]+){1,2})[\])]?\s*\)",
    re.IGNORECASE,
)
_SIGNED, _UNIT = r"([-+]?\d*\.?\d+)", r"([^\W\d][\w/^*]*|°)?"
_RANGE = re.compile(rf"\s*{_SIGNED}\s*{_UNIT}\s*(?:\.\.\.?|–|\bto\b|(?<=\w)-)\s*{_SIGNED}\s*{_UNIT}\s*")
_DRAWN = re.compile(
    rf"(?:\w+\.)*(?:rand|random|randint|randrange|uniform|rand_range|random_range|between|range)?"
    rf"[\[(]\s*{_SIGNED}\s*{_UNIT}\s*,\s*{_SIGNED}\s*{_UNIT}\s*[\])]\s*(\*?\s*[^\W\d][\w/^*]*)?",
    re.IGNORECASE,
)
_ABOUT = re.compile(rf"\s*{_SIGNED}\s*{_UNIT}\s*(?:±|\+/?-)\s*{_SIGNED}\s*{_UNIT}\s*")
_CHOICE = re.compile(r"([^?:]+)\?([^?:]+):([^?:]+)")
_IF_ELSE = re.compile(r"(.+?)\s+if\s+(.+?)\s+else\s+(.+)")
_RAISED = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
_TERM = r"(\d[\d.]*\s+[a-zA-Z]+(?![\w(])|[\w.]+|\([^()]*\))"
_LAMBDA = re.compile(
    r"\s*(?:lambda\s+[\w, ]*:|\(?[\w, ]*\)?\s*=>|function\s*\([\w, ]*\)\s*\{?\s*return)\s*(.+?)[;}\s]*"
)
_REST, _QUOTIENT = re.compile(rf"{_TERM}\s*%\s*{_TERM}"), re.compile(rf"{_TERM}\s*//\s*{_TERM}")
_PER = re.compile(r"\s+per\s+(sec(?:ond)?s?|s|min(?:ute)?s?|hours?|h|m|meters?|metres?)\b")
_UNITS_BELOW = {"sec": "s", "min": "min", "hou": "h", "met": "m"}
_RATE = re.compile(r"\bfps\s*:\s*(\d+(?:\.\d+)?)(?![\w.])")
TIMES, FRAMES = ("t", "T"), ("F", "FF")
"""Variables of other programs, behind a `$`: the time, and the frame's number."""
USUAL = "30"
"""Frames a second of a film that says nothing else."""
BARS = 2
"""Number of bars around an absolute value."""
LONGEST = 500
"""Longest text in which habits of other programs are looked for."""
SIZE = 3
"""Components of the vectors that are recognised."""
_LOOPED = re.compile(r"\[(.+)\s+for\s+(\w+)\s+in\s+(?:np\.|numpy\.)?(?:range|arange)\(\s*([-\d,\s]+)\)\s*\]")
NONE = "values have no loops"
MOST_ITEMS, LONGEST_LIST = 16, 480
"""Largest number of items that a message writes out, and of their characters."""


def bracketed(text: str, span: Span) -> str | None:
    """Three components apart by spaces, and their unit, as a list: ``[0 m, r, 0 m]`` for ``0 r 0 m``; else None."""
    pieces = _pieces(text)
    unit = ""
    if len(pieces) == SIZE + 1 and pieces[-1][:1].isalpha():
        unit = pieces.pop()
        try:
            if scan_unit(unit, 0, span)[1] != len(unit):
                return None
        except ScriptError:
            return None
    plain = [_NUMBER.fullmatch(piece) is not None for piece in pieces]
    if (not unit and sum(plain) < SIZE - 1) or any(_FORMULA.match(piece) is None for piece in pieces):
        return None
    if len(pieces) != SIZE or all(plain) or not any(plain) or not text.isascii():
        return None
    for number, piece in pairwise(pieces):  # 1 m*sin 3
        word = _NAME.match(piece) if _NUMBER.fullmatch(number) else None
        name = piece in UNITS and unit in UNITS and UNITS[piece][1] != UNITS[unit][1]  # 0 h 0 m, a height
        if word is not None and word.group() in UNITS and not name:
            return None
    if any(piece.startswith(_JOINS) or piece.endswith((*_JOINS, "-")) for piece in pieces):
        return None
    return f"[{', '.join(_with(piece, unit, one) for piece, one in zip(pieces, plain, strict=True))}]"


def _with(piece: str, unit: str, plain: bool) -> str:
    """A component with the unit, unless names in it have theirs."""
    if plain or not unit:
        return f"{piece} {unit}".rstrip()
    names = [name for name in _NAME.findall(piece) if name not in FUNCTIONS and name not in CONSTANTS]
    if names and not any(name in FUNCTIONS for name in _NAME.findall(piece)):
        return piece
    return f"{piece}*(1 {unit})"


def _pieces(text: str) -> list[str]:
    """The pieces of a text between spaces outside of brackets; a unit that is a piece by itself, too."""
    pieces, depth = [""], 0
    for character in text.strip():
        depth += (character in "([{") - (character in ")]}")
        if character.isspace() and depth == 0:
            pieces.append("")
        else:
            pieces[-1] += character
    return [piece for piece in pieces if piece]


def two_ends(text: str) -> str | None:
    """Two numbers with the sign of a range between them, or as a chance between them, as a vector of two.

    ``-30 30`` for ``-30..30``, ``1 3 s`` for ``1 s to 3 s``, ``[1 s, 3 s]`` and ``random(1, 3) s``; None of others.
    """
    found = (_RANGE.fullmatch(text) or _DRAWN.fullmatch(text)) if len(text) <= LONGEST else None
    if found is None or (found[2] and found[4] and found[2] != found[4]):
        return None
    behind = found[5] if found.re is _DRAWN else None
    unit = (found[4] or found[2] or behind or "").lstrip("* ").replace("°", "deg")
    return f"{found[1]} {found[3]} {unit}".strip()


def declared(script: str, name: str) -> str | None:
    """The help for a name whose definition is a comment here: ``#declare R = 0.5;``, ``#define R 0.5``."""
    found = re.search(rf"^#(?:declare|local|define)\s+{re.escape(name)}\s*=?\s*([^;\n]+)", script, re.MULTILINE)
    if found is None:
        return None
    return f"a line that begins with `#` is a comment: write `define: {{{name}: {found[1].strip()}}}`"


def in_formula(text: str) -> str:
    """The help for a vector without brackets in a formula: ``p + 0 1 0 m``."""
    told = "in a formula a vector has brackets, and each of its numbers the unit"
    found = re.search(
        rf"(?<![\w.])({_NUMBER.pattern})\s+({_NUMBER.pattern})\s+({_NUMBER.pattern})\s*([^\W\d][\w/^]*)?", text
    )
    if found is None:
        return f"{told}: `p + [1 m, 0 m, 0 m]`"
    vector = ", ".join(f"{found[k]} {found[4] or ''}".strip() for k in (1, 2, 3))
    return f"{told}: write `{(text[: found.start()] + f'[{vector}]' + text[found.end() :]).strip()}`"


def between_times(text: str) -> str | None:
    """The help for two times with the sign of a range between them where a formula says when: ``1 s to 2 s``."""
    ends = (two_ends(text) or "").split()
    if len(ends) != 3 or ends[2] not in ("s", "ms", "min", "h"):
        return None
    low, high, unit = ends
    return f"from when to when is two conditions: `(time > {low} {unit})*(time < {high} {unit})`"


def mean_and_more(text: str) -> tuple[str, str, str] | None:
    """The mean, the deviation and the unit of ``2 +- 1 s``; None of other texts."""
    found = _ABOUT.fullmatch(text)
    if found is None or (found[2] and found[4] and found[2] != found[4]):
        return None
    return found[1], found[3], (found[4] or found[2] or "").replace("°", "deg")


def apart(text: str) -> str | None:
    """The unit with its letters apart that a unit with a prefix was meant as: ``m*s^-2`` for ``ms^-2``; else None.

    Of ``ms`` the first letter is a unit, too, and another one.
    """
    found = re.search(r"(?<![\w.])([^\W\d_])([^\W\d_]{1,3})(?![\w.])", text)
    while found is not None:
        if found[1] in UNITS and found[2] in UNITS and found[0] in UNITS:
            return f"{text[: found.start()]}{found[1]}*{text[found.start(2) :]}"
        found = re.compile(r"(?<![\w.])([^\W\d_])([^\W\d_]{1,3})(?![\w.])").search(text, found.end())
    return None


def by_frame(text: str, name: str, script: str) -> str | None:
    """The help for a time or a frame's number of other programs, ``6 deg*$F``: by the script's frames a second."""
    if name in TIMES:
        return f"the time is `time`: write `{text.strip().replace(f'${name}', 'time')}`"
    if name not in FRAMES:
        return None
    rate = _RATE.search(script)
    meant = f"time*({USUAL if rate is None else rate[1]} Hz)"
    whole = f"({meant})" if re.search(rf"(?:/\s*\${name}\b|\${name}\s*(?:\^|\*\*))", text) else meant
    return f"a frame's number goes by the time: write `{re.sub(rf'[$]{name}(?![A-Za-z0-9_])', whole, text.strip())}`"


def at_rate(help: str | None, script: str) -> str | None:
    """A help that tells frames by the usual rate, with the rate of the script's clock."""
    rate = _RATE.search(script)
    if help is None or rate is None or float(rate[1]) <= 0:
        return help
    fps = rate[1]
    help = help.replace(f"`{USUAL} Hz*time`, where {USUAL} is the `fps` of the clock", f"`{fps} Hz*time`")
    help = help.replace(
        f"12 of {USUAL} a second is at `0.4 s`", f"12 of {fps} a second is at `{12 / float(fps):.4g} s`"
    )
    return help.replace(f"{USUAL} Hz*time", f"{fps} Hz*time").replace(f"fps: {USUAL}}}", f"fps: {fps}}}")


def less(text: str, other: str) -> str:
    """The difference of two formulas as a text: ``x^2 - 1``, ``x^2 - (y + 1)``."""
    text, other = text.strip(), other.strip()
    if other in ("0", "0.0"):
        return text
    text = f"({text})" if re.search(r"[<>=?]", text) else text
    return f"{text} - ({other})" if re.search(r"[-+<>=?]", other) else f"{text} - {other}"


def meant_by_equals(text: str) -> str | None:
    """The help for an equation in place of a formula: the value alone, or the formula whose zeros it has."""
    sides = text.split("=")
    if len(sides) != 2 or not all(one.strip() for one in sides) or sides[0][-1] in "<>!":
        return None
    name, value = (one.strip() for one in sides)
    if name not in ("x", "y", "z") and re.fullmatch(r"[^\W\d][\w.']*(?:/d\w+)?|\w+\([\w, ]*\)", name):
        return f"a value stands alone behind the colon of its field: write `{value}`; `==` compares"
    return f"a surface is where its formula is 0, and inside it is below: write `{less(name, value)}`; `==` compares"


def without_dots(text: str) -> str | None:
    """The help for operators with a dot, which in other programs work by element: ``x.^2``."""
    plain = re.sub(r"\.(?=[*/^])", "", text)
    return (
        f"operators have no dot: write `{plain.strip()}`"
        if plain != text and "." not in re.sub(r"\d\.\d*|\w\.\w", "", plain)
        else None
    )


def other_signs(text: str) -> str | None:
    """The help for signs of other programs in a formula: ``|x|``, ``a % b``, ``@(t, x) -x``."""
    handle = re.match(r"\s*@\([^()]*\)\s*", text)
    if handle is not None and text[handle.end() :].strip():
        return f"write the formula alone, `{text[handle.end() :].strip()}`"
    if text.count("|") == BARS:
        plain = re.sub(r"[|]([^|]+)[|]", r"abs(\1)", text.strip())
        return f"write `{plain}`"
    whole = re.fullmatch(r"\s*([\w.()*/ ]+?)\s*%\s*([\w.]+(?:\s*[a-zA-Z]+)?)\s*", text)
    return None if whole is None else f"write `mod({whole[1]}, {whole[2]})`"


def ternary(text: str) -> str | None:
    """A choice of other languages, ``c ? a : b`` or ``a if c else b``, as ``where(c, a, b)``; None of other texts."""
    if len(text) > LONGEST:
        return None
    if (inner := re.fullmatch(r"\s*\[([^\[\]]*)\]\s*", text)) is not None:  # each component by itself
        parts = [part.strip() for part in re.split(r",(?![^()]*\))", inner[1])]
        chosen = [ternary(part) or part for part in parts]
        return f"[{', '.join(chosen)}]" if chosen != parts else None
    found = _CHOICE.fullmatch(text.strip())
    if found is not None:
        return f"where({found[1].strip()}, {found[2].strip()}, {found[3].strip()})"
    found = _IF_ELSE.fullmatch(text.strip())
    if found is None:
        return None
    condition = modulo(found[2].strip()) or found[2].strip()
    return f"where({condition}, {found[1].strip()}, {found[3].strip()})"


def typed_plainly(text: str) -> str | None:
    """A text with signs of print as a keyboard has them, ``m*s^-1`` for ``m·s⁻¹``; None where others are left."""
    raised = re.sub(r"[⁻¹²³⁰⁴-⁹]+", lambda one: "^" + one[0].translate(_RAISED), text.strip())
    plain = re.sub(r"\s*[×·⋅]\s*", "*", raised).replace("−", "-")
    return plain if plain.isascii() else None


def without_lambda(text: str) -> str | None:
    """The formula of a function without a name, ``lambda x, y: x^2``, ``(x) => x^2``; None of other texts."""
    found = re.fullmatch(
        r"\s*(?:lambda\s+[\w, ]*:|\(?[\w, ]*\)?\s*=>|function\s*\([\w, ]*\)\s*\{?\s*return)\s*(.+?)[;}\s]*", text
    )
    return None if found is None else found[1]


def modulo(text: str) -> str | None:
    """A formula with the signs of other languages for rests and whole quotients as functions; None without any."""
    if len(text) > LONGEST:
        return None
    plain = _REST.sub(r"mod(\1, \2)", _QUOTIENT.sub(r"floor(\1/\2)", text.strip()))
    return None if plain == text.strip() or re.search(r"%|//", plain) else plain


def per_unit(text: str) -> str | None:
    """A text with a bar for each ``per``, ``90 deg/s`` for ``90 deg per second``; None where there is none."""
    plain = _PER.sub(lambda one: f"/{_UNITS_BELOW.get(one[1][:3], one[1])}", text.strip())
    return None if plain == text.strip() else plain


def vector_called(text: str) -> str | None:
    """The vector that a call of other programs makes, as ``new THREE.Vector3(0, 1, 0)``, in brackets; else None."""
    found = _CALLED.fullmatch(text.strip()) if len(text) <= LONGEST else None
    numbers = [] if found is None else [one.strip() for one in found[1].split(",")]
    return f"[{', '.join([*numbers, '0'][:SIZE])}]" if numbers else None


def parted_meant(line: str) -> str | None:
    """The help for a line that ends in a name without a value: by an equals sign, or by a colon without a space."""
    glued, written = _GLUED.search(line), _EQUATED.search(line)
    if written is not None:
        return f"a name has a colon behind it: write `{written[1]}: {written[2].strip()}`"
    return None if glued is None else f"write `{glued[1]}: {glued[2]}`, with a space behind the colon"


def named_by_dollar(text: str, at: int) -> str | None:
    """The help for a name behind a dollar at ``at`` in a text, ``$r`` or ``${r}``; None of Houdini's own."""
    found = _DOLLAR.match(text, at)
    if found is None or found[1] in ("T", "F", "t", "time"):
        return None
    return f"a name stands by itself: write `{text[:at]}{found[1]}{text[found.end() :]}`"


def indexed(expr: Expr, before: str, text: str, at: int) -> str | None:
    """The help for brackets at ``at`` in a text behind an expression, whose last token is ``before``; else None."""
    if isinstance(expr, Vector):
        found = _COPY.match(text, at)
        if found is None or found[2] or expr.span is None or not expr.items:
            return None
        take = "item" if isinstance(expr.items[0], Vector) else "component"
        return f"write `{take}({expr.span.text}, {found[1]})`"
    if not isinstance(expr, Name) and not _LINKED.fullmatch(before):
        return None
    if (index := _INDEX.match(text, at)) is not None:
        whole = f"item({before}, {index[1]})"
        if before.rpartition(".")[2] in VECTORS and int(index[1]) < len(AXES):
            return f"write `{before}.{AXES[int(index[1])]}`"
        if int(index[1]) >= len(AXES) or before.endswith("s"):  # positions, radii of a list
            return f"write `{whole}`"
        if index[1] == "0" and before.rpartition(".")[2] in OVER_TIME:
            return f"at the start of the run it is `initial({before})`, at its end `final({before})`"
        return f"write `{before}.{AXES[int(index[1])]}`, or of a list `{whole}`"
    if (copy := _COPY.match(text, at)) is None:
        return None
    number, rest = copy[1], copy[2] or ""
    if number == "-1" and not rest:
        return f"at the end of the run it is `final({before})`"
    of_copies = f'a copy\'s number stands in braces: write `"{before}.{{{number}}}{rest}"`'
    if number.isdecimal():
        of_copies = f"a copy's number stands behind a dot: write `{before}.{number}{rest}`"
    if rest:
        return of_copies
    if "." in before:
        return f"an item of a list is `item({before}, {number})`; {of_copies}"
    inner = f"({before}, {number})"
    return f"of a list of numbers it is `component{inner}`, of vectors `item{inner}`; {of_copies}"


def _components(text: str) -> list[str]:
    """The pieces of a text between commas outside of brackets."""
    pieces, depth = [""], 0
    for character in text:
        depth += (character in "([") - (character in ")]")
        pieces, rest = ([*pieces, ""], "") if character == "," and depth == 0 else (pieces, character)
        pieces[-1] += rest
    return pieces


def written_out(text: str) -> str | None:
    """The help for ``[2*i for i in range(3)]``: its items one by one, or how many there are; None of other texts."""
    found = _LOOPED.search(text) if len(text) <= 1000 else None
    numbers = [] if found is None else [int(one) for one in found[3].split(",") if one.strip().lstrip("-").isdecimal()]
    if found is None or not 1 <= len(numbers) <= 3 or (len(numbers) == 3 and numbers[2] == 0):
        return None
    counted = range(*numbers)
    place = found[1].strip()
    if place.startswith("[") and place.endswith("]") and len(numbers) == 1:
        point = ", ".join(f'"{one.strip()}"' if "(" in one else one.strip() for one in _components(place[1:-1]))
        whole = f"[{{repeat: {{count: {numbers[0]}, as: {found[2]}}}, point: [{point}]}}]"
        return f"{NONE}: places that are computed stand in a list as `{whole}`"
    items = [re.sub(rf"(?<![\w.]){found[2]}\b", str(k), found[1].strip()) for k in counted[:MOST_ITEMS]]
    whole = f"[{', '.join(items)}]"
    if len(counted) <= MOST_ITEMS and len(whole) <= LONGEST_LIST:
        return f'{NONE}: write its items one by one, `"{whole}"`'
    shown = f"`{items[0]}`, `{items[1]}`, ..." if len(items) > 1 else f"`{whole}`"
    parts = f"of parts made by `repeat: {{count: {len(counted)}, as: {found[2]}}}` each has its own formula"
    return f"{NONE}: write all {len(counted)} items one by one, {shown}; {parts}: `sceneql words repeat`"
