"""Whether a frame's rays meet implicit solids in packets, and what each thread needs for that."""

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
    """What makes a thread's Packets; None where they know no shape. Their kernels are for implicit shapes alone."""
    if tolerance != TOLERANCE or not any(isinstance(shape, Implicit) for shape in frame.shapes):
        return None
    from renderers.tracing.solids.bundles import Packets, solids_in_lanes

    solids = solids_in_lanes(frame.shapes)
    return (lambda: Packets(frame.shapes, solids)) if solids else None


def lender(make: Callable[[], Made]) -> Callable[[Callable[[Made], Result]], Result]:
    """Does work with the thing made for a thread: memory that changes threads goes from one core's cache to another."""
    own = threading.local()

    def lend(work: Callable[[Made], Result]) -> Result:
        if not hasattr(own, "made"):
            own.made = make()
        return work(own.made)

    return lend
