"""The composer: YAML 1.2 core types, spans, limits, and values that YAML tears."""

from __future__ import annotations

import time
from collections.abc import Iterator

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from sceneql.language import compose as composer
from sceneql.language.compose import compose, compose_node
from sceneql.language.encoded import MOST_BYTES, source_of
from sceneql.language.plain import kind_of
from sceneql.language.tree import Mapping, Node, Scalar, Sequence
from sceneql.quantities.diagnostic import Diagnostic, ScriptError
from sceneql.quantities.span import Source


@pytest.fixture(params=["libyaml", "python"])
def loader(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    if request.param == "python":
        monkeypatch.delattr(yaml, "CSafeLoader", raising=False)
    elif not hasattr(yaml, "CSafeLoader"):
        pytest.skip("PyYAML was built without libyaml")
    return str(request.param)


def tree(text: str) -> Mapping:
    return compose(Source("s.yaml", text))


def errors(text: str) -> tuple[Diagnostic, ...]:
    with pytest.raises(ScriptError) as caught:
        tree(text)
    assert all(d.span is not None for d in caught.value.diagnostics)
    return caught.value.diagnostics


def codes(text: str) -> list[str]:
    return [d.code for d in errors(text)]


def nodes(node: Node) -> Iterator[Node]:
    yield node
    inner: list[Node] = []
    if isinstance(node, Mapping):
        inner = [*node.keys.values(), *node.entries.values()]
    elif isinstance(node, Sequence):
        inner = node.items
    for item in inner:
        yield from nodes(item)


def plain(node: Node) -> object:
    if isinstance(node, Mapping):
        return {key: plain(item) for key, item in node.entries.items()}
    return [plain(item) for item in node.items] if isinstance(node, Sequence) else node.text


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        *((t, "number") for t in ("1e3", "1.", ".5", "-2.5E-3", "+1e+3", ".inf", "-.INF", ".nan", "1e-6")),
        *((t, "integer") for t in ("0", "-12", "+7", "0o17", "0xFf", "007")),
        *((t, "boolean") for t in ("true", "False", "TRUE")),
        *((t, "null") for t in ("~", "null", "NULL")),
        *(
            (t, "text")
            for t in ("no", "yes", "on", "1_000", "0b1", "1:30", "nan", "inf", "+", ".", "e3", "1 m", "2e", "٣")
        ),
    ],
)
def test_plain_scalars_have_the_types_of_yaml_1_2(text: str, kind: str) -> None:
    assert kind_of(text) == kind
    assert plain(tree(f"a: {text}")) == {"a": text}


def test_a_quoted_scalar_is_text(loader: str) -> None:
    value = tree("a: '1e3'").entries["a"]
    assert isinstance(value, Scalar)
    assert (value.kind, value.quoted, value.span.text, value.content.text) == ("text", True, "'1e3'", "1e3")


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("mark", ["", "\ufeff"])
def test_spans_count_characters(loader: str, end: str, mark: str) -> None:
    text = mark + end.join(
        ["größe: 'ü𝄞'", "名: [1, β, {c: d}] # end", "last:", "  - x", "  - |", "    two", "    lines", ""]
    )
    root = tree(text)
    assert root.source.text == text.removeprefix("\ufeff")
    texts = [node.span.text.replace(end, "\n") for node in nodes(root)]
    assert texts[1:] == [
        "größe", "名", "last",
        "'ü𝄞'",
        "[1, β, {c: d}]", "1", "β", "{c: d}", "c", "d",
        "- x\n  - |\n    two\n    lines", "x", "|\n    two\n    lines",
    ]  # fmt: skip
    assert str(root.keys["last"].span) == "s.yaml:3:1"


WORD = st.text("abcdefgh", min_size=1, max_size=5)
PLAIN = st.recursive(
    WORD, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(WORD, inner, max_size=3), max_leaves=12
)


@given(value=st.dictionaries(WORD, PLAIN, min_size=1, max_size=4), flow=st.booleans())
def test_what_yaml_writes_is_read_back_with_true_spans(value: dict[str, object], flow: bool) -> None:
    root = tree(yaml.safe_dump(value, default_flow_style=flow, sort_keys=False))
    assert plain(root) == value
    for node in nodes(root):
        if isinstance(node, Scalar):
            assert node.content.text == node.text
        elif node.flow:
            assert node.span.text[0] + node.span.text[-1] == ("[]" if isinstance(node, Sequence) else "{}")
        for inner in nodes(node):
            assert node.start <= inner.start <= inner.end <= node.end


def test_an_alias_shares_its_node(loader: str) -> None:
    root = tree("a: &x # comment\n  b: 1\nc: *x\nd: &y [1]\ne: [*y, *y]\n")
    assert root.entries["a"] is root.entries["c"]
    assert root.entries["a"].span.text == "b: 1"
    assert root.entries["d"].span.text == "[1]"
    assert plain(root.entries["e"]) == [["1"], ["1"]]


@pytest.mark.parametrize(
    ("text", "code", "place"),
    [
        ("", "empty-script", "1:1"),
        ("# nothing\n", "empty-script", "1:1"),
        ("---\n", "empty-script", "1:1"),
        ("- a", "script-shape", "1:1"),
        ("a", "script-shape", "1:1"),
        ("a: 1\n---\nb: 2", "several-documents", "2:1"),
        ("a: 1\nb: 2\na: 3", "duplicate-key", "3:1"),
        ("a: {b: 1, b: 2}", "duplicate-key", "1:11"),
        ("a: !!str 1", "yaml-tag", "1:4"),
        ("a: &x !!map\n  b: 1", "yaml-tag", "1:7"),
        ("a: ! x", "yaml-tag", "1:4"),
        ("a: {<<: {b: 1}}", "merge-key", "1:5"),
        ("? [a]\n: 1", "key-not-text", "1:3"),
        (": 1", "key-not-text", "1:1"),
        ("a: {: 1}", "key-not-text", "1:5"),
        ("a: *b", "unknown-alias", "1:4"),
        ("a: &x [*x]", "alias-cycle", "1:8"),
        ("*a", "unknown-alias", "1:1"),
        ("a: |x\n  b", "yaml-syntax", "1:5"),
        ("a: [,]", "yaml-syntax", "1:5"),
        ("a: 1\n]", "yaml-syntax", "2:1"),
        ("a: 1\x07", "control-character", "1:5"),
        ("a: \ud800", "control-character", "1:4"),
        ("a:\n\tb: 1", "yaml-syntax", "2:1"),
        ("a: b: c", "yaml-syntax", "1:5"),
        ("a: @b", "yaml-syntax", "1:4"),
        ("a: 'b", "yaml-syntax", "1:4"),
        ("a: [1\nb: 2", "yaml-syntax", "1:4"),
        ("a:\n  b: 1\n c: 2", "yaml-syntax", "3:2"),
        ('a: "\\q"', "yaml-syntax", "1:5"),
        ("a: 1\n b: 2", "yaml-syntax", "2:2"),
    ],
)
def test_faults_are_located(loader: str, text: str, code: str, place: str) -> None:
    (found,) = errors(text)
    assert (found.code, str(found.span)) == (code, f"s.yaml:{place}")
    assert found.help
    assert "^" in str(found)


def test_faults_are_found_in_one_run(loader: str) -> None:
    text = "a: !x 1\na: 2\nb: {c: 1, c: max(0, 1)}\nd: #ff8800\ne: *f\n<<: 1\ng: [1, 2] m\n"
    assert codes(text) == [
        "yaml-tag",
        "duplicate-key",
        "duplicate-key",
        "torn-expression",
        "comment-color",
        "unknown-alias",
        "merge-key",
        "unit-after-bracket",
    ]


@pytest.mark.parametrize(
    ("text", "code", "help"),
    [
        ("a: {radius: max(0.1, r)}", "torn-expression", 'quote it: a: {radius: "max(0.1, r)"}'),
        ("a: [max(a, b), 1]", "torn-expression", 'quote it: a: ["max(a, b)", 1]'),
        ("a: {b: f(x, g(y, z), w), c: 1}", "torn-expression", 'quote it: a: {b: "f(x, g(y, z), w)", c: 1}'),
        ("a: {b: f(c[0], 1)}", "torn-expression", 'quote it: a: {b: "f(c[0], 1)"}'),
        ("a: {b: at + [0, 2, 0]}", "torn-expression", 'quote it: a: {b: "at + [0, 2, 0]"}'),
        ("a: [1, 0, 0] * 2", "torn-expression", 'quote it: a: "[1, 0, 0] * 2"'),
        ("- {a: f(\"x\", 1)}", "torn-expression", "quote it: - {a: 'f(\"x\", 1)'}"),
        ("color: #ff8800", "comment-color", 'quote it: color: "#ff8800"'),
        ("a: {color: #f80}\nb: 1", "comment-color", 'quote it: a: {color: "#f80"}'),
        ("a: [red, #ff8800, blue]", "comment-color", 'quote it: a: [red, "#ff8800", blue]'),
        ("a: [0, 1, 0] m", "unit-after-bracket", "write: a: 0 1 0 m"),
        ("- [0, 1, 0] m/s^2  # up", "unit-after-bracket", "write: - 0 1 0 m/s^2  # up"),
        ("a: {b: [r, -1.5, 0] m, c: 1}", "unit-after-bracket", "write: a: {b: [r, -1.5 m, 0 m], c: 1}"),
        ("a: [[0, 1], [2, 3]] km", "unit-after-bracket", "write: a: [0 1 km, 2 3 km]"),
        ("a:\n  - b\n  - [0, 1] m", "unit-after-bracket", "write: - 0 1 m"),
    ],
)  # fmt: skip
def test_torn_values_are_shown_whole(loader: str, text: str, code: str, help: str) -> None:
    (found,) = errors(text)
    assert (found.code, found.help) == (code, help)
    mended = text.splitlines()
    assert found.span is not None
    line = mended[found.span.line - 1]
    mended[found.span.line - 1] = line[: len(line) - len(line.lstrip())] + help.split(": ", 1)[1]
    compose_node(Source("mended.yaml", "\n".join(mended)))


@pytest.mark.parametrize(
    "text",
    [
        "a: {at: [i - 3, 0]}",
        "a: {b: max(1)}",
        'a: {b: "max(0, 1)"}',
        "a: max(0, 1)",
        "a: [0, 1, 0] # m",
        "a: red #ff8800",
        "a: # no color\n  b: 1",
        "a: {smile: (, b: 2}",
        "a: at + [0, 2, 0]",
        "a: #fff is a comment of its own",
    ],
)
def test_whole_values_are_left_alone(loader: str, text: str) -> None:
    if text.startswith("a: #fff"):
        assert codes(text) == ["comment-color"]
    else:
        tree(text)


BOMBS = {
    "brackets": ("a: " + "[" * 30_000 + "]" * 30_000, "too-deep"),
    "braces": ("{a: " * 30_000, "too-deep"),
    "block": ("\n".join(" " * n + "a:" for n in range(200)), "too-deep"),
    "laughs": (
        "a0: &a0 [ha, ha]\n" + "".join(f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 10)}]\n" for n in range(1, 12)),
        "alias-expansion",
    ),
    "chain": (
        "a0: &a0 [ha]\n" + "".join(f"a{n}: &a{n} [*a{n - 1}]\n" for n in range(1, 200)),
        "too-deep",
    ),
    "merge": (
        "a0: &a0 {x: 1, y: 2}\n"
        + "".join(f"a{n}: &a{n} {{<<: [{', '.join([f'*a{n - 1}'] * 9)}]}}\n" for n in range(1, 11)),
        "merge-key",
    ),
    "large": ("a: " + "x" * MOST_BYTES, "too-large"),
    "duplicates": ("a: 1\n" * 20_000, "duplicate-key"),
    "colors": ("".join(f"a{n}: #fff\n" for n in range(20_000)), "comment-color"),
    "halves": ("a: [" + "f(x, y), " * 20_000 + "]", "torn-expression"),
    "sums": ("a: [" + "x + [0, 1], " * 20_000 + "]", "torn-expression"),
}


@pytest.mark.parametrize("name", BOMBS)
def test_bombs_are_refused_at_once(name: str) -> None:
    text, code = BOMBS[name]
    start = time.process_time()
    found = codes(text)
    assert time.process_time() - start < 1
    assert code in found
    assert len(found) <= composer.MOST_ERRORS


def test_a_merge_key_bomb_of_527_bytes_is_refused() -> None:
    rows = [f"a{n}: &a{n}\n <<: [{','.join([f'*a{n - 1}'] * 9)}]\n" for n in range(1, 10)]
    text = "a0: &a0 {x: 1}\n" + "".join(rows)
    text += "#" * (527 - len(text))
    assert len(text) == 527
    assert "merge-key" in codes(text)


def test_too_many_nodes_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(composer, "MOST_NODES", 1000)
    assert codes("a: [" + "1, " * 2000 + "]") == ["too-many-nodes"]
    assert plain(tree("a: [" + "1, " * 900 + "]"))


def test_bytes_are_utf_8() -> None:
    assert source_of("s", "\ufeffä: 1".encode()).text == "ä: 1"
    with pytest.raises(ScriptError) as caught:
        source_of("s.yaml", b"a: 1\n\xc3\xa4: \xe4")
    (found,) = caught.value.diagnostics
    assert (found.code, str(found.span)) == ("not-utf8", "s.yaml:2:4")


def test_the_collector_is_left_as_it_was() -> None:
    import gc

    for text in ("a: 1", "a: ["):
        gc.enable()
        try:
            tree(text)
        except ScriptError:
            assert text == "a: ["
        assert gc.isenabled()
