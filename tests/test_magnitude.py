"""A formula times any number is the same solid: pictures, meshes and messages do not tell how large its values are."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from meshes import tape_of
from moment import IDENTITY, FakeMoment, formula
from random_tapes import NAMES, of_one
from sceneql import pipeline
from sceneql.field.tape.magnitude import ORDINARY, leveling
from sceneql.field.tape.plain_values import plain_values
from sceneql.field.tape.tape_solid import field_gradients, field_values
from sceneql.mesh.cubes.polygonise import polygonise
from sceneql.mesh.measures import volume
from sceneql.shapes.solid import traced
from sceneql.words.objects.implicit import Implicit, Within

QUARTIC = "x^4 + y^4 + z^4 - 0.1"
WAVES = "x^2 + y^2 - 0.3 + sin(3*z)/5"
KINKED = "abs(x) + exp(y*y) + z*z - 1.3"
FACTORS = ["1e-20", "1e-13", "1e-6", "1e6", "1e10", "1e13", "1e20"]
SCENE = """
objects: {{a: {{implicit: {{field: "{field}", unit: {unit} m, bounds: {{ball: {ball}}}, mode: {mode}}}}}}}
outputs: {{p: {{image: {{size: 48 27, renderer: normals}}}}}}
cameras: {{c: {{orthographic: {{height: 2 m, look_at: 0 0 0 m}}}}}}
"""


def solid(text, ball=1.0, unit=1.0):
    (shape,) = traced(
        Implicit(field=formula(text), bounds=Within(ball=ball), unit=unit), "a", IDENTITY, FakeMoment()
    )  # fmt: skip
    return shape.tape, shape.low, shape.high


def drawn(folder, field, mode="solid", unit=1.0, ball=1.0):
    """The picture of a formula's normals, and what was said of it."""
    folder.mkdir(exist_ok=True)
    (folder / "s.yaml").write_text(SCENE.format(field=field, mode=mode, unit=unit, ball=ball))
    report = pipeline.render(pipeline.load(folder / "s.yaml"), folder=folder)
    (made,) = folder.glob("*.png")
    return np.asarray(Image.open(made)), [w.message for w in report.warnings]


@pytest.mark.parametrize(("field", "mode"), [(QUARTIC, "solid"), (WAVES, "surface"), (KINKED, "solid")])
def test_a_factor_changes_no_pixel(tmp_path, field, mode):
    plain, said = drawn(tmp_path / "plain", field, mode)
    assert len(np.unique(plain.reshape(-1, 3), axis=0)) > 20
    for factor in FACTORS:
        picture, others = drawn(tmp_path / factor, f"{factor}*({field})", mode)
        assert np.array_equal(picture, plain), factor
        assert others == said


BALL = "x^2 + y^2 + z^2 - 0.5"


@pytest.mark.parametrize(
    "field",
    [
        "1e300*(1e10*(x^2 + y^2 + z^2) - 5e9)",
        "1e-300*(x^2 + y^2 + z^2) - 5e-301",
        "(1e154*x)^2 + (1e154*y)^2 + (1e154*z)^2 - 5e307",
        "-(5e307 - 1e308*x^2 - 1e308*y^2 - 1e308*z^2)/1e-10",
        f"max(1e300*(1e10*({BALL})), 1e-300*({BALL}))",
    ],
)
def test_numbers_that_would_overflow_lose_no_hit(tmp_path, field):
    plain, said = drawn(tmp_path / "plain", BALL)
    picture, others = drawn(tmp_path / "large", field)
    assert plain.any()
    assert np.abs(picture.astype(int) - plain).max() <= 1
    assert others == said


def test_millimeters_are_drawn_and_meshed_as_meters_are(tmp_path):
    fields = "x^6 + y^6 + z^6 - 700^6", "x^6 + y^6 + z^6 - 0.7^6"
    small, _ = drawn(tmp_path / "mm", fields[0], unit=0.001, ball=1000.0)
    assert np.array_equal(small, drawn(tmp_path / "m", fields[1])[0])
    volumes = []
    for field, unit in zip(fields, (0.001, 1.0), strict=True):
        mesh = polygonise(*solid(field, 1.0 / unit, unit), 0.05)
        volumes.append(volume(mesh.vertices, mesh.triangles))
    assert volumes[0] == pytest.approx(volumes[1], rel=1e-6)


@settings(max_examples=12)
@given(st.floats(-20, 20), st.sampled_from([QUARTIC, WAVES, KINKED]))
def test_a_factor_changes_no_mesh(power, field):
    plain, other = (polygonise(*solid(text), 0.1) for text in (field, f"{10.0**power!r}*({field})"))
    assert np.array_equal(plain.triangles, other.triangles)
    assert np.abs(plain.vertices - other.vertices).max() < 1e-7
    inside = np.linalg.norm(plain.vertices, axis=1) < 0.99
    assert np.abs(plain.normals - other.normals)[inside].max() < 1e-5


@pytest.mark.parametrize(
    ("text", "half"),
    [
        ("x^6 + y^6 + z^6 - 700^6", 1000),
        ("1e20*(x^4 + y^4 + z^4 - 0.1)", 1),
        ("exp(x/10) + exp(-x/10) + exp(y/10) + exp(-y/10) + exp(z/10) + exp(-z/10) - 1e13", 700),
        ("exp(exp(x*x + y*y + z*z)) - 4", 2),
    ],
)
def test_vertices_lie_on_the_surface_however_steep_the_field_is_beside_it(text, half):
    tape, cell = tape_of(text), 2 * half / 30.1
    mesh = polygonise(tape, (-half,) * 3, (half,) * 3, cell)
    assert len(mesh.triangles) > 50
    slopes = np.linalg.norm(field_gradients(tape, mesh.vertices), axis=1)
    assert np.max(np.abs(field_values(tape, mesh.vertices)) / slopes) < 1e-6 * cell


@given(st.integers(-300, 300))
def test_fields_of_any_magnitude_are_leveled_and_ordinary_ones_stay(power):
    tape = tape_of(f"1e{power}*(x^2 + y^2 + z^2 - 0.25)")
    factor = leveling(tape, (-1.0,) * 3, (1.0,) * 3)
    assert np.frexp(factor)[0] == 0.5  # a power of two
    assert 2.0**-ORDINARY / 4 < factor * 10.0**power < 2.0**ORDINARY * 4
    if abs(power) < 5:
        assert factor == 1.0


@pytest.mark.parametrize("name", [name for name in NAMES if name not in ("density", "skeleton")])
def test_plain_values_are_those_of_the_kernels(name):
    points = np.random.default_rng(3).normal(size=(200, 3)).round(1) + 0.0
    tape = of_one(name)
    plain, kernels = plain_values(tape, points), field_values(tape, points)
    assert plain is not None
    defined = np.isfinite(kernels)
    assert np.array_equal(np.isfinite(plain), defined)
    assert np.allclose(plain[defined], kernels[defined], rtol=1e-12, atol=1e-12)
