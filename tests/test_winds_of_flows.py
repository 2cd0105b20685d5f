"""Masses that a flow which is solved carries: `wind: {in: air}`."""

import numpy as np
import pytest

from flows import WAVES, Air
from sceneql.quantities.diagnostic import ScriptError

STREAM = '{velocity: "[1, 0]"}'
FREE = "{left: {periodic: yes}, rest: {wall: {slip: free}}}"


def blown(folder, places, drag="0.4 N*s/m", wind="in: air", end=0.5, solver="{ark3: {step: 10 ms}}", **fields):
    listed = ", ".join(f"p{k}: {{mass: 0.2 kg, position: {place} m}}" for k, place in enumerate(places))
    dust = f"  dust: {{particles: {{list: {{{listed}}}}}}}\n"
    force = f"forces: {{blow: {{wind: {{{wind}, linear: {drag}}}}}}}\n"
    return Air(folder, solver, end, first=dust, models=force, **fields)


@pytest.mark.parametrize("solver", ["{ark3: {step: 10 ms}}", "{sbdf2: {step: 5 ms}}", "{rk4: {step: 5 ms}}"])
def test_a_stream_takes_masses_along_by_their_drag(tmp_path, solver):
    """v = U (1 - exp(-c t/m)); outside the box nothing blows."""
    air = blown(tmp_path, ["0.97 0.31 0", "0.2 1.2 0"], solver=solver, boundary=FREE, initial=STREAM).at(0.5)
    velocity = air.read("velocities", "dust")
    assert velocity[0] == pytest.approx([1 - np.exp(-0.4 * 0.5 / 0.2), 0, 0], abs=2e-4)
    assert velocity[1] == pytest.approx([0, 0, 0], abs=1e-15)
    assert air.read("energy", "dust") == pytest.approx(0.0, abs=1e-4)


def test_the_wind_of_a_flow_is_linear_between_its_faces(tmp_path):
    """Between plates u = 2 y: exact at any height but within half a cell of a wall."""
    moved = '{left: {periodic: yes}, top: {wall: {velocity: "[2, 0]"}}}'
    places = [f"{x} {y} 0" for x, y in ((0.01, 0.123), (0.39, 0.5), (0.2, 0.9371))]
    air = blown(
        tmp_path, places, "100 N*s/m", boundary=moved, initial='{velocity: "[2*y, 0]"}', size="0.4 1 m", cell="0.05 m",
        viscosity="1 Pa*s", end=0.1, solver="{ark3: {step: 1 ms}}",
    ).at(0.1)  # fmt: skip
    heights = air.read("positions", "dust")[:, 1]
    assert air.read("velocities", "dust")[:, 0] == pytest.approx(2 * heights, rel=1e-6)


def test_dust_goes_round_a_vortex_of_a_periodic_box_also_beyond_its_sides(tmp_path):
    """Seen one box further on the wind is the same."""
    side = 6.283185307179586
    spin = {"size": f"{side} {side} m", "cell": f"{side}/24 m", "boundary": WAVES}
    vortex = '{velocity: "[-cos(x)*sin(y), sin(x)*cos(y)]"}'
    air = blown(tmp_path, ["1 2 0", f"{1 + side} {2 - side} 0"], "5 N*s/m", initial=vortex, **spin).at(0.5)
    velocity, places = air.read("velocities", "dust"), air.read("positions", "dust")
    assert velocity[0] == pytest.approx(velocity[1], abs=1e-12)
    x, y, _ = places[0]
    assert velocity[0, :2] == pytest.approx([-np.cos(x) * np.sin(y), np.sin(x) * np.cos(y)], abs=0.06)


@pytest.mark.parametrize(
    ("wind", "text"),
    [
        ("in: dust", "'dust' is no flow"),
        ("in: air, velocity: 1 0 0 m/s", "a wind has one of"),
        ("in: air, gusts: 0.2", "no gusts"),
    ],
)
def test_a_wind_in_no_flow_or_in_two_airs_is_refused(tmp_path, wind, text):
    with pytest.raises(ScriptError, match=text):
        blown(tmp_path, ["0.5 0.5 0"], wind=wind).at(0.1)
