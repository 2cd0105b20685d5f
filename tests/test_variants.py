"""Variants and `--set`: patches of a script."""

from __future__ import annotations

import pytest
from click.testing import CliRunner

from sceneql.cli import cli
from sceneql.language.compose import compose
from sceneql.language.patch import apply_patch, parse_set
from sceneql.language.script import FAMILIES
from sceneql.quantities.span import Source
from scripts import entries, errors, found, plain, script

SPRING = """
define: {k: 2 kN/m}
models: {cage: {mass_spring: {stiffness: k, masses: [1, {at: 2}]}}}
forces: [gravity, gravity]
solvers: {main: auto}
templates: {leg: {objects: {hip: {group: {angle: 1}}}}}
parts: {l: leg}
variants:
  soft: {define.k: 200 N/m, may_fail: yes}
  other: {solvers.main: {euler: {step: 1 ms}}}
"""


@pytest.mark.parametrize(
    ("option", "part", "expected"),
    [
        ("models.cage.mass_spring.stiffness=3", "cage", {"stiffness": "3", "masses": ["1", {"at": "2"}]}),
        ("models.cage.stiffness=3", "cage", {"stiffness": "3", "masses": ["1", {"at": "2"}]}),
        ("cage.stiffness=3", "cage", {"stiffness": "3", "masses": ["1", {"at": "2"}]}),
        ("cage.damping= 3 N*s/m ", "cage", {"stiffness": "k", "masses": ["1", {"at": "2"}], "damping": "3 N*s/m"}),
        ("cage.masses.1.at=[0, 1]", "cage", {"stiffness": "k", "masses": ["1", {"at": ["0", "1"]}]}),
        ("gravity.2.strength=1", "gravity.2", {"strength": "1"}),
        ("main.tolerance=1e-6", "main", {"tolerance": "1e-6"}),
        ("solvers.main={rk4: {step: 1 ms}}", "main", {"step": "1 ms"}),
        ("templates.leg.objects.hip.angle=2", "l.hip", {"angle": "2"}),
        ("objects.ball={sphere: {color: '#ff8800'}}", "ball", {"color": "#ff8800"}),
        ("cameras.top={perspective: {}}", "top", {}),
    ],
)
def test_a_patch_replaces_what_its_path_names(option: str, part: str, expected: object) -> None:
    before = script(SPRING)
    after = script(SPRING, sets=(option,))
    entry = next(section[part] for section in after.sections.values() if part in section)
    assert plain(entry.fields) == expected
    assert before.hash != after.hash
    others = {name: value for name, value in entries(after).items() if name != part}
    assert others == {name: value for name, value in entries(before).items() if name != part}


def test_a_patch_leaves_the_old_tree_as_it_was() -> None:
    root = compose(Source("s.yaml", SPRING))
    before = plain(root)
    patched = apply_patch(root, [parse_set("cage.masses.1.at=7"), parse_set("k=1")], FAMILIES)
    assert plain(root) == before
    assert plain(patched.entries["define"]) == {"k": "1"}
    assert patched.entries["solvers"] is root.entries["solvers"]


def test_a_variant_is_a_patch() -> None:
    read = script(SPRING, variant="soft")
    assert plain(read.settings["define"]) == {"k": "200 N/m"}
    assert (read.variant, read.may_fail, read.variants) == ("soft", True, ("soft", "other"))
    over = script(SPRING, variant="soft", sets=("k=1 N/m",))
    assert plain(over.settings["define"]) == {"k": "1 N/m"}
    assert len({read.hash, over.hash, script(SPRING).hash, script(SPRING, variant="other").hash}) == 4
    assert not script(SPRING, variant="other").may_fail


@pytest.mark.parametrize(
    ("option", "code", "place"),
    [
        ("cag.stiffness=3", "unknown-path", "1:1"),
        ("define.kk=3", "unknown-path", "1:8"),
        ("models.cage.wrong.x=3", "unknown-path", "1:13"),
        ("cage.masses.2=3", "unknown-path", "1:13"),
        ("cage.masses.x=3", "unknown-path", "1:13"),
        ("gravity.2.a.b=3", "unknown-path", "1:11"),
        ("models..x=3", "unknown-path", "1:8"),
        ("clock.end.x=3", "unknown-path", "1:7"),
        ("define.k", "set-shape", "1:1"),
        ("define.k=", "set-shape", "1:1"),
        ("=3", "set-shape", "1:1"),
        ("define.k=[1, 2", "yaml-syntax", "1:10"),
        ("define.k={a: max(0, 1)}", "torn-expression", "1:14"),
        ("define.k=1\x00", "control-character", "1:11"),
    ],
)
def test_faults_of_an_option_point_into_it(option: str, code: str, place: str) -> None:
    assert found(SPRING, sets=(option,)) == [(code, f"--set:{place}")]


def test_suggestions_for_paths_and_variants() -> None:
    (one,) = errors(SPRING, sets=("cag.stiffness=3",))
    assert one.help == "did you mean 'cage'?"
    (one,) = errors(SPRING, variant="sof")
    assert (one.code, one.help) == ("unknown-variant", "did you mean 'soft'?")
    (one,) = errors("objects: {a: sphere}\nmodels: {a: spring}", sets=("a.x=1",))[:1]
    assert (one.code, one.help) == ("unknown-path", "write objects.a.x or models.a.x")


def test_unused_variants_are_checked() -> None:
    assert found("objects: {a: sphere}\nvariants: {v: {objects.b.c: 1}, w: 3}") == [
        ("unknown-path", "s.yaml:2:24"),
        ("section-shape", "s.yaml:2:36"),
    ]


def test_the_hash_is_of_texts_and_patches() -> None:
    assert script(SPRING).hash == script(SPRING).hash
    assert script(SPRING).hash != script(SPRING + "# more").hash
    assert len(script(SPRING).hash) == 64


def test_errors_of_variants_are_told_beside_those_of_the_script(tmp_path) -> None:
    """The variants were looked at where the script itself was right alone."""
    script = tmp_path / "scene.yaml"
    script.write_text(
        "objects: {ball: {sphere: {radius: 0.2 m, positon: 0 2 0 m}}}\nforces: {g: gravity}\n"
        "variants: {moon: {g: 1.62 m/s^2}, big: {ball.radius: 2 kg}}\n"
    )
    run = CliRunner().invoke(cli, ["check", str(script)])
    assert [line for line in str(run.exception).splitlines() if line.startswith("error")] == [
        "error[unknown-field]: sphere has no field 'positon'",
        "error[unknown-word]: '1.62 m/s^2' is no word of forces",
        "error[dimension-mismatch]: radius is a length (m), but this is a mass (kg)",
    ]
