"""Soft discs: the light that they add, what they cover, what hides them."""

import math

import numpy as np
import pytest

from renderers.tracing.draw import draw
from renderers.tracing.light.discs import MANY, ORDERS, left_around, left_at, lit
from sceneql.frame import PointLight, Points, SeenFrame, Sky, Sun, Surface, View

BLACK = Sky(zenith=(0, 0, 0), horizon=(0, 0, 0), ground=(0, 0, 0))
SIDE = 96


def disc(*centers, radius=0.3, color=(1.0, 0.5, 0.25), soft="adds", opacity=1.0):
    surface = Surface(color=(0.0, 0.0, 0.0), emission=color)
    return Points("d", surface, np.array(centers, float), np.full(len(centers), radius), soft=soft, opacity=opacity)


def seen(*shapes, orthographic=False):
    """The picture from (0, 0, 4) towards the origin, where a pixel is 1/48 m of the plane z = 0."""
    half = 1.0 if orthographic else 0.25
    view = View((0.0, 0.0, 4.0), np.eye(3), (SIDE, SIDE), half, orthographic)
    return draw(SeenFrame(0, 0.0, tuple(shapes), (BLACK,), view), samples=1).linear


@pytest.mark.parametrize("orthographic", [False, True])
@pytest.mark.parametrize("radius", [0.3, 0.11, 0.004])
def test_a_disc_adds_a_third_of_its_area_of_light(radius, orthographic):
    light = seen(disc((0.1, -0.2, 0), radius=radius), orthographic=orthographic).sum(axis=(0, 1))
    area = math.pi * (radius * SIDE / 2) ** 2
    rough = 0.12 if radius * SIDE < 1 else 0.01  # a disc of a pixel or so is sampled at few places
    np.testing.assert_allclose(light, area / 3 * np.array([1, 0.5, 0.25]), rtol=rough)


def test_light_adds_up_in_any_order_of_depth():
    a, b = (0, 0, 0.5), (0.05, 0, -0.5)
    np.testing.assert_allclose(seen(disc(a, b)), seen(disc(a)) + seen(disc(b)), rtol=1e-6, atol=1e-7)


def test_the_nearest_of_discs_that_cover_is_seen():
    red, blue = (disc((0, 0, z), color=c, soft="covers") for z, c in ((0.5, (1, 0, 0)), (-0.5, (0, 0, 1))))
    both = Points(
        "d", red.surface, np.concatenate([red.centers, blue.centers]), np.full(2, 0.3),
        colors=np.array([[1.0, 0, 0], [0, 0, 1.0]]), soft="covers",
    )  # fmt: skip
    middle = seen(both)[SIDE // 2, SIDE // 2]
    assert middle[0] > 0.98
    assert middle[2] < 0.02


def test_a_disc_is_hidden_by_what_stands_before_it_alone():
    ball = Points("b", Surface(color=(0.0, 0.0, 0.0), specular=0.0), np.zeros((1, 3)), np.full(1, 0.5))
    assert seen(ball, disc((0, 0, -2.0))).sum() == 0
    np.testing.assert_array_equal(seen(ball, disc((0, 0, 2.0))), seen(disc((0, 0, 2.0))))
    cut = seen(ball, disc((0, 0, 0.5)))[SIDE // 2, SIDE // 2, 0]
    assert cut == pytest.approx(0.5, abs=0.05)


def test_no_disc_behind_the_camera_is_drawn():
    assert seen(disc((0, 0, 5.0), (0, 0, 4.0))).sum() == 0


WHITE = Surface(color=(1.0, 1.0, 1.0))
FRONT = Sun((0.0, 0.0, 1.0), (math.pi, math.pi, math.pi))


def smoke(*centers, opacity=1.0, radius=0.3, surface=WHITE):
    return Points("s", surface, np.array(centers, float), np.full(len(centers), radius), soft="covers", opacity=opacity)


def seen_in(*lights, shapes):
    view = View((0.0, 0.0, 4.0), np.eye(3), (SIDE, SIDE), 0.25)
    return draw(SeenFrame(0, 0.0, tuple(shapes), (*lights, BLACK), view), samples=1).linear


def test_a_disc_that_faces_the_lamp_is_as_bright_as_a_matte_wall():
    middle = seen_in(FRONT, shapes=[smoke((0, 0, 0))])[SIDE // 2, SIDE // 2]
    np.testing.assert_allclose(middle, 1.0, atol=0.01)


def test_white_smoke_in_a_sky_that_is_white_all_around_is_as_bright_where_nothing_hides_it():
    sky = Sky(*[(0.5, 0.5, 0.5)] * 3)
    middle = seen_in(sky, shapes=[smoke((0, 0, 0), opacity=1e-6)])  # it hides nothing, also of itself
    before = seen_in(sky, shapes=[])
    np.testing.assert_allclose(middle, before, atol=1e-6)
    thin, _, _ = lit(smoke((0, 0, 0), opacity=1e-9), (sky,), np.eye(3))
    np.testing.assert_allclose(thin, 0.5, rtol=1e-6)


@pytest.mark.parametrize("opacity", [0.2, 0.6])
def test_discs_leave_of_a_sun_what_they_leave_of_the_view(opacity):
    row = smoke(*[(0, 0, -float(k)) for k in range(4)], opacity=opacity)
    behind = np.array([[0.0, 0.0, -10.0]])
    once = left_at(behind, row, np.array([0.0, 0.0, 1.0]))
    left = (1 - opacity) ** 4
    assert once[0] == pytest.approx(sum(w * left**p for p, w in zip((1, 0.5, 0.25), ORDERS, strict=True)), abs=0.05)


def test_smoke_is_darker_away_from_the_lamp():
    side = Sun((1.0, 0.0, 0.0), (math.pi, math.pi, math.pi))
    rng = np.random.default_rng(7)
    ball = rng.normal(size=(600, 3))
    ball *= 0.5 * rng.uniform(size=(600, 1)) ** (1 / 3) / np.linalg.norm(ball, axis=1)[:, None]
    picture = seen_in(side, shapes=[smoke(*ball, opacity=0.2, radius=0.15)])[..., 1]
    rows = slice(SIDE // 2 - 4, SIDE // 2 + 4)
    left, right = picture[rows, SIDE // 2 - 18].mean(), picture[rows, SIDE // 2 + 18].mean()
    assert right > 2.5 * left > 0


def test_many_discs_have_the_light_of_few():
    """So many that each has one light: a sheet that the lamp shines on is as bright as one of fewer discs."""
    rng = np.random.default_rng(3)
    sheet = np.column_stack([rng.uniform(-1, 1, (MANY, 2)), np.zeros(MANY)])
    many, few = smoke(*sheet, opacity=0.01, radius=0.05), smoke(*sheet[1:], opacity=0.01, radius=0.05)
    one, other = lit(many, (FRONT,), np.eye(3)), lit(few, (FRONT,), np.eye(3))
    assert not one[1].any()
    assert one[0].mean() == pytest.approx(other[0].mean(), rel=0.02)


@pytest.mark.parametrize("lamp", ["sun", "point"])
def test_a_solid_throws_its_shadow_on_smoke(lamp):
    """Where it stands in the light, not beyond the lamp, nor where it cuts through a disc from behind."""
    lights = {"sun": Sun((1.0, 0.0, 0.0), (3.0,) * 3, 0.0), "point": PointLight((1.5, 0.0, 0.0), (6.0,) * 3, 0.1)}

    def middle(*at, radius=0.15):
        ball = Points("b", WHITE, np.array([at]), np.full(1, radius))
        return seen_in(lights[lamp], shapes=[ball, smoke((0, 0, 0.05), radius=0.1)])[SIDE // 2, SIDE // 2, 0]

    plain = middle(0.0, 0.9, 0.0)
    assert plain > 0.1
    assert middle(0.7, 0.0, 0.05) < 0.01 * plain
    assert middle(-0.7, 0.0, 0.05) == plain
    assert middle(0.0, 0.0, 0.0, radius=0.06) > 0.5 * plain  # it fades where it is cut
    if lamp == "point":
        assert middle(1.5, 0.0, 0.0, radius=0.1) == middle(2.5, 0.0, 0.05) == plain


def test_a_puff_that_goes_into_a_shadow_darkens_by_and_by():
    """Whose edge is sharp: from no frame to the next it is dark all over."""
    sun = Sun((0.0, 1.0, 0.0), (3.0,) * 3, 0.0)
    roof = Points("b", WHITE, np.array([[0.5, 1.5, 0.0]]), np.full(1, 0.5))
    rows = np.linspace(-0.3, 0.3, 31)  # a fifteenth of its radius a frame
    seen = [
        seen_in(sun, shapes=[roof, smoke((x, 0.0, 0.0), radius=0.3)])[SIDE // 2 - 20 : SIDE // 2 + 20].sum()
        for x in rows
    ]
    assert seen[-1] < 0.2 * seen[0]
    assert -np.diff(seen).min() < 0.3 * seen[0]


def test_the_light_of_smoke_that_grows_does_not_jump():
    rng = np.random.default_rng(3)
    sheet = np.column_stack([rng.uniform(-1, 1, (MANY, 2)), np.zeros(MANY)])
    side = Sun((0.8, 0.0, 0.6), (1.0,) * 3, 0.0)
    many, few = (lit(smoke(*sheet[:n], opacity=0.01, radius=0.05), (side,), np.eye(3)) for n in (MANY, MANY - 1))
    for one, other in zip(many, few, strict=True):
        np.testing.assert_allclose(one[: MANY - 1], other, atol=5e-3)


def test_glowing_discs_take_no_light():
    glow = Surface(color=(0.0, 0.0, 0.0), emission=(0.4, 0.4, 0.4))
    discs = [smoke((0, 0, 0), (0.1, 0, 0.2), surface=glow)]
    np.testing.assert_array_equal(seen_in(FRONT, shapes=discs), seen_in(shapes=discs))


def test_the_light_on_smoke_is_the_same_wherever_its_lamp_shines_from():
    """A lamp far away is a sun; a lamp in the middle of the discs fails nowhere."""
    pair = smoke((0, 0, 0), (0.1, 0.2, 0.3), opacity=0.5)
    far = PointLight((0.0, 0.0, 1e4), (math.pi * 1e8,) * 3)
    for one, other in zip(lit(pair, (far,), np.eye(3)), lit(pair, (FRONT,), np.eye(3)), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-3, atol=1e-3)
    inside = PointLight((0.05, 0.1, 0.27), (1.0, 1.0, 1.0))
    assert np.isfinite(lit(pair, (inside,), np.eye(3))).all()


def test_a_disc_that_is_nowhere_takes_no_light_from_the_others():
    sound = smoke((0, 0, 0), (0.1, 0, -0.6))
    burst = smoke((0, 0, 0), (0.1, 0, -0.6), (np.nan, 0, 0))
    sun = Sun((0.0, 0.0, 1.0), (3.0, 3.0, 3.0), 0.0)
    assert np.array_equal(seen_in(sun, shapes=[burst]), seen_in(sun, shapes=[sound]))


def test_a_puff_that_drifts_away_changes_nothing_of_the_light_on_the_others():
    rng = np.random.default_rng(5)
    cloud = rng.uniform(-1.0, 1.0, (400, 3))
    sun = Sun((0.8, 0.0, 0.6), (1.0,) * 3, 0.0)
    alone = lit(smoke(*cloud, opacity=0.3, radius=0.1), (sun,), np.eye(3))
    beside = lit(smoke(*cloud, (-90.0, 4.0, 7.0), opacity=0.3, radius=0.1), (sun,), np.eye(3))
    for one, other in zip(alone, beside, strict=True):
        np.testing.assert_allclose(one, other[:-1], atol=0.02)
    assert beside[0][-1] == pytest.approx(1.0 / math.pi, rel=0.25)


def test_the_light_of_a_lamp_in_the_midst_of_smoke_fades_on_all_sides_alike():
    """By the mean over discs by chance, around a hollow, whose number before a place goes by its distance."""
    rng, lamp = np.random.default_rng(11), np.array([0.13, -0.21, 0.34])

    def ball(count):
        points = rng.normal(size=(count, 3))
        return points * rng.uniform(size=(count, 1)) ** (1 / 3) / np.linalg.norm(points, axis=1)[:, None]

    cloud, asked = ball(8000), ball(8000)
    cloud = cloud[np.linalg.norm(cloud, axis=1) > 0.25]
    left = left_around(lamp + asked, smoke(*(lamp + cloud), opacity=0.2, radius=0.05), lamp)
    away, q = np.linalg.norm(asked, axis=1), (np.arange(1000) + 0.5) / 1000
    density, area = 8000 / (4 / 3 * math.pi), 2 * math.pi * 0.05**2 * q / 1000
    fading = [density * (area * (1 - (1 - 0.2 * (1 - q * q) ** 2) ** power)).sum() for power in (1, 0.5, 0.25)]
    for near in (0.4, 0.6, 0.8):
        shell = (away > near) & (away < near + 0.2)
        exact = sum(w * np.exp(-f * (near - 0.15)) for w, f in zip(ORDERS, fading, strict=True))
        sides = [side * asked[:, k] > 0.5 * away for k in range(3) for side in (1, -1)]
        np.testing.assert_allclose([left[shell & side].mean() for side in sides], exact, rtol=0.05)
