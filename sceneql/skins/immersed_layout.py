"""The integers of kernels of masses that a flow carries; offsets are into the floats but for those of y."""

POSITION_AT, VELOCITY_AT, COUNT, INVERSE_AT, FORCE_AT, EXCESS_AT = range(6)
"""The first one's place and velocity in y; how many there are; by mass 1/mass, 0 of what is held, then what contacts
push with [N] (3), then its mass less that of the fluid whose place it takes [kg]."""
BOX_AT, DENSITY_AT, PESKIN, FLOW_AT, HEAD = range(6, 11)
"""Low corner and sides of a cell; density of the flow (1 float); 1 for Peskin's kernel of four points, 0 for splines;
where in these integers the flow's begin (flows/layout.py). From HEAD on those of a flow of several fluids
(flows/varying/fluid_layout.py), or the flow's."""
