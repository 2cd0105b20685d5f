"""The integers by which skins in flows touch what stands: those of objects_layout with other meanings in two places."""

from sceneql.contacts.barrier import objects_layout

FORCE = objects_layout.VELOCITY
"""Offset in the floats of the first vertex's force [N], in place of its velocity in y: a skin has none of its own."""

ANCHORS = objects_layout.LAGGED
"""For each point and object the place (3) in the object's axes at which friction holds the point; NaN where none
does."""

STEEP = objects_layout.SLIP
"""Of NUMBERS: the part of the gap from which on pressure grows faster (touch_push_kernels.py)."""
STEEPER = 0.3
"""That part where nothing starts nearer: else half of the least part at the start, so that nothing is thrown off."""

BODIES = objects_layout.INVERSE
"""Where in these integers those of the masses and rigid bodies begin that the objects are of; for each BODY of them:
those of its system.Place, and RELATIVE."""
RELATIVE, BODY = 8, 9
"""Offset in the floats of the place of the surface in the axes of its body, from the center (7); -1 of a mass."""
