"""What a benchmark's runs are compared with: the script's exact numbers, or a far tighter run by another method."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, cast

from sceneql.compiler.catalogue import Catalogue
from sceneql.failure import RunFailure
from sceneql.graph import Island, SimulationGraph
from sceneql.kinds import Expect, Solver
from sceneql.quantities.expression import Call, Expr, Link, Symbol, walk
from sceneql.quantities.operations import OPERATIONS
from sceneql.report.expect import measure
from sceneql.report.work_precision import Reference, at, run

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.simulation.run import Instant, IslandRun

TIGHTEST, LOOSER = 1e-13, 1e-12
"""Tolerances of the reference, and of a second run: how far they are apart bounds the error of the first."""
ROUNDING = 1e-14


def reference(graph: SimulationGraph, island: Island, catalogue: Catalogue) -> Reference:
    """The exact numbers that the script has for the end; else a run at a far tighter tolerance by another method.

    Raises RunFailure where the reference itself cannot reach the end.
    """
    exact = {name: e for name, e in graph.settings.expect.items() if _tells_the_end(e, island)}
    if exact:
        return _exact(exact, graph.settings.clock.end)
    dopri5 = cast(Solver, cast(type[Solver], catalogue.load("solvers", "dopri5")).model_validate({}))
    rough = run(graph, island, at(dopri5, LOOSER))[1]
    if rough.assembly.contact_mode == "none":
        fine, coarse = _by_dop853(rough, TIGHTEST), _by_dop853(rough, LOOSER)
        because = f"scipy's DOP853 at rtol {TIGHTEST:g}"
    else:
        fine, coarse = _end(run(graph, island, at(dopri5, TIGHTEST))[1]), _end(rough)
        because = f"our own dopri5 at tolerance {TIGHTEST:g}: no other method here knows contacts"
    uncertainty = max(ROUNDING, _difference(coarse, fine, rough))
    return Reference(lambda moment, march: _difference(_end(march), fine, march), because, uncertainty)


def _tells_the_end(expect: Expect, island: Island) -> bool:
    """Whether an expectation is an exact value, at the end of the run, of what this island does."""
    if expect.value is None or "exact" not in expect.because or expect.variant is not None:
        return False
    nodes = list(walk(expect.of.expr))
    series = {node.op for node in nodes if isinstance(node, Call) and OPERATIONS[node.op].series}
    links = {node.task for node in nodes if isinstance(node, Link)}
    return series == {"final"} and bool(links) and links <= {*island.models, *(name for name, _, _ in island.contacts)}


def _exact(expectations: Mapping[str, Expect], end: float) -> Reference:
    def value(expr: Expr, moment: Instant) -> Floats:
        import numpy as np

        links = [node for node in walk(expr) if isinstance(node, Link)]
        series = {link: np.array([moment.read(link.task, link.output)]) for link in links}
        return np.asarray(measure(expr, {Symbol("time"): np.array([end]), **series}, [end]), dtype=np.float64)

    def error(moment: Instant, march: IslandRun) -> float:
        import numpy as np

        largest = 0.0
        for expect in expectations.values():
            assert expect.value is not None
            got, wanted = value(expect.of.expr, moment), value(expect.value.expr, moment)
            largest = max(largest, float(np.max(np.abs(got - wanted))) / (float(np.max(np.abs(wanted))) or 1.0))
        return largest

    return Reference(error, f"exact: {', '.join(expectations)}", ROUNDING)


def _by_dop853(island: IslandRun, tolerance: float) -> Floats:
    """The end of an island by scipy's DOP853 (Hairer, Norsett & Wanner 1993, II.5) on the compiled rate."""
    import numpy as np
    from scipy.integrate import solve_ivp

    march = island.march
    start = march.system.y
    scale = np.maximum(np.abs(start), 1e-3 * np.abs(_end(island)).max(initial=1e-300))
    found = solve_ivp(march.rate, (0.0, march.end), start, method="DOP853", rtol=tolerance, atol=tolerance * scale)
    if not found.success:
        raise RunFailure(found.message, part="the reference", time=float(found.t[-1]), span=None)
    return np.asarray(found.y[:, -1], dtype=np.float64)


def _end(island: IslandRun) -> Floats:
    y, _ = island.march.advance(island.march.end)
    return y


def _difference(y: Floats, reference: Floats, island: IslandRun) -> float:
    """Largest difference in an entry of the models' states, relative to the largest entry of the reference."""
    import numpy as np

    mine = np.zeros(len(y), dtype=bool)
    for first, last, part, _ in island.march.system.ranges:
        mine[first:last] = part in island.island.models  # contacts keep their records in the state, too
    return float(np.max(np.abs(y - reference)[mine])) / (float(np.max(np.abs(reference[mine]))) or 1.0)
