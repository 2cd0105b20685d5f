"""Contacts of skins in flows: with objects, masses, rigid bodies, one another and themselves."""

import numpy as np
import pytest

from sceneql.march.driver import limit
from sceneql.pipeline import load
from sceneql.quantities.diagnostic import ScriptError
from sceneql.run.run import IslandRun

JET = '{stream_function: "-0.3*sin(pi*x)*sin(pi*y)^2"}'
"""Down the middle of a box 2 m by 1 m."""
LAW = "law: {springs: {stretch: 2 N/m}}, prestress: 0.4 N/m"


class Scene:
    """Skins in a flow with contacts, on its way."""

    def __init__(self, folder, skins, contact, objects="", models="", end=0.5, **flow):
        flow = {"size": "2 1 m", "cell": "1/20 m", "density": "1 kg/m^3", "viscosity": "4e-3 Pa*s", **flow}
        fields = ", ".join(f"{key}: {value}" for key, value in flow.items())
        skin = "".join(f"  {name}: {{membrane: {{of: {name}_, {LAW}}}}}\n" for name in skins)
        shapes = "".join(f"  {name}_: {{implicit: {{bounds: {{ball: 1}}, {one}}}}}\n" for name, one in skins.items())
        (folder / "scene.yaml").write_text(
            f"clock: {{end: {end} s, fps: 10}}\n"
            f"models:\n  water: {{flow: {{{fields}}}}}\n{skin}{models}"
            f"forces: [{{immersion: {{on: [{', '.join(skins)}], in: water}}}}]\n"
            + (f"contacts: {{touch: {{collision: {contact}}}}}\n" if contact else "")
            + f"objects:\n{shapes}{objects}"
            "solvers: {main: {ark3: {tolerance: 1e-3}}}\n",
            encoding="utf-8",
        )
        graph = load(folder / "scene.yaml", pruned=False)
        self.tasks, self.run, self.axes = graph.tasks, IslandRun(graph, graph.islands[0]), len(flow["size"].split()) - 1
        self.system = self.run.march.system
        self.run.advance(0.0)

    def read(self, name, output):
        return self.tasks[name].kind.read(output, self.run.state(name))

    def skins(self, y, floats):
        """The places (n, 3) in y, and the forces (n, 3) in the floats, of each skin, as views."""
        made = [task.kind.made.membrane for task in self.tasks.values() if getattr(task.kind, "carried", False)]
        places = [y[one.position_at :][: 3 * one.count].reshape(-1, 3) for one in made]
        return places, [floats[one.force_at :][: 3 * one.count].reshape(-1, 3) for one in made]

    def changed(self, change, time=0.0):
        """The state with the places (n, 3) of each skin changed: state, rate, floats."""
        y, floats, rate = self.run.state("water").y.copy(), self.run.march.floats.copy(), np.zeros(len(self.system.y))
        for places in self.skins(y, floats)[0]:
            places[:, : self.axes] += change(places[:, : self.axes])
        self.run.march.driver.rate(time, y, rate, floats, self.system.ints)
        return y, rate, floats


def shaken(size, seed=2):
    """Places changed at random [m]."""
    rng = np.random.default_rng(seed)
    return lambda places: size * rng.standard_normal(places.shape)


def ellipse(a, b, at, deep=False):
    third = f" + (z/{b})^2" if deep else ""
    return f'position: {at}{"" if deep else " 0"} m, field: "(x/{a})^2 + (y/{b})^2{third} - 1"'


BALL = "  ball: {sphere: {radius: 0.2 m, position: 1.1 0.25 0 m}}\n"
BESIDE = {"egg": ellipse(0.3, 0.15, "1 0.7"), "other": ellipse(0.2, 0.15, "1.05 0.38")}
DEEP = {"egg": ellipse(0.3, 0.2, "0.5 0.75 0.5", True), "other": ellipse(0.3, 0.2, "0.55 0.32 0.5", True)}
ROOM = {"size": "1 1 1 m", "cell": "1/12 m"}


def test_a_skin_that_a_flow_throws_on_a_ball_stays_out_of_it(tmp_path):
    skins = {"egg": ellipse(0.3, 0.15, "1 0.7")}
    scene = Scene(tmp_path, skins, "{between: [egg, ball], friction: 0.4}", BALL, initial=JET, end=0.6)
    nearest = np.inf
    for time in np.arange(0.1, 0.61, 0.1):
        scene.run.advance(time)
        nearest = min(nearest, np.hypot(*(scene.read("egg", "positions") - (1.1, 0.25, 0.0))[:, :2].T).min())
    assert 0.2 < nearest < 0.2 + 0.05  # it came within the gap, a cell, and never in


def test_a_skin_touches_what_its_flow_goes_around(tmp_path):
    skins = {"egg": ellipse(0.3, 0.15, "1 0.7")}
    found = []
    for cell in ("1/20 m", "1/40 m"):
        scene = Scene(tmp_path, skins, "{between: [egg, ball]}", BALL, initial=JET, around="[ball]", cell=cell)
        scene.run.advance(0.5)
        assert np.hypot(*(scene.read("egg", "positions") - (1.1, 0.25, 0.0))[:, :2].T).min() > 0.2
        found.append(scene.read("egg", "volume_correction"))
    assert found[1] < 0.6 * found[0] < 1e-3  # of order 1 beside cut cells


@pytest.mark.parametrize(("skins", "flow"), [(BESIDE, {"initial": JET}), (DEEP, ROOM)], ids=["flat", "deep"])
@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_skins_push_one_another_with_forces_whose_sum_is_0(tmp_path, skins, flow, friction):
    scene = Scene(tmp_path, skins, f"{{between: [egg, other], friction: {friction}}}", **flow)
    y, _, floats = scene.changed(shaken(1e-3))
    places, forces = scene.skins(y, floats)
    size = sum(np.abs(one).sum() for one in forces)
    assert np.abs(forces[0].sum(axis=0)).max() > 1e-3
    assert np.abs(sum(one.sum(axis=0) for one in forces)).max() < 1e-13 * size
    if friction == 0.0:  # what rubs has the arm of the distance that is kept
        moment = sum(np.cross(at, one).sum(axis=0) for at, one in zip(places, forces, strict=True))
        assert np.abs(moment).max() < 1e-13 * size


def test_a_mass_feels_what_a_skin_feels(tmp_path):
    ball = "  ball: {mass_spring: {masses: {b: {position: 0.9 0.97 0 m, mass: 30 g}}, radius: 0.11 m}}\n"
    skins = {"egg": ellipse(0.4, 0.25, "1 0.6")}
    scene = Scene(tmp_path, skins, "{between: [egg, ball]}", "", ball, end=0.05)
    y, rate, floats = scene.changed(shaken(1e-3))
    (_,), (forces,) = scene.skins(y, floats)
    push = 0.03 * rate[scene.run.state("ball").bodies.velocity_at :][:3]
    assert np.abs(push).max() > 1e-3
    assert np.abs(forces.sum(axis=0) + push).max() < 1e-13 * np.abs(forces).sum()


def test_a_rigid_body_feels_force_and_torque_of_a_skin(tmp_path):
    brick = "  brick: {rigid: {of: box, mass: 30 g}}\n"
    box = "  box: {box: {size: 0.2 0.1 0.1 m, position: 1.2 0.91 0 m, rotation: {about: z, angle: -25 deg}}}\n"
    skins = {"egg": ellipse(0.4, 0.25, "1 0.6")}
    scene = Scene(tmp_path, skins, "{between: [egg, brick], friction: 0.5}", box, brick, end=0.05)
    scene.run.advance(0.01)  # friction holds from the end of the first step on
    y, rate, floats = scene.changed(lambda places: np.broadcast_to([2e-3, 0.0], places.shape), 0.01)
    (places,), (forces,) = scene.skins(y, floats)
    bodies, size = scene.run.state("brick").bodies, np.abs(forces).sum()
    push, turn = 0.03 * rate[bodies.velocity_at :][:3], rate[bodies.turning.momentum_at :][:3]
    assert np.abs(push).max() > 1e-3
    assert np.abs(forces.sum(axis=0) + push).max() < 1e-13 * size
    moment = np.cross(places, forces).sum(axis=0) + np.cross(y[bodies.position_at :][:3], push) + turn
    assert np.abs(moment).max() < 1e-13 * size


def test_friction_holds_a_skin_by_springs_and_slides_by_coulombs_law(tmp_path):
    plane = "  floor: {plane: {height: 0.3 m}}\n"
    skins = {"egg": ellipse(0.3, 0.15, "1 0.47")}  # 2 cm over it: within the gap
    law = "{between: [egg, floor], friction: 0.4}"
    scene, smooth = (Scene(tmp_path, skins, one, plane, end=0.05) for one in (law, "{between: [egg, floor]}"))
    scene.run.advance(1e-3)
    places = scene.read("egg", "positions")
    touching = places[:, 1] < 0.335

    def pull(other, by):
        here = scene.read("egg", "positions") - other.read("egg", "positions")
        y, _, floats = other.changed(lambda places: here[:, :2] + [by, 0.0], 1e-3)
        return other.skins(y, floats)[1][0]

    along = [pull(scene, by) - pull(smooth, by) for by in (0.0, 1e-5, 2e-5, 1.0)]
    grip = (along[1] - along[0])[touching, 0]
    assert (grip < 0.0).all()
    assert (along[2] - along[0])[touching, 0] == pytest.approx(2.0 * grip, rel=1e-9)
    assert np.abs(along[3][places[:, 1] > 0.35]).max() < 1e-12
    # Where it would be held by far more than Coulomb's law lets, it is by that, against the way.
    bare = pull(smooth, 1.0) - pull(Scene(tmp_path, skins, None, plane, end=0.05), 1.0)
    assert along[3][touching, 0] == pytest.approx(-0.4 * bare[touching, 1], rel=1e-9)


@pytest.mark.parametrize(("skins", "flow"), [(BESIDE, {}), (DEEP, ROOM)], ids=["flat", "deep"])
def test_friction_holds_a_skin_on_another_by_springs_and_slides_by_coulombs_law(tmp_path, skins, flow):
    law = "{between: [egg, other], friction: 0.4}"
    scene, smooth = (Scene(tmp_path, skins, one, end=0.05, **flow) for one in (law, "{between: [egg, other]}"))
    scene.run.advance(1e-3)
    names = [name for name, task in scene.tasks.items() if getattr(task.kind, "carried", False)]
    here, egg = [scene.read(name, "positions") for name in names], names.index("egg")

    def rub(one, by):
        """Forces (n, 3) on both skins where the first has gone along x."""
        y, floats, rate = one.run.state("water").y.copy(), one.run.march.floats.copy(), np.zeros(len(one.system.y))
        for number, places in enumerate(one.skins(y, floats)[0]):
            places[:] = here[number] + [by * (number == egg), 0.0, 0.0]
        one.run.march.driver.rate(1e-3, y, rate, floats, one.system.ints)
        return one.skins(y, floats)[1]

    def friction(by):
        both = [np.array(one) - other for one, other in zip(rub(scene, by), rub(smooth, by), strict=True)]
        assert sum(one.sum(axis=0) for one in both) == pytest.approx(np.zeros(3), abs=1e-13)
        return both[egg].sum(axis=0)

    start, near, twice = friction(0.0), friction(1e-7), friction(2e-7)
    assert near[0] - start[0] < 0.0
    assert twice[0] - start[0] == pytest.approx(2.0 * (near[0] - start[0]), rel=1e-4)
    alone = Scene(tmp_path, skins, None, end=0.05, **flow)
    normal = np.linalg.norm(np.array(rub(smooth, 0.04)[egg]) - rub(alone, 0.04)[egg], axis=1).sum()
    # It slides. What pushes a vertex is not all along one line: the normal forces are a little more.
    assert 0.25 * normal < -friction(0.04)[0] < 0.41 * normal


@pytest.mark.parametrize(("skins", "flow"), [(BESIDE, {}), (DEEP, ROOM)], ids=["flat", "deep"])
@pytest.mark.parametrize("seed", range(3))
def test_no_vertex_passes_a_skin_in_what_a_step_may_change(tmp_path, skins, flow, seed):
    scene = Scene(tmp_path, skins, "{between: [egg, other]}", **flow)
    system, keeps_apart = scene.system, limit(scene.run.march.system)
    start, changed = system.y.copy(), system.y.copy()
    for places in scene.skins(changed, system.floats)[0]:
        places[:, : scene.axes] += shaken(0.1, seed)(places[:, : scene.axes])
        places[:, 1] += 0.4 * (0.55 - places[:, 1].mean()) / 0.2  # through each other
    part = keeps_apart(0.0, start, changed, system.floats, system.ints)
    assert 0.0 < part < 1.0
    made = [scene.tasks[name].kind.made for name in skins]
    for share in np.linspace(0.0, part, 12):
        one, other = scene.skins(start + share * (changed - start), system.floats)[0]
        assert not made[0].encloses(other, one).any()
        assert not made[1].encloses(one, other).any()
    one, other = scene.skins(changed, system.floats)[0]
    assert made[0].encloses(other, one).any()


@pytest.mark.parametrize(("skins", "flow"), [(BESIDE, {}), (DEEP, ROOM)], ids=["flat", "deep"])
def test_what_is_known_of_distances_is_true_after_any_way(tmp_path, skins, flow):
    scene = Scene(tmp_path, skins, "{between: [egg, other], friction: 0.3}", **flow)
    known, scale, pushed = scene.run.march.floats.copy(), scene.run.march.system.fields.flow.spacing[0], 0
    y, rate, shift = scene.run.state("water").y.copy(), np.zeros(len(scene.system.y)), np.zeros(3)
    for step in range(40):
        shift[1] = 0.05 * scale * (1 if step < 25 else -2)  # toward one another, then apart
        for way, places in zip((-1.0, 1.0), scene.skins(y, known)[0], strict=True):
            places += way * shift
            places[:, : scene.axes] += shaken(0.01 * scale, step)(places[:, : scene.axes])
        scene.run.march.driver.rate(0.0, y, rate, known, scene.system.ints)
        far, unknown = y.copy(), known.copy()
        for places in scene.skins(far, unknown)[0]:
            places += shaken(1e7)(places)  # so far that nothing is known any more
        scene.run.march.driver.rate(0.0, far, rate, unknown, scene.system.ints)
        scene.run.march.driver.rate(0.0, y, rate, unknown, scene.system.ints)
        for forces, exact in zip(scene.skins(y, known)[1], scene.skins(y, unknown)[1], strict=True):
            assert (forces == exact).all()
        pushed += abs(scene.skins(y, known)[1][0].sum(axis=0)[1]) > 1e-3
    assert 5 < pushed < 40  # they touched, and not all the time


def test_a_skin_touches_itself_but_not_what_was_near_from_the_start(tmp_path):
    bone = {"egg": 'position: 1 0.5 0 m, field: "y^2 + 0.1*(x/0.4)^4 - (0.06 + 1.2*x^2)^2"'}
    both = Scene(tmp_path, bone, "{}", cell="1/40 m"), Scene(tmp_path, bone, None, cell="1/40 m")

    def pushed(squeezed):
        found = []
        for scene in both:
            y, _, floats = scene.changed(lambda places: (squeezed - 1.0) * (places - 0.5) * [0.0, 1.0])
            (places,), (forces,) = scene.skins(y, floats)
            found.append(forces)
        return places, found[0] - found[1]

    assert np.abs(pushed(1.0)[1]).max() == 0.0
    places, apart = pushed(0.15)
    waist = np.abs(places[:, 0] - 1.0) < 0.02
    assert (apart[waist, 1] * (places[waist, 1] - 0.5) > 0.0).all()
    assert np.abs(apart.sum(axis=0)).max() < 1e-12 * np.abs(apart).sum()


@pytest.mark.parametrize(
    ("skins", "contact", "objects", "told"),
    [
        ({**BESIDE, "other": ellipse(0.2, 0.15, "1.05 0.5")}, "{}", "", "'other' crosses 'egg' at the start"),
        ({**BESIDE, "other": ellipse(0.3, 0.15, "1 0.4")}, "{}", "", "'other' touches 'egg' at the start"),
        (BESIDE, "{between: [egg, other, ball]}", BALL, "'other' starts inside 'ball'"),
        (BESIDE, "{mode: exact}", "", "which has no mass of its own: it has no impacts"),
        (BESIDE, "{restitution: 0.5}", "", "a skin in a flow, which has no restitution"),
        (BESIDE, "{rolling: 1 mm}", "", "a skin in a flow, which has no rolling"),
    ],
    ids=["cross", "touch", "inside", "exact", "restitution", "rolling"],
)
def test_what_skins_cannot_is_told(tmp_path, skins, contact, objects, told):
    with pytest.raises(ScriptError) as found:
        Scene(tmp_path, skins, contact, objects)
    assert told in str(found.value)


def test_a_skin_may_stand_inside_another(tmp_path):
    skins = {"egg": ellipse(0.4, 0.3, "1 0.5"), "other": ellipse(0.2, 0.15, "1 0.5")}
    scene = Scene(tmp_path, skins, "{}")
    assert "within a gap of 0.05 m" in scene.tasks["touch"].kind.remark(scene.run.state("touch"))


@pytest.mark.parametrize("shift", [0.0, 2.0, -4.0])
def test_skins_touch_across_periodic_ends_as_anywhere(tmp_path, shift):
    apart = {"egg": ellipse(0.3, 0.15, "0.32 0.5"), "other": ellipse(0.3, 0.15, "1.67 0.55")}
    beside = {"egg": ellipse(0.3, 0.15, "1.32 0.5"), "other": ellipse(0.3, 0.15, "0.67 0.55")}
    found = []
    for name, skins in (("across", apart), ("within", beside)):
        (tmp_path / name).mkdir()
        contact = "{between: [egg, other], friction: 0.3, gap: 6 cm}"
        scene = Scene(tmp_path / name, skins, contact, boundary="{left: {periodic: yes}}", end=0.01)
        turn = iter((shift, 0.0))  # the first skin may stand any number of periods off
        y, _, floats = scene.changed(lambda places, turn=turn: np.array([next(turn), 0.0]) + 0.0 * places)
        push, back = scene.skins(y, floats)[1]
        changed = y.copy()
        scene.skins(changed, floats)[0][0][:, 0] += 0.08
        found.append((push.copy(), back.copy(), limit(scene.system)(0.0, y, changed, floats, scene.system.ints)))
        assert np.abs(push).max() > 0.0
        assert push.sum(axis=0) + back.sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-12)
    # The same pair half a box along, but for the order in which nearest places are found.
    for one, same in zip(*(each[:2] for each in found), strict=True):
        assert one == pytest.approx(same, abs=1e-6 * np.abs(same).max())
    assert found[0][2] == pytest.approx(found[1][2], rel=1e-6)
    assert found[0][2] < 1.0


def test_skins_that_cross_over_a_periodic_end_are_refused(tmp_path):
    skins = {"egg": ellipse(0.3, 0.15, "0.2 0.5"), "other": ellipse(0.3, 0.15, "1.8 0.55")}
    with pytest.raises(ScriptError, match="crosses"):
        Scene(tmp_path, skins, "{between: [egg, other]}", boundary="{left: {periodic: yes}}")
