"""Elastic skins full of fluid: `membrane` and `immersion`."""

from dataclasses import replace

import numpy as np
import pytest

from flows import VORTEX
from sceneql.failure import RunFailure
from sceneql.flows import layout
from sceneql.pipeline import load
from sceneql.quantities.diagnostic import ScriptError
from sceneql.run.run import Run
from sceneql.skins.closed_line import even, signed_area
from sceneql.skins.spline_kernels import through
from skins import ELLIPSE, ballooned, smooth_area

RK4, SBDF2 = "{rk4: {step: 4 ms}}", "{sbdf2: {step: 4 ms}}"
WALLED = "{}"
FORCES = "forces: [{immersion: {on: [balloon], in: air}}]\n"


def flow_ints(shape, periodic):
    """The integers that tell splines of a grid's faces, and the number of faces of each component."""
    ints = np.zeros(layout.PLANS, dtype=np.int64)
    ints[:3], ints[3:6], ints[layout.AXES] = (*shape, 1)[:3], periodic, len(shape)
    sizes = [
        int(np.prod([n + (axis == k and not periodic[k]) for k, n in enumerate(shape)])) for axis in range(len(shape))
    ]
    return ints, sizes


def free_of_divergence(shape, periodic, rng):
    """Random faces of each component, none of them through a wall, as differences of a potential at edges."""
    assert len(shape) == 2
    nx, ny = shape
    corners = rng.standard_normal((ny + 1, nx + 1))
    if periodic[0]:
        corners[:, -1] = corners[:, 0]
    else:
        corners[:, 0] = corners[:, -1] = 0.0
    if periodic[1]:
        corners[-1] = corners[0]
    else:
        corners[0] = corners[-1] = 0.0
        if not periodic[0]:
            corners[:, 0] = corners[:, -1] = 0.0
    u, v = np.diff(corners, axis=0), -np.diff(corners, axis=1)
    return np.ascontiguousarray(u[:, : nx + (not periodic[0])]), np.ascontiguousarray(v[: ny + (not periodic[1])])


@pytest.mark.parametrize("periodic", [(1, 1, 0), (0, 0, 0), (1, 0, 0)], ids=["periodic", "walls", "channel"])
def test_what_is_read_of_a_flow_is_free_of_divergence_up_to_the_walls(periodic):
    shape, rng = (7, 6), np.random.default_rng(5)
    ints, _ = flow_ints(shape, periodic)
    u, v = (one.ravel() for one in free_of_divergence(shape, periodic, rng))
    step = 1e-3
    for x, y in [(0.3, 0.2), (3.7, 5.6), (6.9, 3.1), (0.9, 5.95), *rng.uniform(0.1, 5.9, (6, 2))]:
        right, left = (through(u, 0, x + way, y, 0.0, 0.0, False, False, ints) for way in (step, -step))
        up, down = (through(v, 1, x, y + way, 0.0, 0.0, False, False, ints) for way in (step, -step))
        # Differences of cubics: exact but for the third derivative, which is that of u along x alone.
        far = [through(u, 0, x + way, y, 0.0, 0.0, False, False, ints) for way in (2 * step, -2 * step)]
        high = [through(v, 1, x, y + way, 0.0, 0.0, False, False, ints) for way in (2 * step, -2 * step)]
        slope = (8 * (right - left) - (far[0] - far[1]) + 8 * (up - down) - (high[0] - high[1])) / (12 * step)
        assert slope == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("shape", [(7, 6), (5, 6, 6)], ids=["flat", "deep"])
@pytest.mark.parametrize("periodic", [(1, 1, 1), (0, 0, 0)], ids=["periodic", "walls"])
@pytest.mark.parametrize("peskin", [False, True], ids=["splines", "peskin"])
def test_linear_velocities_are_read_exactly_and_spreading_is_the_transpose_of_reading(shape, periodic, peskin):
    rng = np.random.default_rng(3)
    ints, sizes = flow_ints(shape, periodic)
    for component in range(len(shape)):
        place = np.append(rng.uniform(2.2, 3.8, len(shape)), [0.0] * (3 - len(shape)))
        counts = [n + (axis == component and not periodic[component]) for axis, n in enumerate(shape)]
        axes = np.meshgrid(*[np.arange(n) + 0.5 * (axis != component) for axis, n in enumerate(counts)], indexing="ij")
        field = 1.0 + sum((axis + 2.0) * one for axis, one in enumerate(axes))
        u = np.ascontiguousarray(field.transpose(*range(len(shape))[::-1])).ravel()
        exact = 1.0 + sum((axis + 2.0) * place[axis] for axis in range(len(shape)))
        assert through(u, component, *place, 0.0, False, peskin, ints) == pytest.approx(exact, rel=1e-13)
        place[: len(shape)] = rng.uniform(0.05, 3.9, len(shape))
        random, spread = rng.standard_normal(sizes[component]), np.zeros(sizes[component])
        through(spread, component, *place, 1.0, True, peskin, ints)
        assert spread.sum() == pytest.approx(1.0, rel=1e-13)
        assert spread @ random == pytest.approx(through(random, component, *place, 0.0, False, peskin, ints), abs=1e-13)


@pytest.mark.parametrize("boundary", [None, WALLED], ids=["periodic", "walls"])
def test_the_skin_gives_the_fluid_the_energy_that_it_loses(tmp_path, boundary):
    """Without viscosity, by central advection, the sum is kept as the steps become short: their power is the same."""
    sums = []
    for step in (8, 4):
        more = {} if boundary is None else {"boundary": boundary, "at": "0.36 0.31"}
        air = ballooned(
            tmp_path, viscosity="0 Pa*s", volume="free", solver=f"{{rk4: {{step: {step} ms}}}}", end=0.24, **more
        )
        start = air.at(0.0).read("potential", "balloon")
        air.at(0.24)
        moving, stored = air.read("kinetic_energy"), air.read("potential", "balloon")
        sums.append(abs(moving + stored - start) / moving)
        assert moving > 0.01
    assert sums[0] < 2e-4
    assert sums[1] < sums[0] / 7


@pytest.mark.parametrize("solver", [RK4, SBDF2, "{ark3: {}}", "{cnab2: {step: 4 ms}}", "{chorin: {step: 2 ms}}"])
def test_what_is_drawn_keeps_its_area_under_every_solver(tmp_path, solver):
    air = ballooned(tmp_path, solver=solver, end=0.3)
    area = air.at(0.0).read("volume", "balloon")
    for time in (0.0501, 0.1, 0.2777, 0.3):  # within steps, too
        assert air.at(time).read("volume", "balloon") == pytest.approx(area, rel=1e-13)
    assert 1e-8 * area < air.read("volume_correction", "balloon") < 1e-3 * area
    assert air.read("center", "balloon") == pytest.approx([0.5, 0.5, 0.0], abs=1e-6)


def test_a_method_of_two_steps_goes_on_over_what_keeps_the_area(tmp_path):
    """Its error falls at order 2: were each step the first, it would at order 1."""
    ends = {}
    for step in (8, 4, 0.5):
        air = ballooned(tmp_path, solver=f"{{sbdf2: {{step: {step} ms}}}}", end=0.2).at(0.2)
        ends[step] = air.read("positions", "balloon")
    errors = [np.abs(ends[step] - ends[0.5]).max() for step in (8, 4)]
    assert errors[0] / errors[1] > 3.2


def test_the_curve_through_the_vertices_keeps_its_area_by_the_flow_alone(tmp_path):
    air = ballooned(tmp_path, cells=32, volume="free", solver="{ark3: {step: 4 ms}}", end=0.4)
    before = air.at(0.0).read("positions", "balloon")
    after = air.at(0.4).read("positions", "balloon")
    assert smooth_area(after) == pytest.approx(smooth_area(before), rel=4e-7)
    assert np.abs(after - before).max() > 0.03
    assert air.read("volume_correction", "balloon") == 0.0


def test_the_kernel_of_four_points_loses_hundreds_of_times_the_area(tmp_path):
    """What it reads has a divergence (Peskin & Printz 1993, J. Comput. Phys. 105, 33-46)."""
    lost = {}
    for kernel in ("splines", "peskin"):
        forces = f"forces: [{{immersion: {{on: [balloon], in: air, kernel: {kernel}}}}}]\n"
        air = ballooned(tmp_path, cells=32, volume="free", solver="{ark3: {step: 4 ms}}", end=0.4, forces=forces)
        before = smooth_area(air.at(0.0).read("positions", "balloon"))
        lost[kernel] = abs(smooth_area(air.at(0.4).read("positions", "balloon")) / before - 1.0)
    assert 1e-5 < lost["peskin"] < 1e-2
    assert lost["splines"] < lost["peskin"] / 300


def test_what_is_put_back_falls_at_order_two_with_the_spacing(tmp_path):
    told = []
    for cells in (16, 32):
        air = ballooned(tmp_path, cells=cells, solver="{ark3: {step: 4 ms}}", end=0.2).at(0.2)
        told.append(air.read("volume_correction", "balloon"))
    assert np.log2(told[0] / told[1]) == pytest.approx(2.0, abs=0.25)


def test_a_circle_of_one_tension_rests_under_the_pressure_of_laplace(tmp_path):
    law = "law: {tension: 0.5 N/m}"
    air = ballooned(tmp_path, law, "x^2 + y^2 - 0.25^2", "0.51 0.48", cells=32, solver="{sbdf2: {step: 5 ms}}", end=0.5)
    air.at(0.5)
    assert air.read("pressure_jump", "balloon") == pytest.approx(0.5 / 0.25, rel=2e-3)
    assert air.read("deformation", "balloon") < 1e-4
    assert 0.05 * air.read("largest_speed") / 0.5 < 2e-5


def test_an_ellipse_of_springs_comes_to_rest_as_a_circle_of_its_area(tmp_path):
    """Tu and Peskin's ring (1992)."""
    air = ballooned(tmp_path, solver="{ark3: {tolerance: 1e-3}}", end=4.0, cells=20, viscosity="0.1 Pa*s").at(4.0)
    points = air.read("positions", "balloon") - air.read("center", "balloon")
    radii = np.hypot(*points[:, :2].T)
    assert radii == pytest.approx(np.full(len(radii), np.sqrt(0.06)), abs=2e-4)


def test_a_skin_without_tension_to_speak_of_goes_with_the_flow(tmp_path):
    """The vortex of Taylor and Green (1937), at rest without viscosity: vertices keep to its streamlines."""
    side = 6.283185307179586
    air = ballooned(
        tmp_path, "law: {tension: 1e-9 N/m}", "(x^2 + y^2)/0.6^2 - 1", "2.1 3", size=f"{side} {side} m",
        cell=f"{side}/32 m", initial=VORTEX, viscosity="0 Pa*s", solver="{rk4: {step: 50 ms}}", end=1.0,
    )  # fmt: skip
    before = air.at(0.0).read("positions", "balloon")
    after = air.at(1.0).read("positions", "balloon")
    stream = [np.cos(one[:, 0]) * np.cos(one[:, 1]) for one in (before, after)]
    assert np.abs(after - before).max() > 0.3
    assert stream[1] == pytest.approx(stream[0], abs=4e-3)


def test_a_skin_is_the_same_one_period_further_on(tmp_path):
    """Across the seam of a periodic box, and seen a box away."""
    inner, outer = (
        ballooned(tmp_path, at=at, solver=RK4, end=0.1).at(0.1).read("positions", "balloon")
        for at in ("0.5 0.5", "1.0 -1.5")
    )
    assert outer - inner == pytest.approx(np.tile([0.5, -2.0, 0.0], (len(inner), 1)), abs=1e-9)


def test_two_skins_push_one_fluid_the_same_way_round(tmp_path):
    """Mirrored halves of a walled box: so are their motions."""
    eggs = [f'{{implicit: {{field: "{ELLIPSE}", position: {x} 0.5 0 m}}}}' for x in (0.5, 1.5)]
    both = f"objects: {{egg: {eggs[0]}, other: {eggs[1]}}}\n"
    law = "law: {springs: {stretch: 4 N/m}}, prestress: 1 N/m"
    air = ballooned(
        tmp_path, law, size="2 1 m", boundary=WALLED, solver=RK4, end=0.1, objects=both,
        forces=f"  twin: {{membrane: {{of: other, {law}}}}}\n" + FORCES.replace("balloon", "balloon, twin"),
    ).at(0.1)  # fmt: skip
    for output in ("potential", "deformation", "pressure_jump"):
        assert air.read(output, "twin") == pytest.approx(air.read(output, "balloon"), rel=1e-6)
    centers = air.read("center", "balloon"), air.read("center", "twin")
    assert centers[0][0] + centers[1][0] == pytest.approx(2.0, abs=1e-9)


def test_the_second_moments_of_an_ellipse_tell_its_deformation(tmp_path):
    air = ballooned(tmp_path, cells=48).at(0.0)
    assert air.read("deformation", "balloon") == pytest.approx((0.3 - 0.2) / (0.3 + 0.2), abs=2e-5)
    assert air.read("volume", "balloon") == pytest.approx(np.pi * 0.06, rel=2e-4)
    assert smooth_area(air.read("positions", "balloon")) == pytest.approx(np.pi * 0.06, rel=1e-12)
    assert air.read("potential", "balloon") == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("law", ["law: {tension: 4 N/m}", "law: {springs: {stretch: 4 N/m}}"])
def test_the_bound_of_steps_that_is_told_is_that_of_the_spectrum(tmp_path, law):
    air = ballooned(tmp_path, law, cells=12, viscosity="0 Pa*s", volume="free", spacing="0.04 m").at(0.0)
    system = air.run.march.system
    floats, n = system.floats.copy(), len(system.y)
    rates = np.zeros((2 * n + 1, n))
    for k, out in enumerate(rates):
        y = system.y.copy()
        y[k % n] += (1e-6, -1e-6, 0.0)[k // n]
        air.run.march.driver.rate(0.0, y, out, floats, system.ints)
    fastest = np.abs(np.linalg.eigvals((rates[:n] - rates[n : 2 * n]).T / 2e-6)).max()
    immersion, skin, flow = (air.tasks[name].kind for name in ("immersion", "balloon", "air"))
    (told,) = immersion.fastest_carried({"balloon": skin}, flow, None)
    assert told.turn == pytest.approx(fastest, rel=0.06)


def test_a_step_beyond_the_bound_of_a_skin_is_told_and_fails(tmp_path):
    law, bound = "law: {tension: 4 N/m}", 2.83 / (0.55 * 4 * 16**3) ** 0.5
    for part, told in ((0.9, False), (1.5, True)):
        air = ballooned(tmp_path, law, solver=f"{{rk4: {{step: {part * bound!r} s}}}}", end=2.0, viscosity="0 Pa*s")
        assert any("the skin 'balloon'" in str(one) for one in air.graph.warnings) is told
        if told:
            with pytest.raises(RunFailure):
                air.at(2.0)
        else:
            assert air.at(2.0).read("largest_speed") < 5.0


def test_an_outline_is_a_skin_with_even_sides():
    square = np.array([[0, 0], [0, 1], [1, 1], [1, 0]], dtype=float)  # clockwise
    points = even(square, 0.099)
    sides = np.hypot(*(np.roll(points, -1, axis=0) - points).T)
    assert np.ptp(sides) < 1e-9
    assert sides.max() <= 0.1
    assert signed_area(points) == pytest.approx(1.0, abs=0.01)


def test_a_skin_beyond_a_periodic_side_is_one_of_the_flow_that_comes_in_there(tmp_path):
    speeds = []
    for x in (0.5, 1.5, -2.5):
        ball = f"objects: {{egg: {{sphere: {{position: {x} 0.5 0 m, radius: 0.2 m}}}}}}\n"
        air = ballooned(tmp_path, objects=ball, initial='{velocity: "[0.1*sin(2*pi*y), 0.2*sin(2*pi*x)]"}')
        speeds.append(air.at(0.02).read("speed"))
    assert np.ptp(speeds[0]) > 0.1
    assert speeds[1:] == [pytest.approx(speeds[0], rel=1e-9)] * 2


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"at": "0.1 0.5", "boundary": WALLED}, "stands outside its flow, which ends at x = 0 m"),
        ({"spacing": "0.1 m"}, "too coarse for cells of 0.0625 m"),
        ({"formula": "x^2 + y^2 - 0.1^2"}, "is 0.2 m wide: its flow's cells of 0.0625 m are too coarse"),
        ({"formula": "x^2/0.45^2 + y^2/0.2^2 - 1"}, "it would touch itself"),
        ({"formula": "abs(hypot(x, y) - 0.25) - 0.05"}, "has 2 outlines in the plane z = 0"),
        ({"formula": "x^2 + y^2 + (z - 0.5)^2 - 0.1"}, "has no outline in the plane z = 0"),
        ({"law": "law: {tension: 1 N/m}, prestress: 1 N/m"}, "all the tension that there is"),
        (
            {"law": "law: {tension: 1 N/m, springs: {stretch: 1 N/m}}"},
            "has one of `springs`, `neo_hookean`, `skalak` and `tension`",
        ),
        ({"forces": "forces: [{gravity: {}}]\n"}, "no flow carries 'balloon'"),
        ({"forces": "forces: [{immersion: {in: air}}]\n"}, "names the skins and masses"),
        ({"forces": "forces: [{immersion: {on: [balloon], in: balloon}}]\n"}, "is no flow"),
        (
            {"forces": "forces: [{immersion: {on: [balloon, air], in: air}}]\n"},
            "'air' is nothing that a flow can carry",
        ),
        (
            {"forces": "forces: [{immersion: {on: [balloon], in: air}}, {immersion: {on: [balloon], in: air}}]\n"},
            "'balloon' is carried by two forces",
        ),
    ],
)
def test_skins_that_do_not_fit_are_refused(tmp_path, change, text):
    with pytest.raises(ScriptError, match=text.replace("[", r"\[")):
        ballooned(tmp_path, **change).at(0.0)


DRAWN = """
models:
  air: {flow: {size: 1 1 m, cell: 1/16 m, density: 1 kg/m^3, viscosity: 0.1 Pa*s}}
  balloon: {membrane: {of: egg, law: {tension: 1 N/m}, filled: yes, thickness: 4 cm}}
forces: [{immersion: {on: [balloon], in: air}}]
objects: {egg: {sphere: {position: 0.5 0.5 0 m, radius: 0.3 m}}, MORE}
"""


@pytest.mark.parametrize("by", ["", "thin: {surface: {of: balloon, thickness: 1 cm}}"])
def test_a_flat_skin_is_drawn_as_a_closed_line_and_what_it_holds(tmp_path, by):
    """In place of its object, and not twice where a `surface` draws it."""
    path = tmp_path / "scene.yaml"
    path.write_text(DRAWN.replace("MORE", by) + "outputs: {still: {image: {}}}\n", encoding="utf-8")
    graph = load(path)
    (moment,) = Run(graph).moments([0.1])
    line, face = (one for one in moment.lower(graph.drawn["still"]) if "air" not in one.name)
    assert line.ends[1:, 0] == pytest.approx(line.ends[:-1, 1], abs=0)
    assert line.ends[0, 0] == pytest.approx(line.ends[-1, 1], abs=0)
    assert np.hypot(*(line.ends[:, 0] - [0.5, 0.5, 0.0])[:, :2].T) == pytest.approx(
        np.full(len(line.ends), 0.3), abs=2e-3
    )
    assert set(line.radii) == {0.005 if by else 0.02}
    a, b, c = (face.vertices[face.triangles[:, k]] for k in range(3))
    areas = 0.5 * np.cross(b - a, c - a)[:, 2]
    assert areas.min() >= 0.0
    assert areas.sum() == pytest.approx(moment.read("balloon", "volume"), rel=1e-12)


def test_a_skin_that_is_turned_inside_out_or_crosses_itself_is_told(tmp_path):
    air = ballooned(tmp_path, end=0.01).at(0.0)
    skin, state = air.tasks["balloon"].kind, air.run.state("balloon")
    at, count = skin.made.membrane.position_at, skin.made.membrane.count
    turns = 2 * np.pi * np.arange(count) / count

    def told(x, y):
        points = np.column_stack([0.5 + 0.3 * x, 0.5 + 0.3 * y, np.zeros(count)])
        changed = state.y.copy()
        changed[at : at + 3 * count] = points.ravel()
        return skin.trouble(replace(state, y=changed))[0]

    assert not told(np.cos(turns), np.sin(turns))
    assert "inside out at the end" in told(np.cos(turns), -np.sin(turns))
    # Pascal's limacon: its inner loop goes around the same way, and crosses the outer one at the origin.
    radii = 0.4 + 0.6 * np.cos(turns)
    text = told(radii * np.cos(turns), radii * np.sin(turns))
    place = [float(one) for one in text.partition("crosses itself at the end, near (")[2].split(",")[:2]]
    assert place == pytest.approx([0.5, 0.5], abs=2e-3)
