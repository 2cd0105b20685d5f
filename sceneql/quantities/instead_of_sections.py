"""Sentences on sections, and on the fields of single words and groups: what to write instead of other programs'.

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
        "field.trail field.tube field.streamlines field.arrow",
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
    (
        "field.blobby",
        "position pos location center centre",
        "all balls are points of one part: `points: [0 1 0 m, 0.5 1 0 m]`",
    ),
    (
        "field.cloth field.mass_spring",
        "colliders collider collides_with collide collide_with collision collisions",
        "what it touches is a contact: write `contacts: [collision]`, which is with all solids",
    ),
    (
        "place.flow",
        "density",
        "a flow has one density; of warm or salty fluid that it carries some is lighter by its `buoyancy`: `buoyancy:"
        " {by: heat.temperature, expansion: 3.4e-3 1/K, reference: 300 K}`",
    ),
    (
        "field.cloth",
        "density area_density surface_density weight grammage",
        "its mass is that of a square meter: `mass: 0.2 kg/m^2`",
    ),
    ("field.clock", "start begin t0 from", "time begins at 0 s: leave it out"),
    (
        "field.particles",
        "grid lattice rows columns nx ny nz",
        "on a grid stand those that fill an object: `fill: {object: {box: {size: 1 1 1 m, hidden: yes}}, spacing: 10"
        " cm}`",
    ),
    ("field.membrane", "flow fluid in", "it is in the flow around it: leave it out"),
    (
        "field.elastic",
        "resolution cells divisions n subdivisions segments",
        "how far its nodes are apart says how many there are: `spacing: 5 cm`",
    ),
    (
        "field.turbulence",
        "strength amplitude intensity amount magnitude power",
        "how fast it blows is its `speed: 2 m/s`",
    ),
    ("field.turbulence", "scale frequency noise_scale wavelength", "how large its eddies are is their `size: 0.5 m`"),
    (
        "place.iso_surface",
        "of",
        "the surface of a formula is `implicit`, where that is 0: write `{implicit: {field: x^2 + y^2 + z^2 - 1}}`",
    ),
    ("field.cloth", "orientation plane horizontal flat", "it hangs upright; flat it lies by `facing: 0 1 0`"),
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
        "from to start end time",
        "a shot goes `until: 1 s` of the film, and begins where the one before it ends",
    ),
    (
        "field.shots",
        "duration length lasts seconds",
        "a shot ends at its `until`, a time of the film, and begins where the one before ends: add up what they last",
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
    ("field.implicit", "box", "write `bounds: {box: [-1 -1 -1, 1 1 1]}`, the low and the high corner"),
    ("field.implicit", "ball sphere", "write `bounds: {ball: 1.5}`, the radius about the origin"),
    ("field.coil", "thickness width wire_radius line_width", "half of how thick the wire is is `wire: 1 cm`"),
    (
        "field.coil",
        "pitch height length",
        "it reaches from end to end, and has so many turns: `from: 0 0 0 m, to: 0 1 0 m, turns: 5`",
    ),
    (
        "field.surface",
        "z y x height function formula f field",
        "a height above x and z is a formula, `{implicit: {field: y - 0.3*sin(x)*cos(z), bounds: {box: [-3 -1 -3, 3 1"
        " 3]}}}`",
    ),
    (
        "field.mesh",
        "vertices points faces triangles indices",
        "a file has them, `{mesh: {file: cow.obj}}`; a cage of a few is the `points` of a `blobby`",
    ),
    ("field.mirror", "roughness smoothness", "a mirror is wholly smooth: leave it out; `metal` has a `roughness`"),
    ("field.turntable", "elevation pitch height_angle", "how far it looks down is its `tilt: 20 deg`"),
    (
        "field.particles",
        "region box bounds volume domain area",
        "masses fill an object: `fill: {object: NAME, count: 1000}`",
    ),
    (
        "field.spring",
        "x0 center origin anchor point equilibrium",
        "it pulls two places together: `from: 0 0 0 m`, and the mass's, `to: fall.position`",
    ),
    (
        "field.reaction_diffusion",
        "du dv f k d_u d_v da db",
        "each field has its spread and its rate: `species: {u: {coefficient: 2e-5, initial: 1, rate: -u*v^2 + 0.04*(1 -"
        " u)}, v: {coefficient: 1e-5, initial: 0, rate: u*v^2 - 0.1*v}}`",
    ),
    (
        "field.outline",
        "depth height extrude thickness_z",
        "it is flat; a body comes in a file, `{mesh: {file: part.stl}}`, or is made by `union` and `intersection`",
    ),
    (
        "field.objects",
        "emission emissive emit luminance",
        "what shines is a material: `material: {glow: {color: orange, strength: 5}}`",
    ),
    (
        "field.diffusion",
        "velocity flow advection wind carried_by",
        "what carries it is its drift, by the flow's name: `drift: {by: air}`",
    ),
    (
        "field.collision",
        "stiffness damping k kn kp kd c penalty spring erp cfm solref solimp",
        "contacts are hard: `restitution: 0.5` says how much of the speed comes back, and nothing gives way",
    ),
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
        "requestanimationframe game_loop gameloop setup draw update loop main start animate init render_loop",
        "a script says what there is and how it moves, not what is done in each frame: values may be formulas of"
        " `time`, models move objects; `sceneql words sections` shows a whole script",
    ),
    (
        "section",
        "import from require",
        "functions are there without it, `sceneql words functions`; `include: more.yaml` takes in a script",
    ),
    ("section", "for while foreach", REPEAT),
    (
        "section",
        "print printf console.log echo disp puts",
        "text stands in a caption, `overlays: {title: {caption: {text: hello}}}`: `sceneql words caption`",
    ),
    ("section", "layout", "write `outputs: {film: {video: {layout: [{each: variant}]}}}`: `sceneql words layout`"),
    ("section", "if switch", f"there is no `if` around parts; in a value {IF}"),
    (
        "section",
        "def class fn function",
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
        "joint hinge joints hinges constraints constraint",
        "write `ties: {name: {hinge: {between: [model.a, model.b], at: 0 0 0 m}}}`: `sceneql words hinge`",
    ),
    (
        "section",
        "keyframes keyframe keys animation animations animate tween fcurves actions",
        "a value that changes has its keys where it stands, `position: {keys: {0 s: 0 0 0 m, 1 s: 0 1 0 m}}`:"
        " `sceneql words keys`",
    ),
    ("section", "gravity", "write `forces: [gravity]`, or `forces: [{gravity: {strength: 9.81 m/s^2}}]`"),
    ("section", "addforce add_force push thrust", "write `forces: [gravity, {force: {components: [0, 5, 0]}}]`, in N"),
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
