"""Discovery of elements and laws, each in the file that defines the class of its own name; fields that solids lack."""

from __future__ import annotations

import re
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any


@cache
def named(package: str, family: str) -> dict[str, Any]:
    """The classes of a family in a package by the names of their files, in alphabetical order.

    ``p2_mean.py`` defines ``class P2Mean(Element)``.
    """
    spec = find_spec(package)
    assert spec is not None
    assert spec.origin is not None
    found = {}
    for path in sorted(Path(spec.origin).parent.glob("*.py")):
        called = "".join(part.capitalize() for part in path.stem.split("_"))
        if re.search(rf"^class {called}\({family}\):", path.read_text(encoding="utf-8"), re.MULTILINE):
            found[path.stem] = getattr(import_module(f"{package}.{path.stem}"), called)
    return found


SAID = {
    **dict.fromkeys(
        ("modulus", "young", "youngs_modulus", "stiffness", "poisson", "poisson_ratio"),
        "a law has it, `law: {neo_hookean: {modulus: 10 kPa, poisson: 0.45}}`",
    ),
    **dict.fromkeys(
        ("expansion", "thermal_expansion", "thermal_strain", "temperature"),
        "heat strains no solid: there is no word for thermal strain yet",
    ),
    **dict.fromkeys(("mass", "weight"), "write its density, `density: 1000 kg/m^3`"),
}
"""Helps for fields that are likely to be tried of a solid and are none, by name."""
