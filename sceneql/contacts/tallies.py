"""Outputs, remarks and troubles of the word `collision`, from the integers that it remembers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sceneql.system import ModelState

RIGID = ("points", "normals", "forces")
TALLY = ("hits.count", "hits.first.time", "hits.last.time", "hits.last.speed", "rest.time")
BARRIER, SPRINGS, CARRIED = -3, -4, -5
"""Marks in the remembered integers: after them stand those of a barrier, of the memory of masses with rigid bodies,
and of skins in a flow."""


def read(output: str, state: ModelState) -> Any:
    """Output over all models: counts are summed, first times are the earliest, last times the latest."""
    import numpy as np

    if output in RIGID:
        return _rigid(output, state)
    marks = (k for k, each in enumerate(state.ints) if each in (-1, -2, BARRIER, CARRIED))
    ints = state.ints[: next(marks, len(state.ints))]
    tallies = np.array([state.floats[at : at + len(TALLY)] for at in ints]).reshape(-1, len(TALLY))
    column = tallies[:, TALLY.index(output)]
    if output == "hits.count":
        return float(column.sum())
    times = column if output != "hits.last.speed" else tallies[:, TALLY.index("hits.last.time")]
    known = np.flatnonzero(~np.isnan(times))
    if len(known) == 0 or (output == "rest.time" and len(known) < len(tallies)):
        return 0.0 if output == "hits.last.speed" else float("nan")
    best = known[np.argmin(times[known]) if output == "hits.first.time" else np.argmax(times[known])]
    return float(column[best])


def tally(state: ModelState) -> Any:
    """Tally (5,) of the first contact, in the order of TALLY."""
    return state.floats[state.ints[0] : state.ints[0] + len(TALLY)]


def remark(state: ModelState) -> str:
    """Remark about the gap of barriers, or of skins in a flow; empty without these."""
    if CARRIED in state.ints:
        gap = state.floats[state.ints[state.ints.index(CARRIED) + 1]]
        return f"skins in the flow are pushed off within a gap of {gap:.3g} m"
    if BARRIER not in state.ints:
        return ""
    gap, slip = state.floats[state.ints[state.ints.index(BARRIER) + 1] :][:2]
    return f"elastic solids are pushed off within a gap of {gap:.3g} m; friction is smooth below {slip:.2g} m/s"


def trouble(state: ModelState) -> str:
    """Message about steps too long for springs, jammed instants, and crowded or unsolved steps; empty if none."""
    at = [k for k, each in enumerate(state.ints) if each == -1]
    longer, longest = _too_long(state)
    if longer:
        told = f"in {_steps(longer)} longer than {longest:.2g} s masses on springs touched something: "
        return told + "where rigid bodies collide, too, such steps can make energy: shorter ones, or `auto`, do not"
    jammed = sum(state.floats[state.ints[k + 1]] for k, each in enumerate(state.ints) if each == -2)
    if jammed:
        return f"at {jammed:.0f} instants no force fitted the slip of rigid bodies: friction stopped it at once"
    loose, crowded = (sum(state.floats[state.ints[k + j]] for k in at) for j in (5, 6))
    if crowded:
        return f"in {_steps(crowded)} rigid bodies had more contacts than outputs have room for: all acted"
    if not loose:
        return ""
    return f"in {_steps(loose)} contacts of rigid bodies were not solved: friction there is not exact"


def _steps(count: float) -> str:
    """So many steps."""
    return "1 step" if count == 1 else f"{count:.0f} steps"


def _too_long(state: ModelState) -> tuple[float, float]:
    """Number of steps too long for the springs of masses with rigid bodies, and the longest stable step [s]."""
    if SPRINGS not in state.ints:
        return 0.0, 0.0
    from sceneql.contacts.distance.mass_points_kernels import LONGER, LONGEST

    at = state.ints[state.ints.index(SPRINGS) + 1]
    return float(state.floats[at + LONGER]), float(state.floats[at + LONGEST])


def _rigid(output: str, state: ModelState) -> Any:
    """Points [m], normals or forces [N], (n, 3), of the contacts of rigid bodies at the end of the latest step."""
    import numpy as np

    if -1 not in state.ints:
        return np.zeros((0, 3))
    count_at, *places = state.ints[state.ints.index(-1) + 1 :][:4]
    count, at = int(state.floats[count_at]), places[RIGID.index(output)]
    return state.floats[at : at + 3 * count].reshape(-1, 3).copy()
