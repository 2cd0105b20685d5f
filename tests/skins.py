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
