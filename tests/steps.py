"""Scripts whose steps are looked at before they run, for the tests of stability."""

import re

from sceneql import pipeline


def loaded(tmp_path, script, *sets):
    path = tmp_path / "scene.yaml"
    path.write_text(script)
    return pipeline.load(path, sets=sets)


def warnings(graph):
    return [re.sub(r"\(\S*scene\.yaml:", "(scene.yaml:", found.message) for found in graph.warnings]
