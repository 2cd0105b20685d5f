"""All solver words, each with the fields that it cannot do without."""

from __future__ import annotations

import importlib
from pathlib import Path

from sceneql.kinds import Solver
from sceneql.words import solvers

HEUN_3 = {"a": ((), (1 / 3,), (0.0, 2 / 3)), "b": (1 / 4, 0.0, 3 / 4)}
NEEDED = {"runge_kutta": HEUN_3}
EVERY = sorted(p.stem for p in Path(solvers.__path__[0]).glob("*.py") if not p.stem.endswith(("_kernels", "__init__")))


def solver(word: str) -> Solver:
    module = importlib.import_module(f"sceneql.words.solvers.{word}")
    return getattr(module, "".join(part.capitalize() for part in word.split("_")))(**NEEDED.get(word, {}))
