"""Lists of points and numbers that stand in files: tables of text, and arrays of numpy."""

from __future__ import annotations

import numpy as np
import pytest

from sceneql import pipeline
from sceneql.compiler import number_files
from sceneql.quantities.diagnostic import ScriptError

PLACES = np.random.default_rng(5).normal(size=(40, 3))
RADII = np.linspace(0.2, 0.5, 40)


def parts(folder, fields):
    """The skeleton of a blobby with these fields."""
    script = folder / "scene.yaml"
    script.write_text(f"objects:\n  cloud: {{blobby: {{{fields}}}}}\n", encoding="utf-8")
    graph = pipeline.load(script)
    return graph.tasks["cloud"].kind


def points(folder, fields):
    return np.array(parts(folder, fields).points.fixed_list())


def refused(folder, fields):
    with pytest.raises(ScriptError) as caught:
        parts(folder, fields)
    (one,) = caught.value.diagnostics
    assert one.span is not None
    return str(one)


@pytest.mark.parametrize("mark", [",", ";", "\t", " ", " , "])
def test_a_table_of_any_separator_gives_its_numbers_to_the_last_bit(tmp_path, mark):
    lines = ["# a comment", mark.join("zyxr"), *(mark.join(map(repr, (*p[::-1].tolist(), 1.0))) for p in PLACES), ""]
    (tmp_path / "cloud.csv").write_text("\n".join(lines), encoding="utf-8")
    assert np.array_equal(points(tmp_path, "points: {file: cloud.csv, columns: x y z}"), PLACES)
    assert np.array_equal(points(tmp_path, "points: {file: cloud.csv, columns: [3, 2, 1]}"), PLACES)
    assert np.array_equal(points(tmp_path, "points: {file: cloud.csv}"), PLACES[:, ::-1])


def test_units_count_and_one_column_is_a_list_of_numbers(tmp_path):
    np.savetxt(tmp_path / "cloud.txt", np.column_stack([1e3 * PLACES, 1e2 * RADII]), fmt="%.17g")
    ours = parts(tmp_path, "points: {file: cloud.txt, unit: mm}, radius: {file: cloud.txt, columns: 4, unit: cm}")
    assert np.allclose(ours.points.fixed_list(), PLACES, rtol=1e-15, atol=0)
    assert np.allclose(ours.radius.fixed_list(), RADII, rtol=1e-15, atol=0)


def test_arrays_are_lists_too_and_objects_are_not_unpickled(tmp_path):
    np.savez(tmp_path / "cloud.npz", places=PLACES, radii=RADII)
    np.save(tmp_path / "one.npy", PLACES)
    np.savez(tmp_path / "objects.npz", places=np.array([{}], dtype=object))
    ours = parts(tmp_path, "points: {file: cloud.npz, columns: places}, radius: {file: cloud.npz, columns: radii}")
    assert np.array_equal(ours.points.fixed_list(), PLACES)
    assert np.array_equal(ours.radius.fixed_list(), RADII)
    assert np.array_equal(points(tmp_path, "points: {file: one.npy}"), PLACES)
    assert "choose one with `columns`: places, radii" in refused(tmp_path, "points: {file: cloud.npz}")
    assert "did you mean 'places'?" in refused(tmp_path, "points: {file: cloud.npz, columns: place}")
    assert "it holds no array of numbers" in refused(tmp_path, "points: {file: objects.npz}")
    (tmp_path / "broken.npz").write_bytes((tmp_path / "cloud.npz").read_bytes()[:300])
    assert "broken.npz: " in refused(tmp_path, "points: {file: broken.npz}")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1,2,3\n4,nan,6\n", "line 2, column 2: 'nan' is no finite number"),
        ("x,y,z\n\n1,2\n", "line 3 has 2 columns, but column 3 is asked for"),
        ("x,y,z\n", "it has no rows of numbers"),
        ("", "it has no rows of numbers"),
        ("1 2\n", "it has too few columns: 2, where 3 are needed"),
        ("\0\0\0", "it has too few columns: 1, where 3 are needed"),
    ],
)
def test_what_is_no_list_of_points_is_told_by_its_line(tmp_path, text, message):
    (tmp_path / "cloud.csv").write_text(text, encoding="utf-8")
    assert message in refused(tmp_path, "points: {file: cloud.csv}")


def test_files_have_limits_and_stay_in_the_folder(tmp_path, monkeypatch):
    np.savetxt(tmp_path / "cloud.csv", PLACES, delimiter=",")
    np.save(tmp_path / "cloud.npy", PLACES)
    inside = tmp_path / "scene"
    inside.mkdir()
    assert "file-outside" in refused(inside, "points: {file: ../cloud.csv}")
    monkeypatch.setattr(number_files, "MOST", 39)
    for name in ("cloud.csv", "cloud.npy"):
        assert "it has more than 39 rows" in refused(tmp_path, f"points: {{file: {name}}}")
    monkeypatch.setattr(number_files, "LARGEST", 0)
    assert "the file is larger than 0 MiB" in refused(tmp_path, "points: {file: cloud.csv}")


def test_masses_start_where_a_file_says(tmp_path):
    np.savetxt(tmp_path / "dust.csv", PLACES, delimiter=",")
    script = tmp_path / "scene.yaml"
    text = "clock: {end: 1 s}\nmodels: {dust: {particles: {positions: {file: dust.csv}}}}\n"
    script.write_text(text + "outputs: {log: {record: {of: dust.positions}}}\n", encoding="utf-8")
    pipeline.render(pipeline.load(script), folder=tmp_path)
    table = (tmp_path / "scene.csv").read_text(encoding="utf-8").splitlines()
    assert np.array_equal(np.array(table[1].split(",")[1:], dtype=float), PLACES.ravel())
