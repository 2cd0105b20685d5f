"""Primitives of pyrender from triangles with a material."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sceneql.mesh.display_colors import levels

if TYPE_CHECKING:
    from renderers.rastering.triangles import Triangles
    from sceneql.frame import RGB, Floats

FILM = 0.8
"""Transparency of a clear surface."""
TEXELS = 64
"""Number of texels along a square of a checkerboard."""


def primitive(gl: Any, part: Triangles, brightest: float) -> Any:
    """Primitive of pyrender for triangles; radiance is in units of ``brightest`` [W/(sr m^2)]."""
    surface, colors, places = part.surface, part.colors, None
    base: RGB = surface.color
    texture = None
    if surface.checker_size > 0:
        if part.flat:
            base, texture = (1.0, 1.0, 1.0), _checks(gl, surface.color, surface.checker_color)
            places = _places(part.vertices, part.normals, surface.checker_size)
        else:
            own = np.array(surface.color) if colors is None else colors
            odd = np.floor(part.vertices / surface.checker_size).sum(axis=1) % 2 == 1
            colors = np.where(odd[:, None], np.array(surface.checker_color), own)
    if colors is not None:
        base = (1.0, 1.0, 1.0)
        colors = np.column_stack([colors, np.ones(len(colors))])
    clear = surface.transmission
    material = gl.MetallicRoughnessMaterial(
        baseColorFactor=[*base, 1.0 - FILM * clear],
        metallicFactor=surface.metallic,
        roughnessFactor=surface.roughness,
        emissiveFactor=np.sqrt(np.clip(np.array(surface.emission) / brightest, 0.0, 1.0)),  # squared by the shader
        baseColorTexture=texture,
        alphaMode="BLEND" if clear > 0 else "OPAQUE",
        doubleSided=True,
    )
    return gl.Primitive(
        positions=part.vertices.astype(np.float32),
        normals=part.normals.astype(np.float32),
        indices=part.triangles.astype(np.uint32),
        color_0=None if colors is None else colors.astype(np.float32),
        texcoord_0=None if places is None else places.astype(np.float32),
        material=material,
        mode=gl.GLTF.TRIANGLES,
    )


def _places(vertices: Floats, normals: Floats, size: float) -> Floats:
    """Texture coordinates (n, 2), one unit for two squares, along the two axes most nearly parallel to a face."""
    axis = np.argmax(np.abs(normals), axis=1)
    axis[np.abs(normals[:, 1]) > 0.9] = 1
    squares = vertices / size
    rows = np.arange(len(vertices))
    u, v = squares[rows, np.where(axis == 0, 1, 0)], squares[rows, np.where(axis == 2, 1, 2)]
    behind = np.where(axis == 1, 0.0, np.floor(squares[rows, axis] + 1e-9) % 2)
    return np.column_stack([0.5 * (u + behind), 0.5 * v])


def _checks(gl: Any, even: RGB, odd: RGB) -> Any:
    """Texture of two by two squares of a checkerboard."""
    k = np.arange(2 * TEXELS) // TEXELS
    # The first row of a picture is its top, the high end of the second axis.
    board = np.where((k[::-1, None] + k[None, :])[..., None] % 2 == 0, np.array(even), np.array(odd))
    gltf = gl.GLTF
    sampler = gl.Sampler(
        magFilter=gltf.NEAREST, minFilter=gltf.LINEAR_MIPMAP_LINEAR, wrapS=gltf.REPEAT, wrapT=gltf.REPEAT
    )
    return gl.Texture(source=levels(board), source_channels="RGB", sampler=sampler)
