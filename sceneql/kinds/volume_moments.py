"""Volume, center and second moments of what is inside an object."""

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
    """(3, 3) about the center [m^5]."""
    error: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Estimated errors: of the volume [m^3], of the center [m], and of the second moments in the Frobenius norm [m^5].
    Zero: exact but for rounding."""

    @classmethod
    def centered(cls, volume: float, squares: Sequence[float]) -> Self:
        """Of a solid with its axes of symmetry along x, y and z, by the means (3,) of their squares over it [m^2]."""
        import numpy as np

        return cls(volume, np.zeros(3), volume * np.diag(squares))

    def mapped(self, place: Floats) -> Self:
        """Of the solid under an affine map (3, 4), which may stretch or mirror."""
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
        """Of solids that do not overlap, taken together: by the theorem of parallel axes (Huygens & Steiner)."""
        import numpy as np

        volumes = np.array([part.volume for part in parts])
        centers = np.array([part.center for part in parts])
        # From one of the centers, so that nothing is lost far from the origin.
        center = centers[0] + volumes @ (centers - centers[0]) / volumes.sum()
        away = centers - center
        second = sum(part.second for part in parts) + np.einsum("k,ki,kj->ij", volumes, away, away)
        errors, far = np.array([part.error for part in parts]), np.linalg.norm(away, axis=1)
        of_center = (volumes * errors[:, 1] + far * errors[:, 0]).sum() / volumes.sum()
        of_second = (errors[:, 2] + 2.0 * volumes * far * errors[:, 1] + far**2 * errors[:, 0]).sum()
        error = float(errors[:, 0].sum()), float(of_center), float(of_second)
        return cls(float(volumes.sum()), center, second, error)
