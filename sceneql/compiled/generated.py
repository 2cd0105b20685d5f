"""Generated kernel modules: imported from memory, and written to the kernel cache under the hash of their text.

They form the package ``sceneql_generated``, so that kernels in them have names of the usual form
(``"sceneql_generated.rate_0123456789abcdef:rate"``) and other generated modules import them by an ordinary line. The
files are for people and debuggers: whatever becomes of them, the text in memory is what runs.
"""

from __future__ import annotations

import hashlib
import importlib
import sys
from importlib.machinery import ModuleSpec, SourceFileLoader
from importlib.util import spec_from_file_location
from types import ModuleType
from typing import Any, NoReturn

from sceneql.doing import doing

PACKAGE = "sceneql_generated"
_texts: dict[str, bytes] = {}
"""Texts of generated modules, by full name."""


def write(prefix: str, source: str) -> str:
    """Keep a module's text; returns its full name, ``sceneql_generated.<prefix>_<hash of the text>``.

    The same text has the same name, so its compiled code stays cached.
    """
    text = source.encode()
    name = f"{PACKAGE}.{prefix}_{hashlib.sha256(text).hexdigest()[:16]}"
    if name not in _texts:
        from sceneql.compiled.kernels import CACHE

        CACHE.write_text(_file(name), text)
        _texts[name] = text
    return name


def load(name: str) -> ModuleType:
    """Import a module of the package, or any other, by its full name."""
    with doing("compiling"):
        return importlib.import_module(name)


def function(name: str) -> Any:
    """The function of ``"package.module:function"``."""
    module, _, attribute = name.partition(":")
    return getattr(load(module), attribute)


def _file(name: str) -> str:
    """Name in the cache of the text of a module."""
    return f"generated/{name.rpartition('.')[2]}.py"


class _Loader(SourceFileLoader):
    """Loads a module's text from memory, without a file of bytecode, which Python would load unchecked."""

    def get_data(self, path: Any) -> bytes:
        """The text."""
        return _texts[self.name]

    def path_stats(self, path: Any) -> NoReturn:
        """Raises OSError: as if there were no file, which is how Python comes to keep no bytecode."""
        raise FileNotFoundError(path)


class _Finder:
    """Finds the modules of the package."""

    @staticmethod
    def find_spec(name: str, path: Any = None, target: Any = None) -> ModuleSpec | None:
        """The spec of a module whose text was written; None for all others."""
        if name not in _texts:
            return None
        from sceneql.compiled.kernels import CACHE

        at = str(CACHE.path(_file(name)))
        return spec_from_file_location(name, at, loader=_Loader(name, at))


package = ModuleType(PACKAGE)
package.__path__ = []
sys.modules[PACKAGE] = package
sys.meta_path.append(_Finder)
