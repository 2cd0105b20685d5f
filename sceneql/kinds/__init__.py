"""What a word of each family is; its fields' types.

A word is one file with one class, named as the file in CamelCase (``mass_spring.py``: ``MassSpring``), derived from a
family class of this package. The class is the schema and the manual: fields with type, default, range and a line of
text; ``gives``, its outputs; its docstring. When adding a word read ``types.py`` and ``word.py``, then its family.
"""

from __future__ import annotations

from sceneql.kinds.doubt import Doubt
from sceneql.kinds.field_builder import FieldBuilder
from sceneql.kinds.moment import Moment, Shaped
from sceneql.kinds.objects import Collider, Object
from sceneql.kinds.outputs import EachVariant, Output, Picture, Sink, Tools
from sceneql.kinds.physics import Contact, Force, Interaction, Model, Tie
from sceneql.kinds.pictures import Camera, Light, Material, Overlay, Renderer
from sceneql.kinds.settings import (
    MOST_MOMENTS,
    Clock,
    Exceeds,
    Expect,
    Gallery,
    Settings,
    Study,
    TooCoarse,
    bounded_moments,
)
from sceneql.kinds.solving import Methods, Solver
from sceneql.kinds.texts import Text, TextValue
from sceneql.kinds.types import (
    Acceleration,
    Angle,
    Axis,
    CameraRef,
    Color,
    Damping,
    Direction,
    DrawnRef,
    Expected,
    File,
    FixedAngle,
    FixedDamping,
    FixedFrequency,
    FixedLength,
    FixedMass,
    FixedPosition,
    FixedScalar,
    FixedStiffness,
    FixedTime,
    FixedVelocity,
    Length,
    Lengths,
    Mass,
    MaterialRef,
    Measured,
    ModelRef,
    ObjectRef,
    Points,
    Position,
    Power,
    RendererRef,
    Rotation,
    Scalar,
    Speed,
    Stiffness,
    Time,
    Velocity,
    Words,
    WordsOverTime,
)
from sceneql.kinds.values import Formula, Interpolated, Paint, Quantity, Ref, Refers, SceneFile, Symbols, Turn, Value
from sceneql.kinds.volume_moments import VolumeMoments
from sceneql.kinds.word import (
    GRAMMAR,
    LIMITS,
    REQUIRED,
    Gives,
    Kind,
    Problem,
    Record,
    field,
    grammar_of,
    literal,
    quantity_type,
    written_name,
)

FAMILIES: tuple[type[Kind], ...] = (
    Object,
    Model,
    Interaction,
    Tie,
    Contact,
    Solver,
    Camera,
    Light,
    Material,
    Renderer,
    Overlay,
    Output,
)
