"""Volume, centroid and second moments of the inside of an object."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    from sceneql.frame import Floats


@dataclass(frozen=True, slots=True, eq=False)
class VolumeMoments:
    """The integrals of 1, x and (x - center)(x - center)^T over a solid."""

    volume: float
    """[m^3]"""
    center: Floats
    """(3,) [m]."""
    second: Floats
    """(3, 3) second moments about the center [m^5]."""
    error: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Estimated errors of the volume [m^3], of the center [m], and of the second moments in the Frobenius norm [m^5].
    Zero: exact but for rounding."""

    @classmethod
    def centered(cls, volume: float, squares: Sequence[float]) -> Self:
        """The moments of a solid with symmetry axes x, y, z; ``squares`` (3,): means of x^2, y^2, z^2 over it [m^2]."""
        import numpy as np

        return cls(volume, np.zeros(3), volume * np.diag(squares))

    def mapped(self, place: Floats) -> Self:
        """The moments of the solid mapped by an affine map (3, 4), which may stretch or mirror."""
        import numpy as np

        linear = place[:, :3]
        factor, stretch = abs(float(np.linalg.det(linear))), float(np.linalg.norm(linear, 2))
        volume, center, second = self.error
        return type(self)(
            factor * self.volume,
            linear @ self.center + place[:, 3],
            factor * (linear @ self.second @ linear.T),
            (factor * volume, stretch * center, factor * stretch**2 * second),
        )

    @classmethod
    def joined(cls, parts: Sequence[Self]) -> Self:
        """The moments of the union of disjoint solids, by the parallel axis theorem (Huygens & Steiner)."""
        import numpy as np

        volumes = np.array([part.volume for part in parts])
        centers = np.array([part.center for part in parts])
        # Relative to one of the centers, against cancellation far from the origin.
        center = centers[0] + volumes @ (centers - centers[0]) / volumes.sum()
        away = centers - center
        second = sum(part.second for part in parts) + np.einsum("k,ki,kj->ij", volumes, away, away)
        errors, far = np.array([part.error for part in parts]), np.linalg.norm(away, axis=1)
        of_center = (volumes * errors[:, 1] + far * errors[:, 0]).sum() / volumes.sum()
        of_second = (errors[:, 2] + 2.0 * volumes * far * errors[:, 1] + far**2 * errors[:, 0]).sum()
        error = float(errors[:, 0].sum()), float(of_center), float(of_second)
        return cls(float(volumes.sum()), center, second, error)
