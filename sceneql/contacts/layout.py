"""The layout of the integers of a contact and its objects, and of its memory in the floats: indices by name."""

POSITION, VELOCITY, WORK, MASS, INVERSE, RADIUS, BODIES = range(7)
RESTITUTION, FRICTION, THICKNESS, TALLY, PAIRS, LAST, OBJECTS, HEAD = range(7, 15)
"""The integers of a contact: offsets of the bodies, of its numbers and its memory; the objects follow, from HEAD on."""

SURFACE, BEND, CLEAR, NEAR, PLACE, ROTATION, SIZE, DEPTH, MOVING, BEFORE = range(10)
AFTER, FLAT, DATA, OBJECT = BEFORE + 2, BEFORE + 4, BEFORE + 5, BEFORE + 6
"""The OBJECT integers of an object (shape_kernels)."""

HITS, FIRST_TIME, LAST_TIME, LAST_SPEED, REST_TIME, TALLIES = range(6)
"""The tally in the floats; times are NaN before the first impact."""

INSTANT = 7
"""Floats of a body's memory in `exact` mode, from LAST on: the last accepted instant, its place and velocity then."""

END, WHOLE, CUTS, RESTING, LIST = range(5)
"""Memory of a contact in `local` mode, from LAST on: end and length of the step before it was cut, number of its cuts;
the number of resting bodies, and a list of them, which spares a search of all bodies where most fly."""

PRESS, LOAD, PULL, ALONG, EARLIER, TIED, LET_GO, LISTED, PAIR = 1, 2, 3, 4, *range(7, 12)
"""A pair is (body k, object j), numbered k * objects + j. Its memory in the floats, from PAIRS on: state, free normal
acceleration, load (normal force by mass), pull along the surface (force without friction by mass), direction of sliding
(3), load at the end of the step before (`local` mode; NaN where there was none), and within stages
(stage_contacts_kernels) the evaluations since it was tied or last under load (0: not tied), its releases, and 1 where
it may touch in the step (back_off_in_stages_kernels).
"""
SLACK = TIED
"""Where ties last whole steps (channels.BETWEEN): the margin [m/s^2] of static friction over the pull along the surface
at the end of the step before, NaN where the pair did not stick."""
FREE, SLIDES, STICKS, CREEPS = 0.0, 1.0, 2.0, 3.0
"""CREEPS, in `local` mode: slides so slowly that friction is added at the end of the step (friction_kernels.brake)."""

PATH = 13
"""Floats of a path (body_path_kernels)."""
