"""gauss_radau15: orbits to machine precision."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, Any

from sceneql.kinds import FixedScalar, FixedTime, Solver, field
from sceneql.system import Control, Method, Needs, Prepared, Stepper

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.island.system import System

KERNELS = "sceneql.words.solvers.gauss_radau15_kernels"


class GaussRadau15(Solver):
    """Everhart's method of order 15 on Gauss-Radau nodes, for smooth forces and long, accurate orbits.

    Inside a step the accelerations are a polynomial of degree 7, found by iteration from the one before; velocities and
    positions are its exact integrals, added up with compensation, so that the error of the energy grows as a random
    walk of rounding errors. Forces may depend on velocities; states without a velocity are integrated once, and set no
    step where others have one. Steps follow the shortest time in which a body's acceleration changes by its own size.
    It is not for stiff systems, whose iteration does not converge.
    Source: Everhart (1985), IAU Colloq. 83, 185-202; Rein & Spiegel (2015), MNRAS 446, 1424-1437; Pham, Rein & Spiegel
    (2024), Open J. Astrophys. 7, for the length of the steps.
    """

    tolerance: FixedScalar = field(
        "Size of the polynomial's last term against the whole: not the error, which is far smaller.",
        "1e-9",
        at_least=1e-14,
        below=1,
    )
    first_step: FixedTime | None = field("Length of the first step; by default it is chosen.", None, above=0)
    largest_step: FixedTime | None = field("Longest step allowed.", None, above=0)

    def stepper(self) -> Stepper:
        """Steps by the method's own control, with its polynomial as dense output."""
        return Stepper(
            Method(step=f"{KERNELS}:step", order=15, dense=f"{KERNELS}:dense"),
            Control(
                first_step=self.first_step or 0.0,
                adaptive=True,
                tolerance=self.tolerance,
                absolute=self.tolerance,
                largest_step=self.largest_step or inf,
                self_controlled=True,
            ),
            Needs(prepare=f"{__name__}:prepare"),
        )

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """Spectral radius of the step's matrix; infinite where its iteration does not converge."""
        from sceneql.stepping.gauss_radau import growth

        return growth(jacobian, partner, step)


def prepare(system: System, stepper: Stepper) -> Prepared:
    """Lists of the entries that are positions, velocities or neither, and the numbers of the method."""
    import numpy as np

    from sceneql.stepping.gauss_radau import settings
    from sceneql.words.solvers.gauss_radau15_kernels import HEAD, VECTORS

    first, count = system.ints[:2]
    pairs = system.ints[first : first + 3 * count].reshape(-1, 3)
    positions = np.concatenate([np.arange(x, x + n) for x, _, n in pairs] or [np.zeros(0, dtype=int)])
    velocities = system.partner[positions]
    others = np.setdiff1d(np.flatnonzero(system.partner < 0), velocities)
    paired = {entry for x, v, _ in pairs for entry in (x, v)}
    loose = [(at, n) for at, n in system.alike if at not in paired]
    whole = {at for at, _ in system.alike}
    alike = np.concatenate([np.arange(at, at + n) for at, n in loose] or [np.zeros(0, dtype=int)])
    pushed = np.concatenate([velocities, alike, np.setdiff1d(others, alike)])
    # Components of a body share one time scale, as do all states of one copy of equations, and all cells of a field.
    sizes = [size for _, v, n in pairs for size in ([3] * (n // 3) if n % 3 == 0 and v not in whole else [n])]
    sizes = sizes + [n for _, n in loose] or [len(pushed)]
    numbers = np.concatenate(
        [(int(stepper.control.adaptive), len(pushed), len(positions), len(sizes)), pushed, positions, np.cumsum(sizes)]
    )
    return Prepared((stepper.control.tolerance, *settings()), numbers.astype(np.int64), HEAD + VECTORS * len(system.y))
