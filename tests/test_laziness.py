"""What a scene does not need is not imported, run or drawn: seen through sys.modules of fresh processes."""

import json
import subprocess
import sys
from importlib.metadata import packages_distributions

import pytest

from sceneql import pipeline
from sceneql.compiler.catalogue import Catalogue

BALL = "objects:\n  ball: {sphere: {radius: 0.2 m, position: 0 1 0 m}}\n"
STILL = BALL + "outputs: {still: {image: {size: 32 18, time: 0 s}}}\n"
FALL = """
models:
  fall: {particles: {list: {stone: {position: 0 1 0 m}}}}
  unseen: {particles: {list: {stone: {position: 0 2 0 m}}}}
forces: [gravity]
solvers: {main: {rk4: {step: 10 ms}}, spare: {euler: {step: 1 ms, on: [unseen]}}}
clock: {end: 1 s}
objects:
  ball: {sphere: {radius: 0.1 m, position: fall.stone.position}}
  ghost: {sphere: {hidden: yes}}
outputs: {data: {record: {of: [fall.stone.position, ball.radius], every: 0.1 s}}}
"""


def modules_after(tmp_path, script, *command):
    """Names in sys.modules after a command on a script, in a process of its own."""
    scene = tmp_path / "scene.yaml"
    scene.write_text(script)
    code = (
        "import json, sys\nfrom sceneql import cli\n"
        f"sys.argv = ['sceneql', {command[0]!r}, {str(scene)!r}, *{list(command[1:])!r}]\n"
        "try: cli.main()\nexcept SystemExit as end: assert not end.code, end.code\n"
        "print(json.dumps(sorted(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True)
    return set(json.loads(done.stdout.splitlines()[-1]))


def test_check_imports_neither_numpy_nor_numba(tmp_path):
    names = modules_after(tmp_path, FALL, "check")
    assert not names & {"numpy", "numba", "scipy", "trimesh", "imageio", "av", "matplotlib", "rich", "PIL"}
    assert "importlib.metadata" not in names  # an eighth of the time that a check takes


def test_check_compares_starting_places_of_formulas_without_numba(tmp_path):
    script = (
        "objects: {floor: plane, blob: {implicit: {field: x^4 + y^4 + z^4 - 0.1, position: 0 0.9 0 m}}}\n"
        "models: {fall: {rigid: {of: blob, mass: 1 kg}}}\nforces: [gravity]\ncontacts: [collision]\n"
    )
    names = modules_after(tmp_path, script, "check")
    assert "sceneql.field.tape.plain_values" in names
    assert not names & {"numba", "scipy"}


def test_check_imports_three_libraries_and_what_these_import(tmp_path):
    theirs = {"annotated_types", "pydantic_core", "typing_extensions", "typing_inspection"}
    installed = {name for name in packages_distributions() if not name.startswith("_")} - {"sceneql", "renderers"}
    tops = {name.partition(".")[0] for name in modules_after(tmp_path, FALL, "check")}
    assert tops & installed <= {"click", "pydantic", "yaml"} | theirs


def test_check_imports_nothing_that_only_runs_need(tmp_path):
    looks = (
        "materials: {paint: {glossy: {color: tomato}}}\nlights: [studio]\ncameras: {front: perspective}\n"
        + "contacts: [collision]\n"  # else where the floor lies is looked at
        + FALL.replace("objects:\n", "objects:\n  floor: plane\n")
    )
    names = modules_after(tmp_path, looks, "check")
    assert "sceneql.words.materials.glossy" in names
    assert not names & {"sceneql.frame", "sceneql.system", "sceneql.compiled.kernels", "sceneql.run.run"}


def kinds_of_schema(schema):
    """The types of all parts of a pydantic core schema."""
    if isinstance(schema, list | tuple):
        return set().union(*map(kinds_of_schema, schema))
    if not isinstance(schema, dict):
        return set()
    return {str(schema.get("type"))}.union(*map(kinds_of_schema, schema.values()))


def test_no_word_looks_inside_what_the_compiler_has_checked():
    """A schema of values with their trees and places takes ten times as long to build as that of the word."""
    catalogue = Catalogue()
    for family in catalogue.families:
        for word in catalogue.words(family):
            cls = catalogue.load(family, word)
            cls.model_rebuild()
            assert "dataclass" not in kinds_of_schema(cls.__pydantic_core_schema__), word  # trees and places are


def test_a_picture_without_physics_imports_no_solver_no_mesh_and_no_video(tmp_path):
    names = modules_after(tmp_path, STILL, "render")
    assert (tmp_path / "scene.png").is_file()
    assert not names & {"trimesh", "av", "imageio", "matplotlib"}  # numba itself asks for scipy
    assert not [name for name in names if name.startswith(("sceneql.words.solvers.", "sceneql.march.march"))]


def test_a_picture_without_implicit_objects_compiles_nothing_that_finds_them(tmp_path):
    names = modules_after(tmp_path, STILL, "render")
    assert "renderers.tracing.solids.intersect_kernels" in names
    assert not names & {"renderers.tracing.solids.implicit_kernels", "sceneql.field.enclose.enclosure_kernels"}
    assert not names & {"renderers.tracing.mist", "renderers.tracing.light.mist_light_kernels"}
    blob = STILL.replace("objects:\n", "objects:\n  drop: {blobby: {skeleton: [{point: 0 1 0 m, radius: 1 m}]}}\n")
    names = modules_after(tmp_path, blob, "render")
    assert "renderers.tracing.solids.implicit_kernels" in names
    assert "renderers.tracing.solids.sheet_kernels" not in names


def test_only_the_words_that_are_needed_are_loaded(tmp_path):
    names = modules_after(tmp_path, FALL, "render")
    assert "sceneql.stepping.runge_kutta_kernels" in names
    assert not [name for name in names if name.startswith("renderers.")]
    assert not {n for n in names if n.startswith("sceneql.words.contacts.")}


def test_contacts_of_bodies_that_nothing_ties_compile_nothing_of_ties(tmp_path):
    script = """
clock: {end: 0.1 s}
objects: {crate: {box: {position: 0 0.6 0 m}}, floor: plane}
models: {load: {rigid: {of: crate}}}
TIES
forces: [gravity]
contacts: {touch: {collision: {mode: local}}}
solvers: {main: {semi_implicit_euler: {step: 5 ms}}}
outputs: {data: {record: {of: [load.energy]}}}
"""
    ties = {f"sceneql.bodies.rigid.ties.{name}_kernels" for name in ("tied_step", "tied_rows", "tie")}
    ties.add("sceneql.linear.cones.bounded_rows_kernels")
    assert not modules_after(tmp_path, script.replace("TIES", ""), "render") & ties
    hung = "ties: {arm: {hinge: {between: [load, world], at: 1 0.6 0 m, axis: 0 0 1, friction: 1 N*m}}}"
    assert modules_after(tmp_path, script.replace("TIES", hung), "render") >= ties


def test_a_ball_on_a_plane_compiles_nothing_of_edges_and_faces_nor_what_it_does_not_ask_for(tmp_path):
    script = """
clock: {end: 0.5 s}
objects: {floor: plane, ball: {sphere: {radius: 0.5 m, position: 0 0.6 0 m}}OTHER}
models: {load: {rigid: {of: ball}}MORE}
forces: [gravity]
contacts: {touch: {collision: {mode: local}}}
outputs: {data: {record: {of: [load.energy]}}}
"""
    distances = {f"sceneql.contacts.distance.{name}_kernels" for name in ("separation", "axes", "overlay")}
    unasked = {"sceneql.bodies.rigid.free_rotation_kernels", "sceneql.contacts.distance.rolling_kernels"}
    other = script.replace("OTHER", ", other: {box: {position: 1.0002 0.6 0 m}}")
    names = modules_after(tmp_path, other.replace("MORE", ", more: {rigid: {of: other}}"), "render")
    assert names >= distances
    assert not names & unasked
    alone = script.replace("OTHER", "").replace("MORE", "")
    assert not modules_after(tmp_path, alone, "render") & (distances | unasked)


def test_explain_imports_neither_renderer_nor_encoder(tmp_path):
    names = modules_after(tmp_path, FALL.replace("outputs: {", "outputs: {film: {video: {size: 32 18}}, "), "explain")
    assert not names & {"PIL", "av", "imageio", "matplotlib", "trimesh"}
    assert not [name for name in names if name.startswith("renderers.tracing")]


def test_pruned_and_unpruned_runs_give_the_same_bytes(tmp_path):
    scene = tmp_path / "scene.yaml"
    scene.write_text(FALL)
    tables = []
    for pruned in (True, False):
        graph = pipeline.load(scene, pruned=pruned)
        assert ("unseen" in graph.tasks) is not pruned
        (path,) = pipeline.render(graph, folder=tmp_path / str(pruned)).files
        tables.append(path.read_bytes())
    assert tables[0] == tables[1]
    assert tables[0].count(b"\n") == 12


def test_pruned_and_unpruned_pictures_have_the_same_bytes(tmp_path):
    scene = tmp_path / "scene.yaml"
    spare = STILL.replace("objects:\n", "objects:\n  spare: {sphere: {hidden: yes}}\n")
    scene.write_text(spare + "materials: {unused: mirror}\n")
    pictures = []
    for pruned in (True, False):
        (path,) = pipeline.render(pipeline.load(scene, pruned=pruned), folder=tmp_path / str(pruned)).files
        pictures.append(path.read_bytes())
    assert pictures[0] == pictures[1]


def test_what_is_left_out_is_listed_with_its_reason(tmp_path):
    scene = tmp_path / "scene.yaml"
    scene.write_text(FALL)
    left = {part.name: part.reason for part in pipeline.load(scene).left_out}
    assert left["ghost"].startswith("hidden")
    assert set(left) >= {"unseen", "spare", "ghost"}


def test_an_error_in_an_unused_part_is_an_error(tmp_path):
    scene = tmp_path / "scene.yaml"
    scene.write_text(FALL + "materials: {unused: {glossy: {rougness: 1}}}\n")
    with pytest.raises(Exception, match="rougness"):
        pipeline.load(scene)
