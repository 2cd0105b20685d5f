"""Words of a ``--words`` folder whose fields have wrong defaults."""

import subprocess
import sys

import pytest

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
            {"OFTEN": '"300 /s^2"'},
            """\
error[unknown-name]: nothing is called 's'
  --> FILE:15:50
   |
15 |     often: FixedTime = field("How often.", "300 /s^2", above=0)
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
