"""Inclusion of scripts: from the scene's own folder only, each file once."""

from __future__ import annotations

import posixpath
from collections.abc import Callable
from pathlib import Path, PureWindowsPath

from sceneql.language.compose import compose
from sceneql.language.encoded import MOST_BYTES, source_of
from sceneql.language.tree import Mapping, Scalar, Sequence, broken
from sceneql.quantities.diagnostic import Diagnostic, Diagnostics, Note, ScriptError
from sceneql.quantities.span import Source, Span

Read = Callable[[str], Source]
"""Function that returns the script at a path below the scene's folder. Raises OSError, OutsideError or ScriptError."""


class OutsideError(Exception):
    """A path leads out of the scene's folder."""


def read_source(path: Path) -> Source:
    """The text of a script's file. Raises ScriptError when there is none that can be read."""
    try:
        return _read(path, str(path))
    except OSError as error:
        message = f"the script {path} cannot be read: {error.strerror or error}"
        raise ScriptError([Diagnostic("script-missing", message, None)]) from None


def folder_reader(folder: Path) -> Read:
    """A reader of the files below a folder; links are followed and must not lead out of it."""
    root = folder.resolve()

    def read(name: str) -> Source:
        path = (root / name).resolve(strict=True)
        if not path.is_relative_to(root):
            raise OutsideError(name)
        return _read(path, str(folder / name))

    return read


def _read(path: Path, name: str) -> Source:
    if not path.is_file():
        raise FileNotFoundError(None, "it is not a file" if path.exists() else "there is no such file")
    with path.open("rb") as stream:
        # Memory for as many bytes as are asked for is taken at once, whatever there is to read.
        return source_of(name, stream.read(min(path.stat().st_size, MOST_BYTES) + 1))


def read_included(root: Mapping, name: str, read: Read, found: Diagnostics) -> list[Mapping]:
    """The script itself, then all scripts that it includes, in the order met; ``name``: the script's own path.

    Where an included script cannot be read, the tree of the script itself is marked partial.
    """
    reading = _Reading(root, read, found)
    reading.follow(root, [(name, root.span)])
    return [root, *reading.trees.values()]


class _Reading:
    def __init__(self, root: Mapping, read: Read, found: Diagnostics) -> None:
        self.root = root
        self.read = read
        self.found = found
        self.trees: dict[str, Mapping] = {}
        self.failed: set[str] = set()
        self.size = 0

    def follow(self, root: Mapping, chain: list[tuple[str, Span]]) -> None:
        """Read the scripts that a script includes, and those that they include."""
        node = root.entries.get("include")
        if node is None:
            return
        for item in node.items if isinstance(node, Sequence) else [node]:
            if broken(item):
                self.root.partial = True
            elif not isinstance(item, Scalar) or item.kind == "null":
                help = "write `include: [parts.yaml]`"
                self.found.error("section-shape", "an include is the path of a script", item.span, help=help)
                self.root.partial = True
            elif (path := self.inside(item, posixpath.dirname(chain[-1][0]))) is not None:
                self.one(path, item.span, chain)

    def inside(self, item: Scalar, folder: str) -> str | None:
        """The path below the scene's folder, or None after reporting that it leads elsewhere."""
        path = posixpath.normpath(posixpath.join(folder, item.text))
        foreign = "\\" in path or "\0" in path or PureWindowsPath(path).drive != ""
        if foreign or path == ".." or path.startswith(("/", "../")):
            self.outside(item.span)
            return None
        return path

    def outside(self, span: Span) -> None:
        """Report a path that leads out of the scene's folder."""
        self.root.partial = True
        help = "copy the script beside the scene, and name it by a path below it"
        self.found.error("include-outside", "an include stays inside the scene's folder", span, help=help)

    def one(self, path: str, span: Span, chain: list[tuple[str, Span]]) -> None:
        """Read one script, unless it was read before."""
        for at, (name, _) in enumerate(chain):
            if name == path:
                notes = [Note(f"{inner} is included here", place) for inner, place in chain[at + 1 :]]
                message = f"{path} includes itself" + (" by way of others" if notes else "")
                self.found.error("include-cycle", message, span, help="remove this line", notes=notes)
                return
        if path in self.trees or path in self.failed:
            return
        self.failed.add(path)
        try:
            source = self.read(path)
            self.size += len(source.text)
            if self.size > MOST_BYTES:
                self.found.error("too-large", f"with {path}, more than {MOST_BYTES // 1_000_000} MB are included", span)
                self.root.partial = True
                return
            root = compose(source, self.found)
        except OutsideError:
            self.outside(span)
        except (OSError, ValueError, RuntimeError) as error:
            reason = getattr(error, "strerror", None) or error
            help = "an include is looked up from the folder of the script that holds it"
            self.found.error("include-missing", f"{path} cannot be read: {reason}", span, help=help)
            self.root.partial = True
        except ScriptError as error:
            self.found.extend(error.diagnostics)
            self.root.partial = True
        else:
            self.trees[path] = root
            self.follow(root, [*chain, (path, span)])
