"""Help for unknown fields whose value tells what was meant: a part that moves, a look, two corners, two moduli.

``reader`` is the `Reader` (`sceneql.compiler.read`) that met the record.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from pydantic import BaseModel

from sceneql import kinds
from sceneql.compiler import paint
from sceneql.compiler.meant.own_values import in_si
from sceneql.language.tree import Mapping, Node, Scalar, Sequence
from sceneql.quantities.diagnostic import Diagnostics
from sceneql.quantities.dimension import LENGTH, PLAIN

LEADERS = (
    "animation", "animate", "motion", "movement", "action", "parent", "follow", "follows", "following", "attach",
    "attached_to", "attach_to", "driver", "driven_by", "controller", "moved_by", "moves_with", "path", "track", "body",
    "model", "link", "linked_to", "bound_to", "constraint", "pin_to", "stick_to", "on",
)  # fmt: skip
"""Fields of other programs that name what moves a part."""
FOLLOWED = ("position", "rotation")
"""Fields of an object that take the values of what moves it."""
TEXTURES = (
    "texture", "pigment", "finish", "appearance", "shader", "bsdf", "principled", "look", "paint", "skin", "surface",
)  # fmt: skip
"""Groups of other programs that hold how a part looks."""
COLORS = ("color", "colour", "pigment", "diffuse", "diffusecolor", "base_color", "basecolor", "albedo", "rgb", "kd")
MIRRORS = ("reflection", "reflect", "mirror", "reflectivity")
METALS = ("metallic", "metal", "metalness")
SHINY = ("phong", "specular", "specularity", "shininess", "roughness", "gloss", "glossiness", "finish")
"""Their fields."""
BOXES = ("bounds", "bounding_box", "bbox", "aabb", "box", "extents", "limits", "region", "range")
"""Fields of other programs for the two corners of a box."""
SHEAR = ("shear", "shear_modulus", "g", "mu", "lame_mu", "lame2")
BULK = ("bulk", "bulk_modulus", "k", "kappa")
LAME = ("lambda", "lam", "lame", "lame_lambda", "lame1", "lmbda")
"""Moduli by their names in books."""
KINEMATIC = ("nu", "kinematic_viscosity", "nu0")
"""Names of a viscosity divided by the density."""
PARTS, CORNERS = 2, 2


def by_value(reader: Any, cls: type[BaseModel], name: str, node: Mapping) -> str | None:
    """The help for an unknown field of a record by what its value is."""
    known = [kinds.written_name(key) for key in cls.model_fields]
    lower, value = name.lower(), node.entries[name]
    if lower in LEADERS and issubclass(cls, kinds.Object):
        return _following(reader, known, value, node)
    if lower in TEXTURES and "material" in known and not {"material", "color"} & node.entries.keys():
        return _look(reader, value)
    if lower in BOXES and {"corner", "size"} <= {*known} and not {"corner", "size"} & node.entries.keys():
        return _corners(value)
    if "neo_hookean" in known or {"modulus", "poisson"} <= {*known}:
        return _moduli(node, name, wrapped="neo_hookean" in known)
    if lower in KINEMATIC and {"viscosity", "density"} <= {*known} and isinstance(value, Scalar):
        return _dynamic(value, node)
    return None


def _following(reader: Any, known: list[str], value: Node, node: Mapping) -> str | None:
    """The place, and the turn, of what moves a part: ``position: orbit.position``."""
    of = value.text if isinstance(value, Scalar) else ""
    part, inner = reader.names.part_of(of)
    entry, outputs = reader.names.parts.get(part), reader.names.outputs_of(part) or {}
    if entry is None or "models" not in reader.names.catalogue.families_of(entry.word):
        return None
    gives = outputs.get(inner)
    if gives is not None and gives.type.shape == (3,) and gives.type.dimension in (LENGTH, None, PLAIN):
        return f"what moves with another takes its place: write `position: {of}`"
    told = [f"{one}: {of}.{one}" for one in FOLLOWED if one in known and f"{inner}.{one}".strip(".") in outputs]
    told = [one for one in told if one.partition(":")[0] not in node.entries or one.startswith("position")]
    return f"what moves with another takes its place: write `{', '.join(told)}`" if told else None


def _look(reader: Any, value: Node) -> str | None:
    """A texture of other programs as a material: by its color, and by what it says on its shine."""
    fields = {name.lower(): one for name, one in _inside(value)}
    color = next((text for one in COLORS if one in fields and (text := _color(reader, fields[one]))), None)
    word = "mirror" if fields.keys() & {*MIRRORS} else "metal" if fields.keys() & {*METALS} else None
    word = word or ("glossy" if fields.keys() & {*SHINY} else None)
    if color is None and word is None:
        return None
    if word is None:
        return f"how it looks is its color: write `color: {color}`"
    inner = word if color is None else f"{{{word}: {{color: {color}}}}}"
    return f"how it looks is its material: write `material: {inner}`"


def _inside(value: Node) -> Iterator[tuple[str, Node]]:
    """The fields of a group, and of the groups in it."""
    for name, one in value.entries.items() if isinstance(value, Mapping) else ():
        yield name, one
        yield from _inside(one)


def _color(reader: Any, node: Node) -> str | None:
    """The text of a color that is written as it is here, but for capitals; None for others."""
    nothing = Diagnostics()
    names = replace(reader.names, found=nothing)
    if not isinstance(node, Scalar | Sequence) or "\n" in node.span.text:
        return None
    if paint.read_color(node, names, nothing) is not None and not nothing.errors:
        return node.span.text
    if not isinstance(node, Scalar):
        return None
    nothing = Diagnostics()
    small = replace(node, text=node.text.lower())
    fits = paint.read_color(small, replace(reader.names, found=nothing), nothing) is not None and not nothing.errors
    return node.text.lower() if fits else None


def _corners(value: Node) -> str | None:
    """The low corner and the size of a box by two corners."""
    inner = value.items if isinstance(value, Sequence) else value.entries.values() if isinstance(value, Mapping) else ()
    items = [item.span.text for item in inner] or value.span.text.split(",")
    ends = [in_si(item) for item in items]
    if len(ends) != CORNERS or not ends[0] or len(ends[0]) != len(ends[1]):
        return None
    size = [high - low for low, high in zip(*ends, strict=True)]
    if min(size) <= 0.0:
        return None
    low, across = (" ".join(f"{one:.6g}" for one in numbers) for numbers in (ends[0], size))
    return f"where it begins and how far it goes: write `corner: {low} m, size: {across} m`"


def _moduli(node: Mapping, name: str, *, wrapped: bool) -> str | None:
    """Young's modulus and Poisson's ratio by two others: the shear, the bulk modulus, or Lame's first."""
    told = {key.lower(): in_si(value.span.text) for key, value in node.entries.items()}
    one, other, lame = (
        next((told[key][0] for key in names if len(told.get(key, ())) == 1), None) for names in (SHEAR, BULK, LAME)
    )
    if name.lower() not in (*SHEAR, *BULK, *LAME) or one is None or (other is None and lame is None):
        return None
    bulk = other if other is not None else (lame or 0.0) + 2.0 * one / 3.0
    if min(one, bulk) <= 0.0:
        return None
    young, poisson = 9.0 * bulk * one / (3.0 * bulk + one), (3.0 * bulk - 2.0 * one) / (2.0 * (3.0 * bulk + one))
    fields = f"modulus: {young:.5g} Pa, poisson: {poisson:.3g}"
    return f"write `law: {{neo_hookean: {{{fields}}}}}`" if wrapped else f"write `{fields}`"


def _dynamic(value: Scalar, node: Mapping) -> str | None:
    """The viscosity by the kinematic one, which is times the density."""
    density = node.entries["density"].span.text if "density" in node.entries else "1000 kg/m^3"
    text = value.span.text if value.span.text[-1:] in "s2" and "/" in value.span.text else f"{value.span.text} m^2/s"
    return f"it is divided by the density; here stands the whole: write `viscosity: {density}*{text}`"
