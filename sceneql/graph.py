"""The simulation graph that the compiler makes of a script and the run marches. Immutable values."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from sceneql.kinds import Kind, Settings
from sceneql.quantities.span import Span

if TYPE_CHECKING:
    from sceneql.quantities.diagnostic import Diagnostic


@dataclass(frozen=True, slots=True)
class Task:
    """A part of the script: an instance of its word's class, with checked fields."""

    name: str
    word: str
    kind: Kind
    span: Span | None
    needs: tuple[str, ...] = ()
    """Names of the parts to which it links or refers."""
    original: Kind | None = None
    """For a part that a model drives, the kind as the script has it: where the model starts. None for other parts."""

    @property
    def family(self) -> str:
        """The family of its word."""
        return self.kind.family


@dataclass(frozen=True, slots=True)
class Island:
    """Models that are solved together, in script order, by one solver."""

    models: tuple[str, ...]
    forces: tuple[tuple[str, str], ...]
    """(force, model) pairs."""
    contacts: tuple[tuple[str, str, tuple[str, ...]], ...]
    """(contact, model, the objects it may touch)."""
    solver: str
    """Name of the solver's task."""
    reason: str
    """Why this solver."""


@dataclass(frozen=True, slots=True)
class LeftOut:
    """A part that no output needs."""

    name: str
    word: str
    reason: str


@dataclass(frozen=True, slots=True)
class Variants:
    """The variants of a script, of which a graph may be one."""

    names: tuple[str, ...] = ()
    may_fail: bool = False
    """Whether the script says that the run of this variant may fail."""
    this: str = ""
    """The name of the variant that the graph is; empty for the script itself."""
    load: Callable[[str], SimulationGraph] | None = field(default=None, compare=False)
    """Function that loads the graph of a variant by its name."""


@dataclass(frozen=True, slots=True)
class Origin:
    """The sources of a graph."""

    hash: str = ""
    """SHA-256 of the script's texts and patches."""
    files: tuple[str, ...] = ()
    """Paths: scripts, meshes, pictures."""


@dataclass(frozen=True, slots=True)
class SimulationGraph:
    """Everything the run needs, and the parts that were left out."""

    name: str
    """The script's name without its extension: the default name of output files."""
    settings: Settings
    tasks: Mapping[str, Task]
    """In topological order: every part stands behind those it needs."""
    needed_by: Mapping[str, tuple[str, ...]]
    """For each task, the outputs that need it."""
    islands: tuple[Island, ...]
    drawn: Mapping[str, tuple[str, ...]]
    """For each output that draws, the objects and models that it draws."""
    cameras: Mapping[str, str]
    """For each output with pictures, its camera's task."""
    palette: tuple[str, ...] = ()
    """Objects and models in the order that determines their default colors."""
    left_out: tuple[LeftOut, ...] = ()
    warnings: tuple[Diagnostic, ...] = ()
    origin: Origin = Origin()
    variants: Variants = Variants()

    @property
    def script_hash(self) -> str:
        """SHA-256 of the script's texts and patches."""
        return self.origin.hash

    def variant(self, name: str) -> SimulationGraph:
        """The graph of a variant of the script. Raises ScriptError."""
        if self.variants.load is None:
            raise LookupError("the graph does not know its script")
        return self.variants.load(name)
