"""Flows that fill an object: between turning cylinders, in a square outline, in a pipe; what is refused."""

import numpy as np
import pytest

from flows import Air
from sceneql.pipeline import load
from sceneql.quantities.diagnostic import ScriptError

INNER, OUTER, SPEED = 0.4, 1.0, 1.5


def stirred(folder, cells, edges="cut_cell"):
    """A bowl at rest around a drum that turns; the error in the mean square off the walls, and of the torque."""
    drum = f"  drum: {{sphere: {{position: 0.1 -0.05 0 m, radius: {INNER} m}}}}\n"
    bowl = f"objects:\n{drum}  bowl: {{sphere: {{position: 0.1 -0.05 0 m, radius: {OUTER} m}}}}\n"
    air = Air(
        folder, "{sbdf2: {step: 20 ms}}", 1.0, before=bowl, size=None, domain="bowl", flat="yes", cell=f"2/{cells} m",
        viscosity="1 Pa*s", around="[drum]", edges=edges, advection="central",
        boundary=f'{{drum: {{wall: {{velocity: "[-{SPEED}*(y + 0.05), {SPEED}*(x - 0.1)]"}}}}}}',
    ).at(1.0)  # fmt: skip
    slope = -SPEED * INNER**2 / (OUTER**2 - INNER**2)
    swirl = SPEED * INNER**2 * OUTER**2 / (OUTER**2 - INNER**2)
    places = air.read("centers")[:, :2] - [0.1, -0.05]
    r = np.hypot(*places.T)
    within = (r > INNER + 0.1) & (r < OUTER - 0.1)
    wrong = air.read("speed") - np.abs(slope * r + swirl / r)
    torques = [air.read(f"{name}.torque")[2] / (4 * np.pi * swirl) for name in ("drum", "bowl")]
    return np.sqrt(np.mean(wrong[within] ** 2)), torques[0] + 1, torques[1] - 1


def test_a_bowl_that_a_flow_fills_is_of_second_order_and_has_the_torque_of_its_stirrer(tmp_path):
    found = np.abs([stirred(tmp_path, cells) for cells in (20, 40)])
    assert np.log2(found[0, 0] / found[1, 0]) > 1.8
    assert found[1, 1:].max() < 5e-3


def test_a_square_outline_is_the_box_of_that_size(tmp_path):
    """With the lid of its box."""
    square = "objects: {pond: {outline: {points: [0 0 m, 1 0 m, 1 1 m, 0 1 m]}}}\n"
    walls = '{top: {wall: {velocity: "[1, 0]"}}, bottom: {wall: {}}, left: {wall: {}}, right: {wall: {}}}'
    more = {"boundary": walls, "viscosity": "0.01 Pa*s"}
    box = Air(tmp_path, "{sbdf2: {step: 20 ms}}", 0.4, **more).at(0.4)
    pond = Air(tmp_path, "{sbdf2: {step: 20 ms}}", 0.4, before=square, size=None, domain="pond", **more).at(0.4)
    assert pond.read("speed") == pytest.approx(box.read("speed"), abs=1e-6)


def test_a_pipe_lets_through_where_it_meets_its_box(tmp_path):
    """Poiseuille's profile in a cylinder along x whose ends are open."""
    pipe = "objects: {pipe: {cylinder: {radius: 0.25 m, height: 0.5 m, rotation: {about: z, angle: 90 deg}}}}\n"
    air = Air(
        tmp_path, "{sbdf2: {step: 10 ms}}", 0.5, before=pipe, size=None, domain="pipe", cell="1/24 m",
        viscosity="1 Pa*s", boundary="{left: {outflow: {pressure: 8 Pa}}, right: {outflow: {}}}",
    ).at(0.5)  # fmt: skip
    speed, y, z = air.read("velocity")[:, 0], *air.read("centers")[:, 1:].T
    r = np.hypot(y, z)
    wanted = np.where(r < 0.25, 16.0 * (0.25**2 - r**2) / 4.0, 0.0)
    assert np.abs(speed - wanted)[r < 0.2].max() < 0.02 * wanted.max()


@pytest.mark.parametrize(
    ("before", "fields", "text"),
    [
        ("objects: {bowl: {plane: {}}}\n", {}, "cannot be the domain"),
        ("objects: {bowl: {sphere: {radius: 1 m, position: [1 m/s*time, 0 m, 0 m]}}}\n", {}, "and moves"),
        ("objects: {bowl: {sphere: {radius: 1 m}}}\n", {"size": "1 1 m"}, "one of `domain` and `size`"),
        ("objects: {bowl: {sphere: {radius: 1 mm}}}\n", {}, "no two cells"),
        ("objects: {bowl: {sphere: {radius: 1 m}}}\n", {"corner": "1 1 1 m"}, "has no `corner`"),
        ("", {"size": "1 1 m", "domain": None, "flat": "yes"}, "a box is flat where it has two sides"),
    ],
)
def test_what_cannot_be_filled_is_told(tmp_path, before, fields, text):
    with pytest.raises(ScriptError, match=text):
        Air(tmp_path, before=before, **{"size": None, "domain": "bowl", **fields})


def test_a_field_in_the_box_of_such_a_flow_is_carried_inside_and_told_its_numbers(tmp_path):
    bowl = "objects: {bowl: {sphere: {radius: 0.5 m, position: 0.5 0.5 0 m}}}\n"
    dye = '  dye: {diffusion: {BOX, of: number, coefficient: 0.01 m^2/s, initial: "1 + x", drift: {by: air}}}\n'
    more = {"size": None, "domain": "bowl", "flat": "yes", "cell": "0.05 m", "before": bowl}
    with pytest.raises(ScriptError, match=r"size: 1.1 1.1 m`, `corner: -0.05 -0.05 m`"):
        Air(tmp_path, models=dye.replace("BOX", "size: 1 1 m, cell: 0.05 m"), **more)
    box = "size: 1.1 1.1 m, corner: -0.05 -0.05 m, cell: 0.05 m"
    air = Air(tmp_path, models=dye.replace("BOX", box), initial='{velocity: "[-y, x]"}', **more).at(0.0)
    mass = air.read("mass", "dye")
    assert mass == pytest.approx(1.5 * np.pi * 0.25, rel=0.02)  # small cells count as larger ones
    assert air.at(0.1).read("mass", "dye") == pytest.approx(mass, rel=1e-12)


RING = (
    "objects:\n  outer: {sphere: {position: 0 0 0 m, radius: 1.625 m}}\n"
    "  inner: {sphere: {position: 0 0 0 m, radius: 0.625 m}}\n  ring: {difference: {of: [outer, inner]}}\n"
)


def between_cylinders(folder, cell, **more):
    """Warm within, cold without, Ra 1e4 by the gap of a meter, Pr 0.7: a field of the flow's own domain."""
    said = 'of: temperature, coefficient: 1 m^2/s, initial: "0.5", drift: {by: air}, domain: ring, flat: yes'
    held = '{warm: {where: "1 - x^2 - y^2", value: 1}, rest: {value: 0}}'
    heat = f"  heat: {{diffusion: {{{said}, cell: {cell} m, boundary: {held}}}}}\n"
    lift = "{by: heat.temperature, expansion: 7000 1/K, reference: 0.5 K, gravity: 0 -1 0 m/s^2}"
    fields = {"size": None, "domain": "ring", "flat": "yes", "cell": f"{cell} m", "viscosity": "0.7 Pa*s", **more}
    return Air(folder, "{ark3: {}}", 0.3, before=RING, models=heat, advection="central", buoyancy=lift, **fields)


def test_warm_fluid_between_cylinders_carries_as_much_heat_as_is_published(tmp_path):
    """2.010 times what conduction does (Kuehn & Goldstein 1976, J. Fluid Mech. 74, 695-719); with cells of 5 cm
    2.0075 (tests/bench/bench_flow.py annulus)."""
    air = between_cylinders(tmp_path, 0.1).at(0.3)
    assert air.read("divergence") < 1e-6
    field, places = air.read("temperature", "heat"), air.read("centers", "heat")
    assert field.min() > -1e-3
    assert field.max() < 1.001
    known = {(round(x * 1e3), round(y * 1e3)): c for (x, y, _), c in zip(places, field, strict=True)}
    centers = air.read("centers")
    warm = np.array([known.get((round(x * 1e3), round(y * 1e3)), 0.0) for x, y, _ in centers])
    square = np.maximum((centers**2).sum(axis=1), 0.1)
    carried = ((air.read("velocity") * centers).sum(axis=1) * warm / square).sum() * 0.1**2
    assert 1.0 + carried / (2.0 * np.pi) == pytest.approx(2.010, rel=0.05)


def test_a_field_that_ends_at_its_own_skin_is_told_of_ways_through(tmp_path):
    with pytest.raises(ScriptError, match="ends at the skin of its domain, and the flow has ways through"):
        between_cylinders(tmp_path, 0.1, boundary='{left: {inflow: {velocity: "[1, 0]"}}, right: {outflow: {}}}')


@pytest.mark.parametrize(("step", "told"), [("0.75 ms", False), ("1 ms", True)])
def test_the_step_of_an_outline_is_that_of_a_flat_flow(tmp_path, step, told):
    path = tmp_path / "scene.yaml"
    path.write_text(
        "clock: {end: 0.01 s}\nobjects: {pool: {outline: {points: [0 0 m, 1 0 m, 1 1 m, 0 1 m]}}}\n"
        "models: {air: {flow: {domain: pool, cell: 5 cm, density: 1 kg/m^3, viscosity: 1 Pa*s}}}\n"
        f"solvers: {{main: {{rk4: {{step: {step}}}}}}}\noutputs: {{t: {{record: {{of: [air.largest_speed]}}}}}}\n",
        encoding="utf-8",
    )
    codes = [warning.code for warning in load(path).warnings]
    assert ("unstable-step" in codes) is told
