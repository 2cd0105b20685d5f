"""trace: the ray tracer."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any, Literal

from sceneql.kinds import FixedScalar, Renderer, field

DRAFT_SAMPLES, DRAFT_BOUNCES = 2, 1


class Trace(Renderer):
    """Ray-traces a frame: solids exactly, meshes by a bounding hierarchy, implicit surfaces by certified first roots.

    Soft shadows, light of the sky with occlusion, light that surfaces reflect onto one another, reflection and
    refraction; light and shadows go straight through glass: there are no caustics. Microfacet highlights (Walter,
    Marschner, Li and Torrance 2007; Turquin 2019). Shadows and light from around are sampled by a net and averaged over
    the surface around a pixel, so that a film has no grain; the bytes are the same from run to run and for any number
    of threads.

    Where rounding decides what a formula is, each ray's search takes long and ends undecided. After 4 such rays at an
    object in a band of 16 rows of pixels the others at it that only such a search could decide are undecided at once:
    the run tells how many, and `renderer: undecided` shows them.

    `sceneql render --draft` draws a third of the pixels along each side, with 2 samples and one reflection onto matte
    surfaces, and enlarges them: its light and shadows, less sharp, in about a sixth of the time, for trying things out.
    Letters stay sharp.
    """

    tolerance: FixedScalar = field(
        "Of roots of implicit surfaces, relative to the way through an object; finer things are undecided.",
        "1e-9",
        above=0,
        at_most=1e-3,
    )
    samples: Literal[1, 2, 4, 8, 16, 32, 64] = field("Rays in a pixel in which things meet.", 8)
    diffuse_bounces: int = field(
        "Most surfaces, one after the other, by which light is reflected onto a matte one; with 0 lamps, the sky and "
        "what glows light it alone, and shadows of hard lamps are black.",
        256,
        at_least=0,
        at_most=256,
    )

    def kernels(self, traced: Collection[str]) -> tuple[str, ...]:
        """Kernel modules of the tracer."""
        from renderers.tracing.certified import TOLERANCE, certified

        if not traced:
            return ("renderers.tracing.draw",)
        together: tuple[str, ...] = ()
        if self.tolerance == TOLERANCE:
            tape = ("sceneql.field.packets.tape_bundle_kernels", "sceneql.field.packets.enclose_kernels")
            own = {
                "formula": tape,
                "density": ("sceneql.field.packets.density_bundle_kernels",),
                "skeleton": (
                    *tape,
                    "sceneql.field.packets.packet_skeleton_kernels",
                    "sceneql.field.packets.packet_near_kernels",
                ),
            }
            together = (
                *dict.fromkeys(name for kind in sorted(traced) for name in own[kind]),
                "renderers.tracing.solids.bundles",
            )
        return (*together, *certified("renderers.tracing.draw"))

    def draft(self) -> Trace:
        """Renderer for drafts, with fewer rays in pixels at edges, and light that is reflected less often."""
        samples, bounces = min(self.samples, DRAFT_SAMPLES), min(self.diffuse_bounces, DRAFT_BOUNCES)
        return self.model_copy(update={"samples": samples, "diffuse_bounces": bounces})

    def draw(self, frame: Any) -> Any:
        """Picture of a frame: linear (h, w, 3), and the number of undecided pixels."""
        from renderers.tracing.draw import draw

        return draw(frame, self.samples, self.tolerance, bounces=self.diffuse_bounces)
