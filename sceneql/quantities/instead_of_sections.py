"""Sentences on sections, models, and the fields of single words and groups: what to write instead of other programs'.

For messages alone.
"""

from __future__ import annotations

from sceneql.quantities.instead_in_formulas import IF, REPEAT

_VARIED = (
    "what is varied stands under `sweep`, by its path: `sweep: {define.dt: [1 ms, 2 ms]}`: `sceneql words studies`"
)

OF_SECTIONS = (
    # fields of single words and groups
    (
        "field.solvers",
        "timestep time_step dt step",
        "its steps are its own; those that are given are taken by `{rk4: {step: 1 ms}}`, and others of fixed steps",
    ),
    (
        "field.trail field.tube field.coil field.streamlines field.arrow",
        "width thickness line_width linewidth stroke",
        "half of how thick it is is its `radius: 1 cm`",
    ),
    ("field.galaxy", "mass masses", "its masses are `heart`, in the middle, and `disk`, around it"),
    (
        "field.gravity",
        "planet body world place",
        "on the moon it is `strength: 1.62 m/s^2`, on Mars `strength: 3.72 m/s^2`",
    ),
    (
        "field.sun",
        "time date hour latitude longitude daytime",
        "write how high it stands and where, `elevation: 50 deg, azimuth: 30 deg`",
    ),
    (
        "field.perspective",
        "aperture focus_distance focus fstop f_stop depth_of_field dof blur focal_distance bokeh",
        "all is sharp: leave it out",
    ),
    (
        "bare.law",
        "steel iron metal aluminium aluminum copper",
        "steel is `{linear: {modulus: 200 GPa, poisson: 0.3}}`, aluminium has 70 GPa",
    ),
    ("bare.law", "rubber elastomer silicone", "rubber is `{neo_hookean: {modulus: 1 MPa, poisson: 0.49}}`"),
    ("bare.law", "jelly gel soft foam flesh", "jelly is `{neo_hookean: {modulus: 10 kPa, poisson: 0.45}}`"),
    ("bare.law", "wood plastic stiff", "wood is `{linear: {modulus: 10 GPa, poisson: 0.3}}`"),
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
    ("field.gear", "ratio gear_ratio transmission", "its teeth say it: a ratio of 2 is `teeth: 40 20`"),
    (
        "field.streamlines",
        "count number n density spacing seeds",
        "how far they are `apart` says how many there are: `apart: 5 cm`",
    ),
    (
        "field.rigid",
        "type body_type kind",
        "what stands still is `fixed: yes`, and what moves needs no more than `of`",
    ),
    (
        "field.video field.images",
        "from to begin start_time end_time t0 t1 range",
        "a film shows the clock from 0 s to its end: `clock: {end: 3 s}`",
    ),
    (
        "field.torus field.sphere field.cylinder",
        "arc sweep sector theta phi start_angle end_angle angle half",
        "it is whole: `intersection` or `difference` with a box cuts it, `{difference: {of: [ring, box]}}`",
    ),
    (
        "field.outline",
        "sides radius n corners regular",
        "it has its corners by hand, a hexagon `points: [[1, 0], [0.5, 0.87], [-0.5, 0.87], [-1, 0], [-0.5, -0.87],"
        " [0.5, -0.87]]`",
    ),
    (
        "field.graph",
        "xlim x_range xrange xmin xmax x_limits",
        "the `range` is that of y; x goes as far as its values do",
    ),
    ("field.graph", "linewidth line_width width linestyle style marker grid", "lines have one look: leave it out"),
    (
        "field.wind",
        "direction strength speed force power amount",
        "its `velocity: 5 0 0 m/s` says how fast it is, and where to",
    ),
    (
        "field.point",
        "target angle cone penumbra direction spread look_at beam distance decay falloff attenuation",
        "a lamp shines all around, and less with the square of the distance: leave it out",
    ),
    (
        "field.shots",
        "from to start end duration length time",
        "a shot lasts `until: 1 s`, and begins where the one before it ends",
    ),
    (
        "field.diffusion",
        "density heat_capacity specific_heat capacity rho cp c conductivity k kappa lambda",
        "of a solid only its diffusivity counts, the conductivity over density and heat capacity: `coefficient: 400"
        " W/(m*K)/(8960 kg/m^3*385 J/(kg*K))`",
    ),
    ("field.studies", "dt step k n h m values range points", _VARIED),
    (
        "field.emit",
        "direction angle dir toward towards",
        "what is born flies by its `velocity: 0 3 0 m/s`, and by `spread: 10 deg` around that",
    ),
    (
        "field.perspective",
        "offset camera_offset",
        "its place as seen from what it follows is `from: 0 1 4 m`",
    ),
    (
        "field.perspective field.orthographic field.turntable",
        "path waypoints points trajectory curve dolly",
        "a camera moves by its position: `position: {keys: {0 s: 0 1 4 m, 4 s: 3 1 4 m}}`: `sceneql words keys`",
    ),
    (
        "field.caption field.formula field.legend field.labels",
        "x y left top right bottom offset margin",
        "it stands at a side, `place: top left`; a caption also at a place of the scene, `at: 0 1 0 m`",
    ),
    (
        "field.caption field.formula field.legend field.labels field.graph",
        "fontsize font_size textsize text_size letter_size px",
        "letters are as high as a part of the picture: `size: 0.05`",
    ),
    (
        "field.caption",
        "color colour fill",
        "letters are white or black by what is behind them; `dark: yes` says which",
    ),
    (
        "field.wave",
        "tension density stiffness modulus mass",
        "waves have the `speed` sqrt(tension/density): `speed: 1 m/s`",
    ),
    (
        "field.wave",
        "frequency wavelength amplitude omega period",
        "what swings at the start is `initial: 0.1*sin(2*pi*x/0.5)`, and `source: 5*sin(2*pi*3*t)` goes on swinging",
    ),
    (
        "field.layout",
        "rows row grid cols panels cameras",
        "a layout is a list of rows of names, `layout: [[front, height], [top]]`: `sceneql words layout`",
    ),
    (
        "field.objects",
        "motion movement",
        "an object moves by keys, by a formula, `position: [1 m/s*time, 0 m, 0 m]`, or by a model, `models: {fall:"
        " {particles: {of: NAME}}}`",
    ),
    (
        "field.boundary",
        "type kind bc condition",
        "what it has says so: `{value: 0}`, `{flux: 5}`, of a flow `{wall: {}}`, `{outflow: {}}`: nothing more is said",
    ),
    (
        "bare.wall",
        "no_slip noslip no-slip stick wall solid closed fixed",
        "so it is where nothing is said: leave it out",
    ),
    ("bare.wall", "slip free_slip freeslip free-slip free symmetry frictionless", "write `{wall: {slip: free}}`"),
    ("bare.wall", "open outlet out exit", "write `{outflow: {}}`"),
    ("bare.wall", "inlet in source", 'write `{inflow: {velocity: "[1, 0]"}}`'),
    (
        "bare.wall bare bare.boundary",
        "periodic cyclic wrap wraparound",
        "write `{left: {periodic: yes}}`, which is right too",
    ),
    ("bare", "open absorbing outgoing radiating", "write `{open: yes}`"),
    ("bare.boundary", "fixed clamped dirichlet held closed zero", "all sides are `rest`: write `{rest: {value: 0}}`"),
    ("bare.boundary", "open absorbing outgoing radiating outflow", "all sides are `rest`: write `{rest: {open: yes}}`"),
    (
        "bare.boundary",
        "free neumann insulated adiabatic reflecting noflux no_flux no_slip noslip walls wall",
        "so it is where nothing is said: leave it out",
    ),
    (
        "objects",
        "cone pyramid frustum",
        "a cone is a cylinder that is tapered, `{taper: {of: {cylinder: {height: 2 m}}, factor: 0.1}}`",
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
    ("field.implicit", "box", "write `bounds: {box: [-1 -1 -1, 1 1 1]}`, the low and the high corner"),
    ("field.implicit", "ball sphere", "write `bounds: {ball: 1.5}`, the radius about the origin"),
    ("field.joints", "parent base link relative_to", "write `{of: <parent|shoulder>}`"),
    ("field.images field.image", "format type extension ext", "pictures are PNG files: leave it out"),
    ("field.video", "format type extension ext", "films are MP4 files: leave it out"),
    (
        "field.images field.image field.video field.record",
        "name filename prefix basename output out",
        "a file has the entry's name, as `film.mp4` or `frames.0000.png`; `sceneql render SCENE -o FILE` gives another",
    ),
    ("field.glass", "transmission transparency opacity alpha transmissive", "glass is clear by itself: leave it out"),
    # sections
    ("section", "seed", "write `clock: {seed: 5}`"),
    (
        "section",
        "setup draw update loop main start animate init render_loop",
        "a script says what there is and how it moves, not what is done in each frame: values may be formulas of"
        " `time`, models move objects; `sceneql words sections` shows a whole script",
    ),
    (
        "section",
        "import from require",
        "functions are there without it, `sceneql words functions`; `include: more.yaml` takes in a script",
    ),
    ("section", "for while foreach", REPEAT),
    ("section", "if switch", f"there is no `if` around parts; in a value {IF}"),
    (
        "section",
        "def class fn",
        "a piece with fields of its own is a template: `sceneql words templates`",
    ),
    (
        "section",
        "let var const float int double",
        "values have names under `define`, `define: {r: 1 m}`: `sceneql words define`",
    ),
    (
        "section",
        "option options physics_options compiler settings config space physics_world",
        "write `clock: {end: 4 s}`, `solvers: {main: {rk4: {step: 2 ms}}}`, `forces: [gravity]`:"
        " `sceneql words sections`",
    ),
    ("section", "timestep time_step dt step", "a solver has the step: `solvers: {main: {rk4: {step: 1 ms}}}`"),
    (
        "section",
        "worldbody body geom geoms",
        "write `objects: {ball: {sphere: {radius: 0.1 m}}}`, and what moves in `models`: `sceneql words sections`",
    ),
    ("section", "actuator actuators motor motors", "a tie has it, `hinge: {..., motor: {...}}`: `sceneql words hinge`"),
    (
        "section",
        "sensor sensors",
        "`outputs: {data: {record: {values: {height: ball.position.y}}}}`: `sceneql words record`",
    ),
    (
        "section",
        "asset assets",
        "a file is named where it is used: `{mesh: {file: cow.obj}}`; materials stand in `materials`",
    ),
    (
        "section",
        "light sun lamp",
        "write `lights: {lamp: {sun: {elevation: 45 deg}}}`: `sceneql words sun`",
    ),
    ("section", "camera", "write `cameras: {main: {perspective: {position: 0 2 5 m, look_at: 0 1 0 m}}}`"),
    (
        "section",
        "joints hinges constraints constraint",
        "write `ties: {name: {hinge: {between: [model.a, model.b], at: 0 0 0 m}}}`: `sceneql words hinge`",
    ),
    (
        "section",
        "keyframes keyframe keys animation animations animate tween fcurves actions",
        "a value that changes has its keys where it stands, `position: {keys: {0 s: 0 0 0 m, 1 s: 0 1 0 m}}`:"
        " `sceneql words keys`",
    ),
    ("section", "gravity", "write `forces: [gravity]`, or `forces: [{gravity: {strength: 9.81 m/s^2}}]`"),
    ("section", "collision contact", "write `forces: [gravity, collision]`"),
    ("section", "duration end length stop time", "write `clock: {end: 5 s}`: `sceneql words clock`"),
    ("section", "fps framerate frame_rate", "write `clock: {fps: 30}`: `sceneql words clock`"),
    ("section", "resolution size width height", "write `outputs: {film: {video: {size: 720p}}}`"),
    (
        "section",
        "render rendering renderer camera_settings scene_settings",
        "write `outputs: {film: {video: {size: 1080p}}}`",
    ),
    ("section", "world environment", "write `background: black`, or `lights: {sky: sky}`; parts stand in sections"),
    ("section", "sky_sphere skybox sky", "write `lights: {sky: sky}`, or `background: skyblue`"),
    ("section", "fog", "there is no fog over a scene; `mist` draws a field that fills a space: `sceneql words mist`"),
    (
        "section",
        "controls orbitcontrols mouse",
        "a film has no mouse: a camera goes round by `cameras: {c: turntable}`",
    ),
    (
        "section",
        "route routes connect connections",
        "a field takes a value of another part by its name, `position: swing.bob.position`: `sceneql words links`",
    ),
    ("section", "scene root project", "the sections stand by themselves, with no key around them"),
    ("section", "floor", "write `objects: {floor: plane}`"),
    ("section", "sphere box plane", "write `objects: {name: {sphere: {radius: 1 m}}}`: `sceneql words sections`"),
)
"""(what the words were taken for, the words, the sentence)."""

OF_MODELS = (
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
        "write `{elastic: {of: <of|ball>, law: {neo_hookean: {modulus: 10 kPa, poisson: 0.45}}}}`, of an object",
    ),
    (
        "models",
        "balloon bubble skin cell_membrane",
        "write `{membrane: {of: <of|ball>, law: {tension: 1 N/m}}}`, a skin in a `flow`: `sceneql words membrane`",
    ),
    (
        "models",
        "dust sparks sparkles snow rain fireworks",
        "write `{particles: {emit: {rate: 100 /s, velocity: 0 3 0 m/s, lifetime: 2 s}}}`",
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
