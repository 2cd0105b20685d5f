"""The generated driver of an island: kernels that call the island's own kernels with their integers.

Its text depends on the `Structure` alone, so that it is written and compiled once for all scenes of that structure.
``ints`` are laid out as in island.layout.
"""

from __future__ import annotations

from functools import cache
from importlib import import_module
from itertools import chain
from typing import Any, NamedTuple

import sceneql.system.channels as channels
from sceneql.compiled.generated import load, write
from sceneql.compiled.kernels import cache_folder
from sceneql.island import layout
from sceneql.island.system import Structure, System

TABLE = f"ints[{layout.TABLE_AT}]"
BORDERED = (
    "    end = ints[s] + ints[s + 1]",
    "    rate_at(functions[AT_RATE])(t, y, values[end : end + y.size], floats, ints)",
)
"""Lines that evaluate the rate behind the Jacobian's values, for slopes that need what terms write."""
REFRESH = f"    refresh(t, y, floats, ints[ints[{TABLE}] : ints[{TABLE} + 1]])"


class Driver(NamedTuple):
    """The kernels of an island (system/__init__.py has their signatures)."""

    rate: Any
    gap: Any
    impact: Any
    back_off: Any
    after_step: Any
    settle: Any
    free_motion: Any
    tied_drift: Any


def driver(structure: Structure) -> Driver:
    """The driver of a structure, from the cache where it has been compiled before."""
    return _driver(structure, text(structure))


@cache
def _driver(structure: Structure, code: str) -> Driver:
    module = import_module("sceneql.march.march_kernels")
    source = load(write("driver", code))
    if structure.exact:
        gap, impact = source.gap, source.impact
    else:
        gap, impact = module.no_gap, module.no_impact
    back_off = source.back_off if structure.local else module.no_back_off
    after = source.after_step if structure.after else module.no_act
    settle = source.settle if structure.settling else module.no_act
    free = source.free_motion if structure.free else module.no_free_motion
    tied = source.tied_drift if structure.tied else module.no_tied_drift
    return Driver(source.rate, gap, impact, back_off, after, settle, free, tied)


def jacobian(system: System) -> Any:
    """The Jacobian kernel of an island laid out with one; None where it is too large to be found by differences."""
    if system.pattern is None:
        return None
    if system.pattern.exact:
        return _slopes_module(jacobian_text(system.structure)).jacobian
    return load("sceneql.march.differences_kernels").differences


def energy(system: System) -> Any:
    """The potential energy of an island laid out with a Jacobian; None where it has none."""
    if system.pattern is None or system.structure.energies is None:
        return None
    return _slopes_module(jacobian_text(system.structure)).energy


def limit(system: System) -> Any:
    """The largest part of a change that keeps surfaces apart; None on an island without such surfaces."""
    return load(write("limit", limit_text(system.structure))).limit if system.structure.limits else None


def limit_text(structure: Structure) -> str:
    """The text of its module."""
    names = {name: f"kernel_{k}" for k, name in enumerate(structure.limits)}
    before = (structure.terms, structure.exact, structure.local, structure.after)
    others = (structure.settling, structure.free, structure.tied)
    first = layout.GROUPS_AT + sum(len(some) for some in (*before, *others))
    lines = [
        *_imports(names),
        "from sceneql.compiled.kernels import lean",
        *(["from sceneql.island.inputs_kernels import refresh"] if structure.varying else []),
        "from sceneql.system.signatures_kernels import LIMIT",
        *("", "", "@lean(LIMIT)", "def limit(t, y, changed, floats, ints):"),
        *([REFRESH.replace("(t, y,", "(t, changed,")] if structure.varying else []),
        "    part = 1.0",
    ]
    for group, name in enumerate(structure.limits, first):
        call = f"{names[name]}(t, y, changed, floats, ints[ints[b] : ints[b + 1]])"
        lines += _blocks(group, f"part = min(part, {call})")
    return "\n".join([*lines, "    return part"]) + "\n"


@cache
def _slopes_module(code: str) -> Any:
    return load(write("jacobian", code))


def jacobian_text(structure: Structure) -> str:
    """The text of the Jacobian's module."""
    pairs = [name.split("|") for name in structure.slopes or ()]
    names = {pair[0]: f"kernel_{k}" for k, pair in enumerate(pairs)}
    energies = structure.energies or ()
    lazily = list(dict.fromkeys([*(pair[1] for pair in pairs if len(pair) > 1), *filter(None, energies)]))
    lines = [
        *_imports(names),
        "from sceneql.compiled.kernels import lean",
        *(["from sceneql.compiled.numba.lazy_kernels import lazy"] if lazily else []),
        *(["from sceneql.island.inputs_kernels import refresh"] if structure.varying else []),
        *(["from sceneql.compiled.pointers_kernels import AT_RATE, rate_at"] if structure.bordered else []),
        "from sceneql.island.jacobian_kernels import gather",
        "from sceneql.system.signatures_kernels import ENERGY, JACOBIAN, TERM",
        *(f'lazy_{k} = lazy("{name}", {"ENERGY" if name in energies else "TERM"})' for k, name in enumerate(lazily)),
        *("", "", "@lean(JACOBIAN)", "def jacobian(functions, t, y, values, floats, ints):"),
        *([REFRESH] if structure.varying else []),
        f"    s = ints[{layout.SLOPES_AT}]",
        *(BORDERED if structure.bordered else []),
        "    for k in range(ints[s], ints[s] + ints[s + 1]):",
        "        values[k] = 0.0",
    ]
    for group, pair in enumerate(pairs, layout.HEAD):
        lines.append(f"    for b in range(ints[s + {group}], ints[s + {group + 1}], 4):")
        call = "(t, y, values[ints[b + 2] : ints[b + 3]], floats, ints[ints[b] : ints[b + 1]])"
        if len(pair) > 1:
            lines += [
                f"        if floats[{channels.POSITIVE}] != 0.0:",
                f"            lazy_{lazily.index(pair[1])}{call}",
            ]
            lines += ["            continue"]
        lines.append(f"        {names[pair[0]]}{call}")
    lines.append("    gather(t, y, values, floats, ints)")
    if structure.energies is not None:
        lines += ["", "", "@lean(ENERGY)", "def energy(t, y, floats, ints):", "    total = 0.0"]
        for group, name in enumerate(structure.energies, layout.GROUPS_AT):
            if name:
                lines += _blocks(
                    group, f"total += lazy_{lazily.index(name)}(t, y, floats, ints[ints[b] : ints[b + 1]])"
                )
        lines.append("    return total")
    return "\n".join(lines) + "\n"


def modules(structure: Structure) -> tuple[str, ...]:
    """The modules of an island's kernels; those of contacts, as a rule the largest, first.

    Free motions and tied drifts, which only splittings ask for, are compiled at their first call.
    """
    slopes = (name.partition("|")[0] for name in structure.slopes or ())
    after = (*slopes, *structure.after, *structure.settling, *structure.limits)
    names = (*structure.local, *chain(*structure.exact), *after, *structure.terms)
    return tuple(dict.fromkeys(name.partition(":")[0] for name in names))


def lazy_first(structure: Structure) -> list[str]:
    """Lazily compiled modules that contacts will soon need, in order: another process can begin with these."""
    local = dict.fromkeys(name.partition(":")[0] for name in structure.local)
    return [first for module in local for first in getattr(load(module), "LAZY_FIRST", ())]


def text(structure: Structure) -> str:
    """The module's text."""
    names: dict[str, str] = {}
    between = (*structure.local, *structure.after, *structure.settling)
    for name in (*structure.terms, *chain(*structure.exact), *between):
        names.setdefault(name, f"kernel_{len(names)}")
    lines = [
        *_imports(names),
        "from sceneql.compiled.kernels import lean",
        *(["from sceneql.island.inputs_kernels import refresh"] if structure.varying else []),
        "from sceneql.system.signatures_kernels import AFTER_STEP, BACK_OFF, GAP, IMPACT, TERM",
        *(["from sceneql.system.signatures_kernels import FREE_MOTION"] if structure.free else []),
        *(["from sceneql.system.signatures_kernels import TIED_DRIFT, TIED_DRIFT_OF"] if structure.tied else []),
        *(["from sceneql.compiled.numba.lazy_kernels import lazy"] if structure.free or structure.tied else []),
        *(f'free_{k} = lazy("{name}", FREE_MOTION)' for k, name in enumerate(structure.free)),
        *(f'tied_{k} = lazy("{name}", TIED_DRIFT_OF)' for k, name in enumerate(structure.tied)),
    ]
    refresh = [REFRESH] if structure.varying else []
    group = layout.GROUPS_AT
    lines += ["", "", "@lean(TERM)", "def rate(t, y, rate, floats, ints):"]
    lines += [f"    floats[{channels.RATES}] += 1.0", *refresh]
    lines += ["    for k in range(rate.size):", "        rate[k] = 0.0"]
    for name in structure.terms:
        lines += _blocks(group, f"{names[name]}(t, y, rate, floats, ints[ints[b] : ints[b + 1]])")
        group += 1
    if structure.exact:
        lines += _contacts(structure, names, group, refresh)
    group += len(structure.exact)
    at_the_end = [line.replace("(t, y,", "(t1, y1,") for line in refresh]
    call = "{}(t0, t1, y0, rate0, y1, floats, ints[ints[b] : ints[b + 1]])"
    if structure.local:
        lines += ["", "", "@lean(BACK_OFF)", "def back_off(t0, t1, y0, rate0, y1, floats, ints):", *at_the_end]
        for k, name in enumerate(structure.local, group):
            lines += _blocks(k, call.format(names[name]))
    group += len(structure.local)
    for function, acting in (("after_step", structure.after), ("settle", structure.settling)):
        if acting:
            lines += ["", "", "@lean(AFTER_STEP)", f"def {function}(t0, t1, y0, rate0, y1, floats, ints):", *at_the_end]
            lines.append("    changed = False")
        for k, name in enumerate(acting, group):
            lines += _blocks(k, f"changed |= {call.format(names[name])}")
        group += len(acting)
        lines += ["    return changed"] if acting else []
    if structure.free:
        lines += ["", "", "@lean(FREE_MOTION)", "def free_motion(h, y, floats, ints):"]
        for k in range(len(structure.free)):
            lines += _blocks(group + k, f"free_{k}(h, y, floats, ints[ints[b] : ints[b + 1]])")
    group += len(structure.free)
    if structure.tied:
        lines += ["", "", "@lean(TIED_DRIFT)", "def tied_drift(functions, h, y0, kicked, y1, floats, ints):"]
        for k in range(len(structure.tied)):
            call = f"tied_{k}(functions, h, y0, kicked, y1, floats, ints, ints[ints[b] : ints[b + 1]])"
            lines += _blocks(group + k, call)
    return "\n".join(lines) + "\n"


def _imports(names: dict[str, str]) -> list[str]:
    """The kernels' hashes (as comments: a changed kernel makes another module) and imports."""
    modules = dict.fromkeys(name.partition(":")[0] for name in names)
    lines = [f"# {module} {cache_folder(load(module).__name__)}" for module in modules]
    for name, short in names.items():
        module, _, attribute = name.partition(":")
        lines.append(f"from {module} import {attribute} as {short}")
    return lines


def _blocks(group: int, *calls: str) -> list[str]:
    return [f"    for b in range(ints[{group}], ints[{group + 1}]):", *(f"        {call}" for call in calls)]


def _contacts(structure: Structure, names: dict[str, str], first: int, refresh: list[str]) -> list[str]:
    at = f"ints[{layout.RANGES_AT}] + b - ints[{first}]"
    pair_range = (f"p = ints[{at}]", f"q = ints[{at} + 1]")
    lines = ["", "", "@lean(GAP)", "def gap(t, y, gaps, floats, ints):", *refresh]
    for group, (gap, _) in enumerate(structure.exact, first):
        call = f"{names[gap]}(t, y, gaps[p:q], floats, ints[ints[b] : ints[b + 1]])"
        lines += _blocks(group, *pair_range, call)
    lines += ["", "", "@lean(IMPACT)", "def impact(t, y, pair, floats, ints):", *refresh]
    for group, (_, impact) in enumerate(structure.exact, first):
        call = f"{names[impact]}(t, y, pair if pair < 0 else pair - p, floats, ints[ints[b] : ints[b + 1]])"
        lines += _blocks(group, *pair_range, "if pair < 0 or p <= pair < q:", f"    {call}")
    return lines
