"""Finite elements beside exact values: Cook's membrane, LE10, elastica, a strip rolled up, rubber, bars, spheres.

Run: python tests/bench/bench_elements.py [name ...]. Rest is found by plain Newton's method on the project's own forces
and stiffness (tests/solids.py), frequencies by SciPy from its matrices; `falling` times steps of bdf2 with 28,000
elements beside the same tetrahedra as springs, `dropped` those that fall onto a torus; `elastica` has
felupe beside it where that is installed.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
from scipy.sparse.linalg import eigsh, splu

sys.path.insert(0, str(Path(__file__).parents[1]))
from sceneql.linear.newton_kernels import ITERATIONS
from sceneql.pipeline import load
from sceneql.run.run import Run
from solids import Solid

COOK = [(0, 0), (48, 44), (48, 60), (0, 44)]
ELASTICA = {
    1: (0.30172077379981, 0.056433236283377),
    2: (0.49345748039671, 0.16064172082517),
    4: (0.66996418127767, 0.32894124224685),
    10: (0.8106090248803, 0.55499559775375),
}


def solid(fields: str, more: str = "") -> Solid:
    """The model of a script."""
    with tempfile.TemporaryDirectory() as folder:
        return Solid(Path(folder), fields, more)


def told(what: str, *errors: float, seconds: float = 0.0) -> None:
    """A line of relative errors."""
    print(f"{what:60s}" + " ".join(f"{100 * error:+9.4f} %" for error in errors) + f" {seconds:8.2f} s", flush=True)


def cook() -> None:
    """Cook's membrane, one layer: drop of its corner."""
    cases = [("p2_mean", 8, 0.499999, 0.26442), ("p2_mean", 16, 0.499999, 0.26442), ("p1", 32, 0.499999, 0.26442)]
    cases += [("p2", 16, 1 / 3, 0.3075), ("p2_mean", 16, 1 / 3, 0.3075), ("p2", 16, 1 / 3, 23.9677 / 70)]
    for k, (element, n, poisson, exact) in enumerate(cases):
        stress = k == len(cases) - 1
        across = "back: {where: z < 1e-9, components: z}" if stress else "plane: {where: x > -1, components: z}"
        corners = ", ".join(f"{x} {y} {z} m" for z in (0, 1) for x, y in COOK)
        start = time.perf_counter()
        one = solid(
            f"{{block: {{corners: [{corners}], cells: [{n}, {n}, 1], cut: five}}, element: {element}, "
            f"law: {{linear: {{modulus: 70 Pa, poisson: {poisson}}}}}, probes: {{top: 48 52 0.5 m}}, "
            f"hold: {{left: {{where: x < 1e-9, components: {'xy' if stress else 'xyz'}}}, {across}}}, "
            "loads: {tip: {where: x > 47.999, force: 0 1 0 N}}}"
        )
        places, _ = one.rest()
        found = one.read("top.displacement", places)[1]
        name = f"Cook, {'plane stress' if stress else 'plane strain'}, {element} {n} x {n}, Poisson {poisson:.6g}"
        told(name, found / exact - 1, seconds=time.perf_counter() - start)


def elastica() -> None:
    """A strip bent by a load at its end: w and u there, by `equilibrium` and, for load 4, by plain Newton's method."""
    strip = (
        "{{block: {{size: 10 1 0.1 m, center: 5 0 0 m, cells: [40, 2, 1]}}, element: p2, "
        "law: {{{law}: {{modulus: 1.2 MPa, poisson: 0}}}}, hold: {{left: {{where: x < 1e-9}}}}, "
        "loads: {{tip: {{where: x > 9.9999, force: [0 N, 0 N, time * {load} N/s]}}}}, probes: {{end: 10 0 0 m}}}}"
    )
    for law in ("saint_venant", "neo_hookean"):
        for load_, exact in ELASTICA.items():
            script = "clock: {end: 1 s}\nsolvers: {main: equilibrium}\n"
            script += f"models: {{body: {{elastic: {strip.format(law=law, load=load_)}}}}}\n"
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder) / "scene.yaml"
                path.write_text(script)
                run = Run(load(path, pruned=False))
                start = time.perf_counter()
                *_, last = run.moments([0, 1])
            steps = int(run.islands[0].march._settings[ITERATIONS])
            u, w = (last.read("body", "end.displacement") / 10)[[0, 2]]
            errors = w / exact[0] - 1, -u / exact[1] - 1
            told(f"elastica, load {load_}, {law}, {steps} updates", *errors, seconds=time.perf_counter() - start)
        start = time.perf_counter()
        one = solid(strip.format(law=law, load=1))
        places, steps = one.places, 0
        for part in range(1, 9):
            one.time = 0.5 * part
            places, more = one.rest(places, 1e-8, most=100)
            steps += more
        u, w = (one.read("end.displacement", places) / 10)[[0, 2]]
        errors = w / ELASTICA[4][0] - 1, -u / ELASTICA[4][1] - 1
        told(f"elastica, load 4, {law}, {steps} plain Newton steps", *errors, seconds=time.perf_counter() - start)

    peer()


def peer() -> None:
    """The same strip by felupe's H20, 40 cells, load 4 in 8 steps; nothing without it."""
    try:
        import felupe as fem
    except ImportError:
        print("felupe is not installed")
        return
    start = time.perf_counter()
    cube = fem.mesh.add_midpoints_edges(fem.Cube(a=(0, -0.5, -0.05), b=(10, 0.5, 0.05), n=(41, 2, 2)))
    field = fem.FieldContainer([fem.Field(fem.RegionQuadraticHexahedron(cube), dim=3)])
    body, places = fem.SolidBody(fem.NeoHooke(mu=0.6e6, bulk=0.4e6), field), cube.points
    tip = np.flatnonzero(np.isclose(places[:, 0], 10))
    corner = np.isclose(abs(places[tip, 1]), 0.5) & np.isclose(abs(places[tip, 2]), 0.05)
    shares = np.where(corner, -1 / 12, 1 / 3)[:, None] * [[0.0, 0.0, 1.0]]
    load = fem.PointLoad(field, tip, values=0 * shares)
    bounds = {"left": fem.Boundary(field[0], fx=0.0)}
    held, free = fem.dof.partition(field, bounds)
    ends, steps = fem.dof.apply(field, bounds, held), 0
    for part in range(1, 9):
        load.update(0.5 * part * shares)
        solved = fem.newtonraphson(items=[body, load], dof0=held, dof1=free, ext0=ends, verbose=False, tol=1e-8)
        steps += solved.iterations
    u, w = (field[0].values[tip].mean(axis=0) / 10)[[0, 2]]
    errors = w / ELASTICA[4][0] - 1, -u / ELASTICA[4][1] - 1
    told(f"elastica, load 4, felupe's H20, {steps} Newton steps", *errors, seconds=time.perf_counter() - start)


def followed(fields: str, outputs: tuple[str, ...], objects: str = "") -> tuple[list[Any], int, float]:
    """Outputs at 1 s of what `equilibrium` follows, updates of Newton's method, seconds."""
    script = f"clock: {{end: 1 s}}\nsolvers: {{main: equilibrium}}\n{objects}"
    script += f"models: {{body: {{elastic: {{{fields}}}}}}}\n"
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.yaml"
        path.write_text(script)
        run = Run(load(path, pruned=False))
        start = time.perf_counter()
        *_, last = run.moments([0, 1])
        steps = int(run.islands[0].march._settings[ITERATIONS])
    return [last.read("body", output) for output in outputs], steps, time.perf_counter() - start


def ring(along: Any, across: Any) -> float:
    """How far apart the ends of a strip of a law are, of its length, that is bent by M = 2 pi E I/L; h = L/100.

    ``along`` (t, r) and ``across`` (t, r): stresses over E of plane stretches t along it and r across, Poisson's ratio
    0. Exact: r(z) with P_r' = k P_t, k the angle by length, and no P_r on both faces, has the moment of P_t r.
    """
    from scipy.integrate import simpson, solve_bvp
    from scipy.optimize import brentq, newton

    h, length = 0.1, 10.0
    z = np.linspace(-h / 2, h / 2, 201)

    def missed(k: float, told: bool = False) -> float:
        def thin(t: Any, p: Any) -> Any:
            return newton(lambda r: across(t, r) - p, np.ones_like(t), tol=1e-13)

        def slopes(_: Any, y: Any) -> Any:
            r = thin(k * y[0], y[1])
            return np.array([r, k * along(k * y[0], r)])

        found = solve_bvp(slopes, lambda one, two: np.array([one[1], two[1]]), z, [1 / k + z, 0 * z], tol=1e-9)
        r, p = found.sol(z)
        gap = 2 * found.sol(0.0)[0] * np.sin((k * length - 2 * np.pi) / 2) / length
        t = k * r
        return float(gap if told else simpson(along(t, thin(t, p)) * r, x=z) - 2 * np.pi * h**3 / 12 / length)

    return missed(brentq(missed, 0.6, 0.66, xtol=1e-10), told=True)


def rolled() -> None:
    """A strip bent to a ring by M = 2 pi E I/L at its end: how far apart its ends are, beside its law's exact value.

    The bar, 1e-3 of L, is one for `corotated` alone: the exact solid of L/100 misses it by the other laws, by 1.98e-3
    (`saint_venant`) and 1.48e-3 (`neo_hookean`). At 40 cells the mesh's own error hides that.
    """
    laws = {
        "corotated": (lambda t, r: t - 1, lambda t, r: r - 1),
        "saint_venant": (lambda t, r: t * (t * t - 1) / 2, lambda t, r: r * (r * r - 1) / 2),
        "neo_hookean": (lambda t, r: (t - r + (t * r - 1) * r) / 2, lambda t, r: (r - t + (t * r - 1) * t) / 2),
    }
    torque = 2 * np.pi * 1.2e6 * 0.1**3 / 12 / 10
    for law, stresses in laws.items():
        exact = ring(*stresses)
        for cells in (40, 80, 160):
            strip = (
                f"block: {{size: 10 1 0.1 m, center: 5 0 0 m, cells: [{cells}, 1, 2], cut: five}}, element: p2, "
                f"law: {{{law}: {{modulus: 1.2 MPa, poisson: 0}}}}, "
                "hold: {left: {where: x < 1e-9}, plane: {where: x > 1e-9, components: y}}, "
                f"loads: {{tip: {{where: x > 9.999, torque: [0 N*m, time*{-torque} N*m/s, 0 N*m]}}}}, "
                "probes: {end: 10 0 0 m}"
            )
            (end,), steps, seconds = followed(strip, ("end.position",))
            told(f"rolled up, {law}, {cells} cells, {steps} updates; exact", end[0] / 10, exact, seconds=seconds)


def le10() -> None:
    """NAFEMS LE10 by our mesher: stress beside the inner ellipse, on top.

    The outer face is held in height at its middle line, as the reference says, and beside it at the nodes of its middle
    third.
    """
    objects = (
        "objects:\n  disk: {cylinder: {radius: 1 m, height: 0.6 m}}\n  core: {cylinder: {radius: 1 m, height: 1 m}}\n"
        "  wide: {group: {children: [disk], scale: [3.25, 1, 2.75], hidden: yes}}\n"
        "  hole: {group: {children: [core], scale: [2, 1, 1], hidden: yes}}\n"
        "  plate: {difference: {hidden: yes, of: [{intersection: {of: [wide, {box: {size: 4 1 4 m, "
        "position: 2 0 2 m}}]}}, hole]}}\n"
    )
    outer = "(abs((x/3.25)^2 + (z/2.75)^2 - 1) < 1e-6)"
    cases = [(spacing, None) for spacing in (0.4, 0.37, 0.34, 0.31, 0.28, 0.25, 0.22, 0.2)]
    for spacing, fine in [*cases, (0.4, 0.2), (0.4, 0.1), (0.35, 0.1), (0.3, 0.2), (0.3, 0.1), (0.27, 0.12)]:
        finer = f"finer: {{d: {{near: 2 0.3 0 m, within: 0.1 m, spacing: {fine} m}}}}, " if fine else ""
        start, errors, count = time.perf_counter(), [], 0
        for middle in ("(y == 0)*((x/3.25)^2 + (z/2.75)^2 > 0.98)", f"{outer}*(abs(y) < 0.1)"):
            hold = f"outer: {{where: '{outer}', components: xz}}, "
            hold += f"middle: {{where: '{middle}', components: y}}, "
            hold += "one: {where: x < 1e-6, components: x}, two: {where: z < 1e-6, components: z}"
            one = solid(
                f"{{of: plate, spacing: {spacing} m, {finer}element: p2, "
                "law: {linear: {modulus: 210 GPa, poisson: 0.3}}, "
                f"hold: {{{hold}}}, loads: {{top: {{where: y > 0.299999, pressure: 1 MPa}}}}, "
                "probes: {d: 2 0.3 0 m}}",
                objects,
            )
            places, _ = one.rest(tolerance=1e-6)
            errors.append(one.read("d.stress", places)[2, 2] / -5.38e6 - 1)
            count = len(one.mesh.cells)
        name = f"LE10, p2, spacing {spacing}{f', {fine} near it' if fine else ''}, {count} elements; line, third"
        told(name, *errors, seconds=time.perf_counter() - start)


def rubber() -> None:
    """Incompressible neo-Hookean rubber: pulled to twice its length, a rod twisted by 1 rad, a sphere blown up."""
    law = f"element: p2_mean, law: {{neo_hookean: {{modulus: {2 * 1.499999} Pa, poisson: 0.499999}}}}"
    held = ", ".join(f"{axis}: {{where: {axis} < 1e-6, components: {axis}}}" for axis in "xyz")
    pulled = "block: {size: 1 1 1 m, center: 0.5 0.5 0.5 m, cells: [2, 2, 2]}, "
    pulled += f"hold: {{{held}, end: {{where: x > 0.9999, components: x, shift: [1 m/s*time, 0 m, 0 m]}}}}"
    (force,), steps, seconds = followed(f"{pulled}, {law}", ("end.force",))
    told(f"rubber pulled, {steps} updates", force[0] / 1.75 - 1, seconds=seconds)
    for spacing in (0.4, 0.25):
        objects = "objects: {rod: {cylinder: {radius: 0.5 m, height: 1 m, hidden: yes}}, "
        objects += "handle: {sphere: {radius: 0.1 m, rotation: {about: y, angle: time*1 rad/s}, hidden: yes}}}\n"
        hold = "top: {where: y > 0.4999, follows: handle}, bottom: {where: y < -0.4999}"
        twisted = f"of: rod, spacing: {spacing} m, hold: {{{hold}}}, {law}"
        (force, energy), steps, seconds = followed(twisted, ("top.force", "potential"), objects)
        exact = np.pi * 0.5**4 / 4
        told(f"rubber twisted, spacing {spacing}, {steps} updates; N, M", -force[1] / exact - 1, energy / exact - 1,
             seconds=seconds)  # fmt: skip
    outer = (1 + (1.5**3 - 1) / 8) ** (1 / 3)
    pressure = 0.5 * (4 / outer + outer**-4 - 4 / 1.5 - 1.5**-4)
    for spacing in (0.5, 0.4, 0.35):
        objects = "objects:\n  hole: {sphere: {radius: 1.2 m, hidden: yes}}\n  part: {intersection: {hidden: yes, of: ["
        objects += "{difference: {of: [{sphere: {radius: 2 m}}, {sphere: {radius: 1 m}}]}}, "
        objects += "{box: {size: 3 3 3 m, position: 1.5 1.5 1.5 m}}]}}\n"
        blown = f"of: part, spacing: {spacing} m, hold: {{{held}}}, probes: {{inner: 0.5774 0.5774 0.5774 m}}, "
        blown += f"loads: {{air: {{object: hole, pressure: time*{pressure} Pa/s}}}}, {law}"
        (place,), steps, seconds = followed(blown, ("inner.position",), objects)
        name = f"rubber blown up, spacing {spacing}, {steps} updates; radius"
        told(name, np.linalg.norm(place) / 1.5 - 1, seconds=seconds)


def lame() -> None:
    """An eighth of a hollow sphere under pressure inside: displacement and hoop stress there, means over its nodes."""
    objects = "objects:\n  hole: {sphere: {radius: 1.2 m, hidden: yes}}\n  part: {intersection: {hidden: yes, of: ["
    objects += "{difference: {of: [{sphere: {radius: 2 m}}, {sphere: {radius: 1 m}}]}}, "
    objects += "{box: {size: 3 3 3 m, position: 1.5 1.5 1.5 m}}]}}\n"
    held = ", ".join(f"{axis}: {{where: {axis} < 1e-6, components: {axis}}}" for axis in "xyz")
    for spacing in (0.5, 0.35, 0.25):
        fields = f"of: part, spacing: {spacing} m, element: p2, law: {{linear: {{modulus: 10 MPa, poisson: 0.3}}}}, "
        fields += f"hold: {{{held}}}, loads: {{inner: {{object: hole, pressure: 1 Pa}}}}"
        start = time.process_time()
        (places, moves, stress), _, _ = followed(fields, ("positions", "displacements", "stress"), objects)
        own = time.process_time() - start
        r = np.linalg.norm(places - moves, axis=1)
        inner = np.abs(r - 1) < 1e-6
        out, stress = (places - moves)[inner] / r[inner][:, None], stress[inner]
        hoop = 0.5 * (np.trace(stress, axis1=1, axis2=2) - np.einsum("ni,nij,nj->n", out, stress, out))
        outwards = 1e6 * np.sum(moves[inner] * out, axis=1)
        errors = outwards.mean() / 0.08 - 1, hoop.mean() / 0.7142857143 - 1
        name = f"Lame, p2, spacing {spacing}, {len(r)} nodes, processor time; u, hoop stress"
        told(name, *errors, seconds=own)


def sphere() -> None:
    """A free elastic sphere, Poisson's ratio 1/4: its first torsional and spheroidal frequency, each five-fold."""
    for element, spacing in (("p1", 0.4), ("p2", 0.6), ("p2", 0.4), ("p2", 0.3)):
        start = time.perf_counter()
        one = solid(
            f"{{of: ball, spacing: {spacing} m, element: {element}, density: 1 kg/m^3, "
            "law: {linear: {modulus: 2.5 Pa, poisson: 0.25}}}",
            "objects: {ball: {sphere: {radius: 1 m, hidden: yes}}}\n",
        )
        stiffness = one.stiffness(one.places).tocsc()
        squares = eigsh(stiffness, 18, one.inertia.tocsc(), sigma=-1.0, return_eigenvectors=False)
        found = np.sqrt(np.maximum(np.sort(squares), 0.0))
        errors = [found[at : at + 5].mean() / exact - 1 for at, exact in ((6, 2.501132620409), (11, 2.639869277902))]
        name = f"free sphere, {element}, spacing {spacing}; torsional, spheroidal"
        told(name, *errors, seconds=time.perf_counter() - start)


def torsion() -> None:
    """A square bar turned at its ends, which are free to warp: its torque over shear modulus, twist and side^4."""
    for n in (4, 8):
        start = time.perf_counter()
        one = solid(
            f"{{block: {{size: 1 1 4 m, cells: [{n}, {n}, {n}]}}, element: p2, "
            "law: {linear: {modulus: 2.5 Pa, poisson: 0.25}}}"
        )
        x, matrix, twist = one.places, one.stiffness(one.places).tocsc(), 1e-3
        ends = np.abs(np.abs(x[:, 2]) - 2) < 1e-9
        known = np.zeros((len(x), 3), dtype=bool)
        known[ends, :2] = True
        known[np.argmin(np.linalg.norm(x, axis=1)), 2] = True
        move = np.zeros_like(x)
        move[ends, 0], move[ends, 1] = -twist * x[ends, 2] * x[ends, 1], twist * x[ends, 2] * x[ends, 0]
        known, move = known.ravel(), move.ravel()
        free = ~known
        move[free] = splu(matrix[free][:, free]).solve(-(matrix[free] @ move))
        forces = (matrix @ move).reshape(-1, 3)
        top = x[:, 2] > 1.99
        torque = np.sum(x[top, 0] * forces[top, 1] - x[top, 1] * forces[top, 0])
        told(
            f"torsion, p2, {n} x {n} x {n} cells",
            torque / twist / 0.140577014956 - 1,
            seconds=time.perf_counter() - start,
        )


def falling() -> None:
    """Steps of bdf2 at 10 ms: 28,392 p1 elements in free fall beside springs along the same edges."""
    _steps("falling", "cube: {box: {size: 0.78 0.78 0.78 m, hidden: yes}}", "", 0.3)


def dropped() -> None:
    """The same cubes that fall by 1 cm onto a torus, with friction: steps in touch, of processor time, too."""
    ring = "cube: {box: {size: 0.78 0.78 0.78 m, position: 0 0.60 0 m, hidden: yes}}, "
    ring += "ring: {torus: {radius: 0.3 m, tube: 0.1 m, position: 0 0.1 0 m}}"
    _steps("dropped", ring, "contacts: {touch: {collision: {between: [body, ring, floor], friction: 0.3}}}\n", 0.15)


def _steps(called: str, objects: str, contacts: str, end: float) -> None:
    """Print times of steps of elements and of springs; those after a third of ``end`` [s] where they touch."""
    fill = "of: cube, spacing: 60 mm, element: p1, law: {neo_hookean: {modulus: 55 kPa, poisson: 0.4}}"
    models = {
        "elements": f"elastic: {{{fill}}}",
        "springs": "mass_spring: {solid: {object: cube, spacing: 60 mm, density: 1000 kg/m^3, modulus: 55 kPa}}",
    }
    for name, model in models.items():
        script = f"clock: {{end: 1 s}}\nobjects: {{{objects}}}\nmodels: {{body: {{{model}}}}}\nforces: [gravity]\n"
        script += f"{contacts}solvers: {{main: {{bdf2: {{step: 10 ms}}}}}}\n"
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "scene.yaml"
            path.write_text(script)
            moments = Run(load(path, pruned=False)).moments(np.arange(0, end, 0.01))
            times = np.diff([(time.perf_counter(), time.process_time()) for _ in moments], axis=0)
        wall, own = 1e3 * np.median(times[len(times) // 3 if contacts else 0 :], axis=0)
        print(f"{called}, {name}: median step {wall:.0f} ms, of processors {own:.0f} ms", flush=True)


BENCHES = {one.__name__: one for one in (cook, le10, elastica, rolled, lame, rubber, sphere, torsion, falling, dropped)}

if __name__ == "__main__":
    for asked in sys.argv[1:] or BENCHES:
        BENCHES[asked]()
