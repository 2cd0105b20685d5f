"""raster: triangles drawn by OpenGL."""

from __future__ import annotations

from typing import Any, Literal

from sceneql.kinds import FixedScalar, Renderer, field


class Raster(Renderer):
    """Draws triangles by OpenGL (pyrender), off-screen: what interactive programs show, for quick looks.

    Implicit surfaces are polygonised (Lorensen & Cline 1987), balls and rods are made of triangles. Light is direct,
    with shadows of suns, and that of the sky alike from all around; up to four lights of a kind count. Nothing is
    mirrored or refracted, glass is a pale film. Mist, soft discs and iso-surfaces of fields it does not draw, and says
    so (an iso-surface it draws as `polygonised`).
    It needs the package pyrender (`pip install "sceneql[raster]"`) and a library of OpenGL that draws without a screen.
    The bytes are those of that library.
    """

    cells: int = field(
        "Cells along the longest side of an implicit object; finer where that is needed.", 64, at_least=4
    )
    sharp: bool = field(
        "Implicit objects keep their edges (Ju et al. 2002); what is thinner than a cell may go.", False
    )
    samples: Literal[1, 4, 16] = field("Samples in a pixel.", 4)
    shadows: bool = field("Suns throw shadows.", True)
    brightest: FixedScalar = field(
        "The brightest light [W/(sr m^2)] that is told apart; OpenGL gives 256 steps of it.", "2", above=0
    )

    def draw(self, frame: Any) -> Any:
        """Picture of a frame: linear (h, w, 3). Raises ValueError for unsupported shapes, or without OpenGL."""
        from renderers.rastering.draw import draw

        return draw(frame, self.cells, self.sharp, self.samples, self.shadows, self.brightest)
