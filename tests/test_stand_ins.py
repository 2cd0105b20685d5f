"""Soft bodies stand in place of the objects that they are made of."""

import pytest

from sceneql import pipeline

SCRIPT = """
clock: {{end: 20 ms}}
objects:
  mold: {{box: {{size: 0.4 0.4 0.4 m, position: 0 1 0 m, color: crimson}}}}
{more}
models: {{body: {{{model}}}}}
forces: [gravity]
contacts: {{touch: {{collision: {{{between}}}}}}}
"""
ELASTIC = "elastic: {of: mold, spacing: 0.2 m, law: {neo_hookean: {modulus: 30 kPa, poisson: 0.4}}, density: 1 g/cm^3}"
NET = "mass_spring: {solid: {object: mold, spacing: 0.2 m, density: 1 g/cm^3, modulus: 30 kPa}}"


def graph_of(folder, model, more="", between=""):
    (folder / "s.yaml").write_text(SCRIPT.format(model=model, more=more, between=between))
    return pipeline.load(folder / "s.yaml")


@pytest.mark.parametrize("model", [ELASTIC, NET])
def test_the_shape_of_a_soft_body_is_neither_seen_nor_hit(tmp_path, model):
    graph = graph_of(tmp_path, model)
    assert "mold" not in graph.drawn["film"]
    assert "body" in graph.drawn["film"]
    pipeline.render(
        pipeline.load(tmp_path / "s.yaml", sets=["outputs={s: {image: {size: 16 9, time: 20 ms}}}"]), folder=tmp_path
    )


def test_an_elastic_solid_looks_like_its_shape_unless_it_says_otherwise(tmp_path):
    crimson = graph_of(tmp_path, ELASTIC).tasks["mold"].kind.color.expr
    assert graph_of(tmp_path, ELASTIC).tasks["body"].kind.color.expr == crimson
    blue = ELASTIC.replace("{of: mold,", "{of: mold, color: blue,")
    assert graph_of(tmp_path, blue).tasks["body"].kind.color.expr != crimson
    clay = "materials: {clay: {matte: {color: sienna}}}"
    of_clay = graph_of(tmp_path, ELASTIC.replace("mold", "pot"), f"  pot: {{box: {{material: clay}}}}\n{clay}")
    assert of_clay.tasks["body"].kind.material.name == "clay"
    assert "clay" in of_clay.tasks


def test_a_shape_that_other_parts_name_stays(tmp_path):
    grouped = graph_of(tmp_path, ELASTIC, "  pair: {group: {children: [mold]}}")
    assert "pair" in grouped.drawn["film"]
    assert not grouped.tasks["mold"].kind.hidden
    assert not graph_of(tmp_path, ELASTIC, between="between: [body, mold]").tasks["mold"].kind.hidden
