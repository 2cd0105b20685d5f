"""What is known of a script before its run, as warnings of its meaning read it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from sceneql.graph import Island, Task
from sceneql.kinds import (
    Camera,
    Clock,
    Interaction,
    Material,
    Model,
    Object,
    Output,
    Overlay,
    Picture,
    Settings,
    Tie,
    Value,
)
from sceneql.language.script import Script


@dataclass(frozen=True)
class Facts:
    """The parts of a script without errors, their islands, and what its pictures draw."""

    script: Script
    settings: Settings
    tasks: Mapping[str, Task]
    groups: Sequence[Island]
    drawn: Mapping[str, tuple[str, ...]]
    """By output that draws, the parts that it draws."""
    cameras: Mapping[str, str]
    """By picture, its camera."""

    @property
    def clock(self) -> Clock:
        """The clock."""
        return self.settings.clock

    @cached_property
    def frame(self) -> float:
        """Seconds of the simulation from one frame to the next, in the film that has the most [s]."""
        films = [getattr(task.kind, "fps", None) or self.clock.fps for task in self.tasks.values() if _films(task)]
        return self.clock.speed / max(films, default=self.clock.fps)

    @cached_property
    def whole(self) -> bool:
        """Whether a film is meant, and not a piece of a script: with a clock, a camera, an overlay or an output."""
        seen = (Camera, Overlay, Output)
        return "clock" in self.script.settings or any(task.span and isinstance(task.kind, seen) for task in self.all)

    @property
    def all(self) -> Iterator[Task]:
        """All parts."""
        return iter(self.tasks.values())

    @cached_property
    def objects(self) -> dict[str, Object]:
        """Objects by name, as the script has them."""
        return {t.name: t.original or t.kind for t in self.tasks.values() if isinstance(t.kind, Object)}  # type: ignore

    @cached_property
    def models(self) -> dict[str, Model]:
        """Models by name."""
        return {task.name: task.kind for task in self.tasks.values() if isinstance(task.kind, Model)}

    @cached_property
    def members(self) -> frozenset[str]:
        """Names of objects that others are made of."""
        return frozenset(ref.name for kind in self.objects.values() for ref in kind.members())

    @cached_property
    def seen(self) -> frozenset[str]:
        """Names of the parts that pictures draw."""
        return frozenset(name for names in self.drawn.values() for name in names)

    def written(self, name: str) -> bool:
        """Whether a part stands in the script, and not by default."""
        return self.tasks[name].span is not None

    def forces(self, island: Island) -> list[Task]:
        """The forces of an island without its ties, each once."""
        names = dict.fromkeys(name for name, _ in island.forces)
        return [self.tasks[name] for name in names if not isinstance(self.tasks[name].kind, Tie)]

    def ties(self, island: Island) -> list[Task]:
        """The ties of an island, each once."""
        names = dict.fromkeys(name for name, _ in island.forces)
        return [self.tasks[name] for name in names if isinstance(self.tasks[name].kind, Tie)]

    def of(self, kind: type) -> Iterator[Task]:
        """The parts of a kind."""
        return (task for task in self.tasks.values() if isinstance(task.kind, kind))

    def material(self, kind: Any) -> Material | None:
        """The material that an object names; None where it has but a color."""
        ref = getattr(kind, "material", None)
        found = None if ref is None else self.tasks[ref.name].kind
        return found if isinstance(found, Material) else None

    def clear(self, kind: Any) -> bool:
        """Whether one sees through an object."""
        material = self.material(kind)
        return material is not None and material.clear


def _films(task: Task) -> bool:
    return isinstance(task.kind, Picture) and "fps" in type(task.kind).model_fields and isinstance(task.kind, Output)


def constant(value: object) -> Any:
    """The number, or tuple of numbers, of a value that varies neither in time nor with other parts; None of others."""
    return value.number() if isinstance(value, Value) and value.constant else None


def weight(forces: Sequence[Task]) -> list[Task]:
    """Those of some forces that are weights."""
    return [task for task in forces if isinstance(task.kind, Interaction) and task.kind.weighs]
