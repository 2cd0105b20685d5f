"""Kernels of forces between many masses, and of curl noise, against plain sums and differences."""

import numpy as np
import pytest

from sceneql.bodies.neighbors import table
from sceneql.compiled.threads_kernels import threads, tile_address
from sceneql.nbody import direct_kernels, fast_kernels, octree_kernels, tree_kernels
from sceneql.nbody.shared_masses import integers_of
from sceneql.system import Bodies
from sceneql.words.forces import repulsion_kernels, turbulence_kernels

HEAD = 4
"""Numbers before the masses in floats."""


def bodies(count, position_at, velocity_at, mass_at):
    return Bodies("m", count, position_at, velocity_at, 0, mass_at, 0, 0)


def island(n, seed=1):
    """Two models of n bodies together: y, masses, and their layout."""
    rng = np.random.default_rng(seed)
    a = n // 3
    y = rng.normal(size=6 * n + 2)
    after = 6 * a + 1
    models = [bodies(a, 0, 3 * a, HEAD), bodies(n - a, after, after + 3 * (n - a), HEAD + a)]
    places = np.concatenate([y[m.position_at :][: 3 * m.count] for m in models]).reshape(-1, 3)
    return y, rng.random(n) + 0.5, models, places


def forces(rate, models):
    return np.concatenate([rate[m.velocity_at :][: 3 * m.count] for m in models]).reshape(-1, 3)


def gravity(n, softening=0.05, count=2, kernel=direct_kernels.direct_tile, meter=1.0, kilogram=1.0):
    y, m, models, places = island(n)
    y, m, places, softening = meter * y, kilogram * m, meter * places, meter * softening
    room = -(-n // direct_kernels.LANES) * direct_kernels.LANES
    parts = direct_kernels.parts_of(room)
    floats = np.concatenate([[2.0, softening, 0.0, 0.0], m, np.zeros((4 + 3 * parts) * room)])
    entry, _ = threads()
    after = HEAD + n
    tile = tile_address(kernel)
    numbers = (0, 1, 1, after, after + 3 * room, room, after + 4 * room, parts, entry, count, tile)
    weights = (HEAD, 1, HEAD + models[0].count, 1)
    ints = np.array([*numbers, *integers_of(models), *weights], dtype=np.int64)
    rate = np.zeros_like(y)
    direct_kernels.direct(0.0, y, rate, floats, ints)
    apart = places[None] - places[:, None]
    square = (apart**2).sum(axis=2) + softening**2
    exact = 2.0 * m[:, None] * np.einsum("j,ijc->ic", m, apart / square[..., None] ** 1.5)
    return forces(rate, models), exact, (y, floats, ints, m, square)


@pytest.mark.parametrize("n", [3, 32, 33, 500, 1500])
def test_direct_sums_are_exact_to_rounding(n):
    found, exact, _ = gravity(n)
    scale = np.abs(exact).max(axis=1, keepdims=True)
    np.testing.assert_allclose(found / scale, exact / scale, rtol=0, atol=2e-14)
    assert np.abs(found.sum(axis=0)).max() <= 1e-15 * np.abs(found).sum()


@pytest.mark.parametrize(("n", "meter", "kilogram"), [(33, 1.0, 1.0), (500, 3e11, 2e30), (1500, 1e-9, 1e-27)])
def test_fast_sums_are_good_to_single_precision_in_any_unit(n, meter, kilogram):
    found, exact, _ = gravity(n, kernel=fast_kernels.fast_tile, meter=meter, kilogram=kilogram)
    size = np.linalg.norm(exact, axis=1)
    wrong = np.linalg.norm(found - exact, axis=1) / size
    assert 1e-9 < np.sqrt(np.mean(wrong**2)) < 1e-6
    assert wrong.max() < 1e-5
    assert np.abs(found.sum(axis=0)).max() <= 1e-6 * size.sum()


def test_fast_sums_know_near_bodies_from_one_another():
    """Places keep what a float32 of them lacks: a pair a millionth of the extent apart pulls as it should."""
    y, m, models, _ = island(64)
    near = 1e-6
    y[3:6] = [y[0] + near, y[1], y[2]]
    room, entry = direct_kernels.LANES, threads()[0]
    floats = np.concatenate([[1.0, 0.0, 0.0, 0.0], m, np.zeros(7 * room)])
    after = HEAD + 64
    numbers = (0, 1, 1, after, after + 3 * room, room, after + 4 * room, 1, entry, 1)
    weights = (HEAD, 1, HEAD + models[0].count, 1)
    ints = np.array([*numbers, tile_address(fast_kernels.fast_tile), *integers_of(models), *weights], dtype=np.int64)
    rate = np.zeros_like(y)
    direct_kernels.direct(0.0, y, rate, floats, ints)
    apart = y[3] - y[0]
    assert forces(rate, models)[0, 0] == pytest.approx(m[0] * m[1] / apart**2, rel=1e-5)


def test_threads_do_not_change_a_bit_of_fast_sums():
    one, other = (gravity(1500, count=count, kernel=fast_kernels.fast_tile)[0] for count in (1, 5))
    assert np.array_equal(one, other)


def test_threads_do_not_change_a_bit():
    assert np.array_equal(gravity(1500, count=1)[0], gravity(1500, count=5)[0])


def test_bodies_at_one_place_do_not_pull_each_other():
    y, m, models, _ = island(40)
    y[: 3 * models[0].count] = 0.25
    room = direct_kernels.LANES
    floats = np.concatenate([[2.0, 0.0, 0.0, 0.0], m, np.zeros(7 * room)])
    entry, count = threads()
    tile = tile_address(direct_kernels.direct_tile)
    numbers = (0, 1, 1, 44, 44 + 3 * room, room, 44 + 4 * room, 1, entry, count, tile)
    ints = np.array([*numbers, *integers_of(models), HEAD, 1, HEAD + models[0].count, 1], dtype=np.int64)
    rate = np.zeros_like(y)
    direct_kernels.direct(0.0, y, rate, floats, ints)
    assert np.isfinite(rate).all()
    each = forces(rate, models)[: models[0].count] / m[: models[0].count, None]
    np.testing.assert_allclose(each, np.broadcast_to(each[0], each.shape), rtol=1e-12)


def test_potentials_are_the_plain_sums():
    _, _, (y, floats, ints, m, square) = gravity(50)
    found = np.zeros(50)
    direct_kernels.potentials(y, floats, ints, found)
    inverse = 1.0 / np.sqrt(square)
    np.fill_diagonal(inverse, 0.0)
    np.testing.assert_allclose(found, inverse @ m, rtol=1e-13)


@pytest.mark.parametrize("n", [2, 40, 3000])
def test_repulsion_finds_every_pair_of_masses_in_reach_once(n):
    y, m, models, places = island(n)
    m[1::5] = 0.0
    reach, exponent = 0.5, 2.0
    size, p, q = table(n)
    at = np.cumsum([HEAD + n, n, 3 * n, 3 * n, n, size + 1])
    floats = np.zeros(at[-1])
    floats[:HEAD] = [3.0, 0.0, reach, exponent]
    floats[HEAD : HEAD + n] = m
    numbers = [0, 2, *at[:5].tolist(), size, p, q, *threads(), tile_address(repulsion_kernels.repulsion_tile)]
    ints = np.array([*numbers, *integers_of(models)], dtype=np.int64)
    rate = np.zeros_like(y)
    repulsion_kernels.repulsion(0.0, y, rate, floats, ints)
    expected, energy = np.zeros((n, 3)), 0.0
    for k in range(n):
        away = places[k] - places
        r = np.linalg.norm(away, axis=1)
        near = (r < reach) & (r > 0) & (m > 0) & (m[k] > 0)
        left = 1 - r[near] / reach
        expected[k] = (3.0 * left[:, None] ** exponent * away[near] / r[near, None]).sum(axis=0)
        energy += 0.5 * (3.0 * reach / 3.0 * left**3).sum()
    np.testing.assert_allclose(forces(rate, models), expected, rtol=0, atol=1e-11)
    assert floats[at[0] : at[1]].sum() == pytest.approx(energy, rel=1e-12)


def curl_noise(points, angle=0.4, octaves=1, seed=5):
    """The air's velocities at points: the force on masses at rest, with speed, size and drag all 1."""
    n = len(points)
    y = np.concatenate([points.ravel(), np.zeros(3 * n + 1)])
    floats = np.concatenate([[1.0, 1.0, 1.0], np.zeros(3), [1.0, angle], np.ones(n), np.zeros(n)])
    tile = tile_address(turbulence_kernels.turbulence_tile)
    ints = np.array([0, 3 * n, n, 6 * n, 8, 0, 1, 3, 6, 8 + n, octaves, seed, *threads(), tile])
    rate = np.zeros_like(y)
    turbulence_kernels.turbulence(1.0, y, rate, floats, ints)
    return rate[3 * n : 6 * n].reshape(-1, 3)


def test_curl_noise_has_no_divergence_and_the_speed_it_says():
    points = np.random.default_rng(3).uniform(-20, 20, size=(2000, 3))
    h = 1e-3
    slopes = [curl_noise(points + h * e) - curl_noise(points - h * e) for e in np.eye(3)]
    gradients = np.stack(slopes, axis=1) / (2 * h)
    divergence = np.trace(gradients, axis1=1, axis2=2)
    size = np.linalg.norm(gradients, axis=(1, 2))
    # Single precision leaves 1e-7 of the speed, divided by 2 h; a kink of the slope none.
    assert np.abs(divergence).max() < 2e-3 * size.max()
    assert np.sqrt((curl_noise(points, octaves=1) ** 2).sum(axis=1).mean()) == pytest.approx(1, rel=0.05)
    assert np.sqrt((curl_noise(points, octaves=4) ** 2).sum(axis=1).mean()) == pytest.approx(1, rel=0.05)
    assert np.abs(curl_noise(points).mean(axis=0)).max() < 0.05


def test_curl_noise_is_smooth_across_cells_and_differs_by_seed_and_time():
    line = np.linspace(-2, 2, 4001)[:, None] * [1.0, 0.3, 0.2]
    steps = np.abs(np.diff(curl_noise(line), axis=0)).max()
    assert steps < 0.02
    assert np.abs(curl_noise(line) - curl_noise(line, seed=6)).max() > 0.3
    assert np.abs(curl_noise(line) - curl_noise(line, angle=2.0)).max() > 0.3


def tree(n, opening, count=2):
    """Gravity of a clustered cloud by the tree and by plain sums, with the potentials."""
    y, m, models, _ = island(n)
    for model in models:
        place = y[model.position_at :][: 3 * model.count].reshape(-1, 3)
        place *= (np.linalg.norm(place, axis=1) ** 2)[:, None]
    places = np.concatenate([y[model.position_at :][: 3 * model.count] for model in models]).reshape(-1, 3)
    softening, most = 0.02, n // 2 + 64
    parts = [3 * n, n, octree_kernels.NODE * most, 3 * n, n, n, n + 2, n]
    at = np.cumsum([HEAD + n, *parts])
    floats = np.zeros(at[-1])
    floats[:3] = [2.0, softening, opening]
    floats[HEAD : HEAD + n] = m
    numbers = [0, 1, 1, at[0], at[1], n, 2, at[2], most, *at[3:8].tolist()]
    entry, _ = threads()
    numbers += [entry, count, tile_address(tree_kernels.tree_tile)]
    ints = np.array([*numbers, *integers_of(models), HEAD, 1, HEAD + models[0].count, 1], dtype=np.int64)
    rate = np.zeros_like(y)
    tree_kernels.tree(0.0, y, rate, floats, ints)
    apart = places[None] - places[:, None]
    inverse = 1.0 / np.sqrt((apart**2).sum(axis=2) + softening**2)
    exact = 2.0 * m[:, None] * np.einsum("j,ijc->ic", m, apart * inverse[..., None] ** 3)
    np.fill_diagonal(inverse, 0.0)
    found = forces(rate, models)
    return found, exact, floats[at[7] : at[7] + n], inverse @ m


@pytest.mark.parametrize(("opening", "error"), [(0.3, 2e-4), (0.65, 2e-3), (1.0, 1e-2)])
def test_the_tree_errs_by_its_opening(opening, error):
    found, exact, potential, exact_potential = tree(2000, opening)
    wrong = np.linalg.norm(found - exact, axis=1) / np.linalg.norm(exact, axis=1)
    assert 1e-9 < np.sqrt(np.mean(wrong**2)) < error
    assert np.abs(potential / exact_potential - 1).max() < error


@pytest.mark.parametrize("n", [3, 17, 300])
def test_a_tree_that_opens_everything_is_the_plain_sum(n):
    found, exact, potential, exact_potential = tree(n, 1e-9)
    scale = np.abs(exact).max(axis=1, keepdims=True)
    np.testing.assert_allclose(found / scale, exact / scale, rtol=0, atol=1e-13)
    np.testing.assert_allclose(potential, exact_potential, rtol=1e-13)


def test_threads_do_not_change_a_bit_of_the_tree():
    assert np.array_equal(tree(2000, 0.65, count=1)[0], tree(2000, 0.65, count=3)[0])


def test_bodies_at_one_place_end_the_division():
    y = np.zeros(6 * 100)
    y[: 3 * 50] = 1.0
    keys, order = np.empty(100, dtype=np.int64), np.empty(100, dtype=np.int64)
    places = y[: 3 * 100].reshape(100, 3).T.ravel()
    floats = np.concatenate([places, np.ones(100), np.zeros(octree_kernels.NODE * 200 + 200)])
    octree_kernels.sort_by_key(floats, 100, 100, 0, keys, order)
    count = octree_kernels.build(floats, 100, keys, 400, 200)
    assert count == 3
    nodes = floats[400:].reshape(-1)[: octree_kernels.NODE * count].reshape(count, -1)
    assert nodes[1:, octree_kernels.CHILDREN].sum() == 0
    assert nodes[0, octree_kernels.BEGIN] == 0
    assert nodes[0, octree_kernels.END] == 100
    starts = np.zeros(12)
    floats = np.concatenate([floats, starts])
    found = octree_kernels.groups(floats, count, 400, len(floats) - 12)
    assert floats[-12 : -11 + found].tolist() == [0, 50, 100]
