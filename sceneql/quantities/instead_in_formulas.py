"""Sentences on formulas, and on parts by other names: what to write instead of functions, signs, units and words.

For messages alone.
"""

from __future__ import annotations

_COLOR = 'write three numbers from 0 to 1, `[1, 0.5, 0]`, a CSS name, `tomato`, or `"#ff8000"`'
_AND = "for 'and' multiply: `(a > b)*(c > d)`"
_OR = "for 'or' write `max(a > b, c > d)`"
IF = "write `where(condition, a, b)`"
REPEAT = "write `repeat: {count: 5, as: i}` beside the word, `{repeat: {...}, sphere: {...}}`: `sceneql words repeat`"

OF_FORMULAS = (
    ("behind", "px pixel pixels pt", "letters are as high as a part of the picture: `size: 0.05`"),
    ("function", "if switch select", IF),
    (
        "function",
        "vec vec2 vec3 vec4 vector vector3 pvector createvector point float3 array tuple xyz",
        "write `[x, y, z]`, or numbers with one unit behind them, `0 1.2 0 m`",
    ),
    ("function", "rgb rgba color colour", _COLOR),
    ("function", "hsv hsl hsva hsv2rgb", f"write `hue(h)`, h from 0 to 1, for a full color; else {_COLOR}"),
    (
        "function",
        "deg degrees rad radians deg2rad rad2deg",
        "an angle has its unit: write `30 deg`, or `x*(1 deg)`",
    ),
    ("function name", "gaussian gauss gaussian2d", "write `exp(-((x - 0.5)^2 + (y - 0.5)^2)/0.1^2)`"),
    ("function", "pow power", "write `a^b`"),
    (
        "function",
        "map remap map_range maprange linmap rescale",
        "from `a` to `b` while x goes from low to high: write `mix(a, b, clamp((x - low)/(high - low), 0, 1))`",
    ),
    (
        "function",
        "millis second seconds clock gettime get_time performance.now frame frames",
        "the time is `time`, in s: `time/(1 s)` is a plain number",
    ),
    ("function", "range linspace arange", REPEAT),
    (
        "function",
        "laplacian laplace lap del2 nabla grad gradient div divergence curl diff ddx ddy dx dy partial",
        "it is there without it: what spreads has its `coefficient: 2e-5`, and what is carried a `drift`; a rate is the"
        " rest",
    ),
    (
        "function",
        "d ddt dt derivative deriv diff integral integrate",
        "there is none: velocities are outputs, `fall.velocity`, and states of an `equations` model have a `rate`",
    ),
    (
        "function",
        "energy kinetic potential momentum velocity position speed height mass volume temperature",
        "a value is named with its part: write `fall.energy`, `ball.position.y`",
    ),
    ("function", "sind cosd tand", "an angle has its unit: write `sin(30 deg)`, or `sin(x*(1 deg))`"),
    ("name", "up upward upwards", "upwards is `0 1 0`"),
    ("name", "down downward downwards", "downwards is `0 -1 0`"),
    ("name", "left right", "to the right is `1 0 0`, to the left `-1 0 0`"),
    ("name", "forward forwards backward backwards", "away from the usual camera is `0 0 -1`, towards it `0 0 1`"),
    (
        "name",
        "random",
        "`fill: {object: NAME, count: 100}` scatters masses in an object; in a formula write `random(1)`",
    ),
    ("sign", "±", "how far it may be off stands apart: `value: 2 m, tolerance: 1 cm`"),
    ("sign", ":", "a time is in seconds or minutes, `90 s`, `1.5 min`"),
    ("name", "required mandatory", "a field that has to be given is left empty: `fields: {height: }`"),
    ("function", "sqr square", "write `x^2`"),
    ("function", "frac fract", "write `mod(x, 1)`"),
    ("function", "cbrt", "write `x^(1/3)`"),
    ("function", "log2", "write `log(x)/log(2)`"),
    ("function", "log", "write `log(x)/log(b)` for another base"),
    ("function", "atan", "write `atan2(y, x)`"),
    ("function", "noise", "write `noise([x, y])`, `noise([x, y, z])`"),
    (
        "function",
        "random",
        "write `random(1)`, `random(2)`, ...: each is a number from 0 to 1, the same in every run",
    ),
    (
        "before",
        "lambda def function fn return new let var const",
        "write the formula alone: `[1 m/s*time, 0 m, 0 m]`; the time is `time`",
    ),
    ("function name behind", "and", _AND),
    ("function name behind", "or", _OR),
    ("function name", "not", "write `1 - (a > b)`"),
    ("sign", "&", _AND),
    ("sign", "|", _OR),
    ("sign", "?", IF),
    (
        "sign",
        "$",
        "a name stands by itself: write `n`, or `n*(1 cm)` where it is a plain number; the time is `time`",
    ),
    ("sign", "=", "write `==` to compare; the surface where f = c is that of the formula `f - c`"),
    ("sign", "!", "write `where(a == b, 0, 1)` for a difference, `1 - (a > b)` for 'not'"),
    ("sign", "%", "write `mod(a, b)`"),
    ("sign", "//", "a comment begins with `#`, behind a space; a whole quotient is `floor(a/b)`"),
    ("sign", "× ·", "write `*`"),
    ("sign", "−", "write `-`"),
    ("sign", "²", "write `^2`"),
    ("sign", "³", "write `^3`"),
    ("sign", "°", "write `deg`"),
    ("sign", "“ ” „ « »", 'write straight quotes, `"`'),
    ("sign", "‘ ’ ‚", "write straight quotes, `'`"),
    ("sign", ";", "leave it out: the end of the line, or in braces a comma, ends a value"),
    (
        "sign",
        "{ }",
        "a name stands by itself, `radius: r`; only the number of a copy by `repeat` stands in braces, in a name,"
        ' `"ball.{i}.position"`: `sceneql words repeat`',
    ),
    ("unit", "G Gs gauss Gauss", "a gauss is 1e-4 T: 500 G are `0.05 T`"),
    ("unit", "lines contours levels copies segments stars samples", "a number of them has no unit: write it alone"),
    ("unit", "degrees degree", "an angle is in `deg`, a temperature in `°C`"),
    ("unit", "particles particle balls items pieces times", "what is counted has no unit: write `100 /s`"),
    (
        "unit",
        "fps frames frame",
        "a number of frames has no unit: `clock: {fps: 30}`; in a formula it is `30 Hz*time`",
    ),
    (
        "unit name",
        "framecount frame_count frame_current frame_number framenumber iframe",
        "frames are counted by the time: write `30 Hz*time`, where 30 is the `fps` of the clock",
    ),
    (
        "unit name",
        "deltatime delta_time dt",
        "a formula says what is at the `time`, and no step: `1 m/s*time`, in place of what is added in each frame",
    ),
    (
        "name",
        "constant conserved const unchanged",
        "what keeps its value is compared with its start: `of: final(fall.energy), value: at(fall.energy, 0 s)`",
    ),
    ("name", "about", "an axis is a field: `rotation: {about: z, angle: 30 deg}`"),
    ("name", "water", "water has a density of `1000 kg/m^3`, and a viscosity of `1e-3 Pa*s`"),
    ("name", "steel iron", "steel has a density of `7850 kg/m^3`, iron `7870 kg/m^3`"),
    ("name", "wood ice", "wood has a density of about `600 kg/m^3`, ice `917 kg/m^3`"),
    (
        "name",
        "aluminium aluminum concrete stone rock",
        "aluminium has a density of `2700 kg/m^3`, concrete `2400 kg/m^3`",
    ),
    (
        "name",
        "gold silver lead copper",
        "gold has a density of `19300 kg/m^3`, lead `11340 kg/m^3`, copper `8960 kg/m^3`",
    ),
    ("name", "rubber plastic", "rubber has a density of `1100 kg/m^3`, plastic about `1000 kg/m^3`"),
    ("name", "air", "air has a density of `1.2 kg/m^3`, and a viscosity of `1.8e-5 Pa*s`"),
    (
        "unit",
        "lm lumen lumens cd candela lx lux",
        "a lamp has its power in W, as a bulb does: one of 800 lm is `60 W`, one of 1600 lm `100 W`",
    ),
    ("unit", "e electron electrons elementary_charge", "the charge of a proton is `1.602e-19 C`"),
    ("unit name", "micron microns micrometer micrometers", "a micron is `1 um`"),
    ("unit name", "cc ccm", "a cc is a cubic centimeter: write `g/cm^3`"),
    ("unit name", "cp cps centipoise poise", "a poise is `0.1 Pa*s`, a hundredth of it `1e-3 Pa*s`"),
    ("name", "G", "write `6.6743e-11 m^3/(kg*s^2)`, or define it so: `define: {G: 6.6743e-11 m^3/(kg*s^2)}`"),
    ("sign", "~", "leave the field out"),
    ("sign", "'", "a foot is `ft`, an inch `inch`: `2 3 1 ft`"),
    ("sign", '"', "an inch is `inch`, a foot `ft`: `4 2 1 inch`"),
    (
        "unit name",
        "solar_mass solar_masses solarmass msun m_sun sun_mass",
        "the sun has `1.989e30 kg`, the earth `5.972e24 kg`, the moon `7.35e22 kg`",
    ),
    (
        "unit name",
        "earth_mass earth_masses mearth m_earth earth_radius earth_radii",
        "the earth has `5.972e24 kg`, and a radius of `6371 km`",
    ),
    ("name", "frame frames", "frame 12 of 30 a second is at `0.4 s`: a key stands at that, and a formula has `time`"),
    (
        "digits",
        "one two three four five six seven eight nine ten twelve twenty half hundred thousand",
        "write a number in digits, and its unit behind it: `2 m`",
    ),
    ("name", "t", "the time is written 'time'"),
    ("name behind", "if then else elif when", f"{IF}: `sceneql words functions`"),
    (
        "name",
        "x y z",
        "an axis is `1 0 0`, `0 1 0` or `0 0 1`; the coordinates of a place stand in formulas of fields alone",
    ),
    ("name behind", "to until", "from when to when is two conditions: `(time > 1 s)*(time < 2 s)`"),
    ("name", "clock", "the time is `time`"),
    ("name", "end start", "write the time itself, as `4 s`"),
    ("name unit", "per", "write `10 /s`, or `5 m/s`"),
    ("name", "null none nil undefined nan", "leave the field out"),
    ("name", "inf infinity", "what never moves is `fixed: yes`; what has no limit is left out"),
    ("name", "true yes", "in a formula write `1`"),
    ("name", "false no", "in a formula write `0`"),
    (
        "name",
        "i index id",
        "copies have numbers, where `repeat: {count: 5, as: i}` makes them: `sceneql words repeat`",
    ),
    ("negative", "strength", "leave out the minus: what pulls down, as gravity, points there by itself"),
    ("zero", "mass", "what never moves is an object without a model, or a body or mass with `fixed: yes`"),
)
"""(what the words were taken for, the words, the sentence)."""

OF_NAMED = (
    (
        "field.solvers",
        "tolerance rtol atol tol",
        "its steps have one length, `step: 1 ms`; by a tolerance goes `{dopri5: {tolerance: 1e-6}}`",
    ),
    (
        "field.cloth",
        "self_collision selfcollision self_collisions self_collide self_contact",
        "what touches itself is a contact: write `contacts: [mutual_collision]`",
    ),
    (
        "field.mass_spring field.cloth",
        "young youngs_modulus young_modulus modulus elastic_modulus E",
        "it has springs, each with a `stiffness`: of a rod it is modulus times area over length, `100 N/m`",
    ),
    (
        "field.boundary",
        "absorbing absorb radiating nonreflecting transparent",
        "waves go out through it by `open: yes`",
    ),
    ("field.arrow", "along", "what it shows is its `vector: ball.velocity`"),
    ("field.arrow", "length size factor", "it is its vector times `scale`, in meters: of a velocity `scale: 0.1`"),
    (
        "field.emit",
        "size diameter width scale",
        "they have one size, beside `emit`: half of it is their `radius: 1 cm`",
    ),
    (
        "field.hinge",
        "motor_speed motorspeed target_velocity",
        "a motor has the speed: write `motor: {torque: 10 N*m, speed: 3 rad/s}`",
    ),
    (
        "field.perspective field.orthographic field.turntable",
        "aspect aspect_ratio ratio width height resolution",
        "the picture has it: leave it out here, and write `outputs: {film: {video: {size: 1280 720}}}`",
    ),
    (
        "field.flow",
        "re reynolds reynolds_number",
        "a flow has its viscosity, density times speed times length over the Reynolds number: of 100, at 1 m/s and 1 m,"
        " `viscosity: 1000 kg/m^3*1 m/s*1 m/100`",
    ),
    (
        "field.flow",
        "lid_velocity lidvelocity lid top_velocity wall_velocity",
        'a lid is a wall that moves: write `boundary: {top: {wall: {velocity: "[1, 0]"}}}`',
    ),
    ("cameras", "isometric iso axonometric", "write `{orthographic: {look_along: -1 -0.8 -1}}`"),
    (
        "cameras",
        "top front side left right above",
        "write `{orthographic: {look_along: 0 -1 0}}` from above, `0 0 -1` from the front, `-1 0 0` from the right",
    ),
    (
        "forces",
        "buoyancy archimedes lift",
        "of a body write how it is pushed up by place, `{force: {components: [0, where(y < 0, 1000, 0), 0]}}`; a `flow`"
        " has its `buoyancy`",
    ),
    (
        "forces",
        "lennard_jones lennardjones lj van_der_waals morse cohesion attraction",
        "between all masses there are `mutual_gravity`, which draws them together, `repulsion` and `electrostatic`",
    ),
    (
        "forces",
        "magnet magnetism lorentz",
        "write `{magnetic: {field: 0 0 1 T, charge: 1 C}}`: `sceneql words magnetic`",
    ),
    (
        "models",
        "sph smoke fire gas fluid_particles flip mpm",
        "a fluid is a `flow`, smoke a `diffusion` with `drift: {by: FLOW}`, and sparks and drops are `particles` with"
        " `emit`",
    ),
    (
        "objects",
        "heightfield height_field heightmap terrain landscape elevation_grid elevationgrid",
        "a height above x and z is a formula: write `{implicit: {field: y - 0.3*sin(x)*cos(z), bounds: {box: [-3 -1 -3,"
        " 3 1 3]}}}`",
    ),
    (
        "objects",
        "points point_cloud pointcloud dots scatter markers",
        "soft dots stand at points: write `{sprites: {at: <points|[0 0 0 m, 1 0 0 m]>}}`; a solid of balls that melt"
        " together is a `blobby`",
    ),
    ("collider", "ground", "what masses touch is the `floor`: write `between: [ball, floor]`"),
    (
        "overlays",
        "timer clock time stopwatch counter timestamp",
        'a caption tells the time: `{caption: {text: "t = {time:.1f s}"}}`',
    ),
    (
        "overlays",
        "axes axis grid ruler scale_bar scalebar compass gizmo",
        "there is none: arrows and tubes among the `objects` show axes, `{arrow: {vector: 1 0 0 m}}`",
    ),
    (
        "materials",
        "image texture bitmap photo picture map",
        "no picture is read here: write a color, or `checker`, or a color that is a formula of x, y, z",
    ),
    (
        "models",
        "skeleton bones bone armature rig ik inverse_kinematics kinematics chain_ik character puppet",
        "limbs are joints that turn, and objects hang on them: write `{joints: {joints: {shoulder: {at: 0 1 0 m, turn:"
        ' {about: z, angle: "40 deg*sin(2 rad/s*time)"}}, elbow: {of: shoulder, at: 0.5 0 0 m}}}}`; there is no inverse'
        " kinematics: angles are told",
    ),
    (
        "models",
        "rope chain string cord thread wire cable",
        "write `{mass_spring: {rope: {count: <count|20>, from: <from|0 2 0 m>, to: <to|1 2 0 m>}, mass: 10 g,"
        " stiffness: <stiffness|1 kN/m>, pins: [start]}}`, or bodies on ties: `sceneql words rod`",
    ),
    (
        "models",
        "net trampoline sail flag curtain tablecloth towel blanket",
        "write `{cloth: {size: <size|2 2 m>, pins: [top]}}`",
    ),
    (
        "models",
        "soft_body softbody soft jelly jello gel rubber_ball deformable_body",
        "write `{elastic: {of: <of|ball>, law: {neo_hookean: {modulus: <modulus|10 kPa>, poisson: <poisson|0.45>}}}}`,"
        " of an object",
    ),
    (
        "models",
        "balloon bubble skin cell_membrane",
        "write `{membrane: {of: <of|ball>, law: {tension: 1 N/m}}}`, a skin in a `flow`: `sceneql words membrane`",
    ),
    (
        "models",
        "spring oscillator harmonic_oscillator spring_mass",
        "write `{mass_spring: {masses: {hook: {position: 0 2 0 m, fixed: yes}, bob: {position: 0 1 0 m, mass: 1 kg}},"
        " springs: [{between: [hook, bob], rest: 0.8 m, stiffness: 40 N/m}]}}`",
    ),
    (
        "models",
        "pendulum simple_pendulum",
        "write `{equations: {start: {theta: 1, omega: 0}, rate: {theta: omega, omega: -9.81*sin(theta)}}}`; or a body"
        " hangs on a tie: `sceneql words hinge`",
    ),
    (
        "models",
        "double_pendulum",
        "two bodies hang on two ties: `{hinge: {between: [upper, world], at: 0 2 0 m, axis: 0 0 1}}` and `{hinge:"
        " {between: [upper, lower], at: 0 1 0 m, axis: 0 0 1}}`; or their equations are a model: `sceneql words"
        " equations`",
    ),
)
"""(what the words were taken for, the words, the sentence)."""
