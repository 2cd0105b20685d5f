"""One instant of a run: values, states, shapes and surfaces of its parts at that time."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, Protocol, TypeVar, cast

import numpy as np

from sceneql.failure import RunFailure, failing_as
from sceneql.kinds import Contact, Material, Model, Object, Ref, Tie, Value
from sceneql.quantities.evaluate import evaluate
from sceneql.quantities.expression import Expr, Link, Symbol
from sceneql.run.diverging import Diverged, together
from sceneql.run.framed import Framed
from sceneql.shapes.color import default_color, linear
from sceneql.shapes.placement import Placed, compose

if TYPE_CHECKING:
    from sceneql.frame import Floats, Surface
    from sceneql.frame import Shape as Drawn
    from sceneql.kinds.moment import Remembered
    from sceneql.run.history import History
    from sceneql.system import ModelState

IDENTITY = np.eye(3, 4)
T = TypeVar("T")


class Running(Framed, Protocol):
    """The run of an instant, as it uses it (run.Run), or a run ahead of that."""

    ahead: bool
    """Whether it is a dry run ahead of the film."""
    orders: dict[str, int]
    """The parts that any picture draws, with their order."""
    palette: dict[str, int]
    """Index of every object and model in the list of default colors."""
    holders: dict[str, str]
    """For every object inside another one, the name of the object that draws it."""
    history: History
    kept: dict[str, tuple[Hashable, Any]]
    """By part the key and the result of the latest `Instant.kept`."""
    diverged: Sequence[Diverged]
    """The variants that a framing of this run and others left out."""

    @property
    def supports(self) -> Sequence[tuple[str, Drawn]]:
        """What holds bodies to the world: names of objects, each with a shape that holds it."""

    def moments(self, times: Iterable[float]) -> Iterator[Instant]:
        """The instants [s] asked for, in order."""

    def state(self, name: str) -> ModelState:
        """The latest state of a model that is solved, or of a contact."""

    def course(self, value: Value, variant: str | None, until: float) -> tuple[Floats, Floats]:
        """Times (n,) [s] and a requested value at each (n, ...), up to an instant, in a variant of the script."""


@dataclass
class Instant:
    """One instant of a run (kinds.Moment)."""

    run: Running
    now: float
    """[s]"""
    asked: bool = False
    """Whether something was read that may differ at another instant."""
    beside: tuple[Framed, ...] = ()
    """The runs of variants shown in panels beside this one, which share one framing."""
    room: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    """Margins covered by overlays at the picture's left, top, right and bottom, as parts of width and height."""
    rooms: tuple[tuple[float, tuple[float, float, float, float]], ...] = ()
    """The margins that are needed at some instants [s] of the film; without any they are always ``room``."""
    shown: tuple[Drawn, ...] | None = None
    """The shapes of the picture in the making; None before they are known."""
    _states: dict[str, ModelState] = field(default_factory=dict)
    _values: dict[tuple[str, str], tuple[Any, bool]] = field(default_factory=dict)
    """Cache of outputs of other parts, by part and output: the value, and whether it varies."""

    @property
    def time(self) -> float:
        """[s]"""
        self.asked = True
        return self.now

    @property
    def end(self) -> float:
        """When the run ends [s]."""
        return self.run.graph.settings.clock.end

    @property
    def variants(self) -> tuple[str, ...]:
        """The names of the script's variants."""
        return self.run.graph.variants.names

    def at(self, value: Value) -> Any:
        """The value now: float or float64 array, SI. Raises RunFailure if it is not finite."""
        known = value.fixed()
        now = self._evaluate(value.expr) if known is None else known
        if not np.isfinite(now).all():
            raise RunFailure("a value is not finite now", part="", time=self.now, span=value.span)
        return now

    def measure(self, value: Value) -> Any:
        """The value now, finite or not."""
        return self._evaluate(value.expr)

    def _evaluate(self, expr: Expr) -> Any:
        return evaluate(expr, self._look_up, arrays=True)

    def _look_up(self, node: Symbol | Link) -> Any:
        if isinstance(node, Symbol):
            if node.name == "time":
                return self.time
            raise KeyError(node.name)
        return self.read(node.task, node.output)

    def past(self, value: Remembered) -> list[tuple[float, Any]]:
        """Remembered values (time [s], value) at instants before, oldest first."""
        return self.run.history.past(value, self.time)

    def course(self, value: Value, variant: str | None = None, until: float = math.inf) -> tuple[Floats, Floats]:
        """Times (n,) [s] and values (n, ...) of a value that was requested."""
        if self.run.ahead:
            return np.array([self.time]), np.array([self.measure(value)])
        return self.run.course(value, variant, until)

    def read(self, task: str, output: str) -> Any:
        """An output of a part now."""
        kind = self.run.graph.tasks[task].kind
        if isinstance(kind, Model | Contact | Tie) and not (isinstance(kind, Model) and kind.kinematic):
            state = self.state(task)
            if (task, output) not in self._values:  # two hundred tubes may go through one list of places
                self._values[task, output] = kind.read(output, state), True
            return self._values[task, output][0]
        if isinstance(kind, Object) and output in kind.gives:
            return kind.read(output, self)
        if (task, output) not in self._values:
            asked, self.asked = self.asked, False
            expr = kind.formula(output) if isinstance(kind, Model) else getattr(kind, output).expr
            self._values[task, output] = self._evaluate(expr), self.asked
            self.asked = asked
        value, varies = self._values[task, output]
        self.asked = self.asked or varies
        return value

    def state(self, name: str) -> ModelState:
        """The state of a dynamic model or contact now."""
        self.asked = True
        if name not in self._states:
            self._states[name] = self.run.state(name)
        return self._states[name]

    def object(self, ref: Ref) -> Object:
        """The kind of an object."""
        return cast(Object, self.run.graph.tasks[ref.name].kind)

    def surface(self, name: str, material: Ref | None, color: Value | None) -> Surface:
        """The surface of a drawn part: its material's, recolored where ``color`` is given.

        Without a material a default color.
        """
        from sceneql.frame import Surface

        with self.coloring():
            own = None if color is None else linear(self.at(color))
            if material is None:
                return Surface(color=own or default_color(self.run.palette.get(name, 0)), roughness=0.35)
            kind = cast(Material, self.run.graph.tasks[material.name].kind)
            return kind.surface(self, own)

    @contextmanager
    def coloring(self) -> Iterator[None]:
        """Context manager: values read inside only color shapes, so they cannot move a shape out of its bounds."""
        before = self.asked
        yield
        self.asked = before

    def bounds(self, names: Iterable[str]) -> tuple[Floats, Floats]:
        """Low and high corner (3,) [m] of what the parts draw over the whole film; without names of all that stays."""
        asked = list(names)
        boxes = self._of_panels(lambda run: None if (box := run.bounds(asked)) is None else np.array(box))
        return (boxes.min(axis=0), boxes.max(axis=0)) if len(boxes) else (np.full(3, -1.0), np.full(3, 1.0))

    def around(self) -> tuple[Floats, Floats] | None:
        """Low and high corner (3,) [m] around what the picture shows now; None where that is not known or nothing."""
        from sceneql.shapes.world_boxes import box_of

        boxes = np.array([box_of(shape) for shape in self.shown or ()]).reshape(-1, 2, 3)
        boxes = boxes[np.isfinite(boxes).all(axis=(1, 2))]
        return (boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)) if len(boxes) else None

    def boxes(self) -> Floats:
        """Low and high corners (n, 2, 3) [m] of each part that is drawn, over the whole film, in all panels."""
        found = [
            np.array(list(known.values())).reshape(-1, 2, 3) for run in self._together[0] if (known := run.boxes())
        ]
        return np.concatenate([np.zeros((0, 2, 3)), *found])

    def outline(self) -> Floats:
        """Points (n, 3) [m] whose hull encloses all that stays over the whole film, in all panels."""
        points = self._of_panels(lambda run: run.outline())
        self.run.diverged = self._together[1]
        return points if len(points) else np.array([[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]])

    def standing(self) -> Floats:
        """Points (n, 3) [m] whose hull encloses all that does not change, in all panels."""
        return self._of_panels(lambda run: run.standing())

    def moving(self, window: float | None) -> Floats:
        """Instants [s] and points [m], rows (n, 1 + 3), whose hull at each instant encloses all that moves and stays.

        In all panels; none where nothing moves. ``window``: for how long at once a camera shows it [s], with all that
        stands; None: a camera shows it alone.
        """
        return self._of_panels(lambda run: run.moving(window))

    def left_out(self) -> Floats:
        """Instants [s] and points [m], rows (n, 1 + 3), of what moves where panels' common framing leaves this out."""
        out = any(one.graph is self.run.graph and not one.burst for one in self._together[1])
        return self.run.moving(self.end) if out else np.zeros((0, 4))

    @property
    def _together(self) -> tuple[list[Framed], list[Diverged]]:
        """This run and those beside it that share one framing, and the variants left out (diverging.together)."""
        runs = () if self.run.ahead else (self.run, *self.beside)
        return self.kept("panels of variants", tuple(map(id, runs)), lambda: together(runs))

    def _of_panels(self, points_of: Callable[[Framed], Floats | None]) -> Floats:
        """Finite rows of this run and of those beside it, except variants that diverge; a row ends in a place."""
        found = [points for run in self._together[0] if (points := points_of(run)) is not None and len(points)]
        rows = np.concatenate(found) if found else np.zeros((0, 3))
        whole: Floats = rows[np.isfinite(rows).all(axis=1)]
        return whole

    def place(self, name: str) -> Floats:
        """(3, 4) map to the world from the coordinates of an object's position."""
        holder = self.run.holders.get(name)
        if holder is None:
            return IDENTITY
        kind = self.run.graph.tasks[holder].kind
        return compose(self.place(holder), kind.local(self)) if isinstance(kind, Placed) else self.place(holder)

    def kept(self, name: str, key: Hashable, make: Callable[[], T]) -> T:
        """The cached result for a part where its key equals ``key``; else ``make()``, which replaces it."""
        known, made = self.run.kept.get(name, (None, None))
        if made is None or known != key:
            made = make()
            self.run.kept[name] = key, made
        return cast(T, made)

    def lower(self, names: Iterable[str], *, fields: bool = False) -> list[Drawn]:
        """The shapes of the named objects and models.

        With ``fields`` objects that have an inside come as implicit fields.
        """
        shapes: list[Drawn] = []
        for name in names:
            task = self.run.graph.tasks[name]
            with failing_as(name, self.now, task.span):
                if isinstance(task.kind, Object) and fields:
                    from sceneql.shapes.solid import by_field

                    shapes += by_field(task.kind, name, self.place(name), self)
                elif isinstance(task.kind, Object):
                    shapes += task.kind.lower(name, IDENTITY, self)
                elif isinstance(task.kind, Model):
                    shapes += task.kind.lower(name, self.state(name), self)
        return shapes

    def supports(self, names: Iterable[str]) -> list[Drawn]:
        """The shapes of what holds the named objects to the world."""
        shown = set(names)
        return [shape for name, shape in self.run.supports if name in shown]

    @cached_property
    def everything(self) -> list[str]:
        """Names of the parts that any picture draws, in order."""
        return list(self.run.orders)
