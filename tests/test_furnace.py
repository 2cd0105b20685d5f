"""In a furnace, where equal light comes from all around, white things are not to be seen: no light is lost or made."""

from __future__ import annotations

import numpy as np
import pytest

import stage
from renderers.trace import Trace
from renderers.tracing.light.albedo_kernels import REFLECTED
from sceneql.compiler.catalogue import Catalogue
from sceneql.frame import Sky, Surface
from sceneql.pipeline import load, simulate
from stage import frame, sun, view

UNIFORM = Sky((1.0, 1.0, 1.0), (1.0, 1.0, 1.0), (1.0, 1.0, 1.0))
MATERIALS = {
    "matte": {"specular": 0.0},
    "plastic": {"specular": 0.04},
    "strong coat": {"specular": 0.5},
    "metal": {"metallic": 1.0},
    "glass": {"specular": 0.04, "transmission": 1.0, "index_of_refraction": 1.5},
    "diamond": {"specular": 0.172, "transmission": 1.0, "index_of_refraction": 2.42},
}


def scattered_once(roughness, nv, across=400, around=256):
    """Shares of uniform light towards a cosine nv by GGX, by Schlick's terms 1 - (1 - vh)^5 and (1 - vh)^5.

    By the midpoint rule over the distribution of all normals, not of the visible ones as in the tracer's table.
    """
    a2 = roughness**4
    u, phi = np.meshgrid((np.arange(across) + 0.5) / across, (np.arange(around) + 0.5) * 2 * np.pi / around)
    nh = np.sqrt((1 - u) / (1 + (a2 - 1) * u))
    vh = np.sqrt(1 - nv * nv) * np.sqrt(1 - nh * nh) * np.cos(phi) + nv * nh
    nl = 2 * vh * nh - nv
    up = (nl > 0) & (vh > 0)
    nl = np.where(up, nl, 1.0)
    shadowing = nl * np.sqrt(a2 + (1 - a2) * nv * nv) + nv * np.sqrt(a2 + (1 - a2) * nl * nl)
    weight = np.where(up, 2.0 * nl * vh / (shadowing * nh), 0.0)
    grazing = np.clip(1 - vh, 0, 1) ** 5
    return (weight * (1 - grazing)).mean(), (weight * grazing).mean()


@pytest.mark.parametrize("material", MATERIALS)
def test_white_things_in_a_furnace_are_not_to_be_seen(material):
    for roughness in np.linspace(0.0, 1.0, 11):
        surface = Surface(color=(1.0, 1.0, 1.0), roughness=roughness, **MATERIALS[material])
        picture = Trace().draw(frame(stage.sphere(surface), lights=[UNIFORM], seen=view(size=(48, 48)))).linear
        assert np.abs(picture - 1).max() < 0.01


@pytest.mark.parametrize("row", [1, 3, 6, 10, 15])
def test_what_a_rough_surface_scatters_once_is_that_of_its_distribution(row):
    for column in (4, 7, 10, 15):
        exact = scattered_once(row / 15, (column / 15) ** 2)
        assert REFLECTED[row, column] == pytest.approx(exact, abs=0.01)


@pytest.mark.parametrize("roughness", [0.6, 0.8, 1.0])
def test_rough_white_metal_gives_the_light_of_many_suns_back(roughness):
    metal = Surface(color=(1.0, 1.0, 1.0), roughness=roughness, metallic=1.0)
    k = np.arange(300)
    height, turn = (k + 0.5) / 300, k * np.pi * (3 - np.sqrt(5))
    level = np.sqrt(1 - height**2)
    suns = [
        sun(direction, (2 * np.pi / 300,) * 3)
        for direction in zip(level * np.cos(turn), height, level * np.sin(turn), strict=True)
    ]
    for eye in ((0.0, 5.0, 0.1), (4.0, 4.0, 0.0), (5.0, 2.0, 0.0)):
        seen = view(eye, size=(4, 4), half_height=0.1)
        assert Trace().draw(frame(stage.floor(metal), lights=suns, seen=seen)).linear == pytest.approx(1.0, abs=0.03)


@pytest.mark.parametrize("word", sorted(set(Catalogue().words("materials")) - {"glow"}))
def test_white_materials_of_every_word_in_a_furnace_are_not_to_be_seen(word, tmp_path):
    fields = Catalogue().load("materials", word).model_fields
    white = ", ".join(f"{name}: 1 1 1" for name in ("color", "other") if name in fields)
    for roughness in np.linspace(0.0, 1.0, 6) if "roughness" in fields else [None]:
        rough = "" if roughness is None else f", roughness: {roughness}"
        script = (
            f"materials: {{paint: {{{word}: {{{white}{rough}}}}}}}\nobjects: {{ball: {{sphere: {{material: paint}}}}}}"
        )
        (tmp_path / "scene.yaml").write_text(script + "\noutputs: {still: {image: {time: 0 s}}}")
        graph = load(tmp_path / "scene.yaml")
        (moment,) = simulate(graph, [0.0])
        surface = moment.surface("ball", graph.tasks["ball"].kind.material, None)
        picture = Trace().draw(frame(stage.sphere(surface), lights=[UNIFORM], seen=view(size=(48, 48)))).linear
        assert np.abs(picture - 1).max() < 0.01
