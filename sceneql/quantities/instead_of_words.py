"""Sentences on parts: what to write instead of words, fields and sections of other programs.

For messages alone.
"""

from __future__ import annotations

from sceneql.quantities.instead_in_formulas import IF, REPEAT

_WORD = "the word stands around its fields: `{sphere: {radius: 1 m}}`: `sceneql words sections`"

OF_PARTS = (
    ("field.cameras", "roll", "`up` is what is upwards in the picture: `up: 0.2 1 0`"),
    ("field.cameras", "near far near_clip far_clip clip clipping", "it sees what is near and far: leave that out"),
    (
        "field.cameras",
        "zoom scale focal_length lens",
        "write `field_of_view: 40 deg`, or of an orthographic one its `height`",
    ),
    ("cameras", "path dolly track", "a camera moves by its position: `{perspective: {position: {keys: {...}}}}`"),
    (
        "objects models materials lights",
        "USE instance instances copy clone ref prototype",
        "a part like another is `{use: ball}`, with that part's name, and the fields that differ: `sceneql words use`",
    ),
    (
        "outputs",
        "gif apng webp",
        "write `video`, which is MP4; of `images`, numbered PNG files, other programs make a GIF",
    ),
    ("part", "all everything any", "leave the field out: then it is of all"),
    ("part", "none null nil undefined no false", "leave the field out"),
    ("field.overlays", "font font_family typeface weight style bold", "letters have one font, and a `size`"),
    (
        "field.overlays",
        "xlabel ylabel x_label y_label axes labels",
        "lines have their names, `y: {height: ball.position.y}`, and a graph its `title`",
    ),
    ("field.outputs", "frames count number", "the clock tells how many there are: `clock: {end: 4 s, fps: 30}`"),
    ("field.outputs", "frame frame_number", "write its time: frame 12 of 30 a second is `time: 0.4 s`"),
    ("field.outputs", "codec bitrate container", "a film is MP4, H.264: `quality: 17` says how large it gets"),
    ("field.lights", "position", "it has a direction: `elevation: 50 deg, azimuth: 30 deg`, or `direction`"),
    ("field.lights", "temperature kelvin", "write its `color`"),
    (
        "lights",
        "area softbox rectangle rect",
        "a `point` with a `radius` casts soft shadows: `{point: {radius: 0.5 m}}`",
    ),
    (
        "field.models",
        "forces force",
        "forces are a section of their own, `forces: [gravity]`; one acts on some models by `on: [NAME]`",
    ),
    ("field.models", "solver integrator", "solvers are a section of their own, `solvers: {main: {rk4: {step: 1 ms}}}`"),
    (
        "field.models",
        "kinematic is_kinematic isKinematic",
        "what stands still is `fixed: yes`; what moves by keys or formulas is an object without a model",
    ),
    (
        "field.models",
        "count number amount",
        "many fill an object or are born, `fill: {object: NAME, count: 100}` or `emit: {rate: 100 /s}`",
    ),
    (
        "field.models",
        "freejoint free_joint free joint joints joint_type",
        "a body is free where no tie holds it; hinges and others stand in `ties`: `sceneql words hinge`",
    ),
    ("field.models", "feed kill", "what is fed and dies stands in the rates: `rate: -u*v^2 + 0.03*(1 - u)`"),
    ("section", "args arguments inputs", "what an instance may be given stands under `fields: {radius: 1 m}`"),
    ("field.ties", "length distance", "a rod is as long as its ends are apart at the start: `from` and `to`"),
    ("field.objects", "axis", "it stands along y, and is turned: `rotation: {about: x, angle: 90 deg}`"),
    ("field.objects", "static fixed kinematic dynamic", "an object that no model moves stands still"),
    ("bare", "fixed clamped dirichlet held closed zero", "what is held there has a value: write `{value: 0}`"),
    (
        "bare",
        "free neumann insulated adiabatic reflecting noflux no_flux",
        "so it is where nothing is said: leave it out",
    ),
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
        "option options physics_options compiler settings config",
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
    ("field entry", "repeat for foreach loop array times", REPEAT),
    (
        "keys",
        "repeat loop looping period periodic infinite",
        "write `cycle: 2 s`, the time after which they begin anew",
    ),
    ("keys", "interpolation ease easing type mode", "write `curve: linear`, `smooth`, `step` or `cubic`"),
    (
        "beside",
        "matte glossy metal glass mirror glow checker",
        "a material is a field of the object: `{sphere: {radius: 1 m, material: {matte: {color: red}}}}`",
    ),
    (
        "beside",
        "translation geometry appearance children shape",
        "parts in coordinates of their own are a group, `NAME: {group: {children: [{sphere: {radius: 1 m}}],"
        " position: 0 1 0 m}}`",
    ),
    ("beside", "text content string", "text stands in a caption: `NAME: {caption: {text: hello}}`"),
    ("beside", "DEF", "the part's name is that before the colon: leave `DEF` out"),
    ("beside", "name id", "the name stands before the word, in a section of names: `objects: {ball: {sphere: {...}}}`"),
    (
        "beside",
        "particles rigid elastic cloth collision",
        "a model is a part of its own, that names the object: `models: {fall: {particles: {of: ball, mass: 1 kg}}}`",
    ),
    ("field entry", "type kind shape", _WORD),
    (
        "field",
        "scale",
        "write its sizes as they shall be, or let a group scale it, which has the place then, and may be a `rigid`"
        " body: `{group: {children: [{sphere: {radius: 1 m}}], scale: 1 1.4 1, position: 0 1 0 m}}`",
    ),
    (
        "field",
        "roughness metallic metalness shininess specular reflectivity",
        "a material says it, `material: {metal: {roughness: 0.2}}`: `sceneql words glossy`",
    ),
    (
        "field.materials",
        "shininess gloss smoothness glossiness",
        "write `roughness: 0.1`: 0 is a mirror, 1 is dull",
    ),
    ("field.materials", "emission emissive emit", "what shines is `{glow: {color: orange}}`"),
    ("field.materials", "opacity alpha transparency", "what one sees through is `{glass: {color: white}}`"),
    (
        "field.materials",
        "texture map image normal_map bump",
        "there is `checker`, and a color may be a formula of x, y, z",
    ),
    (
        "field.cameras",
        "rotation orientation euler angles quaternion",
        "a camera looks at a place: `look_at: 0 1 0 m`",
    ),
    (
        "field",
        "restitution bounce bounciness bouncy elasticity friction",
        "a contact has it, `contacts: {touch: {collision: {restitution: 0.8, friction: 0.3}}}`",
    ),
    ("field.objects", "count copies number amount instances", REPEAT),
    ("field", "gravity", "write `forces: [gravity]`: `sceneql words gravity`"),
    ("field", "solver integrator", "write `solvers: {main: {rk4: {step: 1 ms}}}`: `sceneql words sections`"),
    ("field", "timestep time_step dt step", "a solver has the step: `solvers: {main: {rk4: {step: 1 ms}}}`"),
    ("field", "file filename path", "the file is named where it is made: `sceneql render SCENE -o FILE`"),
    ("field", "distance", "write where it stands, `position: 0 1 5 m`; without that it finds its place"),
    ("field", "min max low high corner corners", "write its `size`, and of its middle the `position`"),
    (
        "field",
        "checker checkered texture pattern tiles",
        "a material says it, `material: checker`: `sceneql words checker`",
    ),
    (
        "field.objects",
        "geometry mesh primitive",
        "the word says the shape: `{sphere: {radius: 1 m, material: glossy}}`",
    ),
    (
        "field.objects",
        "modifiers modifier subdivision subsurf bevel smooth shade_smooth segments subdivisions",
        "surfaces are exact and need no finer mesh; `union`, `difference`, `bend`, `twist` and `taper` make objects of"
        " objects",
    ),
    ("field", "start", "it begins at 0 s"),
    (
        "field.objects",
        "radius_top radius_bottom top_radius bottom_radius radiustop radiusbottom r1 r2",
        "a cone is a cylinder that is tapered, `{taper: {of: {cylinder: {height: 2 m}}, factor: 0.1}}`",
    ),
    (
        "field",
        "constraints constraint copy_location follow_path child_of",
        "what follows another takes its value, `position: ball.position`: `sceneql words links`",
    ),
    (
        "field",
        "positioninterpolator orientationinterpolator timesensor keyvalue fcurve f_curve action",
        "a value that changes is given by keys, `position: {keys: {0 s: 0 0 0 m, 1 s: 0 1 0 m}}`: `sceneql words keys`",
    ),
    (
        "field",
        "castshadow receiveshadow cast_shadow receive_shadow shadows shadow",
        "light and shadow are computed: leave it out",
    ),
    (
        "field.objects",
        "stroke nostroke stroke_weight strokeweight outline line_width linewidth wireframe edges",
        "surfaces have no lines: leave it out",
    ),
    (
        "field.objects",
        "interior ior refraction refractive_index",
        "write `material: {glass: {}}`: `sceneql words glass`",
    ),
    ("field", "geom geoms collider hitbox", "write `of: NAME`, an object that is its shape"),
    (
        "field.objects",
        "box sphere cylinder torus plane mesh",
        "members stand in a list, `of: [{box: {}}, {sphere: {}}]`, of a group `children: [...]`",
    ),
    ("field", "frames frame_count num_frames nframes", "the clock has the length in s: `clock: {end: 4 s, fps: 30}`"),
    ("field", "diameter", "write half of it as `radius`"),
    (
        "field.objects",
        "velocity speed mass acceleration weight density",
        "an object moves by a model, `models: {fall: {particles: {of: NAME, mass: 1 kg, velocity: 1 0 0 m/s}}}`:"
        " `sceneql words particles`",
    ),
    (
        "field",
        "animate animation keyframes keyframe key",
        "a value that changes is given by keys, `position: {keys: {0 s: 0 0 0 m, 1 s: 0 1 0 m}}`: `sceneql words keys`",
    ),
    (
        "field",
        "young youngs_modulus young_modulus modulus elastic_modulus E nu poisson poisson_ratio",
        "a solid's law says it, `law: {neo_hookean: {modulus: 10 kPa, poisson: 0.45}}`: `sceneql words elastic`",
    ),
    ("field", "opacity alpha transparency transparent", "write `material: glass`: `sceneql words glass`"),
    ("field", "visible show enabled", "write `hidden: yes` for a part that is not drawn"),
    ("field", "parent", "a part moves with others in a group, `{group: {children: [a, b]}}`: `sceneql words group`"),
    (
        "section",
        "joints hinges constraints constraint",
        "write `ties: {name: {hinge: {between: [model.a, model.b], at: 0 0 0 m}}}`: `sceneql words hinge`",
    ),
    (
        "field",
        "hole holes cutout",
        "cut it out of the object, `{difference: {of: [plate, hole]}}`: `sceneql words difference`",
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
    ("absent", "floor", "write `objects: {floor: none}`"),
    ("section", "sphere box plane", "write `objects: {name: {sphere: {radius: 1 m}}}`: `sceneql words sections`"),
    ("body", "wall ground static base ceiling earth fixed none null", "what stands still is `world`"),
    ("body", "floor", "a body is of a model; what stands still is `world`"),
    (
        "forces contacts",
        "floor ground wall terrain",
        "masses hit the floor, and all objects, by `collision`: `forces: [gravity, collision]`",
    ),
    (
        "objects",
        "ellipsoid egg spheroid",
        "write its formula: `{implicit: {field: (x/2)^2 + y^2 + z^2 - 1, bounds: {box: [-2 -1 -1, 2 1 1]}}}`",
    ),
    ("objects", "boolean bool csg", "write `{difference: {of: [a, b]}}`, or `union`, `intersection`"),
    ("field.forces", "mass", "write its `strength`, G times the mass: `6.67e-11*1e10 m^3/s^2`"),
    ("objects", "indexedfaceset faces triangles polygons vertices", "a file has them: `{mesh: {file: cow.obj}}`"),
    ("objects", "text title label caption", "text stands in `overlays: {title: {caption: {text: ...}}}`"),
    (
        "models",
        "pendulum double_pendulum",
        "its equation is a model, `sceneql words equations`; or a body hangs on a tie, `sceneql words hinge`",
    ),
    ("entry", "gravity", "write `gravity: {gravity: {strength: 9.81 m/s^2}}`, or only `forces: [gravity]`"),
    (
        "list",
        "gravity",
        "write `gravity: {gravity: {acceleration: 0 -9.81 0 m/s^2}}`, or only `forces: [gravity]`",
    ),
)
"""(what the words were taken for, the words, the sentence)."""
