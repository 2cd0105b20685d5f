"""The house in numbers: how files stand in rooms, which import which, what contracts hold. `python tests/house.py`."""

import ast
import re
import tomllib
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from modules import ROOT, House

PHYSICS = ("models", "forces", "contacts", "solvers")
TERMS = {"auto", "emission", "equations", "exact", "flow", "force"}
"""Words of physics that are terms of the field, too."""
IGNORED = re.compile(r"^# mypy: ignore-errors", re.MULTILINE)
FACES = {"sceneql", "sceneql.kinds", "sceneql.system"}
"""Rooms whose __init__.py hands names on."""


def room_shares(house):
    """Part of all lines, by room: a folder right under sceneql/ or renderers/."""
    found = Counter()
    for file in house.files:
        if len(file.path.parts) > 2:
            found["/".join(file.path.parts[:2])] += file.lines
    whole = sum(file.lines for file in house.files)
    return Counter({room: lines / whole for room, lines in found.items()})


def loose_files(house):
    """Files beside sub-rooms, and files of flat rooms, by folder; to list a family's folder is to list its words."""
    files = Counter(file.path.parent for file in house.files if not file.is_room)
    rooms = {file.path.parent for file in house.files if file.is_room}
    beside, flat = Counter(), Counter()
    for room in rooms:
        if room.parent != Path("sceneql/words"):
            (beside if any(other.parent == room for other in rooms) else flat)[room.as_posix()] = files[room]
    return beside, flat


def circles(graph):
    """Sets of modules that reach each other (Tarjan 1972)."""
    index, low, stack, found = {}, {}, [], []

    def visit(node):
        index[node] = low[node] = len(index)
        stack.append(node)
        for other in sorted(graph[node]):
            if other not in index:
                visit(other)
            if other in stack:
                low[node] = min(low[node], low[other])
        if low[node] == index[node]:
            at = stack.index(node)
            found.append(sorted(stack[at:]))
            del stack[at:]

    for node in sorted(graph):
        if node not in index:
            visit(node)
    return sorted(circle for circle in found if len(circle) > 1)


def lazy_links(house):
    """Strings that close a circle of imports and strings: (module where the string stands, module that it names)."""
    both = {module: house.imports[module] | house.links[module] for module in house.imports}
    of = {module: number for number, circle in enumerate(circles(both)) for module in circle}
    arrows = ((one, other) for one, named in house.links.items() for other in named - house.imports[one])
    return sorted((one, other) for one, other in arrows if one in of and of[one] == of.get(other))


def layers():
    """By module that the linter knows: its layer, 0 at the top, and whether it is apart from those beside it."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    rows = project["tool"]["importlinter"]["contracts"][0]["layers"]
    return {name: (number, "|" in row) for number, row in enumerate(rows) for name in re.split(r"\s*[|:]\s*", row)}


def arrows_up(house):
    """Imports and strings that lead to a layer above their own, or to another module of it that is to be apart."""
    place = layers()

    def known(module):
        while module and module not in place:
            module = module.rpartition(".")[0]
        return module

    found = []
    for one, named in house.imports.items():
        for other in named | house.links[one]:
            here, there = known(one), known(other)
            if here and there and here != there:
                (level, apart), (above, _) = place[here], place[there]
                if above < level or (above == level and apart):
                    found.append((one, other))
    return sorted(found)


def misplaced_words(house):
    """Files in words/ that are neither a word by the one rule nor kernels."""
    known = {f"sceneql.words.{family}.{word}" for family, words in house.words.items() for word in words}
    files = [file.module for file in house.files if file.module.startswith("sceneql.words.") and not file.is_room]
    return [module for module in files if module not in known and not module.endswith("_kernels")]


def shared_names(house):
    """Names of several files that are no word's."""
    words = {word for family in house.words.values() for word in family}
    count = Counter(file.path.stem for file in house.files if not file.is_room)
    return sorted(name for name, times in count.items() if times > 1 and name not in words)


def record_fields(house):
    """Number of fields of the contracts' records, which are dataclasses and named tuples."""
    found = Counter()
    for file in house.contracts:
        for node in file.nodes[ast.ClassDef]:
            marks = " ".join(map(ast.unparse, (*node.decorator_list, *node.bases)))
            if "dataclass" in marks or "NamedTuple" in marks:
                found[f"{file.module}.{node.name}"] = sum(isinstance(part, ast.AnnAssign) for part in node.body)
    return found


def named_words(house):
    """(contract, word): a solver that a contract names anywhere, a model, force or contact as a name or in quotes."""
    words = {word for family in PHYSICS for word in house.words[family]} - TERMS
    solvers = set(house.words["solvers"])
    found = set()
    for file in house.contracts:
        named = {node.id for node in file.nodes[ast.Name]} | {node.attr for node in file.nodes[ast.Attribute]}
        text = _without_manual(file)
        named |= set(re.findall(r"[`'\"](\w+)[`'\"]", text))
        named |= solvers.intersection(re.findall(r"\w+", text))
        found |= {(file.module, word) for word in words & named}
    return sorted(found)


def _without_manual(file):
    """The text of a file but for what its fields say to the user."""
    text = file.text
    for node in file.nodes[ast.Call]:
        if isinstance(node.func, ast.Name) and node.func.id == "field":
            text = text.replace(ast.get_source_segment(file.text, node), "")
    return text


def slot_definitions(house):
    """Modules that say what a slot of ``floats`` is: index it by a number, or by a constant of their own."""
    found = set()
    for file in house.files:
        for node in file.nodes[ast.Subscript]:
            array = node.value.attr if isinstance(node.value, ast.Attribute) else getattr(node.value, "id", "")
            if array == "floats" and _is_slot(file, node.slice):
                found.add(file.module)
    return sorted(found)


def _is_slot(file, index):
    if isinstance(index, ast.Slice):  # counted from the end: parts as long as the state
        ends = (end for end in (index.lower, index.upper) if end is not None)
        return any(isinstance(part, ast.USub) for end in ends for part in ast.walk(end))
    return isinstance(index, ast.Constant) or (isinstance(index, ast.Name) and index.id in file.constants)


def untyped(house):
    """Files that the type checker passes over, besides kernels and what shortens numba."""
    files = [file.module for file in house.files if IGNORED.search(file.text)]
    return [name for name in files if not name.endswith("_kernels") and not name.startswith("sceneql.compiled.numba.")]


def unresolved(house):
    """(module, line, name) of strings that name nothing."""
    return [(f.module, line, name) for f in house.files for line, name in f.strings() if not house.resolves(name)]


def unsaid(house):
    """Rooms whose __init__.py does not begin with one sentence on one line, or holds more than text."""
    rooms = [file for file in house.files if file.is_room and file.module not in FACES]
    return [room.module for room in rooms if len(room.tree.body) != 1 or not _is_sentence(ast.get_docstring(room.tree))]


def _is_sentence(text):
    first = (text or "").partition("\n")[0]
    return first.endswith(".") and not re.search(r"[.!?] ", first)


class Bar(NamedTuple):
    """A number of the house, and what it may be at most."""

    name: str
    value: Callable[[House], float]
    goal: float
    today: float | None = None
    """What it is where the goal is not met yet; None: the goal is held."""


BARS = (
    Bar("largest room, share of lines [%]", lambda house: 100 * max(room_shares(house).values()), 15),
    Bar("loose files beside sub-rooms", lambda house: max(loose_files(house)[0].values()), 25),
    Bar("files in a flat folder", lambda house: max(loose_files(house)[1].values()), 35),
    Bar("lines of the longest file", lambda house: max(file.lines for file in house.files), 400),
    Bar("circles of files, types counted", lambda house: len(circles(house.imports)), 0),
    Bar("arrows against the layers", lambda house: len(arrows_up(house)), 0),
    Bar("files in words/ that are no word by the one rule", lambda house: len(misplaced_words(house)), 0),
    Bar("names shared by files that are no word's", lambda house: len(shared_names(house)), 8),
    Bar("fields of the largest contract record", lambda house: max(record_fields(house).values()), 12),
    Bar("words named in contracts", lambda house: len(named_words(house)), 0),
    Bar("files that define slots of `floats`", lambda house: len(slot_definitions(house)), 1),
    Bar("files exempt from type checking", lambda house: len(untyped(house)), 0),
    Bar("strings that name nothing", lambda house: len(unresolved(house)), 0),
    Bar("rooms that do not say in a sentence what they hold", lambda house: len(unsaid(house)), 0),
)


def main():
    """Print the table."""
    house = House()
    print(f"{'':52} {'now':>6} {'goal':>6}")
    for bar in BARS:
        print(f"{bar.name:52} {bar.value(house):6.3g} {bar.goal:6g}{'' if bar.today is None else '  open'}")
    words = sum(map(len, house.words.values()))
    print(f"{words} words, {len(house.files)} files, {sum(file.lines for file in house.files)} lines")


if __name__ == "__main__":
    main()
