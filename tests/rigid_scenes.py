"""Scenes of rigid bodies that touch, for the tests of contacts in modes `exact` and `local`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import runs

TIGHT = "dop853: {tolerance: 1e-12}"


def watch(
    folder: Path,
    objects: Mapping[str, str],
    bodies: Mapping[str, str],
    times: Sequence[float],
    *outputs: str,
    law: str,
    forces: str = "[gravity]",
    more: str = "",
    solver: str = TIGHT,
    model: str = "it",
) -> list[list[Any]]:
    """Outputs of the rigid bodies of a model among these objects, in contact by a law."""
    lines = "\n".join(f"  {name}: {what}" for name, what in objects.items())
    each = "\n".join(f"        {name}: {what}" for name, what in bodies.items())
    script = f"""
clock: {{end: {max(times)} s}}
objects:
{lines}
models:
  {model}:
    rigid:
      bodies:
{each}
forces: {forces}
contacts: {{touch: {{collision: {{{law}}}}}}}
solvers: {{main: {{{solver}}}}}
{more}
"""
    return runs.watch(folder, script, times, *outputs, pruned=False)
