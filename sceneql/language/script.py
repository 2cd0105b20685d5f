"""Reading of a script for the checker: composed, joined with its includes, patched, templates written out."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from sceneql.language.compose import compose
from sceneql.language.copies import KEY
from sceneql.language.include import OutsideError, Read, folder_reader, read_included, read_source
from sceneql.language.nesting import unnested
from sceneql.language.patch import (
    VARIANT_OPTIONS,
    Patch,
    apply_patch,
    parse_set,
    report_unnamed,
    variant,
    variant_names,
)
from sceneql.language.replaced import report_replaced
from sceneql.language.reuse import reused
from sceneql.language.scope import Broken, Entry, Expanded, Given, Scope
from sceneql.language.sections import NAMED, join, with_known_keys
from sceneql.language.templates import expand
from sceneql.language.tree import Mapping, Node, Scalar, broken
from sceneql.quantities.diagnostic import Diagnostics, ScriptError, told_once
from sceneql.quantities.span import Source

__all__ = ["FAMILIES", "SETTINGS", "VERSION", "Entry", "Given", "Scope", "Script", "read_script"]

VERSION: Final = "1"
FAMILIES: Final = (
    "objects",
    "models",
    "forces",
    "ties",
    "contacts",
    "solvers",
    "cameras",
    "lights",
    "materials",
    "overlays",
    "outputs",
)
SETTINGS: Final = ("sceneql", "about", "clock", "gallery", "background", "expect", "studies", "define", "variants")
_REWRITTEN: Final = ("include", "templates", "parts", "defaults")


@dataclass(frozen=True, slots=True, eq=False)
class Script:
    """A script ready to be checked.

    ``sections`` holds the entries of each family in the order written, ``settings`` the other top-level values as
    nodes, ``defaults`` the fields by word (already filled into the entries), ``gives`` and ``groups`` what instances
    give and which parts stand for one written name, ``broken`` the names of entries that cannot be read, ``unmade``
    what is only checked (see `Expanded`), ``base`` the tree without its patches.
    ``hash`` is the SHA-256 of all texts and patches.
    """

    name: str
    sources: tuple[Source, ...]
    root: Mapping
    base: Mapping
    sections: dict[str, dict[str, Entry]]
    settings: dict[str, Node]
    defaults: dict[str, Node]
    gives: dict[str, Given]
    groups: dict[str, list[str]]
    broken: Broken
    unmade: dict[str, dict[str, Entry]]
    variants: tuple[str, ...]
    variant: str | None
    may_fail: bool
    hash: str


def read_script(
    script: Path | Source,
    variant: str | None = None,
    sets: Iterable[str | Patch] = (),
    families: Sequence[str] = FAMILIES,
    settings: Sequence[str] = SETTINGS,
    read: Read | None = None,
    found: Diagnostics | None = None,
) -> Script:
    """Read a script from a file, or from a source whose includes ``read`` finds. Raises ScriptError with all errors.

    ``sets`` are patches, as such or as ``path=value``, applied after the variant's. With ``found``, errors that leave
    the rest of the script readable are recorded there instead of raised, and the wrong entries are left out.
    """
    raising = found is None
    found = Diagnostics() if found is None else found
    composed = compose_script(script, families, settings, read, found)
    composed.try_variants(variant, found)
    made = composed.script(variant, sets, found)
    if raising:
        found.raise_errors()
    return made


@dataclass(frozen=True, slots=True, eq=False)
class Composed:
    """The joined tree of a script and those it includes, from which the script of each variant is made."""

    name: str
    trees: tuple[Mapping, ...]
    root: Mapping
    families: Sequence[str]
    settings: Sequence[str]
    variants: tuple[str, ...]
    lost: tuple[str, ...]
    """Names of parts in unknown sections."""

    def try_variants(self, chosen: str | None, found: Diagnostics) -> None:
        """Report errors in the paths of all variants except ``chosen``: an error in an unused part is an error."""
        report_unnamed(self.root, found)
        wrong: dict[str, Diagnostics] = {}
        for name in self.variants:
            report_replaced(self.root, name, self.families, found)
            if name != chosen:
                wrong[name] = Diagnostics()
                for patches in _each(self.root, name, wrong[name]):
                    apply_patch(self.root, patches, self.families, self.settings, wrong[name])
        found.extend(told_once([each.found for each in wrong.values()]))

    def script(self, variant: str | None, sets: Iterable[str | Patch], found: Diagnostics) -> Script:
        """The script of a variant; errors are recorded, and the wrong entries left out."""
        root, lost = self.root, Broken()
        for name in self.lost:
            lost.add(name)
        lost.any = root.partial
        patches = [] if variant is None else [each for own in _each(root, variant, found) for each in own]
        for one in sets:
            try:
                patches.append(parse_set(one) if isinstance(one, str) else one)
            except ScriptError as error:
                found.extend(error.diagnostics)
        patched = apply_patch(root, patches, self.families, self.settings, found)
        whole = reused(unnested(patched, self.families, found), (*self.families, "parts"), found)
        repeats = bool(patches) or any(KEY in tree.source.text for tree in self.trees)
        expanded = expand(whole, self.families, lost, found, repeats=repeats)
        defaults = patched.entries.get("defaults")
        return Script(
            name=self.name,
            sources=tuple(tree.source for tree in self.trees),
            root=patched,
            base=root,
            sections=_in_order(expanded, patched),
            settings={k: n for k, n in patched.entries.items() if k not in self.families and k not in _REWRITTEN},
            defaults=dict(defaults.entries) if isinstance(defaults, Mapping) else {},
            gives=expanded.gives,
            groups=expanded.groups,
            broken=expanded.broken,
            unmade=expanded.unmade,
            variants=self.variants,
            variant=variant,
            may_fail=_may_fail(root, variant),
            hash=_hash(self.trees, patches),
        )


def compose_script(
    script: Path | Source, families: Sequence[str], settings: Sequence[str], read: Read | None, found: Diagnostics
) -> Composed:
    """Read a script and all that it includes; ``families`` and ``settings`` are the sections that it may have."""
    source = script if isinstance(script, Source) else read_source(script)
    if read is None:
        read = _no_folder if isinstance(script, Source) else folder_reader(script.parent)
    known, lost = (*families, *settings, *NAMED, *_REWRITTEN), Broken()
    first = with_known_keys(compose(source, found), known, "a script", lost, found)
    _, *included = read_included(first, Path(source.name).name, read, found)
    trees = (first, *(with_known_keys(tree, known, "a script", lost, found) for tree in included))
    root = join(trees, families, found)
    for tree in trees:
        _check_version(tree, found)
    name = Path(source.name).stem
    return Composed(name, trees, root, families, settings, variant_names(root), lost.names)


def _no_folder(name: str) -> Source:
    raise OutsideError(name)


def _check_version(tree: Mapping, found: Diagnostics) -> None:
    node = tree.entries.get("sceneql")
    if node is not None and not (isinstance(node, Scalar) and (node.text == VERSION or broken(node))):
        written = node.text if isinstance(node, Scalar) else "this"
        help = f"write `sceneql: {VERSION}`"
        found.error(
            "version", f"this program reads version {VERSION} of the language, not {written}", node.span, help=help
        )


def _each(root: Mapping, name: str, found: Diagnostics) -> Iterable[list[Patch]]:
    """One list of the patches of a variant, or nothing after reporting errors."""
    try:
        return [variant(root, name)]
    except ScriptError as error:
        found.extend(error.diagnostics)
        return []


def _may_fail(root: Mapping, name: str | None) -> bool:
    variants = root.entries.get("variants")
    chosen = variants.entries.get(name) if isinstance(variants, Mapping) and name is not None else None
    node = chosen.entries.get(VARIANT_OPTIONS[0]) if isinstance(chosen, Mapping) else None
    return isinstance(node, Scalar) and node.text.lower() in ("yes", "true")


def _in_order(expanded: Expanded, root: Mapping) -> dict[str, dict[str, Entry]]:
    """The sections in the script's order, then those that only templates fill."""
    order = [key for key in root.entries if key in expanded.sections]
    return {key: expanded.sections[key] for key in dict.fromkeys([*order, *expanded.sections])}


def _hash(trees: Iterable[Mapping], patches: Iterable[Patch]) -> str:
    digest = hashlib.sha256()
    texts = [tree.source.text for tree in trees]
    for text in [*texts, *(part for path, node, _ in patches for part in (path, node.span.text))]:
        data = text.encode()
        digest.update(len(data).to_bytes(8, "little") + data)
    return digest.hexdigest()
