"""Solids of tetrahedra from .msh files of Gmsh: versions 2 and 4, of 4 and 10 nodes; what is wrong is told."""

import numpy as np
import pytest

from runs import complaint, watch
from sceneql.bodies.filling.msh import ORDER
from sceneql.bodies.filling.tetrahedra import ENDS
from sceneql.quantities.diagnostic import ScriptError
from solids import Solid

LAW = "law: {linear: {modulus: 1 MPa}}"
GMSH_EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (2, 3), (1, 3))
"""Ends of the nodes 5 to 10 of a tetrahedron in Gmsh's manual."""


def block(folder):
    return Solid(folder, f"{{block: {{size: 1 0.5 0.5 m, cells: [2, 1, 1]}}, element: p2, {LAW}}}").mesh


def written(mesh, version, nodes, turned=()):
    """The text of a file with a point and a triangle beside the tetrahedra, its nodes numbered from 7 in steps of 3."""
    points, cells = mesh.points, mesh.cells
    if nodes == 4:
        points, cells = points[: mesh.corners], cells[:, :4]
    else:
        middle = {tuple(sorted(e)): 4 + k for k, e in enumerate(ENDS)}
        cells = cells[:, [0, 1, 2, 3, *(middle[tuple(sorted(e))] for e in GMSH_EDGES)]]
    cells = np.array(cells)
    for k in turned:
        cells[k, [0, 1]] = cells[k, [1, 0]]
    kind, called = (4 if nodes == 4 else 11), 7 + 3 * np.arange(len(points))
    place = [" ".join(f"{c:.17g}" for c in p) for p in points]
    rows = [" ".join(str(called[n]) for n in cell) for cell in cells]
    if version == 2:
        told = [f"{a} {p}" for a, p in zip(called, place, strict=True)]
        own = [f"{k + 3} {kind} 2 1 1 {row}" for k, row in enumerate(rows)]
        text = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(len(told)), *told, "$EndNodes", "$Elements"]
        text += [str(len(own) + 2), f"1 15 2 1 1 {called[0]}", f"2 2 2 1 1 {rows[0].rsplit(' ', nodes - 3)[0]}"]
        return "\n".join([*text, *own, "$EndElements", ""])
    half, last = len(points) // 2, len(cells) // 2
    parts = [(0, half), (half, len(points))]
    if version == 4.0:
        text = ["$MeshFormat", "4 0 8", "$EndMeshFormat", "$Nodes", f"2 {len(points)}"]
        for a, b in parts:
            text += [f"1 3 0 {b - a}", *(f"{n} {p}" for n, p in zip(called[a:b], place[a:b], strict=True))]
        text += [
            "$EndNodes",
            "$Elements",
            f"2 {len(cells) + 1}",
            "1 0 15 1",
            f"1 {called[0]}",
            f"1 3 {kind} {len(rows)}",
        ]
        return "\n".join([*text, *(f"{k + 3} {row}" for k, row in enumerate(rows)), "$EndElements", ""])
    text = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$Entities", "0 0 0 0", "$EndEntities", "$Nodes"]
    text.append(f"3 {len(points)} 7 {called[-1]}")
    for a, b in parts:
        text += [f"3 1 0 {b - a}", *(str(n) for n in called[a:b]), *place[a:b]]
    text += ["2 5 0 0", "$EndNodes", "$Elements", f"3 {len(cells) + 1} 1 {len(cells) + 1}"]
    text += ["0 1 15 1", f"1 {called[0]}"]
    for a, b in ((0, last), (last, len(cells))):
        text += [f"3 1 {kind} {b - a}", *(f"{k + 3} {rows[k]}" for k in range(a, b))]
    return "\n".join([*text, "$EndElements", ""])


@pytest.mark.parametrize("version", [2, 4.0, 4.1])
@pytest.mark.parametrize("nodes", [4, 10])
@pytest.mark.parametrize("element", ["p1", "p2"])
def test_a_file_gives_the_solid_that_was_written(tmp_path, version, nodes, element):
    mesh = block(tmp_path)
    (tmp_path / "bar.msh").write_text(written(mesh, version, nodes))
    found = Solid(tmp_path, f"{{file: bar.msh, element: {element}, {LAW}}}").mesh
    assert len(found.cells) == len(mesh.cells)
    own = mesh.points[mesh.cells[:, : found.cells.shape[1]]]
    assert found.points[found.cells] == pytest.approx(own, abs=1e-15)
    assert found.tables()[1].sum() == pytest.approx(0.25, rel=1e-12)
    assert len(found.points) == (mesh.corners if element == "p1" else len(mesh.points))


def test_curved_elements_of_ten_nodes_stay_curved(tmp_path):
    ball = "objects: {shape: {sphere: {radius: 0.5 m, hidden: yes}}}\n"
    mesh = Solid(tmp_path, f"{{of: shape, spacing: 0.3 m, element: p2, {LAW}}}", ball).mesh
    (tmp_path / "ball.msh").write_text(written(mesh, 2, 10))
    found = Solid(tmp_path, f"{{file: ball.msh, element: p2, {LAW}}}").mesh
    assert found.tables()[1].sum() == pytest.approx(mesh.tables()[1].sum(), rel=1e-12)
    assert np.linalg.norm(found.points[np.unique(found.faces)], axis=1) == pytest.approx(0.5, abs=1e-9)


def test_nodes_on_edges_are_in_gmshs_order():
    ours = {tuple(sorted(e)): 4 + k for k, e in enumerate(ENDS)}
    for k, place in enumerate(ORDER[4:]):
        assert ours[tuple(sorted(GMSH_EDGES[place - 4]))] == 4 + k


@pytest.mark.parametrize("nodes", [4, 10])
def test_turned_elements_are_told_by_number_and_place(tmp_path, nodes):
    (tmp_path / "bar.msh").write_text(written(block(tmp_path), 4.1, nodes, turned=[5, 7]))
    script = f"models: {{body: {{elastic: {{file: bar.msh, element: p2, {LAW}}}}}}}\n"
    with pytest.raises(
        ScriptError, match=r"2 elements of bar.msh turned inside out, or flat: .* number 8, at \("
    ) as told:
        watch(tmp_path, script, [0.0], "body.energy")
    assert told.value.diagnostics[0].span.line == 1


WRONG = {
    "no mesh\n": "is no .msh",
    "$MeshFormat\n4.1 1 8\n$EndMeshFormat\n": "is a binary .msh: save it as text",
    "$MeshFormat\n1 0 8\n$EndMeshFormat\n": "of version 1: versions 2 and 4 are read",
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n2\n1 0 0 0\n2 1 zero 0\n$EndNodes\n": (
        "line 7 of bad.msh should have 4 numbers"
    ),
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n9\n1 0 0 0\n": "bad.msh ends too soon, in line 6",
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n1\n1 15 2 1 1 1\n$EndElements\n": (
        "has no tetrahedra"
    ),
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n1\n1 4 2 1 1 1 2 3 4\n": "node 2",
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n1\n1 5 2 1 1 1 1 1 1 1 1 1 1\n": (
        "solids that are no tetrahedra"
    ),
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\nmany\n": "line 5 of bad.msh should have 1 number\n",
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n2\n1 0 0 0\n2 0 0\n": "line 7 of bad.msh should have 4 numbers",
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n1\n1 4 2 1 1 1 1 1 1e30\n": (
        "line 10 of bad.msh should have whole numbers"
    ),
    "$MeshFormat\n4.1 0 8 1\n$EndMeshFormat\n$Nodes\n0 0 0 0\n$EndNodes\n": "bad.msh has no nodes",
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 1 1 1\n3 1 0 1\n1\n0 0 0\n$EndNodes\n$Elements\n1 1 5 5\n"
    "3 1 4 1\n5 1 1 1 1 1\n": "element 5 and others of kind 4 should have 4 nodes",
}


@pytest.mark.parametrize("text", WRONG)
def test_what_is_wrong_in_a_file_is_told(tmp_path, text):
    (tmp_path / "bad.msh").write_text(text)
    script = f"models: {{body: {{elastic: {{file: bad.msh, {LAW}}}}}}}\n"
    with pytest.raises(ScriptError, match=WRONG[text]):
        watch(tmp_path, script, [0.0], "body.energy")


@pytest.mark.parametrize(
    ("name", "remedy"),
    [("t.vtk", "gmsh -0 t.vtk -format msh2 -o t.msh"), ("t.stl", "`mesh: {file: t.stl}` under objects")],
)
def test_a_file_of_another_kind_is_told_with_what_to_do(tmp_path, name, remedy):
    (tmp_path / name).write_text("# vtk DataFile Version 2.0\n")
    with pytest.raises(ScriptError, match=r"is no \.msh") as told:
        watch(tmp_path, f"models: {{body: {{elastic: {{file: {name}, {LAW}}}}}}}\n", [0.0], "body.energy")
    assert remedy in told.value.diagnostics[0].help


def test_a_file_that_is_not_there_or_has_a_spacing_is_told_at_once(tmp_path):
    film = "outputs: {film: {image: {size: 32 18}}}\n"
    assert "none.msh" in complaint(tmp_path, f"models: {{body: {{elastic: {{file: none.msh, {LAW}}}}}}}\n{film}")
    (tmp_path / "bar.msh").write_text("$MeshFormat\n")
    told = complaint(tmp_path, f"models: {{body: {{elastic: {{file: bar.msh, spacing: 1 cm, {LAW}}}}}}}\n{film}")
    assert "a file has its elements, and no spacing" in told
