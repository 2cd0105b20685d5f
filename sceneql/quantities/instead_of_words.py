"""Sentences on parts: what to write instead of words and fields of other programs.

For messages alone.
"""

from __future__ import annotations

from sceneql.quantities.instead_in_formulas import REPEAT

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
    ("field.outputs", "times", "an `image` has one `time`; others are outputs of their own, `images` every frame"),
    ("field.outputs", "frame frame_number", "write its time: frame 12 of 30 a second is `time: 0.4 s`"),
    ("field.outputs", "codec bitrate container", "a film is MP4, H.264: `quality: 17` says how large it gets"),
    ("field.lights", "position", "it has a direction, from the scene towards it: `direction: 1 2 1`"),
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
    (
        "field.models",
        "usegravity use_gravity gravity_scale",
        "gravity is in the section `forces`, `forces: [gravity]`, and pulls all models but where it is `on: [NAME]`",
    ),
    (
        "field.models",
        "drag air_drag angular_drag angulardrag linear_drag air_resistance linear_damping angular_damping",
        "drag is a force, `forces: {air: {drag: {linear: 0.1 N*s/m}}}`: `sceneql words drag`",
    ),
    (
        "field.models",
        "angle launch_angle elevation heading direction",
        "a velocity has three numbers, at 45 deg `velocity: [10 m/s*cos(45 deg), 10 m/s*sin(45 deg), 0 m/s]`",
    ),
    (
        "field.models",
        "material color colour",
        "the object has it that the model moves: `objects: {ball: {sphere: {material: metal}}}`",
    ),
    (
        "field.models",
        "rods rod bars",
        "a rod is a tie, `ties: {r: {rod: {between: [net.a, net.b]}}}`: `sceneql words rod`",
    ),
    (
        "field.objects",
        "hollow shell wall_thickness thickness inner_radius outer_radius",
        "cut it out: `{difference: {of: [outer, inner]}}`: `sceneql words difference`",
    ),
    (
        "field.objects",
        "bevel rounded corner_radius fillet edge_radius chamfer",
        "its edges are sharp; where members of a `union` or `difference` meet, their `blend` is a fillet",
    ),
    (
        "field.models",
        "params parameters constants variables args",
        "constants have names under `define`, `define: {sigma: 10}` at the left margin: `sceneql words define`",
    ),
    (
        "field.objects",
        "make_trail trail retain leave_trail",
        "a trail is an object of its own, `objects: {way: {trail: {of: ball.position}}}`: `sceneql words trail`",
    ),
    (
        "field.objects",
        "transform translate",
        "write `position: 0 1 0 m` and `rotation: {about: y, angle: 30 deg}` among its fields",
    ),
    ("field.solvers", "substeps sub_steps steps iterations", "a solver has the length of its step, `step: 1 ms`"),
    (
        "field",
        "damping_ratio zeta",
        "a damping is a force for a speed: of a ratio z write `damping: 2*z*sqrt(k*m)`, k the stiffness, m the mass",
    ),
    (
        "objects",
        "extrude extrusion linear_extrude rotate_extrude lathe loft sweep",
        "there is none: solids are cut and put together by `union`, `difference` and `intersection`, a pipe is a"
        " `tube`, and any other shape comes in a file, `{mesh: {file: part.stl}}`",
    ),
    (
        "field.overlays",
        "min max vmin vmax low high limits range",
        "what shows it has the range: `{graph: {y: ..., range: 0 1}}`, or `{field_map: {of: ..., range: 0 1}}`",
    ),
    ("field.outputs", "background background_color bg", "it stands at the left margin, `background: white`"),
    (
        "field.outputs",
        "samples antialiasing antialias spp max_samples",
        "edges are smooth without it: leave it out",
    ),
    (
        "field.overlays",
        "legend key",
        "each curve has its name, `y: {kinetic: fall.kinetic, potential: fall.potential}`",
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
        "many fill an object or are born: write `fill: {object: {sphere: {radius: 0.5 m, hidden: yes}}, count: 100}`,"
        " or `emit: {rate: 100 /s}`",
    ),
    (
        "field.models",
        "shape radius size dimensions geometry half_extents",
        "the shape is an object, `objects: {ball: {sphere: {radius: 0.3 m}}}`, which the model names:"
        " `of: ball`, or `domain: ball` of a field",
    ),
    (
        "field.models",
        "freejoint free_joint free joint joints joint_type",
        "a body is free where no tie holds it; hinges and others stand in `ties`: `sceneql words hinge`",
    ),
    ("field.models", "feed kill", "what is fed and dies stands in the rates: `rate: -u*v^2 + 0.03*(1 - u)`"),
    ("field.ties", "of body on object", "a tie is between two: write `between: [<own|a>, world]`"),
    (
        "field.sphere field.box field.cylinder field.group field.mesh field.torus",
        "follow attach attached_to",
        "it takes the other's place: write `position: <own|other>.position`",
    ),
    ("field.ties", "length distance", "a rod is as long as its ends are apart at the start: `from` and `to`"),
    ("field.objects", "axis", "it stands along y, and is turned: `rotation: {about: x, angle: 90 deg}`"),
    ("field.objects", "static fixed kinematic dynamic", "an object that no model moves stands still"),
    ("bare", "fixed clamped dirichlet held closed zero", "what is held there has a value: write `{value: 0}`"),
    (
        "bare",
        "free neumann insulated adiabatic reflecting noflux no_flux",
        "so it is where nothing is said: leave it out",
    ),
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
        "a material says it, `material: {metal: {roughness: 0.2}}`, or `glossy`, `mirror`: `sceneql words glossy`",
    ),
    (
        "field.materials",
        "reflectivity reflectance specular_color",
        "its color says how much comes back: `color: 0.9 0.9 0.9`",
    ),
    ("field.materials", "metallic metalness", "the word says it: `metal` is all of metal, `glossy` not at all"),
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
        "restitution bounce bounciness bouncy elasticity",
        "a contact has it, `contacts: {touch: {collision: {restitution: 0.8}}}`",
    ),
    (
        "field.objects",
        "finish phong reflection specularity ambient",
        "a material says it, `material: {glossy: {roughness: 0.2}}`, or `mirror`, `metal`: `sceneql words glossy`",
    ),
    ("field", "friction", "a contact has it, `contacts: {touch: {collision: {friction: 0.3}}}`"),
    ("field.objects", "count copies number instances", REPEAT),
    (
        "field",
        "gravity",
        "write `forces: [gravity]`, or how strong it is, `forces: [{gravity: {strength: 9.81 m/s^2}}]`",
    ),
    ("field", "solver integrator", "write `solvers: {main: {rk4: {step: 1 ms}}}`: `sceneql words sections`"),
    ("field", "timestep time_step dt step", "a solver has the step: `solvers: {main: {rk4: {step: 1 ms}}}`"),
    ("field.outputs", "file filename path", "the file is named where it is made: `sceneql render SCENE -o FILE`"),
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
        "modifiers modifier subdivision subsurf smooth shade_smooth segments subdivisions",
        "surfaces are exact and need no finer mesh; `union`, `difference`, `bend`, `twist` and `taper` make objects of"
        " objects",
    ),
    ("field.outputs", "start", "it begins at 0 s"),
    (
        "field.objects",
        "$fn $fa $fs rings ring_count facets slices stacks tessellation resolution"
        " detail widthsegments heightsegments radialsegments u_segments v_segments smooth_shading",
        "leave it out: surfaces are exact and not made of triangles",
    ),
    ("field.objects", "center centered", "it is centered about its `position`: leave it out"),
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
    ("field", "diameter", "half of it is its `radius: 0.5 m`"),
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
    ("field", "visible visibility show enabled display", "write `hidden: yes` for a part that is not drawn"),
    ("field", "parent", "a part moves with others in a group, `{group: {children: [a, b]}}`: `sceneql words group`"),
    (
        "field",
        "hole holes cutout",
        "cut it out of the object, `{difference: {of: [plate, hole]}}`: `sceneql words difference`",
    ),
    ("absent", "floor", "write `objects: {floor: none}`"),
    ("body", "wall ground static base ceiling earth fixed none null", "what stands still is `world`"),
    ("body", "floor", "a body is of a model; what stands still is `world`"),
    (
        "forces",
        "floor ground wall terrain",
        "masses hit the floor, and all objects, by `collision`: `forces: [gravity, collision]`",
    ),
    (
        "contacts",
        "floor ground wall terrain",
        "masses hit the floor, and all objects, by `collision`: write `contacts: [collision]`",
    ),
    (
        "objects",
        "translate rotate scale transform move resize",
        "the object has fields for that, `{box: {size: 1 1 1 m, position: 1 0 0 m, rotation: {about: y, angle: 30 deg},"
        " color: red}}`; a `group` moves, turns and scales several",
    ),
    (
        "objects",
        "gear gearwheel cog cogwheel",
        "a `gear` is a tie of two bodies that turn: `sceneql words gear`; the wheel itself is `{cylinder: {radius:"
        " <radius|0.5 m>, height: 0.1 m}}`",
    ),
    ("objects", "boolean bool csg", "write `{difference: {of: [a, b]}}`, or `union`, `intersection`"),
    (
        "field.forces",
        "coefficient drag_coefficient cd c_d cw area",
        "of a drag coefficient C and an area A write `quadratic: 0.5*1.2 kg/m^3*C*A`, the 1.2 kg/m^3 being air's;"
        " `linear: 0.1 N*s/m` goes with the speed",
    ),
    ("field.forces", "mass", "write its `strength`, G times the mass: `6.67e-11*1e10 m^3/s^2`"),
    ("objects", "indexedfaceset faces triangles polygons vertices", "a file has them: `{mesh: {file: cow.obj}}`"),
    ("objects", "text title label caption", "text stands in `overlays: {title: {caption: {text: <text|hello>}}}`"),
    (
        "forces contacts ties lights overlays",
        "none null off no nothing",
        "a variant leaves a part out where it writes its section anew: `variants: {vacuum: {forces: [gravity]}}`",
    ),
    ("named", "gravity", "write `gravity: {gravity: {strength: 9.81 m/s^2}}`, or only `forces: [gravity]`"),
    (
        "list",
        "gravity",
        "write `gravity: {gravity: {acceleration: 0 -9.81 0 m/s^2}}`, or only `forces: [gravity]`",
    ),
)
"""(what the words were taken for, the words, the sentence)."""
