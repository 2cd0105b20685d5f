"""Skins of scripts in flows on their way, for tests."""

from __future__ import annotations

import numpy as np

from flows import WAVES, Air

ELLIPSE = "x^2/0.3^2 + y^2/0.2^2 - 1"


def ballooned(
    folder, law="law: {springs: {stretch: 4 N/m}}, prestress: 1 N/m", formula=ELLIPSE, at="0.5 0.5", cells=16, **more
):
    """A skin `balloon` in a flow `air` of 1 m, periodic where nothing else is said; ``more``: fields of both."""
    of_skin = {key: more.pop(key) for key in ("spacing", "volume", "filled") if key in more}
    written = "".join(f", {key}: {value}" for key, value in of_skin.items())
    skin = f"  balloon: {{membrane: {{of: egg, {law}{written}}}}}\n"
    skin += more.pop("forces", "forces: [{immersion: {on: [balloon], in: air}}]\n")
    egg = f'{{implicit: {{field: "{formula}", position: {at} 0 m}}}}'
    skin += more.pop("objects", f"objects: {{egg: {egg}}}\n")
    fields = {"boundary": WAVES, "advection": "central", "cell": f"1/{cells} m", **more}
    return Air(folder, models=skin + fields.pop("models", ""), **fields)


def smooth_area(points):
    """What the trigonometric interpolant of a closed line (n, 3) goes around."""
    places = points[:, 0] + 1j * points[:, 1]
    count = len(places)
    return np.pi * (np.fft.fftfreq(count, 1 / count) * np.abs(np.fft.fft(places) / count) ** 2).sum()


DEEP_WAVES = "{left: {periodic: yes}, bottom: {periodic: yes}, back: {periodic: yes}}"


def deep(folder, law, formula, at="0.5 0.5 0.5", cells=14, **more):
    """A skin `balloon` around a solid of a formula in a deep flow `air` of 1 m."""
    egg = f'{{implicit: {{field: "{formula}", position: {at} m}}}}'
    more = {"size": "1 1 1 m", "boundary": DEEP_WAVES, "objects": f"objects: {{egg: {egg}}}\n", **more}
    return ballooned(folder, law, cells=cells, **more)


def forces(air, points):
    """The forces (n, 3) of the skin at other places (n, 3) [N]."""
    system, skin = air.run.march.system, air.tasks["balloon"].kind.made.membrane
    floats, y, rate = system.floats.copy(), system.y.copy(), np.zeros(len(system.y))
    y[skin.position_at : skin.position_at + 3 * skin.count] = points.ravel()
    air.run.march.driver.rate(0.0, y, rate, floats, system.ints)
    return floats[skin.force_at : skin.force_at + 3 * skin.count].reshape(-1, 3)
