"""rodas5p: the Rosenbrock method of Steinebach."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sceneql.kinds import FixedScalar, FixedTime, Solver, field
from sceneql.system import Control, Method, Needs, Prepared, Stepper

if TYPE_CHECKING:
    from sceneql.frame import Floats
    from sceneql.island.system import System

GAMMA = 0.21193756319429014
C = (0.0, 0.6358126895828704, 0.4095798393397535, 0.9769306725060716, 0.4288403609558664, 1.0, 1.0, 1.0)
D = (GAMMA, -0.42387512638858027, -0.3384627126235924, 1.8046452872882734, 2.325825639765069, 0.0, 0.0, 0.0)
STATES = (
    (),
    (3.0,),
    (2.849394379747939, 0.45842242204463923),
    (-6.954028509809101, 2.489845061869568, -10.358996098473584),
    (2.8029986275628964, 0.5072464736228206, -0.3988312541770524, -0.04721187230404641),
    (-7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256, 0.030198172008377946),
)
"""Weights of the previous stages in the states of the first six stages."""
COUPLINGS = (
    (),
    (-14.155112264123755,),
    (-17.97296035885952, -2.859693295451294),
    (147.12150275711716, -1.41221402718213, 71.68940251302358),
    (165.43517024871676, -0.4592823456491126, 42.90938336958603, -5.961986721573306),
    (24.854864614690072, -3.0009227002832186, 47.4931110020768, 5.5814197821558125, -0.6610691825249471),
    (
        30.91273214028599,
        -3.1208243349937974,
        77.79954646070892,
        34.28646028294783,
        -19.097331116725623,
        -28.087943162872662,
    ),
    (
        37.80277123390563,
        -3.2571969029072276,
        112.26918849496327,
        66.9347231244047,
        -40.06618937091002,
        -54.66780262877968,
        -9.48861652309627,
    ),
)
DENSE = (
    (
        25.948786856663858,
        -2.5579724845846235,
        10.433815404888879,
        -2.3679251022685204,
        0.524948541321073,
        1.1241088310450404,
        0.4272876194431874,
        -0.17202221070155493,
    ),
    (
        -9.91568850695171,
        -0.9689944594115154,
        3.0438037242978453,
        -24.495224566215796,
        20.176138334709044,
        15.98066361424651,
        -6.789040303419874,
        -6.710236069923372,
    ),
    (
        11.419903575922262,
        2.8879645146136994,
        72.92137995996029,
        80.12511834622643,
        -52.072871366152654,
        -59.78993625266729,
        -0.15582684282751913,
        4.883087185713722,
    ),
)


class Rodas5p(Solver):
    """Rodas5P: a Rosenbrock method of order 5(4) with eight stages, for stiff problems at middling tolerances.

    Each step evaluates the Jacobian once and solves eight linear systems of one matrix: no Newton iteration, nothing
    that could fail to converge. A-stable and L-stable, with dense output of order 4. The error of a step is measured as
    that of `radau` is; of what the time alone drives it sees less (poles such as 1/(t - 1) may be passed): take radau
    for that. Source: Steinebach (2023), BIT Numer. Math. 63, 27; Hairer & Wanner, Solving Ordinary Differential
    Equations II (1996), IV.7.
    """

    tolerance: FixedScalar = field("Relative error of a step.", "1e-6", at_least=1e-14, below=1)
    absolute: FixedScalar | None = field(
        "Absolute error of a step, in SI units; by default none: errors are relative to how large entries have been.",
        None,
        above=0,
    )
    first_step: FixedTime | None = field("Length of the first step; by default it is chosen.", None, above=0)
    largest_step: FixedTime | None = field("No step is longer; by default as long as contacts allow.", None, above=0)

    def stepper(self) -> Stepper:
        """Steps by the error of the embedded method."""
        absolute = self.tolerance if self.absolute is None else self.absolute
        rows = [entry for row in (*STATES, *COUPLINGS, *DENSE) for entry in row]
        return Stepper(
            Method(
                step="sceneql.words.solvers.rodas5p_kernels:step",
                order=5,
                dense="sceneql.words.solvers.rodas5p_kernels:dense",
                settings=(self.tolerance, absolute, GAMMA, *C, *D, *rows),
                last_stage=0,
            ),
            Control(
                first_step=self.first_step or 0.0,
                adaptive=True,
                tolerance=self.tolerance,
                absolute=absolute,
                by_scale=self.absolute is None,
                largest_step=self.largest_step or float("inf"),
            ),
            Needs(jacobian=True, prepare="sceneql.words.solvers.rodas5p:prepare"),
        )

    def measure(self) -> str:
        """Scales of its own, where no absolute error is given."""
        return "of how large entries have been" if self.absolute is None else super().measure()

    def growth(self, jacobian: Floats, partner: Any, step: float) -> float:
        """max |R(h lambda)|: the method itself on the modes, in complex numbers."""
        import numpy as np

        z = step * np.linalg.eigvals(jacobian)
        stages: list[Any] = []
        state = np.ones_like(z)
        for i, couplings in enumerate(COUPLINGS):
            if i < len(STATES):
                state = 1.0 + sum((w * u for w, u in zip(STATES[i], stages, strict=True)), np.zeros_like(z))
            else:
                state = state + stages[-1]
            inner = z * state + sum((w * u for w, u in zip(couplings, stages, strict=True)), np.zeros_like(z))
            stages.append(GAMMA * inner / (1.0 - GAMMA * z))
        return float(np.abs(state + stages[-1]).max(initial=0.0))


def prepare(system: System, stepper: Stepper) -> Prepared:
    """Arrays for rodas5p_kernels.step on an island."""
    import numpy as np

    from sceneql.linear.stage import stage_plan
    from sceneql.stepping.error_scales import alone, error_scales

    plan = stage_plan(system, exact=True)
    assert system.pattern is not None
    room, stages = system.pattern.room, len(COUPLINGS)
    scaled, sizes = error_scales(system) if stepper.control.by_scale else (np.zeros(0, np.int64), np.zeros(0))
    at = len(stepper.method.settings)
    return Prepared(
        settings=np.concatenate([stepper.method.settings, plan.scales, sizes, [np.nan]]),
        numbers=np.concatenate([[stages, at, room, at + len(plan.scales), len(scaled)], scaled, plan.numbers]),
        work=(4 + stages) * len(system.y) + room + plan.store,
        text=plan.text,
        alone=alone(scaled) if len(scaled) else None,
        scales=(at + len(plan.scales), len(sizes)),
    )
