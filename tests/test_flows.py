"""Incompressible flow: against exact solutions, what is conserved, orders, solids, what it carries."""

import itertools

import numpy as np
import pytest

from campaigns import LONG
from flows import VORTEX, Air, waves
from sceneql.flows.drawn_lines import lines
from sceneql.flows.readings import _own
from sceneql.grids.medium import FieldLayout

EDDY = {"initial": '{stream_function: "sin(pi*x)^2*sin(pi*y)^2"}', "viscosity": "0.02 Pa*s", "advection": "central"}
SLIP = "{wall: {slip: free}}"
BESIDE = '{left: {inflow: {velocity: "[1, 0]"}}, right: {outflow: {}}}'


def order(errors, factor=2.0):
    """Observed order of the last two of errors, each by steps or cells ``factor`` times as fine as the one before."""
    return np.log(errors[-2] / errors[-1]) / np.log(factor)


# --- space ---


def vortex_error(folder, cells, advection):
    air = waves(folder, cells, "{rk4: {step: 20 ms}}", 0.2, advection=advection).at(0.2)
    x, y, _ = air.read("centers").T
    rest = np.exp(-2 * 0.1 * 0.2)
    vorticity = air.read("vorticity") - 2 * np.cos(x) * np.cos(y) * rest
    pressure = air.read("pressure") + (np.cos(2 * x) + np.cos(2 * y)) * rest**2 / 4
    return np.sqrt(np.mean(vorticity**2)), np.sqrt(np.mean(pressure**2))


@pytest.mark.parametrize(
    ("advection", "least", "most"), [("central", 1.95, 2.1), ("koren", 1.7, 2.3), ("upwind", 0.9, 1.4)]
)
def test_the_vortex_of_taylor_and_green_is_met_by_each_advection_at_its_order(tmp_path, advection, least, most):
    found = np.array([vortex_error(tmp_path, cells, advection) for cells in (16, 32)])
    assert least <= order(found[:, 0]) <= most
    assert order(found[:, 1]) >= least - 0.3


def test_flow_between_plates_is_exact(tmp_path):
    """Couette's flow is linear, and Poiseuille's a parabola, whose second difference is exact but for the walls."""
    moved = '{left: {periodic: yes}, top: {wall: {velocity: "[2, 0]"}}}'
    narrow = {"size": "0.4 1 m", "cell": "0.1 m", "viscosity": "1 Pa*s"}
    sheared = Air(tmp_path, "{sbdf2: {step: 20 ms}}", 4.0, boundary=moved, **narrow).at(4.0)
    height = sheared.read("centers")[:, 1]
    assert sheared.read("velocity")[:, 0] == pytest.approx(2 * height, abs=1e-9)
    driven = Air(
        tmp_path, "{sbdf2: {step: 20 ms}}", 4.0, boundary="{left: {periodic: yes}}", force='"[8, 0]"', **narrow
    ).at(4.0)
    speed = driven.read("velocity")[:, 0]
    assert speed == pytest.approx(4 * (height * (1 - height) + 0.1**2 / 4), abs=1e-9)


def test_a_free_surface_of_a_wall_has_no_friction_and_navier_slips(tmp_path):
    """u = U (y + l)/(H + l) over a wall of slip length l; nothing slows a uniform flow between walls that slip."""
    slip = '{left: {periodic: yes}, bottom: {wall: {slip: 0.5 m}}, top: {wall: {velocity: "[3, 0]"}}}'
    narrow = {"size": "0.4 1 m", "cell": "0.1 m", "viscosity": "1 Pa*s"}
    air = Air(tmp_path, "{sbdf2: {step: 10 ms}}", 6.0, boundary=slip, **narrow).at(6.0)
    assert air.read("velocity")[:, 0] == pytest.approx(2 * (air.read("centers")[:, 1] + 0.5), abs=1e-7)
    free = "{left: {periodic: yes}, rest: {wall: {slip: free}}}"
    air = Air(tmp_path, "{sbdf2: {step: 10 ms}}", 0.5, boundary=free, initial='{velocity: "[1, 0]"}').at(0.5)
    assert air.read("velocity")[:, 0] == pytest.approx(1.0, abs=1e-13)


# --- what is conserved ---

KINDS = {"wall": "", "open": "outflow: {}", "periodic": "periodic: yes"}


@pytest.mark.parametrize("size", ["1 0.7 m", "3.3 2.6 m", "0.9 0.7 0.5 m"])
def test_projection_leaves_rounding_whatever_the_sides(tmp_path, size):
    pairs = (("left", "right"), ("bottom", "top"), ("back", "front"))[: len(size.split()) - 1]
    swirl = "[sin(3*x + y), cos(x*y)" + (", x + z*y]" if len(pairs) == 3 else "]")
    for chosen in [*itertools.product(KINDS, repeat=len(pairs))][:: 4 if len(pairs) == 3 else 1]:
        said = ((pair[len(kind) % 2], KINDS[kind]) for pair, kind in zip(pairs, chosen, strict=True))
        sides = [f"{side}: {{{kind}}}" for side, kind in said if kind]
        air = Air(
            tmp_path, "{euler: {step: 1 ms}}", 1e-3, size=size, cell="0.1 m",
            initial=f'{{velocity: "{swirl}"}}', boundary="{" + ", ".join(sides) + "}",
        )  # fmt: skip
        assert air.at(1e-3).read("divergence") < 1e-12, chosen


def test_sides_of_several_parts_lose_their_divergence_too(tmp_path):
    side = '{right: {where: "y - 0.4", outflow: {}}, left: {where: "0.5 - y", inflow: {velocity: "[y, 0]"}}}'
    air = Air(tmp_path, "{sbdf2: {step: 10 ms}}", 0.1, boundary=side).at(0.1)
    assert air.read("divergence") < 1e-8 * air.read("largest_speed") * 16


def test_momentum_stays_and_central_advection_keeps_the_energy(tmp_path):
    """Without viscosity in a periodic box; what is left of the energy's change is the solver's (order 4 in time)."""
    start = '{velocity: "[1 - cos(x)*sin(y) + 0.3*sin(2*y), 0.5 + sin(x)*cos(y)]"}'
    lost = []
    for step in ("40 ms", "20 ms"):
        air = waves(tmp_path, 16, f"{{rk4: {{step: {step}}}}}", 0.8, initial=start, viscosity="0 Pa*s")
        before = air.at(0.0).read("kinetic_energy"), air.read("momentum")
        after = air.at(0.8).read("kinetic_energy"), air.read("momentum")
        assert after[1] == pytest.approx(before[1], abs=1e-12)
        lost.append(abs(after[0] / before[0] - 1.0))
    assert lost[1] < 1e-6
    assert order(lost) > 3.5


def test_limited_advection_loses_energy(tmp_path):
    air = waves(tmp_path, 16, "{rk4: {step: 20 ms}}", 0.4, advection="koren", viscosity="0 Pa*s")
    before = air.at(0.0).read("kinetic_energy")
    assert 0.9 < air.at(0.4).read("kinetic_energy") / before < 1.0


# --- time ---


@pytest.mark.parametrize(
    ("solver", "steps", "least", "most"),
    [
        ("chorin", (10, 5), 0.9, 1.2),
        ("cnab2", (10, 5), 1.9, 2.2),
        ("sbdf2", (10, 5), 1.9, 2.2),
        ("ark3", (20, 10), 2.8, 3.3),
    ],
)
def test_solvers_of_flows_keep_their_order_beside_walls(tmp_path, solver, steps, least, most):
    """Velocity, between steps too, and the pressure that is told, against small explicit steps on the same cells."""
    exact = Air(tmp_path, "{rk4: {step: 1 ms}}", 0.4, **EDDY)
    between, exact = exact.at(0.3925).read("velocity"), exact.at(0.4)
    found = []
    for step in steps:
        air = Air(tmp_path, f"{{{solver}: {{step: {step} ms}}}}", 0.4, **EDDY)
        off = np.abs(air.at(0.3925).read("velocity") - between).max()
        air.at(0.4)
        found.append([np.abs(air.read(one) - exact.read(one)).max() for one in ("velocity", "pressure")])
        assert off <= 1.2 * found[-1][0]
    assert least <= order(np.array(found)[:, 0]) <= most
    assert order(np.array(found)[:, 1]) >= least - 0.3


def test_auto_marches_flows_by_a_tolerance(tmp_path):
    exact = Air(tmp_path, "{rk4: {step: 1 ms}}", 0.4, **EDDY).at(0.4).read("velocity")
    errors, steps = [], []
    for tolerance in ("1e-6", "1e-8"):
        air = Air(tmp_path, f"{{auto: {{tolerance: {tolerance}}}}}", 0.4, **EDDY).at(0.4)
        errors.append(np.abs(air.read("velocity") - exact).max())
        steps.append(air.run.march.statistics.steps)
    assert errors[0] < 1e-3
    assert errors[1] < 0.1 * errors[0]
    assert steps[0] < 40


def test_implicit_viscosity_bears_steps_far_beyond_the_explicit_bound(tmp_path):
    """100 times: the flow comes to rest, by every scheme that damps."""
    thick = {**EDDY, "viscosity": "20 Pa*s"}
    for solver in ("{chorin: {step: 5 ms}}", "{sbdf2: {step: 5 ms}}", "{ark3: {step: 5 ms}}"):
        assert Air(tmp_path, solver, 0.5, **thick).at(0.5).read("largest_speed") < 1e-3


# --- what is given at the boundary ---


def test_what_comes_in_goes_out_also_where_it_varies_in_time(tmp_path):
    sides = '{left: {inflow: {velocity: "[y*(1 - y)*(1 + 0.5*sin(6*t)), 0]"}}, right: {outflow: {}}}'
    air = Air(tmp_path, "{ark3: {step: 10 ms}}", 0.5, boundary=sides).at(0.5)
    speed = air.read("velocity")[:, 0].reshape(16, 16)
    y = (np.arange(16) + 0.5) / 16
    given = (y * (1 - y)).mean() * (1 + 0.5 * np.sin(3.0))
    assert speed.mean(axis=0) == pytest.approx(given, rel=1e-5)


def test_the_pressure_outside_drives_a_flow(tmp_path):
    """Poiseuille's flow rate, by the difference of the pressures."""
    sides = "{left: {outflow: {pressure: 0.01 Pa}}, right: {outflow: {}}}"
    air = Air(tmp_path, "{sbdf2: {step: 0.05 s}}", 5.0, boundary=sides, viscosity="0.5 Pa*s").at(5.0)
    assert air.read("velocity")[:, 0].mean() == pytest.approx(0.01 / (12 * 0.5), rel=0.01)


@pytest.mark.parametrize("viscosity", ["1e-3 Pa*s", "1e-3*(1 + x)"])
def test_what_a_pressure_sets_moving_comes_to_the_speed_of_bernoulli(tmp_path, viscosity):
    """Fluid that rests outside: L du/dt = p/density - u^2/2."""
    sides = f"{{rest: {SLIP}, left: {{outflow: {{pressure: 4 Pa}}}}, right: {{outflow: {{}}}}}}"
    size = {"size": "1 0.25 m", "density": "2 kg/m^3", "cell": "1/8 m"}
    air = Air(tmp_path, "{auto: {}}", 1.0, boundary=sides, viscosity=viscosity, **size).at(1.0)
    assert air.read("largest_speed") == pytest.approx(2.0 * np.tanh(1.0), rel=2e-3)


@pytest.mark.parametrize("ramp", ["t^2", "t^3"])
def test_what_rests_under_a_pressure_is_set_moving_smoothly(tmp_path, ramp):
    """p = 1 Pa + density (1 m - x) du/dt: steps by a tolerance shrank to nothing."""
    sides = f'{{left: {{inflow: {{velocity: "[{ramp}, 0]"}}}}, right: {{outflow: {{pressure: 1 Pa}}}}, rest: {SLIP}}}'
    more = {"size": "1 0.25 m", "cell": "1/8 m", "probes": "{here: 0.25 0.1 m}"}
    air = Air(tmp_path, "{auto: {}}", 1.0, boundary=sides, **more).at(0.5)
    power = int(ramp[-1])
    assert air.read("here.velocity")[0] == pytest.approx(0.5**power, rel=1e-3)
    assert air.read("here.pressure") == pytest.approx(1.0 + 0.75 * power * 0.5 ** (power - 1), rel=1e-3)


# --- solids ---


def channel(folder, cells, edges="cut_cell", offset=0.0):
    """Poiseuille's flow between two solids 0.7 m apart: rate of flow over the exact one, force over weight, less 1."""
    h = 1 / cells
    low, high = 0.13 + offset, 0.17 - offset
    a, b = (f"{{box: {{size: 2 {s} 1 m, position: 0 {y} 0 m}}}}" for s, y in ((low, low / 2), (high, 1 - high / 2)))
    air = Air(
        folder, "{sbdf2: {step: 10 ms}}", 1.5, before=f"objects: {{a: {a}, b: {b}}}\n", size=f"{3 * h} 1 m",
        cell=f"{h} m", viscosity="1 Pa*s", around="[a, b]", edges=edges, boundary="{left: {periodic: yes}}",
        force='"[8, 0]"',
    ).at(1.5)  # fmt: skip
    through = air.read("momentum")[0] / (3 * h)
    force = air.read("a.force") + air.read("b.force")
    return through / (8 * 0.7**3 / 12) - 1, force[0] / (8 * 0.7 * 3 * h) - 1


def test_walls_that_cut_cells_are_of_second_order_and_take_all_momentum(tmp_path):
    errors = []
    for cells in (16, 32):
        found = [channel(tmp_path, cells, offset=offset) for offset in (0.0, 0.013, 0.027)]
        errors.append(max(abs(rate) for rate, _ in found))
        assert max(abs(force) for _, force in found) < 1e-6
    assert errors[1] < 0.006
    assert order(errors) > 1.8


@pytest.mark.parametrize("advection", ["central", "koren"])
def test_a_round_solid_takes_the_momentum_that_a_force_gives_the_stream(tmp_path, advection):
    """Steady in a periodic box: what is carried into faces that the solid shuts counts, too (Re about 15)."""
    stone = "objects: {stone: {sphere: {position: 0.47 0.52 0 m, radius: 0.2 m}}}\n"
    air = Air(
        tmp_path, "{sbdf2: {step: 40 ms}}", 30.0, before=stone, around="[stone]", viscosity="0.03 Pa*s",
        boundary="{left: {periodic: yes}, bottom: {periodic: yes}}", force='"[0.5, 0.1]"', advection=advection,
    ).at(30.0)  # fmt: skip
    state = air.run.state("air")
    cells, ints = air.tasks["air"].kind.layout(state, "speed"), state.ints[5:]
    volumes = [_own(ints, state.floats, cells, axis).sum() for axis in range(2)]
    assert volumes == pytest.approx([1 - np.pi * 0.2**2] * 2, rel=4e-3)
    force = air.read("stone.force")
    assert force[:2] == pytest.approx([0.5 * volumes[0], 0.1 * volumes[1]], rel=1e-6)


def past(folder, place, along, back):
    """Force along and across on a ball, ``place`` off the middle of a channel along x or y, or back along it."""
    middle = 0.4 + place
    far = 0.9 if back else 0.3
    where = (far, middle) if along == "x" else (middle, far)
    speed = f"{'-' if back else ''}{'y*(0.8 - y)' if along == 'x' else 'x*(0.8 - x)'}"
    ends = ("left", "right") if along == "x" else ("bottom", "top")
    first, last = ends[::-1] if back else ends
    velocity = f"[{speed}, 0]" if along == "x" else f"[0, {speed}]"
    air = Air(
        folder, "{sbdf2: {step: 20 ms}}", 0.6, size="1.2 0.8 m" if along == "x" else "0.8 1.2 m", cell="0.05 m",
        before=f"objects: {{ball: {{sphere: {{position: {where[0]} {where[1]} 0 m, radius: 0.13 m}}}}}}\n",
        around="[ball]", viscosity="1e-3 Pa*s",
        boundary=f'{{{first}: {{inflow: {{velocity: "{velocity}"}}}}, {last}: {{outflow: {{}}}}}}',
    ).at(0.6)  # fmt: skip
    x, y, _ = air.read("ball.force")
    drag, lift = (x, y) if along == "x" else (y, x)
    return -drag if back else drag, lift


def test_the_force_on_a_solid_is_mirrored_with_the_stream(tmp_path):
    """Off to one side or the other, forth or back, along x or y; in the middle of a channel nothing lifts it."""
    drag, lift = past(tmp_path, 0.013, "x", False)
    assert abs(lift) > 1e-3 * drag
    for place, along, back in itertools.product((0.013, -0.013), "xy", (False, True)):
        found = past(tmp_path, place, along, back)
        assert found == pytest.approx((drag, lift if place > 0.0 else -lift), rel=1e-9), (place, along, back)
    assert abs(past(tmp_path, 0.0, "x", False)[1]) < 1e-12 * drag


def test_the_pressure_in_a_solid_is_zero(tmp_path):
    """Where no face of a cell is open: nothing solves for it."""
    stone = "objects: {stone: {sphere: {position: 0.5 0.45 0 m, radius: 0.2 m}}}\n"
    air = Air(tmp_path, "{sbdf2: {step: 5 ms}}", 0.05, before=stone, around="[stone]", boundary=BESIDE).at(0.05)
    within = np.hypot(*(air.read("centers")[:, :2] - [0.5, 0.45]).T) < 0.12
    pressure = air.read("pressure")
    assert within.any()
    assert (pressure[within] == 0.0).all()
    assert np.abs(pressure).max() > 0.1


def test_a_staircase_is_of_first_order(tmp_path):
    assert max(abs(channel(tmp_path, 32, "staircase", offset)[0]) for offset in (0.0, 0.013)) > 0.02


# --- fields that it carries ---


def heated(folder, cells, rayleigh, solver, end):
    """The heated cavity of Pr 0.71, in units of its side and of the diffusion of heat."""
    heat = f"""  heat:
    diffusion:
      of: temperature
      size: 1 1 m
      cell: 1/{cells} m
      coefficient: 1
      initial: 300.5 - x
      boundary: {{left: {{value: 300.5}}, right: {{value: 299.5}}}}
      drift: {{by: air}}
"""
    lift = f"{{by: heat.temperature, expansion: {0.71 * rayleigh} 1/K, reference: 300 K, gravity: 0 -1 0 m/s^2}}"
    air = Air(folder, solver, end, heat, cell=f"1/{cells} m", viscosity="0.71 Pa*s", buoyancy=lift).at(end)
    warm = air.read("temperature", "heat").reshape(cells, cells)
    return air, (300.5 - warm[:, 0]).mean() * 2 * cells, (warm[:, -1] - 299.5).mean() * 2 * cells


def test_a_heated_cavity_passes_on_the_heat_of_de_vahl_davis(tmp_path):
    """Nu = 2.2448 at Ra 1e4 (Hortmann et al. 1990): within 1.1 % on 32 x 32 cells; heat in is heat out."""
    air, hot, cold = heated(tmp_path, 32, 1e4, "{sbdf2: {step: 0.5 ms}}", 0.5)
    assert hot == pytest.approx(2.2448, rel=0.011)
    assert hot == pytest.approx(cold, rel=1e-6)
    assert air.read("velocity").max(axis=0)[:2] == pytest.approx([16.178, 19.617], rel=0.005)


def test_a_flow_brings_in_what_a_field_has_at_its_inflow(tmp_path):
    """Its mass grows by what is brought, and nothing new arises."""
    dye = """  dye:
    diffusion: {of: number, size: 1 1 m, cell: 1/16 m, coefficient: 0, boundary: {left: {value: 2}}, drift: {by: air}}
"""
    wide = '{left: {inflow: {velocity: "[1, 0]"}}, right: {outflow: {}}, rest: {wall: {slip: free}}}'
    start = '{velocity: "[1, 0]"}'
    air = Air(tmp_path, "{rk4: {step: 5 ms}}", 1.4, dye, boundary=wide, initial=start)
    assert air.at(0.4).read("mass", "dye") == pytest.approx(0.8, rel=1e-6)
    assert air.read("mass", "dye") == pytest.approx(air.read("inflow", "dye"), rel=1e-12)
    assert air.read("max", "dye") < 2.0 + 1e-6
    assert air.at(1.4).read("concentration", "dye") == pytest.approx(2.0, abs=1e-2)


def test_a_field_may_be_solved_before_or_after_its_flow(tmp_path):
    """The order of a script's models does not matter to what they do."""
    dye = (
        "  dye: {diffusion: {of: number, size: 1 1 m, cell: 1/16 m, coefficient: 0.01, initial: x, drift: {by: air}}}\n"
    )
    ends = []
    for first in (False, True):
        air = Air(tmp_path, "{ark3: {step: 20 ms}}", 0.1, "" if first else dye, first=dye if first else "", **EDDY)
        ends.append(air.at(0.1).read("concentration", "dye"))
    assert ends[0] == pytest.approx(ends[1], abs=1e-13)
    assert ends[0].mean() == pytest.approx(0.5, rel=1e-12)
    assert np.abs(ends[0] - (np.arange(256) % 16 + 0.5) / 16).max() > 0.01


# --- the lid-driven cavity ---


def cavity(folder, cells, end, step):
    lid = '{top: {wall: {velocity: "[1, 0]"}}}'
    return Air(
        folder, f"{{sbdf2: {{step: {step}}}}}", end, cell=f"1/{cells} m", viscosity="0.01 Pa*s", advection="central",
        boundary=lid,
    ).at(end)  # fmt: skip


def extremes(air, cells):
    """The least u on the vertical middle, the largest and the least v on the horizontal one, by parabolas."""
    u, v, _ = (part.reshape(cells, cells) for part in air.read("velocity").T)
    lines = 0.5 * (u[:, cells // 2 - 1] + u[:, cells // 2]), 0.5 * (v[cells // 2 - 1] + v[cells // 2])
    found = []
    for line, sign in ((lines[0], -1), (lines[1], 1), (lines[1], -1)):
        k = int(np.argmax(sign * line))
        a, b, c = line[k - 1 : k + 2]
        found.append(b - (a - c) ** 2 / (8 * (a - 2 * b + c)))
    return found


def test_a_lid_drives_a_cavity_as_marchi_found(tmp_path):
    """Re 100 (Marchi et al. 2009): within 2.8 % on 32 x 32 cells (0.8 % on 64 x 64, below)."""
    found = extremes(cavity(tmp_path, 32, 16.0, "20 ms"), 32)
    assert found == pytest.approx([-0.2140424, 0.1795728, -0.2538030], rel=0.028)


def test_a_steady_flow_in_a_box_with_a_way_through_is_told_by_its_vortex(tmp_path):
    """A vortex beside a stream keeps its sign: vorticity is -du/dy of the sheared stream beside the walls."""
    air = Air(tmp_path, "{sbdf2: {step: 10 ms}}", 1.0, boundary=BESIDE, initial=VORTEX).at(1.0)
    turning = air.read("vorticity").reshape(16, 16)
    assert turning[0, 8] < 0.0 < turning[-1, 8]


@pytest.mark.skipif(not LONG, reason="half a minute: make test-long")
@pytest.mark.parametrize(("cells", "step", "within"), [(64, "10 ms", 0.008), (128, "4 ms", 0.002)])
def test_a_lid_drives_a_finer_cavity_nearer(tmp_path, cells, step, within):
    found = extremes(cavity(tmp_path, cells, 20.0, step), cells)
    assert found == pytest.approx([-0.2140424, 0.1795728, -0.2538030], rel=within)


def test_streamlines_end_at_the_box_that_the_flow_runs_into():
    """Towards a wall, as beside it velocities read between centers do not vanish."""
    layout = FieldLayout((8, 8, 1), 0, 0, (0.0, 0.0, -0.5), (0.25, 0.25, 1.0))
    ends = lines(np.tile([0.3, 1.0, 0.0], (64, 1)), layout, 0.5, np.inf)
    assert len(ends) > 20
    assert ends[..., :2].min() >= -1e-5
    assert 2.0 - 1e-5 <= ends[..., :2].max() <= 2.0 + 1e-5


def test_streamlines_follow_the_circles_of_a_vortex():
    """Of a solid rotation: every piece keeps its distance from the axis, and lines fill the box evenly."""
    layout = FieldLayout((32, 32, 1), 0, 0, (-1.0, -1.0, -0.5), (1 / 16, 1 / 16, 1.0))
    x, y, z = layout.centers().T
    ends = lines(np.column_stack([-y, x, 0 * z]), layout, 0.2, np.inf)
    first, last = np.linalg.norm(ends, axis=2).T
    inner = first < 0.9
    assert np.abs(first - last)[inner].max() < 2e-3
    assert np.unique(np.round(first[inner], 1)).size > 5


@pytest.mark.parametrize("solver", ["{chorin: {step: 5 ms}}", "{sbdf2: {step: 5 ms}}", "{ark3: {step: 20 ms}}"])
def test_what_has_come_in_is_what_is_there_also_around_solids(tmp_path, solver):
    """Where diffusion is implicit, too; and no dye enters the stone."""
    of = "of: number, size: 1 1 m, cell: 1/16 m, coefficient: 0.02, boundary: {left: {value: 2}}"
    dye = f"  dye: {{diffusion: {{{of}, drift: {{by: air}}}}}}\n"
    stone = "objects: {stone: {sphere: {position: 0.5 0.45 0 m, radius: 0.2 m}}}\n"
    air = Air(tmp_path, solver, 0.5, dye, before=stone, around="[stone]", boundary=BESIDE).at(0.5)
    assert air.read("mass", "dye") > 0.3
    assert air.read("mass", "dye") == pytest.approx(air.read("inflow", "dye"), rel=1e-10)
    assert air.read("max", "dye") <= 2.0 + 1e-6
    assert len(air.read("concentration", "dye")) < 256


def test_both_sides_of_a_direction_may_say_that_it_is_periodic(tmp_path):
    """Who writes both means one thing; the second was refused, since the first has its faces already."""
    narrow = {"size": "0.4 1 m", "cell": "0.1 m", "viscosity": "1 Pa*s", "force": '"[8, 0]"'}
    one, both = (
        Air(tmp_path, "{sbdf2: {step: 20 ms}}", 0.1, boundary=f"{{left: {{periodic: yes}}{more}}}", **narrow).at(0.1)
        for more in ("", ", right: {periodic: yes}")
    )
    assert np.array_equal(one.read("velocity"), both.read("velocity"))
