"""A method prepared for an island: its compiled functions, numbers and memory."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.compiled.generated import function
from sceneql.compiled.pointers_kernels import addresses
from sceneql.march import march_kernels as kernels
from sceneql.march.driver import energy, jacobian, limit
from sceneql.system import Prepared

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.island.system import System
    from sceneql.march.driver import Driver
    from sceneql.system import Stepper


@dataclass(frozen=True, slots=True)
class Engaged:
    """The data of a method on one island that the loop of steps uses."""

    stepper: Stepper
    functions: Any
    """Addresses of the compiled functions, as `march_kernels` takes them."""
    dense: Any
    """Function that interpolates the state within a step, from the states and rates at its ends and the method's
    scratch."""
    extend: Any
    """Function that computes further stages for ``dense``; None: it needs none."""
    mixed: bool
    """Whether entries changed after the step (by contacts or births) are interpolated linearly, all others by
    ``dense``."""
    settings: Floats
    numbers: Any
    work: Floats
    """Settings, integers and scratch of the step, which it may change."""
    kept: int
    text: str
    alone: Any
    """(n,) bool: entries whose errors are scaled by their own magnitude alone."""
    scales: tuple[int, int]
    """`kept`, `text` and `scales` as in `Prepared`."""
    told: tuple[tuple[int, int], ...]
    """(index, value) of the counts that describe the method to the loop of steps."""
    first: Prepared
    """Initial `settings` and `numbers`, and the size of the scratch."""

    def begin(self, counts: Any) -> Engaged:
        """A copy of the method with its memory as before the first step; sets the loop's ``counts``."""
        for k, value in self.told:
            counts[k] = value
        settings, numbers = np.array(self.first.settings, np.float64), np.array(self.first.numbers, np.int64)
        return replace(self, settings=settings, numbers=numbers, work=np.zeros(self.first.work))

    @property
    def sizes(self) -> Floats:
        """The error scales (largest magnitudes of entries so far), a view of the settings."""
        first, count = self.scales
        return self.settings[first : first + count]

    def measure_as(self, before: Engaged) -> None:
        """Take over the error scales of the method ``before``, where it measured errors by the same scales."""
        if len(self.sizes) == len(before.sizes) and np.array_equal(self.alone, before.alone):
            self.sizes[:] = before.sizes

    def go_on(self, before: Engaged) -> None:
        """Take over the memory of the same method on the same island, ``before`` its Jacobian had more places."""
        if not self.kept:
            return
        counts = (len(self.stepper.method.settings), len(self.stepper.method.numbers), self.kept)
        pairs = ((self.settings, before.settings), (self.numbers, before.numbers), (self.work, before.work))
        for (new, old), count in zip(pairs, counts, strict=True):
            new[:count] = old[:count]
        self.settings[0] = 0.0


class Methods:
    """The methods of a march, prepared for its island; the march may switch between them."""

    def __init__(self, several: bool) -> None:
        """``several``: whether the march may switch; else nothing is cached."""
        self._several = several
        self._system: System | None = None
        self._laid_out: dict[int, Engaged] = {}

    def begin(self, system: System, stepper: Stepper, driver: Driver, *, counts: Any) -> Engaged:
        """The method at its beginning (`Engaged.begin`).

        Prepared at its first use, and anew after the island was laid out anew.
        """
        if system is not self._system:
            self._system = system
            self._laid_out.clear()
        known = self._laid_out.get(id(stepper)) or engage(system, stepper, driver)
        if self._several:
            self._laid_out[id(stepper)] = known
        return known.begin(counts)


def engage(system: System, stepper: Stepper, driver: Driver) -> Engaged:
    """Prepare a method for an island; `begin` starts it."""
    method, control, needs = stepper.method, stepper.control, stepper.needs
    local = bool(system.structure.local)
    between = needs.jacobian and not needs.newton
    # A method's dense output lacks changes made after its step, as by local contacts in any step.
    mixed = between and (local or bool(system.structure.after))
    dense = None if local and not between else method.dense
    interpolant = kernels.hermite if dense is None else function(dense)
    # With exact contacts steps compute their dense output themselves: after its end a step's contacts may have changed.
    extend = None if method.extend is None or local or system.pairs else function(method.extend)
    # Islands without exact contacts have no events: the kernels that find them are not even loaded.
    event = function("sceneql.march.events_kernels:find_event") if system.pairs else None
    slopes = jacobian(system) if needs.jacobian else None
    potential = energy(system) if needs.newton and (needs.at_rest or not system.damped) else None
    keeps_apart = limit(system)
    functions = addresses(function(method.step), interpolant, *driver, slopes, event, potential, keeps_apart)
    if needs.prepare is None:
        prepared = Prepared(method.settings, method.numbers, max(1, method.work) * len(system.y))
    else:
        prepared = function(needs.prepare)(system, stepper)
    last = method.last_stage if prepared.last_stage is None else prepared.last_stage
    told = (
        (kernels.ADAPTIVE, control.adaptive),
        (kernels.ORDER, method.order),
        (kernels.LAST_STAGE, -1 if local and between else last),
        (kernels.CONTROLS, control.self_controlled),
        (kernels.SETTLES, method.settles if system.structure.settling else 0),
        (kernels.HALVES, control.halves),
        # Newton's method keeps surfaces from passing each other by itself, up to the state of its last stage.
        (kernels.WATCHED, keeps_apart is not None and not (needs.newton and method.last_stage >= 0)),
    )
    alone = np.zeros(len(system.y), dtype=bool) if prepared.alone is None else prepared.alone
    return Engaged(
        stepper,
        functions,
        interpolant,
        extend,
        mixed,
        settings=np.zeros(0),
        numbers=np.zeros(0, dtype=np.int64),
        work=np.zeros(0),
        kept=prepared.kept,
        text=prepared.text,
        alone=alone,
        scales=prepared.scales,
        told=told,
        first=prepared,
    )
