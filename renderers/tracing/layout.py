"""Layout of the tracer's scene (two arrays), of its scratch and of its lists of rays."""

NODE_COUNT, ITEM_COUNT, ENDLESS_COUNT, LIGHT_COUNT, NODES_AT, LINKS_AT, SHAPE_COUNT = range(7)
HAS_THIN, BOX_COUNT, EMBERS_AT, EMBERS, MISTS_AT, MISTS, BOUNCES = range(7, 14)
"""The header; HAS_THIN tells whether there are THIN items, EMBERS how many spheres glow, EMBERS_AT where their tree is,
MISTS_AT where in the ints the places of the reals of so many MISTS are, BOUNCES by how many surfaces light is reflected
onto others.
The first ENDLESS_COUNT items have no bounds; they stand in the first node, which has none either."""

ITEMS = 14
"""Offset of the items, by leaf: kind, place of the reals, place of the surface, index of the shape."""
KIND, REALS_AT, SURFACE_AT, SHAPE = range(4)
TRIANGLE, ROUND, QUADRIC, HALF_SPACE, IMPLICIT, SHEET, GRID, THIN = range(8)
"""Kinds. Their reals:
TRIANGLE: corner, edge, edge; normals at the corners, colors at the corners (a NaN first: there are none): 27. Where the
surface has a TEXTURE, places of the material at the corners stand in place of the colors.
ROUND (sphere or capsule): end, axis to the other end, radius, color (NaN: the surface's): 10.
QUADRIC: map to local (3, 4), squares, linear, constant, low, high: 25.
HALF_SPACE (a quadric that is nothing else): unit normal, height of its face along that: 4.
GRID: as grid_kernels says.
THIN: as ROUND, of a capsule that the camera may see thinner than a pixel (thin_capsules_kernels), and the length of the
line that it is a piece of: 11.
IMPLICIT and SHEET: low, high, place of its ranges, a ball that it is in (4; radius inf: none is known), index of its
shape: 12. The ranges, in ints: place of the code, its rows, place of the constants, their number, place of the parts,
their rows; place of the cells; the same six of its paint and of what a sheet lies within (no rows: it has none); place
of the plan for single rays (sceneql.field.tape.plans), its length."""
BALL, OF_SHAPE = 7, 11
"""Columns of the ball and of the shape among these reals."""
CELLS_AT, PAINT, WITHIN, PLAN, RANGES = 6, 7, 13, 19, 21
"""Columns of the ranges, and their number."""
CELLS = 32
"""Occupancy cells along each axis of an implicit object's box, through which single rays walk."""

TO_NODES, TO_WORLD, MIST_LOW, MIST_HIGH, NODES, MIST_BOX, MIST_COLOR, LIT, ABSORPTION = (
    0,
    12,
    24,
    27,
    30,
    33,
    39,
    42,
    43,
)
"""Reals of a mist: maps to its nodes and from these to the world (3, 4), corners of its box in nodes, nodes along x, y,
z, its box in the world, color, whether it is lit; the absorption of its nodes [1/m], if it is lit the radiance that it
has at each where it is thick (3, one behind the other), and for each block of grid_kernels.BLOCK cells 1 if there is
any in it."""
SEEN, LIGHT, LEFT = range(3)
"""What a ray wants to know of mists (mist_kernels.mists_along)."""

EMBER = 9
"""Reals of a node of the tree of spheres that glow: their mean place by intensity, distance from there up to which they
reach, largest radius, sum of their intensities (3), number of spheres. With one sphere it is that sphere."""
LINK = 3
"""Integers of a node: its skip link (the next node after a miss), first item, number of items (0: an inner node)."""

SKY = 0
"""Zenith, horizon, ground, visible; whether light comes from sky or surfaces; whether `visible` is given: 14."""
HAS_LIGHT, HAS_VISIBLE = 12, 13
TOLERANCE, SAMPLES = 14, 15
"""Tolerance of roots of implicit objects, relative to the searched piece of a ray; number of samples on it instead."""
CAMERA = 16
"""Origin (of an orthographic camera as ``window`` moves it), right, up, back, half height, orthographic, width, height:
16."""
WIDTH, HEIGHT = CAMERA + 14, CAMERA + 15
FADE = 32
"""Sine of the angle to an endless floor below which it fades into the backdrop: a horizon without an edge."""
BELOW = 33
"""What `visible` becomes below the horizon, by the same angle: 3."""
LIGHTS = 36
"""Offset of the first light."""
LIGHT = 9
"""Reals of a light: kind, direction to it or position, irradiance or intensity, angular diameter or radius; radius of
its disk, of a sun at distance 1."""
SUN, POINT = range(2)
BOX = 14
"""Reals of a soft box, behind the lights: direction to it, unit vectors across and up in it, half width and half height
at distance 1, radiance."""

COLOR, ROUGHNESS, METALLIC, SPECULAR, TRANSMISSION = 0, 3, 4, 5, 6
INDEX, EMISSION, CHECKER, CHECKER_COLOR = 7, 8, 11, 12
TEXTURE, SURFACE_SIZE = 15, 16
"""Offsets in the reals of a surface, and their number. TEXTURE: place in the ints of the ranges of a tape by places of
the material, as those of an implicit object's paint; 0 for none."""

EMPTY, MIXED, FULL, UNKNOWN = range(4)
"""An occupancy cell: proved outside, undecided, proved inside; not looked at, since no ray has come to it yet."""

ITEM_OF = 1
"""In the rows of a thread's scratch for shapes: a column, of the item of one that packets know."""
TOLD = 1
KNOWN, PROBING, REACHED, BEYOND = 1.0, 2.0, 3.0, 4.0
"""In the last row of a thread's scratch (scene_kernels.SCRATCH): a column, and its values."""
WIDE_RADIUS, WIDE_SPREAD, WIDE_FROM = 2, 3, 4
"""In the same row: the cone of a camera's ray, and the distance up to which it is through with thin capsules; all
are 0 for other rays, the first two also for one that has met its MOST_LINES capsules as wide as its cone."""
LOST = 5
"""In the rows for shapes: a column, how many rays have ended after many undecided places in one since the band of rows
was begun, and how many were given up after MOST_LOST of these."""
MOST_LOST = 4
"""Of these in a band: from then on what only the certified search could decide of that shape is undecided at once,
since each takes some 0.1 s. So the time of a frame is bounded, whatever its formulas, and a sound one beside is
searched all the same; bands do not depend on the number of threads."""
FAR, WANT, REST_AT, REST_ITEM, REST_LIGHT, ANSWERS = range(6, 12)
FIRST, ANYWHERE, NOTHING = range(3)
"""Want of a ray: the first hit, any hit, or none, for a ray that misses all boxes."""
WALKED = -2.0
"""In place of the REST_ITEM of a ray that meets boxes of sheets or grids: only a walk tells what it hits."""
MODE, NEXT, OPEN, WAYS, ALONE = range(5)
PLAIN, ASKING, TELLING, ENDING = range(4)
"""In the head of a list of rays (scene_kernels.ASKED): columns, and the values of MODE."""
