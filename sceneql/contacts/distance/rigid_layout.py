"""The layout of the integers of contacts of rigid bodies: indices by name."""

BODIES, SHAPES, SHAPES_AT, BODIES_AT, PLACES_AT, ROOM_AT, ROOM, KEPT_AT, KEPT_NAMES_AT, MOST_KEPT = range(10)
RESTITUTION_AT, FRICTION_AT, COUNT_AT, POINTS_AT, NORMALS_AT, FORCES_AT, LOOSE_AT, CROWDED_AT = range(10, 18)
ALL_BODIES, TIES_AT, TIES, JOINED_AT, LEDS, LEDS_AT, SKINS_AT, MASSES_AT, ROLLING_AT, HEAD = range(18, 28)
"""Integers of an island's contacts: numbers of bodies that move and of shapes, of which theirs come first; where the
shapes (contacts/distance/convex.py) and the bodies' integers begin; offsets into the floats of places (7 a shape), of
working memory and its size; where impulses are kept from step to step among the floats, their names among the integers,
and how many at most; offsets of the coefficients; of how many contacts there were, and of their points, normals and
forces; of the steps whose contacts were not solved to rounding, or were more than can be kept; the number of bodies
with those that ties alone bring in, behind the others; where the integers of ties begin, and their number (0: no ties);
where the pairs begin that ties join, so that they do not touch, after their number; number of the objects that move by
themselves, and where their integers begin (LED each: their shape, then led_kernels); where it stands for each shape
where its skin begins (contact_skin_kernels), 0 where none is needed; where the integers of masses begin, which are the
last of the bodies (mass_near_kernels; 0: none); offset of the length of moments that resist rolling."""
LED = 5
