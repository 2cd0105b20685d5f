"""Packing of implicit objects."""

from __future__ import annotations

from typing import TYPE_CHECKING

from renderers.tracing.scene_kernels import CROSSING, SKIN
from renderers.tracing.solids.skin_kernels import skin
from sceneql.compiled.kernels import address

if TYPE_CHECKING:
    from renderers.tracing.scene_kernels import Scene


def prepared(scene: Scene, *, sheets: bool, march: bool, certain: bool) -> Scene:
    """Scene with the addresses of the kernels for its implicit objects.

    Solids and ``sheets`` are intersected by certified roots, in cells that are not proved empty. With ``march`` they
    are intersected by samples on the ray, with ``certain`` by certified intervals alone, both without cells.
    """
    scene = scene._replace(skin=address(skin, SKIN))
    if march or certain:
        if march:
            from renderers.tracing.solids.fixed_samples_kernels import sampled as other
        else:
            from renderers.tracing.solids.certain_kernels import certain as other
        return scene._replace(solid=address(other, CROSSING), sheet=address(other, CROSSING))
    from renderers.tracing.solids.implicit_kernels import crossing

    scene = scene._replace(solid=address(crossing, CROSSING))
    if sheets:
        from renderers.tracing.solids import sheet_kernels

        scene = scene._replace(sheet=address(sheet_kernels.crossing, CROSSING))
    return scene
