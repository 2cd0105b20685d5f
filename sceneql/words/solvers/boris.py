"""boris: the method of plasma physics for charges in magnetic fields."""

from __future__ import annotations

import cmath
import math
from typing import TYPE_CHECKING, Any, ClassVar

from sceneql.kinds import FixedTime, Solver, field
from sceneql.kinds.eigenvalues import eigenvalues
from sceneql.stepping.splitting import VERLET

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.system import Stepper


class Boris(Solver):
    """Boris' method, order 2: half a kick by all forces but the magnetic one, its turn by the exact angle, half a kick.

    Positions drift by half a step before and after, as in leapfrog. In a magnetic field alone speeds keep to rounding
    (1e-12 over 1e5 steps), and in a uniform one the phase is exact, too; with an electric field across it the drift E/B
    comes out times (a/2)/tan(a/2), a = step q B/m being the angle of a step. Reversible in time, with the magnetic
    field, where other forces do not depend on the velocity; those that do, such as drag, see it in the middle of the
    step. The angular velocity of the turn, -q B/m, is read off the accelerations of all bodies at rest and moving along
    x and along y at once: five evaluations a step. States without a velocity advance by the midpoint rule.
    Source: Boris (1970), Proc. 4th Conf. Numerical Simulation of Plasmas, 3-67; Birdsall & Langdon, Plasma Physics via
    Computer Simulation (1985), section 4-4.
    """

    refuses_ties: ClassVar[str] = "its kicks and turns are those of free charges"

    step: FixedTime = field("Length of a step.", "1 ms", above=0)

    def stepper(self) -> Stepper:
        """Fixed steps."""
        from sceneql.system import Control, Method, Stepper

        return Stepper(
            Method(step="sceneql.words.solvers.boris_kernels:step", order=2, work=4), Control(first_step=self.step)
        )

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """Spectral radius of the step's matrix; three pairs make a body, that turns, two one that turns in a plane."""
        import numpy as np

        j, of = np.asarray(jacobian, dtype=float), np.asarray(partner)
        n = len(j)
        positions = np.flatnonzero(of >= 0)
        velocities = of[positions]
        spin, half_turn = np.zeros((n, n)), np.eye(n)
        if len(velocities) % 3 == 0:
            bodies = velocities.reshape(-1, 3)
            along_x, along_y = j[:, bodies[:, 0]].sum(axis=1), j[:, bodies[:, 1]].sum(axis=1)
            for a, b, c in bodies:
                turn = _cross(along_y[c], -along_x[c], 0.5 * (along_x[b] - along_y[a]))
                spin[np.ix_((a, b, c), (a, b, c))] = turn
                half_turn[np.ix_((a, b, c), (a, b, c))] = _turned(turn, 0.5 * step)
        elif len(velocities) == 2:
            a, b = velocities
            turn = _cross(0.0, 0.0, 0.5 * (j[b, a] - j[a, b]))
            spin[np.ix_((a, b), (a, b))] = turn[:2, :2]
            half_turn[np.ix_((a, b), (a, b))] = _turned(turn, 0.5 * step)[:2, :2]
        start = np.eye(n)
        seen = half_turn @ (start + 0.5 * step * (j - spin))
        seen[positions] = start[positions] + 0.5 * step * start[velocities]
        kick = (j - spin) @ seen
        end = half_turn @ half_turn @ (start + 0.5 * step * kick) + 0.5 * step * kick
        end[positions] = seen[positions] + 0.5 * step * end[velocities]
        return float(np.abs(np.linalg.eigvals(end)).max(initial=0.0))

    def oscillation(self, frequency: float, decay: float, step: float, turn: float = 0.0) -> float | None:
        """That of leapfrog without damping, where the steps are the same in another order; else of its own map."""
        if not decay and not turn:
            return VERLET.oscillation(frequency, decay, step)
        half = cmath.exp(0.5j * turn * step)
        # (e^(i turn step) - 1)/step, without cancellation.
        round_ = 2j * math.sin(0.5 * turn * step) * half / step
        columns = []
        for x, v in ((1.0, 0.0), (0.0, 1.0)):
            place = x + 0.5 * step * v
            kick = -(frequency**2) * place - decay * half * (v + 0.5 * step * (-(frequency**2) * x - decay * v))
            pushed = round_ * v + 0.5 * (half * half + 1.0) * kick
            columns.append((v + 0.5 * step * pushed, pushed))
        return max(abs(1.0 + step * change) for change in eigenvalues(list(zip(*columns, strict=True))))


def _cross(x: float, y: float, z: float) -> Floats:
    """Matrix (3, 3) of the vector product with (x, y, z) on the left."""
    import numpy as np

    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def _turned(spin: Floats, time: float) -> Floats:
    """Rotation (3, 3) for ``time`` [s] at an angular velocity, given by its matrix from `_cross` (Rodrigues 1840)."""
    import numpy as np

    speed = float(np.sqrt(0.5 * np.sum(spin * spin)))
    if speed == 0.0:
        return np.eye(3)
    axis = spin / speed
    turned: Floats = np.eye(3) + np.sin(speed * time) * axis + 2.0 * np.sin(0.5 * speed * time) ** 2 * axis @ axis
    return turned
