"""galaxy: a disk of stars in orbit around a heavy center."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from sceneql import kinds
from sceneql.bodies import bodies as masses
from sceneql.kinds import Gives, Model, Moment, Quantity, field, quantity_type
from sceneql.kinds.stable_step import StaticMass
from sceneql.quantities import dimension as dim
from sceneql.shapes.placement import unit_vector

if TYPE_CHECKING:
    from numpy import int64
    from numpy.typing import NDArray

    from sceneql.frame import Floats
    from sceneql.frame import Points as Spheres
    from sceneql.system import Assembly, Bodies, ModelState

FixedGravitation = Annotated[float, Quantity(dim.VOLUME / dim.MASS / dim.TIME**2)]
WORDS = 2**32


class Galaxy(Model):
    """A disk of stars round a heavy center, for `mutual_gravity` to hold together.

    The density over the disk falls as exp(-r/scale) up to ``radius`` (Freeman 1970), and normally with ``thickness``
    across it. Each star starts on the circular orbit that the mass within its distance asks for, as if that were a
    ball, by v^2 = G M r^2 / (r^2 + softening^2)^(3/2), with a random velocity of ``dispersion`` times v in every
    direction. Stars turn by the right hand about the axis. The center is mass number 0.
    """

    gives: ClassVar[Mapping[str, Gives]] = {
        **masses.BODY_OUTPUTS,
        "core": Gives(quantity_type(dim.LENGTH, (3,)), "Where the heavy center is."),
    }

    stars: int = field("Number of stars.", 1000, at_least=1, at_most=5_000_000)
    radius: kinds.FixedLength = field("Radius of the disk.", "1 m", above=0)
    scale: kinds.FixedLength | None = field(
        "Length over which it thins out; by default a third of the radius.", None, above=0
    )
    thickness: kinds.FixedLength = field("Standard deviation across the disk.", "0 m", at_least=0)
    heart: kinds.FixedMass = field("Mass of the center.", "1 kg", above=0)
    disk: kinds.FixedMass = field("Mass of all stars together.", "0.1 kg", above=0)
    position: kinds.FixedPosition = field("Where the center starts.", "0 0 0 m")
    velocity: kinds.FixedVelocity = field("How fast its center of mass moves.", "0 0 0 m/s")
    axis: kinds.Direction = field("Axis that the stars run round; its length does not matter.", "0 1 0")
    constant: FixedGravitation = field("The constant of gravitation, as that of the force.", "6.6743e-11 m^3/kg/s^2")
    softening: kinds.FixedLength = field("That of the force.", "0 m", at_least=0)
    dispersion: kinds.FixedScalar = field("Random part of the velocities.", "0", at_least=0, at_most=1)
    seed: int = field("Seed of the stars.", 0, at_least=0, at_most=WORDS - 1)
    size: kinds.FixedLength | None = field(
        "Radius of a star in the picture; by default a hundredth of the disk's.", None, above=0
    )
    core: kinds.FixedLength | None = field(
        "Radius of the center in the picture; by default three times a star's.", None, above=0
    )
    material: kinds.MaterialRef | None = field("How the stars look.", None)
    color: kinds.Color | None = field("Color in place of the material's.", None)

    def darkens(self) -> bool:
        """Stars."""
        return True

    def static_masses(self) -> Mapping[str, StaticMass]:
        """A star."""
        return {"": StaticMass(self.disk / self.stars)}

    def assemble(self, name: str, assembly: Assembly) -> Bodies:
        """Reserve the center and the stars."""
        import numpy as np

        n = self.stars
        chance = self._chance
        scale = self.radius / 3 if self.scale is None else self.scale
        r = _exponential(chance(0), self.radius / scale) * scale
        angle = 2 * np.pi * chance(1)
        height = self.thickness * _normal(chance(2), chance(3))
        across, other, up = _frame(np.asarray(assembly.initial(self.axis), dtype=float))
        outward = np.cos(angle)[:, None] * across + np.sin(angle)[:, None] * other
        onward = np.cos(angle)[:, None] * other - np.sin(angle)[:, None] * across
        within = self.heart + self.disk * _share(r / scale) / _share(np.float64(self.radius / scale))
        speed = np.sqrt(self.constant * within * r**2 / (r**2 + self.softening**2) ** 1.5)
        shaken = np.stack([_normal(chance(4 + 2 * c), chance(5 + 2 * c)) for c in range(3)], axis=1)
        places = r[:, None] * outward + height[:, None] * up
        velocities = speed[:, None] * (onward + self.dispersion * shaken)
        star = 0.01 * self.radius if self.size is None else self.size
        center = np.zeros((1, 3))
        m = np.concatenate([[self.heart], np.full(n, self.disk / n)])
        velocities = np.concatenate([center, velocities])
        velocities -= m @ velocities / m.sum()
        return masses.reserve(
            name,
            assembly,
            positions=np.concatenate([center, places]) + self.position,
            velocities=velocities + self.velocity,
            masses=m,
            radii=np.concatenate([[3.0 * star if self.core is None else self.core], np.full(n, star)]),
            fixed=np.zeros(n + 1, dtype=bool),
        )

    def _chance(self, draw: int) -> Floats:
        """Random numbers (stars,) in [0, 1), by the number of the draw."""
        import numpy as np

        from sceneql.quantities.chance import philox, unit

        stars = np.arange(self.stars, dtype=np.uint64)
        found: Floats = unit(*philox(stars, np.full_like(stars, draw), np.uint64(self.seed)))
        return found

    def read(self, output: str, state: ModelState) -> Any:
        """Any output of the manual."""
        assert state.bodies is not None
        if output == "core":
            return masses.positions(state.bodies, state)[0].copy()
        return masses.read(output, state.bodies, state)

    def places(self, output: str, state: ModelState) -> NDArray[int64] | None:
        """Of the stars, and of the center, which is the first."""
        assert state.bodies is not None
        found = masses.places("positions" if output == "core" else output, state.bodies)
        return found[0] if found is not None and output == "core" else found

    def lower(self, name: str, state: ModelState, moment: Moment) -> Iterable[Spheres]:
        """Spheres."""
        from sceneql.frame import Points as Spheres

        assert state.bodies is not None
        surface = moment.surface(name, self.material, self.color)
        places = masses.positions(state.bodies, state)
        yield Spheres(name, surface, places.copy(), masses.radii(state.bodies, state).copy())


def _share(x: Any) -> Any:
    """Fraction of an exponential disk's mass within x scale lengths."""
    import numpy as np

    return 1 - (1 + x) * np.exp(-x)


def _exponential(chance: Floats, most: float) -> Floats:
    """Radii [scale lengths] of an exponential disk cut at ``most``, for random numbers, by bisection of `_share`."""
    import numpy as np

    low, high = np.zeros_like(chance), np.full_like(chance, most)
    wanted = chance * _share(np.float64(most))
    for _ in range(50):
        middle = 0.5 * (low + high)
        below = _share(middle) < wanted
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return 0.5 * (low + high)


def _normal(first: Floats, second: Floats) -> Floats:
    """Standard normal numbers from two arrays in [0, 1) (Box & Muller 1958)."""
    import numpy as np

    found: Floats = np.sqrt(-2 * np.log1p(-first)) * np.cos(2 * np.pi * second)
    return found


def _frame(axis: Floats) -> tuple[Floats, Floats, Floats]:
    """Two unit vectors (3,) across an axis, and the axis as a unit vector; right-handed."""
    import numpy as np

    up = unit_vector(axis)
    across = np.cross(np.eye(3)[int(np.argmin(np.abs(up)))], up)
    across /= np.linalg.norm(across)
    return across, np.cross(up, across), up
