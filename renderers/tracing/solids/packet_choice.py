"""Decides whether a frame's rays use packets, and lends each thread its memory."""

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
    """Maker of a thread's Packets; None if no shape suits them. Their kernels are for implicit shapes alone."""
    if tolerance != TOLERANCE or not any(isinstance(shape, Implicit) for shape in frame.shapes):
        return None
    from renderers.tracing.solids.bundles import Packets, solids_in_lanes

    solids = solids_in_lanes(frame.shapes)
    return (lambda: Packets(frame.shapes, solids)) if solids else None


def lender(make: Callable[[], Made]) -> Callable[[Callable[[Made], Result]], Result]:
    """Function that lends one thing for each thread: memory that changes threads moves between cores' caches."""
    own = threading.local()

    def lend(work: Callable[[Made], Result]) -> Result:
        if not hasattr(own, "made"):
            own.made = make()
        return work(own.made)

    return lend
