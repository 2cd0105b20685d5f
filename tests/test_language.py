"""Sections, entries and includes: from a text to a script."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from sceneql.language.script import read_script
from sceneql.quantities.diagnostic import Diagnostics, ScriptError
from sceneql.quantities.span import Source
from scripts import entries, errors, found, plain, script

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


def test_reading_a_script_imports_nothing_heavy() -> None:
    code = (
        "import sys, sceneql.language.script; print(sorted({'numpy', 'numba', 'pydantic', 'scipy'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
