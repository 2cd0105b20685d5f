"""The catalogue of words. Listing the words of a family lists its folder; naming a word imports its file alone.

Words come from the package's own folders, then from folders of the user's (``--words DIR`` with one subfolder a family,
as ``DIR/solvers/heun.py``), then from installed packages through the entry point group ``sceneql.words`` (entry
``solvers.heun = "package.module"``), which is read only when a word is in none of the folders.
"""

from __future__ import annotations

import importlib
import re
import sys
from functools import cached_property
from pathlib import Path
from types import ModuleType
from typing import Any

from sceneql.compiler.defaults import check_defaults
from sceneql.kinds import FAMILIES, Kind, written_name

ROOT = Path(__file__).parent.parent
LONGEST = 60
"""Largest number of characters of a word: file names are limited."""
USER_PACKAGE = "sceneql_words"


def class_name(word: str) -> str:
    """The name of a word's class: ``MassSpring`` for ``mass_spring``."""
    return "".join(part.capitalize() for part in word.split("_"))


class Catalogue:
    """The words that a script may use."""

    def __init__(self, words_folder: Path | None = None) -> None:
        self.families: dict[str, type[Kind]] = {kind.family: kind for kind in FAMILIES}
        self._folder = None if words_folder is None else words_folder.resolve()
        if self._folder is not None:
            package = ModuleType(USER_PACKAGE)
            package.__path__ = [str(self._folder)]
            for name in [name for name in sys.modules if name.split(".")[0] == USER_PACKAGE]:
                del sys.modules[name]  # another folder's words under the same names
            sys.modules[USER_PACKAGE] = package
            importlib.invalidate_caches()
        self._loaded: dict[tuple[str, str], type[Kind]] = {}

    def _places(self, family: str) -> list[tuple[str, Path]]:
        """Packages and folders of the words that may stand in a family's section."""
        also = [kind.family for kind in FAMILIES if kind.also_under == family]
        return [place for name in (family, *also) for place in self._own_places(name)]

    def _own_places(self, family: str) -> list[tuple[str, Path]]:
        if family == "renderers":
            places = [("renderers", ROOT.parent / "renderers")]
        else:
            places = [(f"sceneql.words.{family}", ROOT / "words" / family)]
        if self._folder is not None:
            places.append((f"{USER_PACKAGE}.{family}", self._folder / family))
        return places

    def words(self, family: str) -> list[str]:
        """The words of a family, in alphabetical order."""
        found = {path.stem for _, folder in self._own_places(family) for path in folder.glob("*.py") if _is_word(path)}
        found |= {name.partition(".")[2] for name in self._installed if name.partition(".")[0] == family}
        return sorted(found)

    def choices(self, family: str) -> list[str]:
        """The words that may stand in a family's section."""
        also = [kind.family for kind in FAMILIES if kind.also_under == family]
        return sorted(word for name in (family, *also) for word in self.words(name))

    def load(self, family: str, word: str) -> type[Kind] | None:
        """The class of a word that may stand in a family's section; None if there is none.

        Raises ScriptError where the word's file has a default that no script could write.
        """
        key = (family, word)
        if key not in self._loaded and _may_be_word(word):
            for package, folder in self._places(family):
                if _is_word(folder / f"{word}.py"):
                    self._loaded[key] = _class(importlib.import_module(f"{package}.{word}"), word)
                    break
            else:
                entry = self._installed.get(f"{family}.{word}")
                if entry is not None:
                    self._loaded[key] = _class(entry.load(), word)
        return self._loaded.get(key)

    def families_of(self, word: str) -> list[str]:
        """The families that have a word of this name (for a hint when it stands in the wrong section)."""
        if not _may_be_word(word):
            return []
        return [
            family
            for family in self.families
            if any(_is_word(folder / f"{word}.py") for _, folder in self._own_places(family))
        ]

    def having(self, field: str) -> list[tuple[str, str]]:
        """The (family, word) of all words with a field of a name; it imports the whole vocabulary, for messages."""
        words = ((family, word) for family in self.families for word in self.words(family))
        loaded = [((family, word), cls) for family, word in words if (cls := self.load(family, word)) is not None]
        return [name for name, cls in loaded if field in map(written_name, cls.model_fields)]

    @cached_property
    def _installed(self) -> dict[str, Any]:
        from importlib.metadata import entry_points

        return {entry.name: entry for entry in entry_points(group="sceneql.words")}


def _class(module: ModuleType, word: str) -> type[Kind]:
    cls: type[Kind] = getattr(module, class_name(word))
    check_defaults(cls)
    return cls


def _may_be_word(text: str) -> bool:
    """Whether a text may be the name of a word's file."""
    return text.isidentifier() and len(text) <= LONGEST


def _is_word(path: Path) -> bool:
    """Whether a file defines the class that its name asks for (kernel files and helpers beside words do not)."""
    if path.stem.startswith("_") or path.stem.endswith("_kernels") or not path.is_file():
        return False
    return re.search(rf"^class {class_name(path.stem)}\(", path.read_text(encoding="utf-8"), re.MULTILINE) is not None
