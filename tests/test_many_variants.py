"""Many variants are checked in time that grows with their number, and what is wrong in many is told once."""

from __future__ import annotations

from pathlib import Path

from click.testing import CliRunner

from runs import complaint
from sceneql.cli import cli
from sceneql.compiler import names
from sceneql.language import script
from sceneql.quantities.diagnostic import Diagnostic

SCENE = """define: {{r: 1 m}}
objects: {{ball: {{sphere: {{radius: r, position: 0 1 0 m, color: tomato}}}}}}
outputs: {{film: {{image: {{}}}}}}
variants:
{variants}"""


def checked(folder: Path, variants: str) -> str:
    path = folder / "scene.yaml"
    path.write_text(SCENE.format(variants=variants))
    run = CliRunner().invoke(cli, ["check", str(path)])
    return str(run.exception or run.output)


def test_a_script_of_many_variants_is_read_twice_and_its_own_texts_are_parsed_twice(
    tmp_path: Path, monkeypatch
) -> None:  # type: ignore[no-untyped-def]
    composed, parsed = [], []
    monkeypatch.setattr(script, "compose", lambda *args, of=script.compose: composed.append(1) or of(*args))
    monkeypatch.setattr(names, "parse_value", lambda *args, of=names.parse_value: parsed.append(args[0]) or of(*args))
    assert "ok, 5 parts" in checked(tmp_path, "".join(f"  v{k}: {{define.r: {k + 1} m}}\n" for k in range(50)))
    assert len(composed) == 2
    assert parsed.count("0 1 0 m") == 2
    assert len(parsed) < 70


def test_what_is_wrong_in_many_variants_is_told_once(tmp_path: Path) -> None:
    lines = "".join(f"  v{k}: {{define.r: -{k + 1} m}}\n  u{k}: {{clock.end: {k + 1} m}}\n" for k in range(20))
    said = checked(tmp_path, lines)
    assert said.count("error[") == 2
    assert "radius must be above 0 m, not -1 m (so or alike in 20 variants)" in said
    assert "end is a time (s), but this is a length (m) (so or alike in 20 variants)" in said


def test_wrong_paths_of_many_variants_are_told_once(tmp_path: Path) -> None:
    said = checked(tmp_path, "".join(f"  v{k}: {{objects.ball.rad.x: 2}}\n" for k in range(20)))
    assert said.count("error[") == 1
    assert "(so or alike in 20 variants)" in said


def test_what_is_wrong_in_one_variant_is_told_as_it_is(tmp_path: Path) -> None:
    assert "radius must be above 0 m, not -1 m\n" in checked(tmp_path, "  v: {define.r: -1 m}\n  w: {define.r: 2 m}\n")


def test_a_long_name_is_cut_in_what_is_told(tmp_path: Path) -> None:
    long = "x" * 1_000_000
    text = f'objects: {{c: {{sphere: {{color: "{long}", material: "{long}"}}}}, d: "{long}"}}\n'
    said = complaint(tmp_path, text)
    assert said.count("error[") == 3
    assert len(said) < 5000
    assert f"'{'x' * 39}...{'x' * 19}' is no color" in said
    assert len(str(Diagnostic("invalid", "word " * 10_000, None))) < 1100


def test_a_unit_behind_a_product_is_put_behind_its_number(tmp_path: Path) -> None:
    said = complaint(tmp_path, "objects: {b: {sphere: {position: [0.2*time m/s, 0 m, 0 m]}}}\n")
    assert "write `0.2 m/s*time`" in said
