"""The cost of a march."""

from dataclasses import dataclass


@dataclass(slots=True)
class Statistics:
    """The cost of a march so far."""

    steps: int = 0
    rejected: int = 0
    """Rejected steps."""
    events: int = 0
    """Impacts of exact contacts."""
    evaluations: int = 0
    """Evaluations of the rate."""
    orderings: int = 0
    """How many times linear systems were ordered anew for pairs that had no place in the Jacobian yet."""
    seconds: float = 0.0
    """Run time of the compiled steps [s]."""
