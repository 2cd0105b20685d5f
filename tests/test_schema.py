"""The JSON Schema (draft 2020-12) takes every script that is right and refuses misspelt ones, as editors read it."""

import re
from pathlib import Path

import pytest
import yaml

from sceneql.compiler.catalogue import Catalogue
from sceneql.report.new import SCRIPT
from sceneql.report.schema import schema

SCHEMA = schema(Catalogue())
HERE = Path(__file__).parent
SCENES = sorted([*(HERE.parent / "scenes").glob("*.yaml"), *(HERE / "wishes").glob("*.yaml")])
NOTES = {"$schema", "$defs", "title", "description", "default"}
TYPES = {"object": dict, "array": list, "string": str, "integer": int, "number": (int, float), "boolean": bool}


class Core(yaml.SafeLoader):
    """YAML 1.2's core types, as editors read them: `on` and `yes` are texts."""


BOOLEAN = "tag:yaml.org,2002:bool"
Core.yaml_implicit_resolvers = {
    first: [(tag, pattern) for tag, pattern in pairs if tag != BOOLEAN]
    for first, pairs in yaml.SafeLoader.yaml_implicit_resolvers.items()
}
Core.add_implicit_resolver(BOOLEAN, re.compile("^(?:true|false)$"), ["t", "f"])


def read(text):
    return yaml.load(text, Core)


def fits(value, type_):
    if type_ == "null" or value is None:
        return type_ == "null" and value is None
    return isinstance(value, TYPES[type_]) and (type_ == "boolean" or not isinstance(value, bool))


def problems(value, rule, at="script"):
    """What a rule has against a value: the keywords that the schema uses, and no others."""
    found = []
    for keyword, wanted in rule.items():
        match keyword:
            case "$ref":
                found += problems(value, SCHEMA["$defs"][wanted.removeprefix("#/$defs/")], at)
            case "anyOf":
                tried = [problems(value, arm, at) for arm in wanted]
                found += [] if not all(tried) else min(tried, key=len)
            case "enum":
                found += [] if value in wanted else [f"{at}: {value!r} is none of {wanted}"]
            case "const":
                found += [] if value == wanted else [f"{at}: {value!r} is not {wanted!r}"]
            case "pattern" if isinstance(value, str):
                found += [] if re.search(wanted, value) else [f"{at}: {value!r} does not match {wanted!r}"]
            case "type":
                types = [wanted] if isinstance(wanted, str) else wanted
                found += [] if any(fits(value, t) for t in types) else [f"{at}: {value!r} is none of {types}"]
            case "properties" if isinstance(value, dict):
                found += [p for key in wanted.keys() & value for p in problems(value[key], wanted[key], f"{at}.{key}")]
            case "additionalProperties" if isinstance(value, dict):
                others = value.keys() - rule.get("properties", {}).keys()
                if wanted is False:
                    found += [f"{at}.{key} is unknown" for key in others]
                elif isinstance(wanted, dict):
                    found += [p for key in others for p in problems(value[key], wanted, f"{at}.{key}")]
            case "items" if isinstance(value, list):
                found += [p for k, item in enumerate(value) for p in problems(item, wanted, f"{at}[{k}]")]
            case "required" if isinstance(value, dict):
                found += [f"{at} lacks {key}" for key in wanted if key not in value]
            case "properties" | "additionalProperties" | "items" | "required" | "pattern":
                pass
            case _:
                assert keyword in NOTES, f"unknown keyword {keyword} in {at}"
    return found


def test_it_names_its_draft():
    assert SCHEMA["$schema"] == "https://json-schema.org/draft/2020-12/schema"


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_it_takes_every_scene(path):
    assert problems(read(path.read_text()), SCHEMA) == []


def test_it_takes_the_first_script_of_a_user():
    assert problems(read(SCRIPT.format(name="mine", schema="s.json")), SCHEMA) == []


@pytest.mark.parametrize(
    "script",
    [
        "objects: {a: {sphere: {radus: 1 m}}}",
        "objects: {a: spere}",
        "objects: {a: {spere: {}}}",
        "object: {a: sphere}",
        "clock: {ende: 1 s}",
        "forces: [gravitas]",
        "objects: {a: {tube: {radius: 1 m}}}",
        "outputs: {a: {record: {of: [a.b], format: txt}}}",
        "objects: {a: {repeat: {as: k}, sphere: }}",
        "objects: {a: sphere, b: {use: {a: 1 m}}}",
        "sceneql: 2",
    ],
)
def test_it_refuses_what_is_misspelt(script):
    assert problems(read(script), SCHEMA)


@pytest.mark.parametrize(
    "script",
    [
        "objects: {a: {sphere: {position: {x: 1 m}, material: {glossy: {roughness: 0.1}}}}}",
        "objects: {a: {sphere: {position: [0, 1, 0], material: mirror, hidden: yes}}}",
        "objects: {a: {sphere: {radius: {keys: {0 s: 1 m, 1 s: 2 m}}}}}",
        "objects: {a: {sphere: }}",
        "objects: {a: {repeat: {count: 3, as: k}, sphere: {position: [k, 0, 0]}}}",
        "objects: {a: sphere, b: {use: a, radius: 1 m, repeat: {count: 3}}}",
        "objects: [sphere, {box: {size: 1 1 1 m}}]",
        "forces: {c: {collision: {between: [a, b]}}}",
        "outputs: {film: {video: {size: 360p, camera: {turntable: {}}}}}",
        "outputs: {film: {video: {show: [a, b]}}}",
        "outputs: {film: {video: {size: [640, 360], fps: 24}}}",
        "models: {swing: {equations: {start: {a: 1}, rate: {a: -a}, gives: {bob: [cos(a), sin(a), 0]}}}}",
        "models: {net: {mass_spring: {masses: {bead: {repeat: {count: 3, as: i}, position: 0 0 0 m, mass: 1 kg}}}}}",
        "objects: {skin: {blobby: {skeleton: [{repeat: {leg: [a, b]}, point: leg.hip, radius: 1 m}]}}}",
        "objects:\ndefine:\noverlays: {told: {caption: {text: 5}}}",
        "define: {k: 1 N/m}\nvariants: {soft: {define.k: 2 N/m}}\ndefaults: {sphere: {radius: 1 m}}",
    ],
)
def test_it_takes_the_forms_of_the_language(script):
    assert problems(read(script), SCHEMA) == []
