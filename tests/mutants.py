"""Scripts and drawings made wrong: tokens of good ones swapped, left out, doubled, or in place of others."""

from __future__ import annotations

import random
import re
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from types import FrameType

from sceneql.quantities.unit_table import KNOWN_UNITS

ROOT = Path(__file__).parents[1]
SCRIPTS = sorted(
    path
    for path in [*ROOT.glob("scenes/*.yaml"), *ROOT.glob("tests/wishes/*.yaml")]
    if "\ninclude:" not in path.read_text(encoding="utf-8")
)
"""Scenes of one file: that another is included would be their only news."""
TOKEN = re.compile(r"[^\W\d]\w*|\d+(?:\.\d+)?(?:[eE][-+]?\d+)?|\n *|[ \t]+|.", re.DOTALL)
NUMBERS = [
    *("0", "-0", "1", "-1", "2", "7", "0.5", "-3.5", "1e300", "-1e300", "1e-300", "1e308", "1e-320", "1e999", "nan"),
    *("inf", ".nan", "-.inf", "1e9", "99999999999", "1e20", "9" * 40, "9" * 5000, "1e" + "9" * 20, "0x10", "0o17"),
    *("1_000", "1,5", "007", "4294967296", "9223372036854775807"),
]
TYPES = [
    *("{}", "[]", "[[]]", "null", "~", "yes", "no", "true", "''", '"a"', "{a: 1}", "[1, 2]", "[1, 2, 3] m", "1 2 3"),
    *("0 0 0 m", "time", "time/(1 s)", "pi", "sqrt(-1)", "1/0", "{keys: {0 s: 0, 1 s: 1}}", "{x: 1 m}", "auto", "red"),
    *("[[1, 2, 3], [4, 5, 6]]", "sphere", "{sphere: {}}", "{sphere: {radius: 1 m}}", "[a, b]", "x", "x^2 + y^2 - 1"),
    *("#ff0000", "1 m", "2 s", "3 kg", "{time:.2f s}", "'{x'", r"\frac{1}{2}", r"'\foo'"),
]
YAML = [
    *("&a ", "*a", "<<: *a", "!!int ", "!x ", "? ", "---\n", "...\n", "|\n", ">-\n", "%YAML 1.2\n", "\x00", "\ufeff"),
    *("\u2028", "\x85", "\t", "#", "'", '"', "{", "}", "[", "]", ":", ",", "-", "- ", ": ", "\\", "@", "`", "\u202e"),
    *("\U0001f600", "e\u0301", "\r", "\\0"),
]
SIGNS = ["+", "-", "*", "/", "^", "(", ")", ".", "..", "<", "==", "=", "%", "·", "²"]
LONG = [
    *("a" * 3000, "1" * 3000, "(" * 300, "-" * 3000, "x+" * 2000 + "x", "[" * 100, "{a: " * 80, "a." * 500),
    *(r"\frac{1}{" * 60, " " * 3000),
]
AROUND = ["{%s}", "[%s]", "{a: %s}", "(%s)", "'%s'", "-%s", "[%s, %s]"]
SPACES = ["\n", "\n  ", "\n    ", "\n      ", " "]


@cache
def vocabulary() -> list[str]:
    """All the names that the good scripts have."""
    return sorted({name for path in SCRIPTS for name in re.findall(r"[^\W\d]\w*", path.read_text(encoding="utf-8"))})


def mutant(rng: random.Random, tokens: list[str]) -> str:
    """A text with one to eight of its tokens wrong."""
    tokens = list(tokens)
    for _ in range(rng.choice([1, 1, 1, 2, 2, 3, 8])):
        at, other = rng.randrange(len(tokens)), rng.randrange(len(tokens))
        match rng.randrange(14):
            case 0:
                tokens[at], tokens[other] = tokens[other], tokens[at]
            case 1:
                del tokens[at : at + rng.randrange(1, 4)]
            case 2:
                tokens[at:at] = tokens[other : other + rng.randrange(1, 12)]
            case 3 | 4 | 5:
                _other(rng, tokens, lambda token: token[0].isdecimal(), NUMBERS)
            case 6:
                _other(rng, tokens, lambda token: token in KNOWN_UNITS, [*KNOWN_UNITS, ""])
            case 7 | 8:
                _other(rng, tokens, str.isidentifier, vocabulary())
            case 9:
                _other(rng, tokens, lambda token: token[0].isalnum(), TYPES)
            case 10:
                tokens[at:at] = [rng.choice(rng.choice([YAML, YAML, SIGNS, LONG]))]
            case 11:
                tokens = _moved(rng, "".join(tokens))
            case 12:
                tokens[at] = rng.choice(AROUND).replace("%s", tokens[at])
            case _:
                _other(rng, tokens, lambda token: token[0] == "\n", SPACES)
        tokens = [token for token in tokens if token] or [" "]
    return "".join(tokens)


def _other(rng: random.Random, tokens: list[str], fits: Callable[[str], bool], others: list[str]) -> None:
    """Another token in place of one that fits."""
    fitting = [k for k, token in enumerate(tokens) if fits(token)]
    if fitting:
        tokens[rng.choice(fitting)] = rng.choice(others)


def _moved(rng: random.Random, text: str) -> list[str]:
    """The tokens of a text of which some lines stand elsewhere."""
    lines = text.splitlines(keepends=True)
    at, other = rng.randrange(len(lines)), rng.randrange(len(lines))
    some = lines[at : at + rng.randrange(1, 4)]
    if rng.random() < 0.5:
        del lines[at : at + len(some)]
    lines[other:other] = [rng.choice(["", "", "  "]) + line for line in some]
    return TOKEN.findall("".join(lines)) or [" "]


def mutants(seed: int, count: int) -> Iterator[tuple[Path, str]]:
    """Scripts made wrong, each with the path of the good one; each of all tokens is as likely to be the wrong one."""
    rng = random.Random(seed)
    read = {path: TOKEN.findall(path.read_text(encoding="utf-8")) for path in SCRIPTS}
    weights = [1.0 / len(read[path]) for path in SCRIPTS]
    for path in rng.choices(SCRIPTS, weights, k=count):
        yield path, mutant(rng, read[path])


class OverTimeError(BaseException):
    """More processor time was taken than is allowed. No handler of errors catches it."""


@contextmanager
def within_seconds(seconds: float) -> Iterator[None]:
    """Raises OverTimeError where the block takes more processor time, as one that hangs does."""

    def stop(number: int, frame: FrameType | None) -> None:
        raise OverTimeError(f"more than {seconds} s of processor time")

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)
