"""The driver of an island: kernels, the same for all islands, that call the island's own kernels by their addresses.

The addresses stand in the island's integers. So a new combination of forces, contacts and values compiles nothing but
the kernels of its words.
"""

from __future__ import annotations

from itertools import chain
from typing import TYPE_CHECKING, Any, NamedTuple

from sceneql.compiled.generated import function, load
from sceneql.island import layout

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sceneql.island.system import Structure, System

RATE = "sceneql.march.driver_kernels"
CONTACTS = "sceneql.march.driver_contacts_kernels"
LOCAL = "sceneql.march.driver_local_kernels"
ACTS = "sceneql.march.driver_acts_kernels"
DRIFTS = "sceneql.march.driver_drifts_kernels"
"""The modules of its kernels: of rates, of contacts in mode exact, in mode local, of what acts beside steps, and of
ties in the drifts of splittings."""


class Driver(NamedTuple):
    """The driver kernels of an island (system/__init__.py has their signatures)."""

    rate: Any
    gap: Any
    impact: Any
    back_off: Any
    after_step: Any
    settle: Any
    free_motion: Any
    tied_drift: Any


def driver(system: System) -> Driver:
    """The driver of an island, with its own kernels compiled except those that only some solvers call."""
    structure = system.structure
    _write(system, layout.CALLS_AT, _calls(structure))
    none = load("sceneql.march.march_kernels")
    met = load(CONTACTS) if structure.exact else none
    gap, impact = (met.gap, met.impact) if structure.exact else (none.no_gap, none.no_impact)
    acts = load(ACTS) if _acts(structure) else none
    return Driver(
        function(f"{RATE}:rate"),
        gap,
        impact,
        function(f"{LOCAL}:back_off") if structure.local else none.no_back_off,
        acts.after_step if structure.after else none.no_act,
        acts.settle if structure.settling else none.no_act,
        acts.free_motion if structure.free else none.no_free_motion,
        load(DRIFTS).tied_drift if structure.tied else none.no_tied_drift,
    )


def jacobian(system: System) -> Any:
    """The Jacobian kernel of an island laid out with one; None where it is too large to be found by differences."""
    if system.pattern is None:
        return None
    if not system.pattern.exact:
        return load("sceneql.march.differences_kernels").differences
    _write(system, system.ints[layout.SLOPES_AT] + layout.KERNELS_AT, _slopes(system.structure))
    return load("sceneql.march.driver_slopes_kernels").jacobian


def energy(system: System) -> Any:
    """The kernel of the potential energy of an island laid out with a Jacobian; None where it has no potential."""
    if system.pattern is None or system.structure.energies is None:
        return None
    return load("sceneql.march.driver_slopes_kernels").energy


def limit(system: System) -> Any:
    """The kernel of the largest change that keeps surfaces apart; None for an island without such surfaces."""
    return load("sceneql.march.driver_limit_kernels").limit if system.structure.limits else None


def modules(structure: Structure) -> tuple[str, ...]:
    """The modules of an island's kernels; those of contacts, as a rule the largest, first.

    Free motions and tied drifts, which only splittings ask for, are compiled at their first call.
    """
    slopes = (name.partition("|")[0] for name in structure.slopes or ())
    after = (*slopes, *structure.after, *structure.settling, *structure.limits)
    names = (*structure.local, *chain(*structure.exact), *after, *structure.terms)
    return tuple(dict.fromkeys(name.partition(":")[0] for name in names))


def own_modules(structure: Structure) -> tuple[str, ...]:
    """The modules that the driver of an island consists of, beside those of the island's kernels."""
    asked = {CONTACTS: structure.exact, LOCAL: structure.local, ACTS: _acts(structure), DRIFTS: structure.tied}
    return (RATE, *(module for module, some in asked.items() if some))


def _acts(structure: Structure) -> bool:
    """Whether anything acts between steps, or bodies move by themselves."""
    return any((structure.after, structure.settling, structure.free))


def lazy_first(structure: Structure) -> list[str]:
    """Lazily compiled modules that contacts will soon need, in order, for another process to begin with."""
    local = dict.fromkeys(name.partition(":")[0] for name in structure.local)
    return [first for module in local for first in getattr(load(module), "LAZY_FIRST", ())]


def _calls(structure: Structure) -> Iterator[int]:
    """The addresses at layout.CALLS_AT."""
    from sceneql.compiled.numba.lazy_kernels import place_of
    from sceneql.compiled.numbered_kernels import number_of
    from sceneql.system import signatures_kernels as kinds

    for name, energy in zip(structure.terms, structure.energies or ("",) * len(structure.terms), strict=True):
        yield number_of(function(name), kinds.TERM)
        yield place_of(energy, kinds.ENERGY) if energy else 0
    for gap, impact in structure.exact:
        yield number_of(function(gap), kinds.GAP)
        yield number_of(function(impact), kinds.IMPACT)
    acting = ((name, kinds.AFTER_STEP) for name in (*structure.after, *structure.settling))
    for name, kind in (*((name, kinds.BACK_OFF) for name in structure.local), *acting):
        yield from (number_of(function(name), kind), 0)
    late = ((name, kinds.TIED_DRIFT_OF) for name in structure.tied)
    for name, kind in (*((name, kinds.FREE_MOTION) for name in structure.free), *late):
        yield from (place_of(name, kind), 0)
    for name in structure.limits:
        yield from (number_of(function(name), kinds.LIMIT), 0)


def _slopes(structure: Structure) -> Iterator[int]:
    """The addresses at layout.KERNELS_AT."""
    from sceneql.compiled.numba.lazy_kernels import place_of
    from sceneql.compiled.numbered_kernels import number_of
    from sceneql.system.signatures_kernels import TERM

    for name in structure.slopes or ():
        kernel, _, positive = name.partition("|")
        yield number_of(function(kernel), TERM)
        yield place_of(positive, TERM) if positive else 0


def _write(system: System, where: int, addresses: Iterator[int]) -> None:
    """Write addresses from index ints[where] on, unless they have been written before."""
    at = system.ints[where]
    for k, one in enumerate(addresses if system.ints[at] == 0 else (), at):
        system.ints[k] = one
