"""The types of fields by name: a value in time of each quantity, its constant twin (``Fixed...``), references."""

from __future__ import annotations

from typing import Annotated

from sceneql.kinds.texts import Text
from sceneql.kinds.values import Interpolated, Paint, Quantity, Ref, Refers, SceneFile, Turn, Value
from sceneql.quantities import dimension as dim

Scalar = Annotated[Value, Quantity(dim.PLAIN)]
Length = Annotated[Value, Quantity(dim.LENGTH)]
Time = Annotated[Value, Quantity(dim.TIME)]
Mass = Annotated[Value, Quantity(dim.MASS)]
Angle = Annotated[Value, Quantity(dim.ANGLE, needs_unit=True)]
Speed = Annotated[Value, Quantity(dim.VELOCITY)]
Power = Annotated[Value, Quantity(dim.POWER)]
Stiffness = Annotated[Value, Quantity(dim.STIFFNESS)]
Damping = Annotated[Value, Quantity(dim.DAMPING)]
Position = Annotated[Value, Quantity(dim.LENGTH, (3,))]
Velocity = Annotated[Value, Quantity(dim.VELOCITY, (3,))]
Acceleration = Annotated[Value, Quantity(dim.ACCELERATION, (3,))]
Direction = Annotated[Value, Quantity(dim.PLAIN, (3,), direction=True)]
Points = Annotated[Value, Quantity(dim.LENGTH, (None, 3))]
Lengths = Annotated[Value, Quantity(dim.LENGTH, (None,))]
Color = Annotated[Value, Paint()]
Rotation = Annotated[Value, Turn()]
Axis = Annotated[tuple[float, float, float], Quantity(dim.PLAIN, (3,), direction=True)]

FixedScalar = Annotated[float, Quantity(dim.PLAIN)]
FixedLength = Annotated[float, Quantity(dim.LENGTH)]
FixedTime = Annotated[float, Quantity(dim.TIME)]
FixedMass = Annotated[float, Quantity(dim.MASS)]
FixedAngle = Annotated[float, Quantity(dim.ANGLE, needs_unit=True)]
FixedStiffness = Annotated[float, Quantity(dim.STIFFNESS)]
FixedDamping = Annotated[float, Quantity(dim.DAMPING)]
FixedFrequency = Annotated[float, Quantity(dim.FREQUENCY)]
FixedPosition = Annotated[tuple[float, float, float], Quantity(dim.LENGTH, (3,))]
FixedVelocity = Annotated[tuple[float, float, float], Quantity(dim.VELOCITY, (3,))]

Measured = Annotated[Value, Quantity(None, None)]
"""Any output or expression, for records."""
Expected = Annotated[Value, Quantity(None, None, over_time=True)]
"""Any expression, including ones over the whole run, for expectations."""

Words = Annotated[Text, Interpolated()]
"""A text with values in braces."""
WordsOverTime = Annotated[Text, Interpolated(over_time=True)]
"""The same, where values may also use the course of the run so far."""

ObjectRef = Annotated[Ref, Refers("objects")]
ModelRef = Annotated[Ref, Refers("models")]
BodyRef = Annotated[Ref, Refers("models", also="objects", bodies=True)]
"""A body: a model of one, one of several by its name there, an object that moves by itself, or the world."""
CameraRef = Annotated[Ref, Refers("cameras")]
MaterialRef = Annotated[Ref, Refers("materials")]
RendererRef = Annotated[Ref, Refers("renderers")]
DrawnRef = Annotated[Ref, Refers("objects", also="models")]
"""An object, or a model that draws itself."""

PanelRef = Annotated[Ref, Refers("overlays", also="cameras", panel=True)]
"""An overlay or a camera in a panel of a layout."""

File = Annotated[str, SceneFile()]
