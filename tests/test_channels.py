"""The channels of an island and the integers of kernels are read by name: laws over the syntax trees of all files."""

import ast
import re
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
CHANNELS = ROOT / "sceneql" / "system" / "channels.py"
FILES = sorted(path for room in ("sceneql", "renderers") for path in (ROOT / room).rglob("*.py") if path != CHANNELS)
TEXTS = {path: path.read_text(encoding="utf-8") for path in FILES}


@cache
def nodes(text):
    """The subscripts and the differences of a text's syntax tree."""
    found = list(ast.walk(ast.parse(text)))
    differences = (node for node in found if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Sub))
    return [node for node in found if isinstance(node, ast.Subscript)], list(differences)


def subscripts(text, *names):
    """The subscripts of arrays of these names, or of attributes of these names."""
    for node in nodes(text)[0]:
        if not {getattr(node.value, "id", ""), getattr(node.value, "attr", "")}.isdisjoint(names):
            yield node


def numbered(index):
    """Whether an index is a number, also one below 0 or one times something."""
    if isinstance(index, ast.Slice):
        return any(isinstance(end, ast.UnaryOp) for end in (index.lower, index.upper))
    return isinstance(index, ast.UnaryOp) or (isinstance(index, ast.Constant) and isinstance(index.value, int))


def slots_without_a_name(text):
    """Places of the floats of an island that a text knows by itself: numbers, own constants, counts from the end."""
    if "floats" not in text:
        return []
    found = re.findall(r"floats\[-?[0-9][^\]]*\]", text)
    indices = [node.slice for node in subscripts(text, "floats")]
    found += [ast.unparse(index) for index in indices if numbered(index)]
    found += [index.id for index in indices if isinstance(index, ast.Name) and index.id.isupper()]
    for node in nodes(text)[1]:
        if getattr(node.left, "attr", "") == "size" and ast.unparse(node.left).endswith("floats.size"):
            found += [ast.unparse(node)] * ("channels." not in ast.unparse(node.right))
    return found


@pytest.mark.parametrize(
    "text",
    [
        "a = floats[0]",
        "self.floats[2] = 1.0",
        "a = floats[-2 * n : -n]",
        "AT = 1\na = floats[AT]",
        "base = floats.size - 3 * y.size",
        "lines = ['    floats[0] += 1.0']",
        "def f():\n    '''floats[3]: a [s] in a stage'''",
    ],
)
def test_a_slot_without_a_name_is_found(text):
    assert slots_without_a_name(text)


@pytest.mark.parametrize(
    "text", ["a = floats[channels.STAGE]", "at = floats.size - channels.BASE * n", "floats[at] = 1"]
)
def test_a_slot_by_name_is_none_without(text):
    assert not slots_without_a_name(text)


def test_nobody_but_the_channels_says_where_a_slot_is():
    assert {str(path): found for path, text in TEXTS.items() if (found := slots_without_a_name(text))} == {}


def read_by_number(text, *arrays):
    """Entries of arrays that a text reads by number."""
    if not any(f"{array}[" in text for array in arrays):
        return []
    found = (node for node in subscripts(text, *arrays) if isinstance(node.slice, ast.Constant))
    return [ast.unparse(node) for node in found if isinstance(node.value, ast.Name)]


def test_kernels_read_their_integers_by_name():
    assert read_by_number("a, b = ints[2], ints[COUNT]", "ints") == ["ints[2]"]
    assert {str(path): found for path, text in TEXTS.items() if (found := read_by_number(text, "ints"))} == {}
    kernels = {path: text for path, text in TEXTS.items() if path.stem.endswith("_kernels")}
    of_steps = {str(path): read_by_number(text, "numbers", "settings") for path, text in kernels.items()}
    assert {path: found for path, found in of_steps.items() if found} == {}
