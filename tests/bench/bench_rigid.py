"""Rigid bodies and ties by solvers: error and time, beside MuJoCo and Exudyn in one run.

    python tests/bench/bench_rigid.py [PART...]

    free     a free body, cases A and B: angle, angular momentum L
    rods     two rods on hinges to 2 and 10 s: angles and rates, gaps of the hinges
    top      a heavy top on a ball, 5 s: how it leans, how far it went round
    chain    10, 100 and 1000 links on hinges: ms a step
    windows  four-bar chains of 1 and 40 windows, 10 s through the places where all links lie in line: energy

A script is loaded and run as a film's is, after a short run of it that compiles. ms are of processor time, of the run
up to the last instant, the median of some runs where it is short. Of the peers, MuJoCo and Exudyn (pip install mujoco
exudyn; left out where they are missing), one compiled call is timed, which takes all steps; `kernel` are ms of the
clock in the compiled steps of ours.
"""

from __future__ import annotations

import math
import statistics
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from sceneql.pipeline import load
from sceneql.run.run import Run

FOLDER = Path(tempfile.mkdtemp())
ROUNDS, SHORT = 9, 0.1
"""Runs that are counted where one takes less than so many seconds; else it is one."""
INERTIA = (1.0, 2.0, 3.0)
"""Of the free body about its own axes [kg m^2]."""
CASES = {
    "A": ((0.8, 0.7, 0.6), 20.0, (-0.636295763417436, 0.515834806373842, 0.0142968800686671, -0.57344376638916)),
    "B": ((0.01, 1.0, 0.01), 100.0, (-0.0156462415148542, 0.965439574274269, -7.97160940397554e-5, -0.260156908801055)),
}
"""Spin [rad/s], time [s], rotation then [w, x, y, z]: by power series of order 26 with 30 digits."""
THIN, LONG = 1e-4, 1 / 12
"""Inertia of a uniform rod of 1 m and 1 kg along itself, which does not count in a plane, and across [kg m^2]."""
AT_2 = (-0.082758306821, 0.407362074912, -0.961145444546, 11.898955053045)
"""Of the two rods at 2 s: angles from the vertical, their rates."""
EXUDYN = (
    *(("GeneralizedAlpha", 1e-10, 0.01), ("RK44", 1e-10, 0.01), ("DOPRI5", 1e-10, 0.01)),
    *(("DOPRI5", tolerance, 1.0) for tolerance in (1e-10, 1e-11, 1e-12)),
)
"""Methods, tolerances and steps [s] of the free body, by DOPRI5 the longest that is allowed."""


def build(script: str) -> Run:
    """A run of a script."""
    path = FOLDER / "scene.yaml"
    path.write_text(script, encoding="utf-8")
    return Run(load(path, pruned=False))


def run(script: str, end: float, *outputs: str) -> tuple[list[Any], float, list[str], int]:
    """Outputs at the end, ms, and as columns of a table ms, those of compiled steps, and steps tried; steps."""
    build(script).at(1e-3 * end)
    spent: list[float] = []
    kernel: list[float] = []
    while not spent or (len(spent) < ROUNDS and spent[-1] < SHORT):
        made = build(script)
        started = time.process_time()
        moment = made.at(end)
        spent.append(time.process_time() - started)
        done = made.islands[0].march.statistics
        kernel.append(done.seconds)
    found = [moment.read(*output.split(".", 1)) for output in outputs]
    ms, within = (1e3 * statistics.median(column) for column in (spent, kernel))
    tried = done.steps + done.rejected
    return found, ms, [f"{ms:.3f}", f"{within:.3f}", f"{tried}"], tried


def timed(call: Callable[[], object]) -> float:
    """ms of processor time of a call."""
    started = time.process_time()
    call()
    return 1e3 * (time.process_time() - started)


def often(call: Callable[[], tuple[Any, ...]]) -> tuple[Any, ...]:
    """What a call returns, its last number, ms, the median of some calls where it is short."""
    found = [call()]
    while len(found) < ROUNDS and found[-1][-1] < 1e3 * SHORT:
        found.append(call())
    return (*found[-1][:-1], statistics.median(one[-1] for one in found))


def there(peer: str) -> bool:
    """Whether a peer is installed; a line where it is not."""
    if find_spec(peer) is None:
        print(f"  skip {peer}: it is not installed (pip install {peer})")
        return False
    return True


def tell(name: str, *columns: str) -> None:
    """One line of a table."""
    print(f"  {name:30}" + "".join(f"{column:>12}" for column in columns), flush=True)


def angle(rotation: Sequence[float], exact: Sequence[float]) -> float:
    """Between two rotations [rad]."""
    one, other = (Rotation.from_quat(q, scalar_first=True) for q in (rotation, exact))
    return float((one.inv() * other).magnitude())


def free() -> None:
    """Cases A and B."""
    words = ["auto"]
    words += [f"dop853: {{tolerance: {tolerance}}}" for tolerance in ("1e-9", "1e-11", "1e-12", "1e-13", "1e-14")]
    words += ["gauss_radau15", "rk4: {step: 10 ms}", "rk4: {step: 1 ms}", "verlet: {step: 1 ms}", "verlet: {step: 1 s}"]
    words += ["verlet: {step: 20 s}"]
    for name, (spin, end, exact) in CASES.items():
        print(f"free body, case {name}, {end:g} s")
        tell("", "angle [rad]", "L", "ms", "kernel", "steps")
        model = f"{{rigid: {{mass: 1 kg, inertia: {vector(INERTIA)} kg*m^2, spin: {vector(spin)} rad/s}}}}"
        for word in words:
            script = f"clock: {{end: {end} s}}\nmodels: {{top: {model}}}\nsolvers: {{main: {{{word}}}}}\n"
            (q, momentum), _, columns, _ = run(script, end, "top.rotation", "top.angular_momentum")
            off = np.abs(momentum - np.multiply(INERTIA, spin)).max()
            tell(word, f"{angle(q, exact):.1e}", f"{off:.0e}", *columns)
        if there("mujoco"):
            for word, step in (("Euler", 0.01), ("implicitfast", 0.001), ("RK4", 0.01), ("RK4", 0.001)):
                q, momentum, ms = often(partial(free_mujoco, word, step, spin, end))
                off = np.abs(momentum - np.multiply(INERTIA, spin)).max()
                tell(f"MuJoCo {word} {1e3 * step:g} ms", f"{angle(q, exact):.1e}", f"{off:.0e}", f"{ms:.3f}")
        if there("exudyn"):
            for word, tolerance, step in EXUDYN[: None if name == "A" else 4]:  # below that it finds no step for B
                q, ms = often(partial(free_exudyn, word, tolerance, spin, end, step))
                label = f"Exudyn {word}" + (f" {tolerance:g}" if word == "DOPRI5" else "")
                tell(f"{label} {1e3 * step:g} ms", f"{angle(q, exact):.1e}", "", f"{ms:.3f}")


def vector(numbers: Sequence[float]) -> str:
    """As a script writes it."""
    return " ".join(f"{number!r}" for number in numbers)


def mujoco_of(bodies: str, word: str, step: float, gravity: str) -> Any:
    """A model of MuJoCo."""
    import mujoco

    option = f'<option timestep="{step}" integrator="{word}" gravity="{gravity}"/>'
    return mujoco.MjModel.from_xml_string(f"<mujoco>{option}<worldbody>{bodies}</worldbody></mujoco>")


def free_mujoco(word: str, step: float, spin: Sequence[float], end: float) -> tuple[Any, Any, float]:
    """Rotation, angular momentum, ms."""
    import mujoco

    body = f'<body><freejoint/><inertial pos="0 0 0" mass="1" diaginertia="{vector(INERTIA)}"/></body>'
    model = mujoco_of(body, word, step, "0 0 0")
    data = mujoco.MjData(model)
    data.qvel[3:] = spin  # in the body's axes
    ms = timed(lambda: mujoco.mj_step(model, data, nstep=round(end / step)))
    turn = Rotation.from_quat(data.qpos[3:], scalar_first=True)
    return data.qpos[3:].copy(), turn.apply(np.multiply(INERTIA, data.qvel[3:])), ms


def exudyn_run(system: Any, word: str, tolerance: float, end: float, step: float) -> float:
    """ms of a run."""
    import exudyn

    settings = exudyn.SimulationSettings()
    settings.timeIntegration.endTime = end
    settings.timeIntegration.numberOfSteps = round(end / step)
    settings.timeIntegration.absoluteTolerance = settings.timeIntegration.relativeTolerance = tolerance
    settings.timeIntegration.verboseMode = 0
    settings.solution.file.write = False
    solver = getattr(exudyn.DynamicSolverType, word)
    return timed(lambda: system.SolveDynamic(settings, solverType=solver))


def free_exudyn(word: str, tolerance: float, spin: Sequence[float], end: float, step: float) -> tuple[Any, float]:
    """Rotation, ms."""
    import exudyn
    from exudyn.utilities import RigidBodyInertia

    system = exudyn.SystemContainer().AddSystem()
    made = system.CreateRigidBody(
        inertia=RigidBodyInertia(mass=1, inertiaTensor=np.diag(INERTIA)),
        nodeType=exudyn.NodeType.RotationRotationVector,
        initialAngularVelocity=list(spin),
        returnDict=True,
    )
    system.Assemble()
    ms = exudyn_run(system, word, tolerance, end, step)
    turn = system.GetNodeOutput(made["nodeNumber"], exudyn.OutputVariableType.RotationMatrix)
    return Rotation.from_matrix(np.reshape(turn, (3, 3))).as_quat(scalar_first=True), ms


def rod(at: str, upright: bool, more: str = "") -> str:
    """A uniform rod of 1 m and 1 kg, along x or y."""
    inertia = (LONG, THIN, LONG) if upright else (THIN, LONG, LONG)
    return f"{{mass: 1 kg, inertia: {vector(inertia)} kg*m^2, position: {at} m{more}}}"


def tied(bodies: Sequence[str], ties: Sequence[str], solver: str, end: float) -> str:
    """A script of bodies, `links`, and ties."""
    lines = "\n".join(f"        {body}" for body in bodies)
    joints = "\n".join(f"  {tie}" for tie in ties)
    return (
        f"clock: {{end: {end} s}}\nmodels:\n  links:\n    rigid:\n      bodies:\n{lines}\n"
        f"forces: [gravity]\nties:\n{joints}\nsolvers: {{main: {{{solver}}}}}\n"
    )


def two_rods(end: float) -> Any:
    """Angles from the vertical and their rates, by the equations in the angles."""

    def rate(_t: float, y: Any) -> list[float]:
        a, b, va, vb = y
        cross, turn = 0.5 * math.cos(a - b), 0.5 * math.sin(a - b)
        left = np.array([[4 / 3, cross], [cross, 1 / 3]])
        right = [-1.5 * 9.81 * math.sin(a) - turn * vb**2, -0.5 * 9.81 * math.sin(b) + turn * va**2]
        return [va, vb, *np.linalg.solve(left, right)]

    start = [0.5 * math.pi, 0.5 * math.pi, 0, 0]
    return solve_ivp(rate, (0, end), start, "DOP853", rtol=3e-14, atol=1e-14).y[:, -1]


def rods() -> None:
    """Two rods on hinges."""
    bodies = [f"a: {rod('0.5 0 0', False, ', points: {end: 0.5 0 0 m, start: -0.5 0 0 m}')}"]
    bodies += [f"b: {rod('1.5 0 0', False, ', points: {start: -0.5 0 0 m}')}"]
    ties = ["one: {hinge: {between: [links.a, world], at: 0 0 0 m}}"]
    ties += ["two: {hinge: {between: [links.b, links.a], at: 1 0 0 m}}"]
    words = [f"dop853: {{tolerance: {tolerance}}}" for tolerance in ("1e-8", "1e-9", "1e-10", "1e-11", "1e-12")]
    words += [f"adams: {{tolerance: {tolerance}}}" for tolerance in ("1e-9", "1e-10", "1e-11", "1e-12", "1e-13")]
    words += ["gauss_radau15", "rk4: {step: 2 ms}", "rk4: {step: 0.5 ms}"]
    places = ("links.a.start.position", "links.a.end.position", "links.b.start.position")
    for end in (2.0, 10.0):
        exact = np.array(AT_2) if end == 2 else two_rods(end)
        print(f"two rods on hinges, {end:g} s")
        tell("", "error", "gap [m]", "ms", "kernel", "steps")
        curves: dict[str, list[tuple[float, float]]] = {"dop853": [], "adams": [], "MuJoCo": []}
        for word in words:
            outputs = ("one.angle", "two.angle", "one.speed", "two.speed", *places)
            (a, b, va, vb, foot, top, other), ms, columns, _ = run(tied(bodies, ties, word, end), end, *outputs)
            gap = max(np.abs(foot).max(), np.abs(top - other).max())
            off = swung([a, b, va, vb], exact)
            tell(word, f"{off:.1e}", f"{gap:.0e}", *columns)
            curves.get(word.partition(":")[0], []).append((off, ms))
        if there("mujoco"):
            for step in (0.002, 0.001, 0.0005, 0.00025):
                found, ms = often(partial(rods_mujoco, step, end))
                off = swung(found, exact)
                tell(f"MuJoCo RK4 {1e3 * step:g} ms", f"{off:.1e}", "0", f"{ms:.3f}")
                curves["MuJoCo"].append((off, ms))
        good = 1e-9 if end == 2 else 1e-6
        least = {name: at_error(curve, good) for name, curve in curves.items() if curve}
        told = ", ".join(f"{name} {ms:.2f} ms" for name, ms in least.items())
        bar = (
            f": MuJoCo's time is {least['MuJoCo'] / least['adams']:.1f} times that of adams"
            if "MuJoCo" in least
            else ""
        )
        print(f"  at an error of {good:g}: {told}{bar}")
        if there("exudyn"):
            for step in (0.002, 0.0005):
                found, gap, ms = rods_exudyn(step, end)
                off = f"{np.abs(np.angle(np.exp(1j * (found - exact[:2])))).max():.1e}"
                tell(f"Exudyn GeneralizedAlpha {1e3 * step:g} ms", off, f"{gap:.0e}", f"{ms:.3f}")


def at_error(curve: Sequence[tuple[float, float]], error: float) -> float:
    """ms at an error, by the straight line through the logarithms of (error, ms)."""
    line = np.polyfit(*np.log(np.transpose(curve)), 1)
    return math.exp(float(np.polyval(line, math.log(error))))


def swung(found: Sequence[float], exact: Any) -> float:
    """The largest error of angles, whole turns aside, and rates: found are those of each hinge."""
    a, b, va, vb = found
    off = np.array([a + 0.5 * math.pi, a + b + 0.5 * math.pi, va, va + vb]) - exact
    off[:2] = np.angle(np.exp(1j * off[:2]))
    return float(np.abs(off).max())


def rods_mujoco(step: float, end: float) -> tuple[Any, float]:
    """Angles and speeds of the hinges, ms."""
    import mujoco

    inertial = (
        f'<joint type="hinge" axis="0 0 1"/><inertial pos="0.5 0 0" mass="1" diaginertia="{THIN} {LONG} {LONG}"/>'
    )
    bodies = f'<body>{inertial}<body pos="1 0 0">{inertial}</body></body>'
    model = mujoco_of(bodies, "RK4", step, "0 -9.81 0")
    data = mujoco.MjData(model)
    ms = timed(lambda: mujoco.mj_step(model, data, nstep=round(end / step)))
    return [*data.qpos, *data.qvel], ms


def rods_exudyn(step: float, end: float) -> tuple[Any, float, float]:
    """Angles from the vertical, gap, ms."""
    import exudyn
    from exudyn.utilities import RigidBodyInertia

    system = exudyn.SystemContainer().AddSystem()
    before, made = system.CreateGround(), []
    for k in range(2):
        body = system.CreateRigidBody(
            inertia=RigidBodyInertia(mass=1, inertiaTensor=np.diag([THIN, LONG, LONG])),
            referencePosition=[k + 0.5, 0, 0],
            gravity=[0, -9.81, 0],
            returnDict=True,
        )
        system.CreateRevoluteJoint(itemNumbers=[before, body["bodyNumber"]], position=[k, 0, 0], axis=[0, 0, 1])
        before = body["bodyNumber"]
        made.append(before)
    system.Assemble()
    ms = exudyn_run(system, "GeneralizedAlpha", 1e-10, end, step)
    what = exudyn.OutputVariableType.Position
    ends = [system.GetObjectOutputBody(body, what, [x, 0, 0]) for body in made for x in (-0.5, 0.5)]
    along = [np.subtract(ends[2 * k + 1], ends[2 * k]) for k in range(2)]
    angles = np.array([math.atan2(x, -y) for x, y, _ in along])
    return angles, float(max(np.abs(ends[0]).max(), np.abs(np.subtract(ends[2], ends[1])).max())), ms


def top() -> None:
    """A heavy top: about its foot 1, 1 and 0.5 kg m^2, m g l = 3 N m, 8 rad/s about its axis, which leans by 0.4."""
    s, c = math.sin(0.4), math.cos(0.4)
    model = f"mass: 1 kg, inertia: 0.75 0.5 0.75 kg*m^2, position: {vector((0.5 * s, 0.5 * c, 0))} m"
    more = f"rotation: {{about: z, angle: -0.4 rad}}, spin: {vector((8 * s, 8 * c, 0))} rad/s"
    print("heavy top, 5 s")
    tell("", "leans [rad]", "round [rad]", "ms", "kernel", "steps")
    words = ["auto", *(f"dop853: {{tolerance: {tolerance}}}" for tolerance in ("1e-9", "1e-12", "1e-13"))]
    for word in (*words, "blanes_moan: {step: 10 ms}", "verlet: {step: 1 ms}"):
        script = (
            f"clock: {{end: 5 s}}\nmodels: {{top: {{rigid: {{{model}, {more}}}}}}}\n"
            "forces: {down: {gravity: {strength: 6 m/s^2}}}\n"
            f"ties: {{foot: {{ball: {{between: [top, world], at: 0 0 0 m}}}}}}\nsolvers: {{main: {{{word}}}}}\n"
        )
        ((x, y, z),), _, columns, _ = run(script, 5.0, "top.position")
        off = abs(math.acos(2 * y) - 0.400012050557)
        went = abs(math.remainder(math.atan2(-z, x) - 4.549154113092, 2 * math.pi))
        tell(word, f"{off:.1e}", f"{went:.1e}", *columns)


def chain() -> None:
    """Links that hang from one end and start level."""
    print("chain of links on hinges: ms a step, and to set it up")
    tell("", "rk4", "dop853", "set up", "gap [m]")
    for count in (10, 100, 1000):
        bodies = [
            f"c{k}: {rod(f'{k + 0.5} 0 0', False, ', points: {end: 0.5 0 0 m, start: -0.5 0 0 m}')}"
            for k in range(count)
        ]
        ties = ["h0: {hinge: {between: [links.c0, world], at: 0 0 0 m}}"]
        ties += [f"h{k}: {{hinge: {{between: [links.c{k}, links.c{k - 1}], at: {k} 0 0 m}}}}" for k in range(1, count)]
        end, last = 0.1, f"links.c{count - 1}.start.position"
        columns = []
        for word in ("rk4: {step: 2 ms}", "dop853: {tolerance: 1e-9}"):
            script = tied(bodies, ties, word, end)
            started = time.perf_counter()
            build(script)
            spent = time.perf_counter() - started
            (one, other), ms, _, steps = run(script, end, f"links.c{count - 2}.end.position", last)
            columns.append(f"{ms / steps:.3f}")
        tell(f"{count} links", *columns, f"{1e3 * spent:.0f}", f"{np.abs(one - other).max():.0e}")


def windows() -> None:
    """Four-bar chains (IFToMM's benchmark A02)."""
    print("four-bar windows, 10 s")
    tell("", "dE [J]", "of", "ms", "kernel", "steps")
    for count in (1, 40):
        cranks = range(count + 1)
        bodies = [f"c{k}: {rod(f'{k} 0.5 0', True, ', velocity: 0.5 0 0 m/s, spin: 0 0 -1 rad/s')}" for k in cranks]
        bodies += [f"b{k}: {rod(f'{k + 0.5} 1 0', False, ', velocity: 1 0 0 m/s')}" for k in range(count)]
        ties = [f"g{k}: {{hinge: {{between: [links.c{k}, world], at: {k} 0 0 m}}}}" for k in cranks]
        for k in range(count):
            ties.append(f"l{k}: {{hinge: {{between: [links.b{k}, links.c{k}], at: {k} 1 0 m}}}}")
            ties.append(f"r{k}: {{hinge: {{between: [links.b{k}, links.c{k + 1}], at: {k + 1} 1 0 m}}}}")
        for word in ("dop853: {tolerance: 1e-9}", "dop853: {tolerance: 1e-11}", "rk4: {step: 1 ms}"):
            script = tied(bodies, ties, word, 10.0)
            start = float(build(script).at(0.0).read("links", "energy"))
            (energy,), _, columns, _ = run(script, 10.0, "links.energy")
            tell(f"{count}: {word}", f"{abs(energy - start):.1e}", f"{start:.3g}", *columns)


def main(wanted: list[str]) -> None:
    """Print the tables."""
    parts = {"free": free, "rods": rods, "top": top, "chain": chain, "windows": windows}
    for name in wanted or parts:
        parts[name]()


if __name__ == "__main__":
    main(sys.argv[1:])
