"""Words of a ``--words`` folder whose fields have wrong defaults."""

import subprocess
import sys
from pathlib import Path

import pytest

from runs import complaint
from sceneql.compiler.catalogue import Catalogue
from sceneql.quantities.diagnostic import ScriptError
from sceneql.report.manual import listing

FORCE = """\
'''A force whose defaults are wrong.'''

from sceneql.kinds import Force, Record, Scalar, FixedTime, field


class Pulse(Record):
    '''A stretch of time.'''

    length: FixedTime = field("How long — \u00e9 it lasts.", LENGTH)


class Pull(Force):
    '''It pulls.'''

    often: FixedTime = field("How often.", OFTEN, above=0)
    pulse: Pulse = field("Each of them.", Pulse())
    share: float = field("How much of it.", default=SHARE, at_most=1)
    until: FixedTime | None = field("When it ends.", UNTIL)
"""
SCENE = """\
models: {ball: {particles: {list: {a: {mass: 1 kg, position: 0 0 0 m}}}}}
forces: [{pull: {often: 1 s}}]
solvers: {main: rk4}
outputs: {data: {record: {of: [ball.a.position]}}}
"""


@pytest.mark.parametrize("command", ["check", "render"])
@pytest.mark.parametrize(
    ("given", "told"),
    [
        (
            {"OFTEN": '"300 /q^2"'},
            """\
error[unknown-name]: nothing is called 'q'
  --> FILE:15:50
   |
15 |     often: FixedTime = field("How often.", "300 /q^2", above=0)
   |                                                  ^

1 error
""",
        ),
        (
            {"OFTEN": "'3 m'", "LENGTH": '"2 kg"'},
            """\
error[dimension-mismatch]: length is a time (s), but this is a mass (kg)
 --> FILE:9:58
  |
9 |     length: FixedTime = field("How long — \u00e9 it lasts.", "2 kg")
  |                                                          ^^^^

error[dimension-mismatch]: often is a time (s), but this is a length (m)
  --> FILE:15:45
   |
15 |     often: FixedTime = field("How often.", '3 m', above=0)
   |                                             ^^^

2 errors
""",
        ),
        (
            {"OFTEN": '"0 s"', "SHARE": "1.5"},
            """\
error[out-of-range]: often must be above 0 s, not 0 s
  --> FILE:15:45
   |
15 |     often: FixedTime = field("How often.", "0 s", above=0)
   |                                             ^^^

error[out-of-range]: share must be at most 1, not 1.5
  --> FILE:17:53
   |
17 |     share: float = field("How much of it.", default=1.5, at_most=1)
   |                                                     ^^^

2 errors
""",
        ),
        (
            {"UNTIL": '"3 m"'},
            """\
error[dimension-mismatch]: until is a time (s), but this is a length (m)
  --> FILE:18:55
   |
18 |     until: FixedTime | None = field("When it ends.", "3 m")
   |                                                       ^^^

1 error
""",
        ),
    ],
)
def test_a_wrong_default_is_told_in_the_file_of_its_word(tmp_path, command, given, told):
    text = FORCE
    for name, default in ({"OFTEN": '"1 s"', "LENGTH": '"1 s"', "SHARE": "0.5", "UNTIL": '"2 s"'} | given).items():
        text = text.replace(name, default)
    path = tmp_path / "forces" / "pull.py"
    path.parent.mkdir()
    path.write_text(text, encoding="utf-8")
    (tmp_path / "scene.yaml").write_text(SCENE)
    run = [sys.executable, "-m", "sceneql", command, "scene.yaml", "--words", "."]
    said = subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, encoding="utf-8")
    assert (said.returncode, said.stdout, said.stderr) == (3, "", told.replace("FILE", str(path.resolve())))


PAIR = """\
'''A model whose defaults are tuples.'''

from sceneql.kinds import FixedLength, FixedPosition, FixedTime, Model, field


class Pair(Model):
    '''Two of them.'''

    both: tuple[FixedLength, FixedTime] = field("Length and time.", ("1 cm", SECOND))
    some: tuple[FixedLength, ...] = field("Lengths.", ("1 cm", 0.5, "3 m"), above=0)
    place: FixedPosition = field("A place.", ("1 cm", "0", "2 m"))
    names: tuple[str, ...] = field("Names.", ("a", "1 cm"))
"""


def pair(folder, second):
    path = folder / "models" / "pair.py"
    path.parent.mkdir()
    path.write_text(PAIR.replace("SECOND", second))
    return Catalogue(folder).load("models", "pair"), path


def test_texts_in_a_default_that_is_a_tuple_are_read_as_those_of_a_script(tmp_path):
    cls, _ = pair(tmp_path, '"2 min"')
    made = cls()
    assert (made.both, made.some, made.place) == ((0.01, 120.0), (0.01, 0.5, 3.0), (0.01, 0.0, 2.0))
    assert made.names == ("a", "1 cm")


def test_a_wrong_text_in_a_default_that_is_a_tuple_is_told_where_it_stands(tmp_path):
    with pytest.raises(ScriptError) as error:
        pair(tmp_path, '"2 kg"')
    assert (
        str(error.value)
        == f"""\
error[dimension-mismatch]: both is a time (s), but this is a mass (kg)
 --> {tmp_path}/models/pair.py:9:79
  |
9 |     both: tuple[FixedLength, FixedTime] = field("Length and time.", ("1 cm", "2 kg"))
  |                                                                               ^^^^"""
    )


def test_the_words_of_a_folder_are_listed_beside_one_with_a_wrong_default(tmp_path: Path) -> None:
    (tmp_path / "models").mkdir()
    for name, default in (("good", "1 m"), ("bad", "1 kg")):
        text = f"from sceneql.kinds import FixedLength, Model, field\nclass {name.title()}(Model):\n"
        text += f'    """A {name} one."""\n    size: FixedLength = field("Size.", "{default}")\n'
        (tmp_path / "models" / f"{name}.py").write_text(text)
    said = listing(Catalogue(tmp_path))
    assert "good                  A good one" in said
    assert "bad                   cannot be used, as told below" in said
    assert "size is a length (m), but this is a mass (kg)" in said


def test_a_film_of_almost_no_frames_a_second_is_refused(tmp_path: Path) -> None:
    said = complaint(tmp_path, "clock: {fps: 1e-9}\noutputs: {film: {video: {fps: 1e-4}}}\n")
    assert "fps must be at least 0.001, not 1e-09" in said
    assert "fps must be at least 0.001, not 0.0001" in said


def test_a_graph_too_small_to_draw_is_refused(tmp_path: Path) -> None:
    text = "overlays: {g: {graph: {y: time, size: 0.5 28 %}}}\noutputs: {film: {image: {}}}\n"
    assert "size must be at least 0.05, not 0.005" in complaint(tmp_path, text)
