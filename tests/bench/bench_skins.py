"""Elastic skins full of fluid beside exact values: areas kept, pressure, false currents, the ring of springs.

    python tests/bench/bench_skins.py                 all of these
    python tests/bench/bench_skins.py areas 64 4      area of ring and star, cells a side, vertices a cell, in two boxes
    python tests/bench/bench_skins.py circle 64       pressure jump and false currents of a circle at rest
    python tests/bench/bench_skins.py rest 64         radius of the relaxing ring at rest
    python tests/bench/bench_skins.py ring 21.33      mode 2 of a ring of springs, cells a radius
    python tests/bench/bench_skins.py correction      how much volume is put back, on three grids
    python tests/bench/bench_skins.py deep 48 5       volume of an egg in a deep flow, cells a side, step [ms]
    python tests/bench/bench_skins.py capsule 12 10   rubber in shear: deformation, cells a radius, radii between walls
    python tests/bench/bench_skins.py bag 96          bag of heavy fluid on a floor, cells a side
    python tests/bench/bench_skins.py fall 96         circle that begins to fall, cells a side and half
    python tests/bench/bench_skins.py stiff 1e5       implicit skins beside explicit ones, stretch [N/m]
    python tests/bench/bench_skins.py share 64        a skin's part of a step's time there

Sources: Tu & Peskin (1992), SIAM J. Sci. Stat. Comput. 13, 1361-1376, for the relaxing ring. The frequency and damping
of the ring of springs are roots of a determinant of Bessel functions, in a fluid without bounds.
"""

from __future__ import annotations

import itertools
import math
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from sceneql.pipeline import load
from sceneql.run.run import IslandRun

FOLDER = Path(tempfile.mkdtemp())
WAVES = "{left: {periodic: yes}, bottom: {periodic: yes}}"
ELLIPSE = "x^2/0.75^2 + y^2/0.5^2 - 1"
EGG = "(x/0.75)^2 + (y/0.5)^2 + (z/0.55)^2 - 1"
SMALL_EGG = "(x/0.68)^2 + (y/0.45)^2 + (z/0.5)^2 - 1"
STAR = "hypot(x, y) - 0.55*(1 + 0.25*cos(3*atan2(y, x)) + 0.1*sin(2*atan2(y, x)))"
SHEAR = (("bottom", -1), ("top", 1))
SHAPES = {"ring": (ELLIPSE, 0.5), "star": (STAR, 0.4)}
"""Formula, and radius of the circle as long as the skin is without tension."""
VISCOUS = {1e-3: (-0.03757409, 1.69524035), 1e-2: (-0.12369588, 1.61484587), 3e-2: (-0.22188524, 1.52552240)}
"""By viscosity the exponent of mode 2, radius, stiffness and density 1 [1/s]."""


class Balloon:
    """One skin `balloon` in a flow `air`, on its way."""

    def __init__(
        self, formula: str, law: str, cells: int, solver: str, end: float, side: float = 3.0, mu: float = 0.1,
        at: tuple[float, float] = (1.53, 1.53), walls: bool = False, more: str = "", bound: float = 1.0,
        deep: bool = False, alone: bool = False,
    ) -> None:  # fmt: skip
        boundary = "{}" if walls else WAVES
        if deep:
            boundary = boundary.replace("}}", "}, back: {periodic: yes}}")
        egg = f'field: "{formula}", bounds: {{ball: {bound}}}, position: {at[0]} {at[1]} {1.53 if deep else 0} m'
        flow = f"size: {side} {side} {side if deep else ''} m, cell: {side!r}/{cells} m"
        flow += f", density: 1 kg/m^3, viscosity: {mu!r} Pa*s"
        text = (
            f"clock: {{end: {end!r} s, fps: 1}}\nmodels:\n  air: {{flow: {{{flow}, boundary: {boundary}}}}}\n"
            f"  balloon: {{membrane: {{of: egg, {law}{more}}}}}\nforces: [{{immersion: {{on: [balloon], in: air}}}}]\n"
            f"objects: {{egg: {{implicit: {{{egg}}}}}}}\nsolvers: {{main: {solver}}}\n"
        )
        if alone:
            lines = text.splitlines(keepends=True)
            text = "".join(line for line in lines if "balloon" not in line and "egg" not in line)
        self.tasks, self.run = self.begun(text)

    @staticmethod
    def begun(text: str) -> tuple[Any, IslandRun]:
        """The parts of a script and its island, at the start."""
        path = FOLDER / "scene.yaml"
        path.write_text(text, encoding="utf-8")
        graph = load(path, pruned=False)
        run = IslandRun(graph, graph.islands[0])
        run.advance(0.0)
        return graph.tasks, run

    @classmethod
    def of(cls, text: str) -> Balloon:
        """That of a script."""
        made = cls.__new__(cls)
        made.tasks, made.run = cls.begun(text)
        return made

    def read(self, output: str, model: str = "balloon") -> Any:
        """An output, now."""
        return self.tasks[model].kind.read(output, self.run.state(model))


def smooth_area(points: Any) -> float:
    """What the trigonometric interpolant of a closed line goes around."""
    places = points[:, 0] + 1j * points[:, 1]
    count = len(places)
    return math.pi * float((np.fft.fftfreq(count, 1 / count) * np.abs(np.fft.fft(places) / count) ** 2).sum())


def by_rest(shape: str) -> tuple[str, str]:
    """Formula and law of tension = 10 (length/own length - 1), whose own lengths are a smaller circle's."""
    formula, rest = SHAPES[shape]
    q = np.arange(20_000) * 2 * math.pi / 20_000
    radius = 0.55 * (1 + 0.25 * np.cos(3 * q) + 0.1 * np.sin(2 * q))
    line = radius * np.exp(1j * q) if shape == "star" else 0.75 * np.cos(q) + 0.5j * np.sin(q)
    part = float(np.abs(np.roll(line, -1) - line).sum()) / (2 * math.pi * rest)
    return formula, f"law: {{springs: {{stretch: {10 * part!r} N/m}}}}, prestress: {10 * (part - 1)!r} N/m"


def areas(cells: str, vertices: str = "4") -> None:
    """Relative changes of the area to 2 s, drawn and smooth, free and kept; ``vertices`` a cell."""
    for shape in SHAPES:
        formula, law = by_rest(shape)
        for walls in (False, True):
            at = (1.53, 1.53)
            if walls:  # two cells off the wall
                low = 0.75 if shape == "ring" else 0.665
                at = (low + 2 * 3 / int(cells), 1.53)
            found = []
            for more in (", volume: free", ""):
                more += f", spacing: 3 m/{cells}/{vertices}"
                made = Balloon(formula, law, int(cells), "{ark3: {step: 1 ms}}", 2.0, at=at, walls=walls, more=more)
                drawn, smooth, most = made.read("volume"), smooth_area(made.read("positions")), 0.0
                begun = time.process_time()
                for k in range(1, 21):
                    made.run.advance(0.1 * k)
                    most = max(most, abs(made.read("volume") / drawn - 1.0))
                taken = time.process_time() - begun
                found.append((most, smooth_area(made.read("positions")) / smooth - 1.0))
            (free, lost), (kept, _) = found
            put = made.read("volume_correction") / drawn
            print(
                f"{shape}{' beside a wall' if walls else '':14s} {made.read('count'):.0f} vertices: "
                f"smooth {lost:+.1e}, drawn {free:.1e} free, {kept:.1e} kept ({put:.1e} put back), {taken:.2f} s"
            )


def correction() -> None:
    """The volume that is put back, of ring and star to 2 s."""
    for shape in SHAPES:
        told = []
        for cells in (32, 64, 128):
            made = Balloon(*by_rest(shape), cells, "{ark3: {step: 5 ms}}", 2.0)
            volume = made.read("volume")
            made.run.advance(2.0)
            told.append(made.read("volume_correction") / volume)
        orders = ", ".join(f"{math.log2(a / b):.2f}" for a, b in itertools.pairwise(told))
        print(f"{shape}: {', '.join(f'{one:.2e}' for one in told)} of the volume put back, orders {orders}")


def deep(cells: str, step: str = "5") -> None:
    """Volume of an egg that relaxes to 0.4 s, free on two meshes, and kept."""
    law, lost = "law: {springs: {stretch: 10 N/m}}, prestress: 3 N/m", []
    for apart, volume in ((0.35, "free"), (0.17, "free"), (0.35, "kept")):
        more = f", volume: {volume}, spacing: {apart * 3 / int(cells)!r} m"
        made = Balloon(EGG, law, int(cells), f"{{ark3: {{step: {step} ms}}}}", 0.4, deep=True, more=more)
        before, begun, most = made.read("volume"), time.process_time(), 0.0
        for k in range(1, 5):
            made.run.advance(0.1 * k)
            most = max(most, abs(made.read("volume") / before - 1.0))
        lost.append(made.read("volume") / before - 1.0)
        text = (
            f"{made.read('count'):.0f} vertices, {volume}: drawn volume {lost[-1]:+.2e} at the end, {most:.1e} at most"
        )
        print(f"{text}, deformation {made.read('deformation'):.4f}, {time.process_time() - begun:.0f} s", flush=True)
    part = (0.35 / 0.17) ** 2
    print(f"extrapolated {(part * lost[1] - lost[0]) / (part - 1.0):+.1e}")


def share(cells: str) -> None:
    """Processor time of steps by sbdf2 with a skin of about 2,500 vertices and without."""
    taken = []
    for alone in (False, True):
        law, more = "law: {springs: {stretch: 10 N/m}}, prestress: 3 N/m", f", spacing: {1.0 * 3 / int(cells)!r} m"
        made = Balloon(SMALL_EGG, law, int(cells), "{sbdf2: {step: 5 ms}}", 1.0, deep=True, more=more, alone=alone)
        if not alone:
            print(f"{made.read('count'):.0f} vertices")
        made.run.advance(0.02)
        best = math.inf
        for k in range(1, 6):
            begun = time.process_time()
            made.run.advance(0.02 + 0.02 * k)
            best = min(best, time.process_time() - begun)
        taken.append(best / 4)
    print(f"{taken[0]:.3f} s a step, {taken[1]:.3f} s without: {1 - taken[1] / taken[0]:.0%} of it for the skin")


def capsule(across: str, wide: str = "10") -> None:
    """Capsules of rubber in shear, cells a radius, between walls so many radii apart: D over Ca, drawn to 0."""
    cell, side, density, found = 1.0 / float(across), float(wide), 0.02, []
    for number in (0.01, 0.02):
        ends = ", ".join(f'{name}: {{wall: {{velocity: "[{way * side / 2}, 0, 0]"}}}}' for name, way in SHEAR)
        text = (
            f"clock: {{end: 5 s, fps: 1}}\nmodels:\n  air:\n    flow:\n      size: {side} {side} {side} m\n"
            f"      cell: {cell!r} m\n      density: {density} kg/m^3\n      viscosity: 1 Pa*s\n"
            f'      initial: {{velocity: "[y - {side / 2}, 0*y, 0*y]"}}\n'
            f"      boundary: {{left: {{periodic: yes}}, back: {{periodic: yes}}, {ends}}}\n"
            f"  balloon: {{membrane: {{of: ball, law: {{neo_hookean: {{modulus: {1 / number!r} N/m}}}}}}}}\n"
            f"forces: [{{immersion: {{on: [balloon], in: air}}}}]\n"
            f"objects: {{ball: {{sphere: {{radius: 1 m, position: {side / 2} {side / 2} {side / 2} m}}}}}}\n"
            f"solvers: {{main: {{sbdf2: {{step: {0.1 * number!r} s}}}}}}\n"
        )
        made, told, begun = Balloon.of(text), [], time.process_time()
        for k in range(1, 31):  # it follows in times of 4 mu a/G
            made.run.advance(number * k)
            told.append(made.read("deformation"))
        found.append(told[-1] / number)
        text = f"Ca {number}: D/Ca {found[-1]:.4f} after {30 * number:.2f} s ({told[-2] / number:.4f} before)"
        print(f"{text}, {made.read('count'):.0f} vertices, {time.process_time() - begun:.0f} s", flush=True)
    line = 2.0 * found[0] - found[1]
    print(f"D/Ca drawn to 0 {line:.4f}, {line / (25 / 12) - 1:+.1%} of 25/12")


def circle(cells: str) -> None:
    """A circle of one tension, prestressed, at rest."""
    law = "law: {springs: {stretch: 1 N/m}}, prestress: 1 N/m"
    made = Balloon("x^2 + y^2 - 0.8^2", law, int(cells), "{ark3: {step: 5 ms}}", 3.0)
    made.run.advance(3.0)
    radius = made.read("area") / (2 * math.pi)
    jump, speed = made.read("pressure_jump"), made.read("largest_speed", "air")
    print(f"jump over tension/radius {jump * radius - 1:+.1e} off; false currents mu |u|/T {0.1 * speed:.1e}")


def rest(cells: str) -> None:
    """The relaxing ring once it has come to rest."""
    made = Balloon(*by_rest("ring"), int(cells), "{ark3: {tolerance: 1e-4}}", 12.0)
    made.run.advance(12.0)
    points = made.read("positions")
    radii = np.hypot(*(points - made.read("center"))[:, :2].T) - math.sqrt(0.375)
    speed = made.read("largest_speed", "air")
    print(f"radius at rest {radii.min():+.1e} to {radii.max():+.1e} m off, speed {speed:.1e}")


def bag(cells: str) -> None:
    """A bag of heavy fluid at rest on a floor without friction, of a fluid a thousand times as light and thin."""
    floor = 2.0 / int(cells)
    egg = f'field: "x^2 + y^2 - 0.18^2", bounds: {{ball: 1}}, position: 0.5 {floor + 0.19!r} 0 m'
    law = "law: {springs: {stretch: 4000 N/m}}, filling: {density: 1000 kg/m^3, viscosity: 80 Pa*s}"
    flow = f"size: 1 1 m, cell: 1/{cells} m, density: 1 kg/m^3, viscosity: 0.08 Pa*s"
    flow += ", boundary: {bottom: {wall: {slip: free}}}"
    text = f"clock: {{end: 2 s, fps: 1}}\nmodels:\n  air: {{flow: {{{flow}}}}}\n"
    text += (
        f"  balloon: {{membrane: {{of: egg, {law}}}}}\nforces: [gravity, {{immersion: {{on: [balloon], in: air}}}}]\n"
    )
    ledge = f"ledge: {{plane: {{position: 0 {floor!r} 0 m, normal: 0 1 0}}}}"
    text += f"objects: {{egg: {{implicit: {{{egg}}}}}, {ledge}}}\n"
    text += "contacts: {land: {collision: {between: [balloon, ledge]}}}\nsolvers: {main: {auto: {}}}\n"
    made, begun = Balloon.of(text), time.process_time()
    sides = []
    for k in range(8):  # it still swings a little: the mean of the last periods
        made.run.advance(1.3 + 0.1 * k)
        sides.append(np.ptp(made.read("positions"), axis=0)[:2])
    width, height = np.mean(sides, axis=0)
    print(
        f"{cells} cells: height {height:.7f} m ({height / 0.26211314 - 1:+.2%}), width {width:.7f} m "
        f"({width / 0.46532072 - 1:+.2%}), {time.process_time() - begun:.0f} s"
    )


def fall(cells: str) -> None:
    """A circle of fluid in a box of 12 radii begins to fall: (heavy - light)/(heavy + light) g."""
    for density in (3.0, 1000.0):
        found = []
        for count in (int(cells) // 2, int(cells)):
            law = "law: {springs: {stretch: 1e-3 N/m}}"
            more = f", filling: {{density: {density!r} kg/m^3, viscosity: 1e-5 Pa*s}}"
            egg = 'implicit: {field: "x^2 + y^2 - 1/144", bounds: {ball: 1}, position: 0.5 0.5 0 m}'
            made = Balloon.of(
                f"clock: {{end: 0.01 s, fps: 1}}\nmodels:\n  air: {{flow: {{size: 1 1 m, cell: 1/{count} m, density: "
                f"1 kg/m^3, viscosity: 1e-5 Pa*s}}}}\n  balloon: {{membrane: {{of: egg, {law}{more}}}}}\n"
                f"forces: [gravity, {{immersion: {{on: [balloon], in: air}}}}]\nobjects: {{egg: {{{egg}}}}}\n"
                "solvers: {main: {imex_midpoint: {step: 1 ms}}}\n"
            )
            before = made.read("center")[1]
            made.run.advance(0.01)
            found.append(2.0 * (before - made.read("center")[1]) / 1e-4 / ((density - 1) / (density + 1) * 9.81) - 1)
        print(f"{density:g} : 1: off by {found[0]:+.2%}, {found[1]:+.2%}, drawn to 0 {2 * found[1] - found[0]:+.2%}")


def stiff(stretch: str = "1e5") -> None:
    """An ellipse of springs in a vortex of 1 m/s to 1 s: time and places, skins explicit, by `auto` and implicit."""
    wave, ends = "cos(2*pi*x/3)*cos(2*pi*y/3)*0.477464829275686", []
    skin = f"of: egg, law: {{springs: {{stretch: {stretch} N/m}}}}, spacing: 3 m/64/2"
    steps = ("step: 20 ms, ", "step: 10 ms, ", "step: 5 ms, ", "")
    for solver in ("ark3: {skins: explicit}", "auto: {}", *(f"ark3: {{{step}skins: implicit}}" for step in steps)):
        made = Balloon.of(
            "clock: {end: 1 s, fps: 1}\nmodels:\n  air: {flow: {size: 3 3 m, cell: 3/64 m, density: 1 kg/m^3, "
            f'viscosity: 0.1 Pa*s, initial: {{stream_function: "{wave}"}}, boundary: {WAVES}}}}}\n'
            f"  balloon: {{membrane: {{{skin}}}}}\nforces: [{{immersion: {{on: [balloon], in: air}}}}]\n"
            f'objects: {{egg: {{implicit: {{field: "{ELLIPSE}", bounds: {{ball: 1}}, position: 1.53 1.53 0 m}}}}}}\n'
            f"solvers: {{main: {{{solver}}}}}\n"
        )
        begun = time.process_time()
        made.run.advance(1.0)
        taken, done = time.process_time() - begun, made.run.march.statistics
        ends.append(made.read("positions"))
        apart = np.abs(ends[-1] - ends[0]).max()
        print(f"{solver}: {done.steps} steps, {done.rejected} rejected, {taken:.2f} s, {apart:.1e} m off", flush=True)


def exponent(values: Any, apart: float) -> complex:
    """That of a decaying oscillation by its samples (Prony 1795)."""
    rows = np.column_stack([values[1:-1], values[:-2]])
    a, b = np.linalg.lstsq(rows, values[2:], rcond=None)[0]
    roots = np.roots([1.0, -a, -b])
    return complex(np.log(roots[np.argmax(roots.imag)]) / apart)


def ring(across: str) -> None:
    """Mode 2 of a ring of springs without own lengths, in a box of 8 radii."""
    for mu in (1e-2, 3e-2):
        cells = round(8 * float(across))
        formula = "hypot(x, y) - (1 + 0.02*(x^2 - y^2)/(x^2 + y^2))"
        law = "law: {springs: {stretch: 1 N/m}}, prestress: 1 N/m"
        made = Balloon(formula, law, cells, "{sbdf2: {step: 5 ms}}", 8.0, 8.0, mu, (4.0, 4.0), bound=1.1)
        signed = []
        begun = time.process_time()
        for k in range(81):
            made.run.advance(0.1 * k)
            points = made.read("positions") - made.read("center")
            z = points[:, 0] + 1j * points[:, 1]
            signed.append(float((z**2).mean().real))
        found = exponent(np.array(signed)[10:], 0.1)
        decay, turn = VISCOUS[mu]
        print(
            f"mu {mu:g}, {cells} cells a side: frequency {found.imag:.4f} ({found.imag / turn - 1:+.2%}), damping "
            f"{-found.real:.4f} ({found.real / decay - 1:+.1%}), {time.process_time() - begun:.1f} s"
        )


if __name__ == "__main__":
    all_of = (areas, circle, rest, ring, correction, deep, stiff, share, bag, fall, capsule)
    parts = {one.__name__: one for one in all_of}
    if len(sys.argv) > 1:
        parts[sys.argv[1]](*sys.argv[2:])
    else:
        (
            areas("64"),
            circle("64"),
            rest("64"),
            ring("21.33"),
            correction(),
            deep("48"),
            stiff(),
            share("64"),
            bag("96"),
            fall("96"),
        )
