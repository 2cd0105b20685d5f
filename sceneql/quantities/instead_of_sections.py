"""Sentences on sections: what to write instead of those of other programs.

For messages alone.
"""

from __future__ import annotations

from sceneql.quantities.instead_in_formulas import IF, REPEAT

OF_SECTIONS = (
    ("section", "args arguments inputs", "what an instance may be given stands under `fields: {radius: 1 m}`"),
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
