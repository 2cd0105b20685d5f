"""Includes, sections and entries, templates, copies, defaults, patches: from a text to a script."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from sceneql.language.compose import compose
from sceneql.language.patch import apply_patch, parse_set
from sceneql.language.script import FAMILIES, Script, read_script
from sceneql.language.tree import Mapping, Node, Scalar, Sequence
from sceneql.quantities.diagnostic import Diagnostic, Diagnostics, ScriptError
from sceneql.quantities.span import Source


def script(
    text: str, files: dict[str, str] | None = None, *, variant: str | None = None, sets: tuple[str, ...] = ()
) -> Script:
    def read(name: str) -> Source:
        if name not in (files or {}):
            raise FileNotFoundError(2, "there is no such file")
        return Source(name, (files or {})[name])

    return read_script(Source("s.yaml", text), variant, sets, read=read)


def errors(text: str, files: dict[str, str] | None = None, **options: object) -> tuple[Diagnostic, ...]:
    with pytest.raises(ScriptError) as caught:
        script(text, files, **options)  # type: ignore[arg-type]
    return caught.value.diagnostics


def found(text: str, files: dict[str, str] | None = None, **options: object) -> list[tuple[str, str]]:
    return [(d.code, str(d.span)) for d in errors(text, files, **options)]


def plain(node: Node | None) -> object:
    if isinstance(node, Mapping):
        return {key: plain(item) for key, item in node.entries.items()}
    if isinstance(node, Sequence):
        return [plain(item) for item in node.items]
    return None if node is None else node.text


def entries(script: Script) -> dict[str, object]:
    return {n: {e.word: plain(e.fields)} for section in script.sections.values() for n, e in section.items()}


# Sections and entries


def test_an_entry_has_three_forms() -> None:
    read = script(
        "objects: {a: sphere, b: {box: {size: 1 m}}, c: {plane: }}\nforces: [gravity, {drag: {k: 1}}, gravity]"
    )
    assert entries(read) == {
        "a": {"sphere": None},
        "b": {"box": {"size": "1 m"}},
        "c": {"plane": None},
        "gravity": {"gravity": None},
        "drag": {"drag": {"k": "1"}},
        "gravity.2": {"gravity": None},
    }
    entry = read.sections["objects"]["b"]
    assert (entry.span.text, entry.word_span.text, entry.scope) == ("b", "box", None)


def test_a_part_without_name_gets_one_that_is_free() -> None:
    read = script("forces: [gravity]\nobjects: {gravity: sphere}\ndefine: {gravity.2: 1}")
    assert list(read.sections["forces"]) == ["gravity.3"]


@pytest.mark.parametrize(
    "entry", ["3", "[a]", "", "{}", "{a: 1, b: 2}", "true", "{repeat: {count: 1}}", "{repeat: {count: 2}, a: 1, b: 2}"]
)
def test_an_entry_of_another_shape_is_an_error(entry: str) -> None:
    (one,) = errors(f"objects: {{x: {entry}}}")
    assert one.code == "entry-shape"
    assert one.span is not None
    assert one.span.line == 1
    assert one.help


def test_settings_stay_nodes_and_unknown_sections_are_named() -> None:
    read = script("sceneql: 1\nabout: x\nclock: {end: 1 s}\nobjects:")
    assert {key: plain(node) for key, node in read.settings.items()} == {
        "sceneql": "1",
        "about": "x",
        "clock": {"end": "1 s"},
    }
    (one,) = errors("object: {a: sphere}")
    assert (one.code, one.help) == ("unknown-section", "did you mean 'objects'?")


def test_all_errors_come_in_one_run() -> None:
    text = "sceneql: 7\nobject: 1\nobjects: {a: 3, b.c: box}\nmodels: {a: spring}\nvariants: {v: {defin.k: 1}}\n"
    assert [code for code, _ in found(text, sets=("nowhere.x=1",))] == [
        "unknown-path",
        "version",
        "unknown-section",
        "entry-shape",
        "part-name",
        "duplicate-name",
        "unknown-path",
    ]


def test_names_are_shared_by_all_parts() -> None:
    (one,) = errors("define: {k: 1}\nobjects: {k: sphere}")
    assert (one.code, str(one.span), str(one.notes[0].span)) == ("duplicate-name", "s.yaml:2:11", "s.yaml:1:10")


def test_errors_can_be_collected_beside_what_is_right() -> None:
    collected = Diagnostics()
    read = read_script(Source("s.yaml", "objects: {a: 3, b: sphere}"), found=collected)
    assert list(read.sections["objects"]) == ["b"]
    assert [d.code for d in collected.errors] == ["entry-shape"]


# Includes


def test_an_include_adds_to_the_sections() -> None:
    files = {
        "parts/a.yaml": "objects: {b: box}\nclock: {end: 9 s}\ninclude: b.yaml",
        "parts/b.yaml": "forces: [gravity]",
    }
    read = script("include: [parts/a.yaml]\nobjects: {a: sphere}\nforces: {g: gravity}\nclock: {end: 1 s}", files)
    assert list(entries(read)) == ["a", "b", "g", "gravity"]
    assert plain(read.settings["clock"]) == {"end": "1 s"}
    assert read.sections["objects"]["b"].span.source.name == "parts/a.yaml"
    assert len(read.sources) == 3


def test_a_script_included_twice_is_read_once() -> None:
    files = {"a.yaml": "include: c.yaml", "b.yaml": "include: c.yaml", "c.yaml": "objects: {a: sphere}"}
    assert list(entries(script("include: [a.yaml, b.yaml]", files))) == ["a"]


@pytest.mark.parametrize("section", ["objects: {a: box}", "define: {a: 1}", "templates: {a: {}}", "variants: {a: }"])
def test_a_name_in_two_scripts_is_an_error_at_both(section: str) -> None:
    (one,) = errors(f"include: a.yaml\n{section}", {"a.yaml": section})
    assert one.code == "duplicate-name"
    assert {str(one.span).split(":")[0], str(one.notes[0].span).split(":")[0]} == {"a.yaml", "s.yaml"}


@pytest.mark.parametrize(
    "path", ["/etc/passwd", "../a.yaml", "a/../../b.yaml", "..", "C:\\a.yaml", "a\\b.yaml", '"\\0"']
)
def test_an_include_stays_in_the_folder(path: str) -> None:
    assert found(f"include: [{path}]") == [("include-outside", "s.yaml:1:11")]


def test_include_faults_are_located() -> None:
    files = {"a.yaml": "include: b.yaml", "b.yaml": "include: a.yaml", "bad.yaml": "define: {a: [0, 1] m}"}
    assert found("include: [a.yaml, none.yaml, bad.yaml, [1]]", files) == [
        ("include-cycle", "b.yaml:1:10"),
        ("unit-after-bracket", "bad.yaml:1:20"),
        ("include-missing", "s.yaml:1:19"),
        ("section-shape", "s.yaml:1:40"),
    ]
    assert found("include: s.yaml", {"s.yaml": "include: s.yaml"}) == [("include-cycle", "s.yaml:1:10")]


def test_files_are_read_below_the_folder_only(tmp_path: Path) -> None:
    scene = tmp_path / "scene"
    (scene / "sub").mkdir(parents=True)
    (tmp_path / "secret.yaml").write_text("objects: {secret: sphere}")
    (scene / "sub" / "part.yaml").write_text("objects: {part: sphere}")
    (scene / "link.yaml").symlink_to(tmp_path / "secret.yaml")
    (scene / "inner.yaml").symlink_to(scene / "sub" / "part.yaml")
    (scene / "null.yaml").symlink_to(os.devnull)
    os.mkfifo(scene / "fifo.yaml")
    main = scene / "main.yaml"
    main.write_text("include: inner.yaml\nobjects: {a: sphere}")
    read = read_script(main)
    assert (list(read.sections["objects"]), read.name) == (["a", "part"], "main")
    main.write_text("include: [link.yaml, null.yaml, sub, fifo.yaml, none.yaml]")
    with pytest.raises(ScriptError) as caught:
        read_script(main)
    assert [d.code for d in caught.value.diagnostics] == ["include-outside"] * 2 + ["include-missing"] * 3
    with pytest.raises(ScriptError) as caught:
        read_script(scene / "none.yaml")
    assert [d.code for d in caught.value.diagnostics] == ["script-missing"]


# Templates, parts, copies, defaults

STREET = """
define: {n: 3}
templates:
  lamp:
    fields: {at: , height: 2 m, top: 2*height}
    gives: {lit: bulb.on}
    objects:
      pole: {cylinder: {position: at, height: height}}
      bulb: {sphere: {position: pole.top}}
    lights: [point]
    parts: {foot: {base: {wide: at}}}
  base: {fields: {wide: 1 m}, objects: {plate: {box: {size: wide}}}}
parts:
  one: {lamp: {at: 0 0 0 m}}
  row: {repeat: {count: n, as: i}, lamp: {at: "[i, 0, 0]"}}
objects:
  dust: {repeat: {count: 2}, sphere: {radius: i}}
"""


def test_an_instance_adds_its_entries_under_its_name() -> None:
    read = script(STREET)
    instances = ["one", "row.0", "row.1", "row.2"]
    assert set(read.sections["objects"]) == {
        "dust.0", "dust.1", *(f"{name}.{part}" for name in instances for part in ("pole", "bulb", "foot.plate"))
    }  # fmt: skip
    assert list(read.sections["lights"]) == [f"{name}.point" for name in instances]
    assert read.groups["dust"] == ["dust.0", "dust.1"]
    assert read.groups["row.1"] == ["row.1.pole", "row.1.bulb", "row.1.point", "row.1.foot.plate"]
    assert len(read.groups["row"]) == 12


def test_names_inside_an_instance_are_looked_up_inside_first() -> None:
    read = script(STREET)
    scope = read.sections["objects"]["row.1.bulb"].scope
    assert scope is not None
    resolved = [scope.resolve(name) for name in ("pole", "foot.plate", "lit", "one", "dust")]
    assert resolved == ["row.1.pole", "row.1.foot.plate", "row.1.lit", "one", "dust"]
    inner = read.sections["objects"]["row.1.foot.plate"].scope
    assert inner is not None
    assert inner.resolve("bulb") == "row.1.bulb"
    assert (plain(read.gives["row.2.lit"].node), read.gives["row.2.lit"].scope.resolve("bulb")) == (
        "bulb.on",
        "row.2.bulb",
    )


def field(read: Script, part: str, name: str) -> list[str]:
    """What a name means inside a part, followed outward through the fields to the last text."""
    entry = next(section[part] for section in read.sections.values() if part in section)
    scope, texts = entry.scope, []
    while scope is not None:
        if name in scope.fields:
            node = scope.fields[name]
            assert isinstance(node, Scalar)
            name = node.text.split("*")[-1].split(",")[0].strip("[")
            texts.append(node.text)
        scope = scope.outer
    return texts


def test_a_field_is_read_outside_its_instance() -> None:
    read = script(STREET)
    assert field(read, "row.2.pole", "at") == ["[i, 0, 0]", "2"]
    assert field(read, "row.2.foot.plate", "wide") == ["at", "[i, 0, 0]", "2"]
    assert field(read, "one.pole", "top") == ["2*height", "2 m"]
    assert field(read, "dust.1", "i") == ["1"]


def test_template_faults_are_located() -> None:
    text = """templates:
  leg: {fields: {at: , n: 1}, object: {}, objects: {n: box}}
  self: {parts: {x: self}}
  odd: 3
parts:
  a: leg
  b: {leg: {at: 1, m: 2}}
  c: lag
  d: self
  e: {leg: 3}
"""
    assert found(text) == [
        ("unknown-section", "s.yaml:2:31"),
        ("duplicate-name", "s.yaml:2:53"),
        ("template-cycle", "s.yaml:3:21"),
        ("section-shape", "s.yaml:4:8"),
        ("missing-field", "s.yaml:6:6"),
        ("unknown-field", "s.yaml:7:20"),
        ("unknown-template", "s.yaml:8:6"),
        ("entry-shape", "s.yaml:10:12"),
    ]


@pytest.mark.parametrize(
    ("repeat", "code"),
    [
        ("{count: 20000}", "limit-refused"),
        ("{count: -1}", "repeat-count"),
        ("{count: 1.5}", "repeat-count"),
        ("{count: n}", "repeat-count"),
        ("{count: 99999999999999999999}", "limit-refused"),
        ("{}", "repeat-shape"),
        ("3", "repeat-shape"),
        ("{count: 3, as: 2}", "repeat-shape"),
        ("{count: 3, of: x}", "repeat-shape"),
    ],
)
def test_repeat_faults_are_located(repeat: str, code: str) -> None:
    assert found(f"objects: {{a: {{repeat: {repeat}, sphere: {{}}}}}}\ndefine: {{n: n}}")[0][0] == code


def test_copies_of_copies_are_refused_at_once() -> None:
    text = "templates:\n  t0: {objects: [sphere]}\n"
    text += "".join(f"  t{n}: {{parts: {{a: {{repeat: {{count: 9999}}, t{n - 1}: {{}}}}}}}}\n" for n in range(1, 70))
    assert found(text + "parts: {a: t3}")[0][0] == "too-many-parts"
    assert found(text.replace("9999", "1") + "parts: {a: t69}")[0][0] == "too-deep"


def test_defaults_fill_fields_that_are_not_given() -> None:
    read = script(
        "defaults: {sphere: {radius: 1 m, color: red}}\nobjects: {a: sphere, b: {sphere: {radius: 2 m}}, c: box}"
    )
    assert entries(read) == {
        "a": {"sphere": {"radius": "1 m", "color": "red"}},
        "b": {"sphere": {"radius": "2 m", "color": "red"}},
        "c": {"box": None},
    }
    assert found("defaults: {sphere: 3}") == [("section-shape", "s.yaml:1:20")]


# Variants and --set

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


def test_reading_a_script_imports_nothing_heavy() -> None:
    code = (
        "import sys, sceneql.language.script; print(sorted({'numpy', 'numba', 'pydantic', 'scipy'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
