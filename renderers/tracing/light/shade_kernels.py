# mypy: ignore-errors
"""From a record and its visibility to radiance: Lambert, GGX, the sky's blurred reflection."""

import numpy as np
from numba import types

from renderers.tracing import layout
from renderers.tracing.light.albedo_kernels import mean_reflectance
from renderers.tracing.light.light_kernels import highlight, schlick, sky_ambient, sky_radiance
from renderers.tracing.light.lights_kernels import light_at
from renderers.tracing.light.soft_boxes_kernels import soft_boxes
from renderers.tracing.light.visibility_kernels import FIRST_LIGHT, SKY
from renderers.tracing.record_kernels import IMAGED, NORMAL, PLACE, SURFACE, TINT, TRACED, VIEW, WEIGHT
from renderers.tracing.scene_kernels import ROW, SCENE, part
from sceneql.compiled.kernels import kernel

SHARPEST = 0.02
"""Least GGX width of a highlight, so that lights of no size do not vanish from mirrors."""


@part
def edge_reflectance(f0):
    """Reflectance at grazing incidence: 1, but 0 for a surface with no reflection at all (specular 0)."""
    return min(1.0, 50.0 * f0)


@part
def reflectance_at_normal(reals, record):
    """F0 (3) of a record."""
    s = int(record[SURFACE])
    metallic = reals[s + layout.METALLIC]
    plain = reals[s + layout.SPECULAR] * (1.0 - metallic)
    return plain + metallic * record[TINT], plain + metallic * record[TINT + 1], plain + metallic * record[TINT + 2]


@part
def facing_ratio(record):
    """Cosine between normal and viewer, kept above zero."""
    across = record[NORMAL] * record[VIEW] + record[NORMAL + 2] * record[VIEW + 2]
    return max(float(across + record[NORMAL + 1] * record[VIEW + 1]), 1e-3)


@part
def reflected_more(f0, once):
    """Factor of a specular reflection by which what is scattered again on a rough surface comes back.

    For ``once``, the part of uniform light that is scattered once where the surface absorbs none (Turquin 2019,
    Practical Multiple Scattering Compensation for Microfacet Models, eq. 16).
    """
    return 1.0 + f0 * (1.0 / once - 1.0)


@part
def mean_specular(reals, record, nv):
    """Share (3) of uniform light that a record's surface reflects specularly."""
    scale, bias = mean_reflectance(reals[int(record[SURFACE]) + layout.ROUGHNESS], nv)
    r, g, b = reflectance_at_normal(reals, record)
    return (
        min((r * scale + edge_reflectance(r) * bias) * reflected_more(r, scale + bias), 1.0),
        min((g * scale + edge_reflectance(g) * bias) * reflected_more(g, scale + bias), 1.0),
        min((b * scale + edge_reflectance(b) * bias) * reflected_more(b, scale + bias), 1.0),
    )


@part
def light_width(reals, k, distance, roughness):
    """GGX width of the highlight of the light whose reals begin at k: the surface's, widened by the light's size."""
    size = 0.25 * reals[k + 7]
    if reals[k] == layout.POINT:
        size = 0.5 * reals[k + 7] / distance
    alpha = roughness * roughness
    return min(np.sqrt(alpha * alpha + size * size + SHARPEST * SHARPEST), 1.0)


@part
def is_dark(u):
    """Whether the sky has no light."""
    for k in range(layout.SKY, layout.SKY + 9):
        if u[k] != 0.0:
            return False
    return True


@part
def sky_on(u, record, dark):
    """Irradiance / pi (3) of the unobstructed sky on a record; ``dark``: what ``is_dark`` says."""
    return (0.0, 0.0, 0.0) if dark else sky_ambient(u, float(record[NORMAL + 1]))


@part
def share_seen(scene, visibility, l):
    """Share of light l that reaches a record, past all that is solid and through mists."""
    share = visibility[FIRST_LIGHT + 2 * l]
    if scene.mist != 0:
        share *= visibility[FIRST_LIGHT + 2 * int(scene.ints[layout.LIGHT_COUNT]) + l]
    return share


@part
def reflects(u, s):
    """Whether the surface whose reals begin at s reflects anything specularly."""
    return u[s + layout.SPECULAR] != 0.0 or u[s + layout.METALLIC] != 0.0


@part
def shade_matte(scene, record, visibility, s, open_sky):
    """``shade`` of a surface that does not reflect: bit for bit the same, since those terms are 0.

    ``open_sky`` (3): what ``sky_on`` says.
    """
    u = scene.reals
    nx, ny, nz = float(record[NORMAL]), float(record[NORMAL + 1]), float(record[NORMAL + 2])
    x, y, z = float(record[PLACE]), float(record[PLACE + 1]), float(record[PLACE + 2])
    body = (1.0 - u[s + layout.METALLIC]) * (1.0 - u[s + layout.TRANSMISSION])
    r, g, b = 0.0, 0.0, 0.0
    for l in range(int(scene.ints[layout.LIGHT_COUNT])):
        lx, ly, lz, _, ir, ig, ib = light_at(u, l, x, y, z)
        nl = nx * lx + ny * ly + nz * lz
        if nl > 0.0:
            nl *= share_seen(scene, visibility, l)
            r, g, b = r + nl * ir, g + nl * ig, b + nl * ib
    e = s + layout.EMISSION
    return (
        record[WEIGHT] * (body * record[TINT] * (max(open_sky[0] - visibility[SKY], 0.0) + r / np.pi) + u[e]),
        record[WEIGHT + 1]
        * (body * record[TINT + 1] * (max(open_sky[1] - visibility[SKY + 1], 0.0) + g / np.pi) + u[e + 1]),
        record[WEIGHT + 2]
        * (body * record[TINT + 2] * (max(open_sky[2] - visibility[SKY + 2], 0.0) + b / np.pi) + u[e + 2]),
    )


@part
def shade_here(scene, record, visibility):
    """Radiance (3) of a record times its weight, without the rays that are traced further."""
    return shade_under(scene, record, visibility, sky_on(scene.reals, record, False))


@part
def shade_under(scene, record, visibility, open_sky):
    """``shade_here``, by what ``sky_on`` says: most neighbors have the same normal."""
    u = scene.reals
    s = int(record[SURFACE])
    nx, ny, nz = float(record[NORMAL]), float(record[NORMAL + 1]), float(record[NORMAL + 2])
    vx, vy, vz = float(record[VIEW]), float(record[VIEW + 1]), float(record[VIEW + 2])
    x, y, z = float(record[PLACE]), float(record[PLACE + 1]), float(record[PLACE + 2])
    if not reflects(u, s):
        return shade_matte(scene, record, visibility, s, open_sky)
    roughness = u[s + layout.ROUGHNESS]
    nv = facing_ratio(record)
    f0 = reflectance_at_normal(u, record)
    specular = mean_specular(u, record, nv)
    body = (1.0 - u[s + layout.METALLIC]) * (1.0 - u[s + layout.TRANSMISSION])
    twice = 2.0 * (nx * vx + ny * vy + nz * vz)
    mirrored_sky = sky_radiance(u, twice * ny - vy)
    boxes = soft_boxes(scene, twice * nx - vx, twice * ny - vy, twice * nz - vz, 2.0 * roughness * roughness)
    sums = (0.0, 0.0, 0.0)  # irradiance of the matte part, by channel
    lobes = (0.0, 0.0, 0.0)
    scale, bias = mean_reflectance(roughness, nv)
    once = scale + bias
    for l in range(int(scene.ints[layout.LIGHT_COUNT])):
        lx, ly, lz, distance, ir, ig, ib = light_at(u, l, x, y, z)
        nl = nx * lx + ny * ly + nz * lz
        if nl <= 0.0:
            continue
        nl_seen = nl * share_seen(scene, visibility, l)
        sums = sums[0] + nl_seen * ir, sums[1] + nl_seen * ig, sums[2] + nl_seen * ib
        hx, hy, hz = lx + vx, ly + vy, lz + vz
        length = np.sqrt(hx * hx + hy * hy + hz * hz)
        if length < 1e-9:
            continue
        nh = min(max((nx * hx + ny * hy + nz * hz) / length, 0.0), 1.0)
        vh = min(max((vx * hx + vy * hy + vz * hz) / length, 0.0), 1.0)
        lobe = nl_seen * highlight(nl, nv, nh, light_width(u, layout.LIGHTS + layout.LIGHT * l, distance, roughness))
        lobes = (
            lobes[0] + lobe * ir * schlick(f0[0], edge_reflectance(f0[0]), vh),
            lobes[1] + lobe * ig * schlick(f0[1], edge_reflectance(f0[1]), vh),
            lobes[2] + lobe * ib * schlick(f0[2], edge_reflectance(f0[2]), vh),
        )
    for c in range(3):
        arriving = max(open_sky[c] - visibility[SKY + c], 0.0)
        share = min(arriving / open_sky[c], 1.0) if open_sky[c] > 0.0 else 0.0
        blurred = arriving + share * ((1.0 - roughness) * (mirrored_sky[c] - open_sky[c]) + boxes[c])
        diffuse = body * record[TINT + c] * (1.0 - specular[c])
        total = diffuse * (arriving + sums[c] / np.pi) + u[s + layout.EMISSION + c]
        total += (1.0 - record[IMAGED]) * lobes[c] * reflected_more(f0[c], once)
        total += specular[c] * (1.0 - record[TRACED]) * blurred
        total *= record[WEIGHT + c]
        if c == 0:
            sums = total, sums[1], sums[2]
        elif c == 1:
            sums = sums[0], total, sums[2]
        else:
            sums = sums[0], sums[1], total
    return sums


@part
def add_light(scene, record, visibility, radiance, share):
    """Add ``share`` of a record's light to a pixel's radiance (3,)."""
    r, g, b = shade_here(scene, record, visibility)
    radiance[0] += share * r
    radiance[1] += share * g
    radiance[2] += share * b


@kernel(types.UniTuple(types.float64, 3)(SCENE, ROW, ROW), _nrt=False, inner=True)
def shade(scene, record, visibility):
    """``shade_here``, by a call."""
    return shade_here(scene, record, visibility)
