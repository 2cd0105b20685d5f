"""Sentences that say what to write instead of words of other programs without a counterpart in the language.

For messages alone.
"""

from __future__ import annotations

import re

_COLOR = 'write three numbers from 0 to 1, `[1, 0.5, 0]`, a CSS name, `tomato`, or `"#ff8000"`'
_AND = "for 'and' multiply: `(a > b)*(c > d)`"
_OR = "for 'or' write `max(a > b, c > d)`"
_IF = "write `where(condition, a, b)`"
_WORD = "the word stands around its fields: `{sphere: {radius: 1 m}}`: `sceneql words sections`"
_REPEAT = "write `repeat: {count: 5, as: i}` beside the word, `{repeat: {...}, sphere: {...}}`: `sceneql words repeat`"

_SENTENCES = (
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
    ("part", "all everything any", "leave the field out: then it is of all"),
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
    ("field.models", "feed kill", "what is fed and dies stands in the rates: `rate: -u*v^2 + 0.03*(1 - u)`"),
    ("section", "args arguments inputs", "what an instance may be given stands under `fields: {radius: 1 m}`"),
    ("field.ties", "length distance", "a rod is as long as its ends are apart at the start: `from` and `to`"),
    ("field.objects", "axis", "it stands along y, and is turned: `rotation: {about: x, angle: 90 deg}`"),
    ("field.objects", "static fixed kinematic dynamic", "an object that no model moves stands still"),
    ("section", "seed", "write `clock: {seed: 5}`"),
    ("behind", "px pixel pixels pt", "letters are as high as a part of the picture: `size: 0.05`"),
    ("function", "if switch select", _IF),
    (
        "function",
        "vec vec2 vec3 vec4 vector vector3 point float3 array tuple xyz",
        "write `[x, y, z]`, or numbers with one unit behind them, `0 1.2 0 m`",
    ),
    ("function", "rgb rgba color colour", _COLOR),
    ("function", "hsv hsl hsva hsv2rgb", f"write `hue(h)`, h from 0 to 1, for a full color; else {_COLOR}"),
    (
        "function",
        "deg degrees rad radians deg2rad rad2deg",
        "an angle has its unit: write `30 deg`, or `x*(1 deg)`",
    ),
    ("function", "gaussian gauss gaussian2d", "write `exp(-((x - 0.5)^2 + (y - 0.5)^2)/0.1^2)`"),
    ("function", "pow power", "write `a^b`"),
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
    ("function name behind", "and", _AND),
    ("function name behind", "or", _OR),
    ("function name", "not", "write `1 - (a > b)`"),
    ("sign", "&", _AND),
    ("sign", "|", _OR),
    ("sign", "?", _IF),
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
    ("unit", "particles particle balls items pieces times", "what is counted has no unit: write `100 /s`"),
    (
        "unit",
        "fps frames frame",
        "a number of frames has no unit: `clock: {fps: 30}`; in a formula write `time`, which is 1 s at frame 30",
    ),
    ("name", "frame frames", "write `time`, which is 0.4 s at frame 12 of 30 a second"),
    ("name", "t", "the time is written 'time'"),
    ("name behind", "if then else elif when", f"{_IF}: `sceneql words functions`"),
    (
        "name",
        "x y z",
        "an axis is `1 0 0`, `0 1 0` or `0 0 1`; the coordinates of a place stand in formulas of fields alone",
    ),
    ("name behind", "to until", "from when to when is two conditions: `(time > 1 s)*(time < 2 s)`"),
    ("name", "inf infinity", "what never moves is `fixed: yes`; what has no limit is left out"),
    ("name", "true yes", "in a formula write `1`"),
    ("name", "false no", "in a formula write `0`"),
    (
        "name",
        "i index id",
        "copies have numbers, where `repeat: {count: 5, as: i}` makes them: `sceneql words repeat`",
    ),
    ("field entry", "repeat for foreach loop array times", _REPEAT),
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
    ("field.objects", "count copies number amount instances", _REPEAT),
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
    ("section", "scene world root project", "the sections stand by themselves, with no key around them"),
    ("section", "floor", "write `objects: {floor: plane}`"),
    ("absent", "floor", "write `objects: {floor: none}`"),
    ("section", "sphere box plane", "write `objects: {name: {sphere: {radius: 1 m}}}`: `sceneql words sections`"),
    ("zero", "mass", "what never moves is an object without a model, or a body or mass with `fixed: yes`"),
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

INSTEAD = {(what, word): text for kinds, words, text in _SENTENCES for what in kinds.split() for word in words.split()}
"""The sentence of what to write in place of a called `function`, a `sign` or `name` of a formula or `behind` a number
of it, the `field` of a part, or `field.FAMILY`, a `section` of the script, the key of an `entry` or one `beside` its
word, a field of `keys`, a `unit`, a `body` of a tie, a `zero`, or a word of a family, by the family's name."""

_TON = re.compile(r"\d\s*[^\s()\[\],]*[*/]t(?!\w)")


def time_meant(text: str) -> str | None:
    """The help for a quantity in which ``t`` is read as a tonne though most likely the time was meant: ``2 m/s*t``."""
    return "the time is `time`: `t` behind a unit is 1000 kg" if _TON.search(text) is not None else None


def instead(what: str, word: str) -> str | None:
    """The help for a word of another program that is taken for ``what`` (a key of `INSTEAD`), if known."""
    return INSTEAD.get((what, word)) or INSTEAD.get((what, word.lower()))


def anywhere(word: str) -> str | None:
    """The help for a word of another program, whatever it was meant as."""
    found = [(what, help) for (what, other), help in INSTEAD.items() if other == word.lower()]
    return min(found, key=lambda one: "." in one[0], default=("", None))[1]
