"""Flows as one writes them on a first day: a step at the inlet, a post across a channel, no object that shows them."""

import pytest

from flows import Air
from sceneql.failure import RunFailure
from sceneql.pipeline import load, shapes_of, simulate
from sceneql.quantities.diagnostic import ScriptError
from sceneql.run.extremes import watched
from sceneql.shapes.color import linear

STREAM = '{left: {inflow: {velocity: "[1, 0]"}}, right: {outflow: {}}}'
BOX = "size: 1 0.4 m, cell: 5 cm, density: 1 kg/m^3, viscosity: 0.1 Pa*s"
HEAT = (
    "diffusion: {size: 1 0.4 m, cell: 5 cm, coefficient: 1e-3 m^2/s, of: temperature, initial: 20 °C, drift: {by: air}}"
)
LED = "diffusion: {size: 1 1 m, cell: 25 cm, coefficient: 1e-3, of: number, source: lead.position.y}"
LEAD = "{motion: {position: 0 1 0 m}}"
DEEP = "size: 1 1 1 m, cell: 25 cm, density: 1 kg/m^3, viscosity: 0.1 Pa*s"
DUST = "particles: {list: {mote: {position: 0.5 0.5 0.5 m, mass: 1 mg}}}"


@pytest.mark.parametrize("shift", [-1e-4, 0.0, 1e-4])
def test_a_step_may_begin_at_the_side_that_fluid_enters_by(tmp_path, shift):
    """What flows in beside the step flows out, where the skins of both are one plane too."""
    step = f"objects:\n  step: {{box: {{size: 0.4 0.2 1 m, position: {0.2 + shift} 0.1 0 m}}}}\n"
    air = Air(tmp_path, "{auto: {}}", 0.1, before=step, size="1 0.4 m", cell="5 cm", around="[step]", boundary=STREAM)
    assert air.at(0.1).read("divergence") < 1e-9
    u = air.read("velocity")[:, 0].reshape(8, 20)
    assert u[4:, 0].mean() == pytest.approx(1.0, abs=0.05)
    assert u[:, -1].mean() == pytest.approx(0.5, abs=0.02)
    assert not u[:4, 1:7].any()


def test_what_closes_a_channel_off_is_named(tmp_path):
    post = "objects:\n  post: {cylinder: {radius: 10 cm, height: 1 m, position: 0.5 0.2 0 m}}\n"
    flow = {"size": "1 0.4 m", "cell": "5 cm", "around": "[post]"}
    with pytest.raises(ScriptError, match="'post' closes this part of it off") as told:
        Air(tmp_path, before=post, boundary=STREAM, **flow)
    assert "rotation: {about: x, angle: 90 deg}" in str(told.value)
    turned = post.replace("position", "rotation: {about: x, angle: 90 deg}, position")
    Air(tmp_path, "{auto: {}}", before=turned, boundary=STREAM, **flow)
    Air(tmp_path, "{auto: {}}", before=post, boundary=STREAM.replace("1, 0", "0, 0"), **flow)


@pytest.mark.parametrize(
    ("models", "objects", "more", "drawn"),
    [
        (f"air: {{flow: {{{BOX}}}}}", "", "", ["air_map"]),
        (f"air: {{flow: {{{BOX}}}}}, heat: {{{HEAT}}}", "", "", ["heat_map"]),
        (f"air: {{flow: {{{BOX}}}}}, heat: {{{HEAT}}}", "map: {field_map: {of: heat.temperature}}", "", ["map"]),
        (f"air: {{flow: {{{BOX}}}}}, heat: {{{HEAT}}}", "map: {field_map: {of: air.speed}}", "", ["map"]),
        (f"heat: {{{LED}}}, lead: {LEAD}", "ball: {sphere: {position: lead.position}}", "", ["ball", "heat_map"]),
        (f"air: {{flow: {{{DEEP}}}}}", "", "", ["air_streamlines"]),
        (f"air: {{flow: {{{DEEP}}}}}, dust: {{{DUST}}}", "", "wind: {in: air, linear: 1e-5 N*s/m}", ["dust"]),
    ],
    ids=[
        "a flow",
        "what it carries",
        "a map of that",
        "a map of the flow",
        "what else moves",
        "a deep flow",
        "its wind",
    ],
)
def test_one_picture_of_a_flow_and_what_it_carries(tmp_path, models, objects, more, drawn):
    """No map lies in the plane of another, nor does an opaque box hide what moves in it."""
    script = f"models: {{{models}}}\nobjects: {{{objects}}}\n"
    if more:
        script += f"forces: [{{{more}}}]\n"
    (tmp_path / "scene.yaml").write_text(script + "outputs: {still: {image: {time: 0 s}}}\n", encoding="utf-8")
    graph = load(tmp_path / "scene.yaml")
    assert sorted(set(graph.drawn["still"]) - {"floor"}) == drawn


def test_the_surface_of_a_field_is_told_the_word_that_draws_it(tmp_path):
    pond = "models: {pond: {wave: {size: 1 1 m, cell: 0.1 m, speed: 1 m/s}}}\nobjects: {water: {surface: {of: pond}}}\n"
    (tmp_path / "scene.yaml").write_text(pond, encoding="utf-8")
    graph = load(tmp_path / "scene.yaml")
    moment = next(simulate(graph, [0.0]))
    with pytest.raises(RunFailure, match=r"write `field_map: \{of: pond\.height\}`"):
        shapes_of(["water"], moment)


def test_a_field_of_two_names_is_watched_once(tmp_path):
    heat = HEAT.replace("drift: {by: air}", "boundary: {left: {value: 80}}")
    air = Air(tmp_path, "{auto: {}}", models=f"  heat: {{{heat}}}\n")
    assert len(watched(air.run)) <= 1
    (tmp_path / "scene.yaml").write_text(f"models: {{heat: {{{heat}}}}}\n", encoding="utf-8")
    graph = load(tmp_path / "scene.yaml", pruned=False)
    assert len(watched(type(air.run)(graph, graph.islands[0]))) == 1


def test_a_stream_that_is_even_but_for_rounding_has_the_range_of_the_run(tmp_path):
    pole = "objects: {pole: {sphere: {radius: 0.1 m, position: 0.4 0.2 0 m}}, map: {field_map: {of: air.speed}}}\n"
    air = f'models: {{air: {{flow: {{{BOX}, boundary: {STREAM}, initial: {{velocity: "[1 + 1e-12*x, 0]"}}}}}}}}\n'
    (tmp_path / "scene.yaml").write_text(f"clock: {{end: 0.2 s}}\n{pole}{air}", encoding="utf-8")
    graph = load(tmp_path / "scene.yaml")
    moment = next(simulate(graph, [0.0]))
    low, high = graph.tasks["map"].kind.scale(moment)
    assert high - low > 0.1


def test_a_map_without_colors_has_its_own_color(tmp_path):
    pond = "models: {pond: {wave: {size: 1 1 m, cell: 0.1 m, speed: 1 m/s}}}\n"
    water = "objects: {water: {field_map: {of: pond.height, colors: none, material: glossy, color: 0.1 0.2 0.5}}}\n"
    (tmp_path / "scene.yaml").write_text(pond + water, encoding="utf-8")
    moment = next(simulate(load(tmp_path / "scene.yaml"), [0.0]))
    (mesh,) = shapes_of(["water"], moment).shapes
    assert mesh.surface.color == pytest.approx(linear([0.1, 0.2, 0.5]))


def test_what_to_write_is_what_the_script_has(tmp_path):
    """The flow of an immersion, not its skin; a vector as formulas take it."""
    scene = tmp_path / "scene.yaml"
    scene.write_text(
        "clock: {end: 1 s}\nobjects: {ball: {sphere: {radius: 0.2 m}}}\nmodels:\n"
        f"  skin: {{membrane: {{of: ball, law: {{tension: 5 N/m}}}}}}\n  air: {{flow: {{{BOX}, velocity: 1 0 m/s}}}}\n"
        "forces: [{immersion: {on: [skin]}}]\n",
        encoding="utf-8",
    )
    with pytest.raises(ScriptError) as told:
        load(scene)
    assert "For example `in: air`" in str(told.value)
    assert "write `initial: {velocity: [1 m/s, 0 m/s]}`" in str(told.value)


def test_a_probe_reads_velocity_and_pressure_between_cells(tmp_path):
    """Flow against a wall, u = (x, -y), whose pressure is -density |x|^2/2."""
    side = '{rest: {inflow: {velocity: "[x, -y]"}}, bottom: {wall: {slip: free}}}'
    more = {"corner": "-1 0 m", "size": "2 1 m", "initial": '{velocity: "[x, -y]"}', "advection": "central"}
    probes = "{here: 0.13 0.57 m, there: -0.5 0.3 m}"
    air = Air(tmp_path, boundary=side, probes=probes, **more).at(0.1)
    assert air.read("here.velocity") == pytest.approx([0.13, -0.57, 0], abs=1e-6)
    jump = air.read("here.pressure") - air.read("there.pressure")
    assert jump == pytest.approx(-0.5 * (0.13**2 + 0.57**2 - 0.25 - 0.09), abs=2e-3)


def test_a_probe_that_cannot_be_read_is_told(tmp_path):
    for probes, text in (("{speed: 0.5 0.5 m}", "cannot be called"), ("{far: 2 0.5 m}", "stands outside of the box")):
        with pytest.raises(ScriptError, match=text):
            Air(tmp_path, probes=probes)
