"""Our modules as files: what each defines, imports and names in strings."""

import ast
import gc
import re
from collections import defaultdict
from functools import cache, cached_property
from pathlib import Path

ROOT = Path(__file__).parent.parent
TOPS = ("sceneql", "renderers")
CONTRACTS = re.compile(r"sceneql\.(system|frame|graph|kinds)\b")
NAME = re.compile(r"(?:sceneql|renderers)(?:\.[a-z_0-9]+)+(?::\w+)?")
NO_CODE = {"sceneql.schema.json", "sceneql.words"}
"""A file, and the entry points of installed words."""


class File:
    """A module of the house, read once."""

    def __init__(self, path):
        self.path = path.relative_to(ROOT)
        self.text = path.read_text(encoding="utf-8")
        self.tree = ast.parse(self.text)
        self.lines = self.text.count("\n")
        self.module = ".".join(self.path.with_suffix("").parts).removesuffix(".__init__")
        self.is_room = path.stem == "__init__"

    @cached_property
    def nodes(self):
        """All nodes of its tree, by type."""
        found = defaultdict(list)
        for node in ast.walk(self.tree):
            found[type(node)].append(node)
        return found

    @cached_property
    def texts(self):
        """Texts of the constants of the module, by name."""
        return {
            target.id: node.value.value
            for node in self.tree.body
            if isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant)
            for target in node.targets
            if isinstance(target, ast.Name) and isinstance(node.value.value, str)
        }

    @cached_property
    def constants(self):
        """Names that are given a value at the top of the module."""
        targets = [target for node in self.tree.body if isinstance(node, ast.Assign) for target in node.targets]
        return {part.id for target in targets for part in ast.walk(target) if isinstance(part, ast.Name)}

    @cached_property
    def defined(self):
        """Names at the top of the module."""
        body = self.tree.body
        own = {node.name for node in body if isinstance(node, ast.FunctionDef | ast.ClassDef)}
        taken = [alias for node in body if isinstance(node, ast.ImportFrom) for alias in node.names]
        return own | self.constants | {alias.asname or alias.name for alias in taken}

    def strings(self):
        """(line, name) of every string that is the name of something of ours, ``"package.module:function"``."""
        joined = self.nodes[ast.JoinedStr]
        inner = {id(part) for node in joined for part in ast.walk(node)} - set(map(id, joined))
        for node in (*self.nodes[ast.Constant], *joined):
            text = text_of(node, self.texts) if id(node) not in inner else None
            if text is not None and NAME.fullmatch(text) and text not in NO_CODE:
                yield node.lineno, text


def text_of(node, known):
    """What a string or an f-string of constants says; None where it is put together from something else."""
    if isinstance(node, ast.Constant):
        return node.value if isinstance(node.value, str) else None
    parts = []
    for part in node.values:
        if isinstance(part, ast.FormattedValue):
            if not (isinstance(part.value, ast.Name) and part.value.id in known):
                return None
            parts.append(known[part.value.id])
        else:
            parts.append(part.value)
    return "".join(parts)


@cache
def whole_house():
    """All modules, read once in a process, and not while tests are collected: their trees are large."""
    return House()


class House:
    """All modules, and what ties them."""

    def __init__(self):
        paths = sorted(path for top in TOPS for path in (ROOT / top).rglob("*.py"))
        gc.disable()  # all that is made stays: to look it over again and again took three quarters of the time
        self.files = [File(path) for path in paths]
        self.by_module = {file.module: file for file in self.files}
        gc.freeze()
        gc.enable()

    @cached_property
    def imports(self):
        """Which module imports which, at the top, in functions and for types alike."""
        return {file.module: set(self._imported(file)) - {file.module} for file in self.files}

    def _imported(self, file):
        for node in file.nodes[ast.Import]:
            yield from (alias.name for alias in node.names if alias.name in self.by_module)
        for node in file.nodes[ast.ImportFrom]:
            for alias in node.names:
                whole = f"{node.module}.{alias.name}"
                name = whole if whole in self.by_module else node.module
                if name in self.by_module:
                    yield name

    @cached_property
    def links(self):
        """Which module names which in a string, to load it when it is needed."""
        found = {}
        for file in self.files:
            named = {name.partition(":")[0] for _, name in file.strings()}
            found[file.module] = {name for name in named if name in self.by_module} - {file.module}
        return found

    @cached_property
    def words(self):
        """The words of each family by the one rule ``words/<family>/<word>.py``; renderers stand in renderers/."""
        found = defaultdict(list)
        for file in self.files:
            parts = file.path.parts
            family = parts[2] if parts[:2] == ("sceneql", "words") and len(parts) == 4 else ""
            family = "renderers" if parts[0] == "renderers" and len(parts) == 2 else family
            if family and _class_of(file.path.stem) in file.defined:
                found[family].append(file.path.stem)
        return dict(found)

    @cached_property
    def contracts(self):
        """What rooms say to each other through."""
        return [file for file in self.files if CONTRACTS.match(file.module)]

    def resolves(self, name):
        """Whether a string names a module of ours, or what one defines."""
        module, _, function = name.partition(":")
        if not function and module not in self.by_module:
            module, _, function = module.rpartition(".")
        return module in self.by_module and (not function or function in self.by_module[module].defined)


def _class_of(word):
    return "".join(part.capitalize() for part in word.split("_"))
