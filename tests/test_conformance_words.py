"""One suite over every word of every family, from the catalogue: the class is the schema and the manual."""

import json
import subprocess
import sys
from typing import get_args

import pytest
from pydantic import BaseModel

from sceneql import pipeline
from sceneql.compiler.catalogue import ROOT, Catalogue, class_name
from sceneql.compiler.defaults import check_defaults
from sceneql.kinds import FAMILIES, REQUIRED, Settings, Value
from sceneql.quantities.diagnostic import ScriptError
from sceneql.report.manual import manual
from sceneql.report.schema import schema

CATALOGUE = Catalogue()
WORDS = [(family, word) for family in CATALOGUE.families for word in CATALOGUE.words(family)]
each_word = pytest.mark.parametrize(("family", "word"), WORDS, ids=lambda part: part)


def records(annotation):
    """The records inside a field's type."""
    if isinstance(annotation, type):
        return [annotation] if issubclass(annotation, BaseModel) else []
    return [found for part in get_args(annotation) for found in records(part)]


def with_records(cls):
    """A word's class and the records that its fields hold, at any depth."""
    found, stack = [], [cls]
    while stack:
        one = stack.pop()
        if one not in found:
            found.append(one)
            stack += [record for info in one.model_fields.values() for record in records(info.annotation)]
    return found


def sentence(text):
    """Whether a text is one that a manual may show: a capital or a code word first, a full stop last."""
    first = text.strip().splitlines()[0].strip()
    return first[0] == first[0].upper() and first.endswith((".", ":"))


def test_every_family_has_words():
    assert all(CATALOGUE.words(family) for family in CATALOGUE.families)
    assert len(WORDS) >= 40


@each_word
def test_the_class_is_of_its_family_and_named_as_its_file(family, word):
    cls = CATALOGUE.load(family, word)
    assert cls.__name__ == class_name(word)
    assert cls.family == family
    assert issubclass(cls, next(kind for kind in FAMILIES if kind.family == family))
    assert cls.__module__.rpartition(".")[2] == word


@each_word
def test_it_is_documented_and_so_is_every_field_and_output(family, word):
    cls = CATALOGUE.load(family, word)
    assert "__doc__" in vars(cls)
    assert sentence(cls.__doc__)
    for record in with_records(cls):
        for name, info in record.model_fields.items():
            assert info.description, (record, name)
            assert sentence(info.description), (record, name)
    for name, gives in cls.gives.items():
        assert sentence(gives.doc), name


@each_word
def test_a_script_may_write_every_default(family, word, tmp_path):
    given = {}
    for name, info in CATALOGUE.load(family, word).model_fields.items():
        if info.default not in (None, "", ()) and isinstance(info.default, str | bool | int | float | tuple):
            given[name.removesuffix("_")] = plainly(info.default)
    script = tmp_path / "scene.yaml"
    script.write_text(json.dumps({family: {"it": {word: given}}}))
    assert complaints(script) <= {"missing-field", "invalid"}  # what is required is not written, alone or as one of


def complaints(script):
    """The codes of what is wrong with a script."""
    try:
        pipeline.load(script)
    except ScriptError as error:
        return {diagnostic.code for diagnostic in error.diagnostics}
    return set()


def plainly(default):
    """A default as a script has it."""
    if isinstance(default, bool):
        return "yes" if default else "no"
    return " ".join(map(str, default)) if isinstance(default, tuple) else str(default)


@each_word
def test_defaults_of_words_and_of_their_records_are_what_their_fields_take(family, word):
    check_defaults.__wrapped__(CATALOGUE.load(family, word))


def test_defaults_of_settings_are_what_their_fields_take():
    check_defaults(Settings)


@each_word
def test_no_field_hides_what_its_family_asks_for(family, word):
    cls = CATALOGUE.load(family, word)
    for parent in cls.__mro__[1:]:
        methods = set(vars(parent)) - set(getattr(parent, "model_fields", {}))
        assert not methods & set(cls.model_fields), parent


@each_word
def test_its_manual_tells_all(family, word):
    page = manual(CATALOGUE, word)
    cls = CATALOGUE.load(family, word)
    assert page.startswith(word) or f"\n{word} (" in page
    for name, info in cls.model_fields.items():
        assert f"  {name.removesuffix('_')} (" in page, name
        assert info.description in page
    for name in cls.gives:
        assert name in page


def test_the_schema_has_every_word_and_field():
    definitions = json.loads(json.dumps(schema(CATALOGUE)))["$defs"]
    for family, word in WORDS:
        names = {name.removesuffix("_") for name in CATALOGUE.load(family, word).model_fields}
        listed, entry, _ = definitions[family]["anyOf"]
        assert word in listed["enum"]
        assert set(entry["properties"][word]["properties"]) == names


def test_reading_every_word_imports_nothing_heavy():
    code = (
        "import json, sys\nfrom sceneql.compiler.catalogue import Catalogue\nc = Catalogue()\n"
        "[c.load(f, w) for f in c.families for w in c.words(f)]\nprint(json.dumps(sorted(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    names = set(json.loads(done.stdout))
    assert not names & {"numpy", "numba", "scipy", "trimesh", "imageio", "av", "PIL", "matplotlib", "rich"}
    assert not [name for name in names if name.endswith("_kernels")]


def test_every_file_of_a_family_is_a_word_or_stands_beside_one():
    """A file whose class is misnamed would otherwise be no word, silently."""
    for family in CATALOGUE.families:
        folder = ROOT.parent / "renderers" if family == "renderers" else ROOT / "words" / family
        words = CATALOGUE.words(family)
        for path in folder.glob("*.py"):
            text = path.read_text(encoding="utf-8")
            family_class = next(kind.__name__ for kind in FAMILIES if kind.family == family)
            if path.stem not in words:
                assert f"({family_class})" not in text, path


def test_defaults_are_written_as_in_a_script():
    """A required field has no default; a value in time has a text, or None where it may be left out."""
    for family, word in WORDS:
        for record in with_records(CATALOGUE.load(family, word)):
            for name, info in record.model_fields.items():
                written = info.json_schema_extra["default"]
                assert (written is REQUIRED) == info.is_required(), (record, name)
                if info.annotation is Value and not info.is_required():
                    assert written is None or isinstance(written, str), (record, name)
