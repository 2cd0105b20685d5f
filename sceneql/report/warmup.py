"""Compile everything once: importing a kernel file compiles its kernels for their explicit signatures."""

from __future__ import annotations

import importlib

from sceneql.kernels import PACKAGES, compiled


def warmup() -> str:
    """Import every kernel file of the package; what was compiled and how long it took."""
    for package in PACKAGES:
        for path in sorted(package.rglob("*_kernels.py")):
            name = ".".join(path.relative_to(package.parent).with_suffix("").parts)
            importlib.import_module(name)
    return f"compiled {compiled.count} functions in {compiled.seconds:.1f} s"
