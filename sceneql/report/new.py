"""A first script to change, with comments and a schema for editors."""

from __future__ import annotations

import json
from pathlib import Path

from sceneql.files import refuse_unwritable, try_folder, whole

SCRIPT = """\
# yaml-language-server: $schema=./{schema}
# A first scene. Make the film:   sceneql render {name}.yaml
# See what will run and why:      sceneql explain {name}.yaml
# All words and their fields:     sceneql words, sceneql words mass_spring
sceneql: 1
about: A ball on a spring, over a floor.

define:                      # names for values; change one here or with --set define.k='90 N/m'
  k: 40 N/m

clock: {{end: 4 s, fps: 30}}

models:                      # what moves: state, and the laws inside it
  swing:
    mass_spring:
      masses:
        hook: {{position: 0 2.2 0 m, fixed: yes}}
        bob: {{position: 0.7 1.2 0 m, mass: 1 kg}}
      springs:
        - {{between: [hook, bob], rest: 1 m, stiffness: k, damping: 0.2 N*s/m}}

forces: [gravity]            # what acts on the models

objects:                     # what is drawn; a link such as swing.bob.position follows the model
  ball: {{sphere: {{radius: 0.2 m, position: swing.bob.position, color: tomato}}}}
  wire: {{coil: {{from: swing.hook.position, to: swing.bob.position, radius: 6 cm}}}}
  floor: plane

variants:                    # sceneql render {name}.yaml --variant stiff
  stiff: {{define.k: 400 N/m}}

expect:                      # numbers that must hold, and where they are known from
  energy:
    of: max(abs(relative_drift(swing.energy)))
    below: 1e-5
    because: conservation, the energy lost in the damper counted
"""


def write(name: str) -> list[Path]:
    """Write NAME.yaml and the schema beside it; refuses to overwrite the script. Raises OSError, Unsuitable."""
    from sceneql.compiler.catalogue import Catalogue
    from sceneql.report.schema import schema

    path = Path(name if name.endswith(".yaml") else f"{name}.yaml")
    refuse_unwritable(path)
    if path.exists():
        raise FileExistsError(f"{path} is there already")
    try_folder(path.parent)
    beside = path.with_name("sceneql.schema.json")
    with whole(beside) as stream:
        stream.write(json.dumps(schema(Catalogue()), indent=1).encode())
    with whole(path) as stream:
        stream.write(SCRIPT.format(name=path.stem, schema=beside.name).encode())
    return [path, beside]
