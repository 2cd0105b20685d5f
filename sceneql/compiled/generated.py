"""Generated kernel modules: written to the kernel cache under the hash of their text, and imported from there.

They form the package ``sceneql_generated``, so that kernels in them have names of the usual form
(``"sceneql_generated.rate_0123456789abcdef:rate"``) and other generated modules import them by an ordinary line.
"""

from __future__ import annotations

import hashlib
import importlib
import os
import sys
import tempfile
from pathlib import Path
from types import ModuleType
from typing import Any

PACKAGE = "sceneql_generated"


def write(prefix: str, source: str) -> str:
    """Keep a module's text; returns its full name, ``sceneql_generated.<prefix>_<hash of the text>``.

    The same text is written once, so its compiled code stays cached; the file appears whole or not at all.
    """
    folder = _package_folder()
    name = f"{prefix}_{hashlib.sha256(source.encode()).hexdigest()[:16]}"
    path = folder / f"{name}.py"
    if not path.exists():
        handle, partial = tempfile.mkstemp(dir=folder, suffix=".partial")
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(source)
        os.replace(partial, path)
        importlib.invalidate_caches()
    return f"{PACKAGE}.{name}"


def load(name: str) -> ModuleType:
    """Import a module of the package, or any other, by its full name."""
    _package_folder()
    return importlib.import_module(name)


def function(name: str) -> Any:
    """The function of ``"package.module:function"``."""
    module, _, attribute = name.partition(":")
    return getattr(load(module), attribute)


def _package_folder() -> Path:
    from sceneql.compiled.kernels import CACHE

    folder = CACHE / "generated"
    if PACKAGE not in sys.modules:
        folder.mkdir(parents=True, exist_ok=True)
        package = ModuleType(PACKAGE)
        package.__path__ = [str(folder)]
        sys.modules[PACKAGE] = package
    return folder
