"""Compilation of everything: importing a kernel file compiles its kernels for their explicit signatures."""

from __future__ import annotations

import importlib
from pathlib import Path

import renderers
import sceneql
from sceneql.compiled.kernels import compiled


def warmup() -> str:
    """Import every kernel file of the package; returns how many functions were compiled and how long it took."""
    for package in (sceneql, renderers):
        root = Path(str(package.__file__)).parent
        for path in sorted(root.rglob("*_kernels.py")):
            importlib.import_module(".".join(path.relative_to(root.parent).with_suffix("").parts))
    return f"compiled {compiled.count} functions in {compiled.seconds:.1f} s"
