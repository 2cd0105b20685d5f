"""Choice of packets for a frame's rays, and working memory for each thread."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, TypeVar

from renderers.tracing.certified import TOLERANCE
from sceneql.frame import Implicit

if TYPE_CHECKING:
    from collections.abc import Callable

    from renderers.tracing.solids.bundles import Packets
    from sceneql.frame import SeenFrame

Made = TypeVar("Made")
Result = TypeVar("Result")


def packets_for(frame: SeenFrame, tolerance: float) -> Callable[[], Packets] | None:
    """Factory of a thread's Packets; None without implicit solids, or at a tolerance other than TOLERANCE."""
    if tolerance != TOLERANCE or not any(isinstance(shape, Implicit) for shape in frame.shapes):
        return None
    from renderers.tracing.solids.bundles import Packets, solids_in_lanes

    solids = solids_in_lanes(frame.shapes)
    return (lambda: Packets(frame.shapes, solids)) if solids else None


def lender(make: Callable[[], Made]) -> Callable[[Callable[[Made], Result]], Result]:
    """Function that runs work with an object of its own for each thread, so that memory stays in a core's cache."""
    own = threading.local()

    def lend(work: Callable[[Made], Result]) -> Result:
        if not hasattr(own, "made"):
            own.made = make()
        return work(own.made)

    return lend
