"""Drawings and texts made to do harm: refused by name and place, or read, in time and memory that stay small."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from runs import complaint
from sceneql.grids.domain import svg
from sceneql.grids.domain.svg_path import curves
from sceneql.language.compose import compose
from sceneql.language.within import within
from sceneql.pictures.mathematics import DEEPEST, fault, printed
from sceneql.quantities.diagnostic import Diagnostic
from sceneql.quantities.span import Source

HEAD = '<svg xmlns="http://www.w3.org/2000/svg">'
GOOD = '<path d="M0 0 h10 v10 h-10 Z"/>'
OVERLAY = "overlays: {{say: {overlay}}}\noutputs: {{film: video}}\n"
LIMITED = """
import resource, sys
resource.setrlimit(resource.RLIMIT_CPU, (5, 6))
from sceneql.grids.domain import svg
base = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
try:
    svg.rings(sys.argv[1])
    print("read")
except ValueError as error:
    print(error)
print((resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - base) // 1024)
"""


def drawn(folder: Path, text: str) -> str:
    path = folder / "s.svg"
    path.write_text(text, encoding="utf-8")
    return str(path)


@pytest.mark.parametrize(
    ("inner", "said"),
    [
        (f'<path d="M0 0 {"1 2 " * 950_000}"/>', "more than 100000 commands"),
        (f'<path d="M0 0 {"a1 1 0 0 0 1 1" * 250_000}"/>', "more than 100000 commands"),
        (f'<path transform="{"scale(1)" * 300_000}" d="M0 0h1v1z"/>', "more than 1000 steps"),
        (f'<path transform="rotate(9){" " * 3_000_000}x" d="M0 0h1v1z"/>', "the transform 'x' is not read"),
        ('<circle r="1"/>' * 250_000, "more than 100000 curves"),
        ("<g>" * 500_000 + "</g>" * 500_000, "nested more than 100 deep"),
    ],
    ids=["numbers", "arcs", "transforms", "spaces", "elements", "groups"],
)
def test_a_huge_drawing_takes_seconds_and_little_memory(tmp_path, inner, said):
    path = drawn(tmp_path, f"{HEAD}{inner}</svg>")
    ran = subprocess.run([sys.executable, "-c", LIMITED, path], capture_output=True, text=True, check=True)
    told, grown = ran.stdout.splitlines()
    assert said in told
    assert len(told) < 200
    assert int(grown) < 250


@pytest.mark.parametrize("name", ["rot13", "zlib", "nonsense", "utf-7", "utf-32", "idna", "punycode", "x" * 100_000])
def test_a_drawing_in_no_encoding_of_letters_is_no_svg(tmp_path, name):
    with pytest.raises(ValueError, match=r"^s\.svg is no SVG: .{1,100}$"):
        svg.rings(drawn(tmp_path, f'<?xml version="1.0" encoding="{name}"?>{HEAD}{GOOD}</svg>'))


@pytest.mark.parametrize(
    ("inner", "said"),
    [
        ('<rect width="1e300" height="1e300"/>', "a width beyond"),
        ('<rect width="1e308" height="1e308" x="1e308"/>', "a x beyond"),
        ('<rect width="1e999" height="1"/>', "a width beyond"),
        ('<rect width="1" height="1" transform="scale(1e80) scale(1e80)"/>', "a point beyond"),
        ('<rect width="1" height="1" transform="rotate(1e999)"/>', "not finite"),
        ('<path d="M0 0 h1e300 v1z"/>', "a number beyond"),
        ('<rect width="1e-200" height="1e-200"/>', "not between"),
        (
            '<g transform="translate(1e100,4) skewX(10)"><ellipse rx="2" ry="1"/></g>',
            "4.* from its origin|2 wide or high",
        ),
        ('<rect width="1" height="1" x="1e12"/>', "rounding takes its shape"),
        (f'<path transform="{"s" * 9999}" d="M0 0h1v1z"/>', "the transform 's{40}...' is not read"),
    ],
)
def test_a_drawing_with_sides_beyond_all_measure_is_refused(tmp_path, inner, said):
    with pytest.raises(ValueError, match=rf"^s\.svg.*{said}"):
        svg.rings(drawn(tmp_path, f"{HEAD}{inner}</svg>"))


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
@pytest.mark.parametrize("declared", ['<!ENTITY a "aaaa">', '<!ATTLIST path id CDATA "aaaa">'])
def test_what_stands_for_more_than_it_takes_is_refused_in_every_encoding(tmp_path, encoding, declared):
    path = tmp_path / "s.svg"
    path.write_bytes(
        f'<?xml version="1.0" encoding="{encoding}"?><!DOCTYPE s [{declared}]>{HEAD}</svg>'.encode(encoding)
    )
    with pytest.raises(ValueError, match="entities"):
        svg.rings(str(path))


def test_a_drawing_that_was_rewritten_is_read_again(tmp_path):
    path = drawn(tmp_path, f"{HEAD}{GOOD}</svg>")
    assert abs(svg.area(svg.rings(path)["path"])) == pytest.approx(100)
    drawn(tmp_path, f'{HEAD}<path d="M0 0 h20 v10 h-20 Z"/></svg>')
    assert abs(svg.area(svg.rings(path)["path"])) == pytest.approx(200)


@pytest.mark.parametrize("radii", ["1e-300 2e-300", "1e-60 2e-60", "1e-9 2e-9"])
def test_radii_of_an_arc_that_are_far_too_small_are_made_as_large_as_they_must_be(radii):
    """Ends that the radii do not reach have an ellipse of their ratio between them (appendix B.2.5)."""
    small, enough = (curves(f"M0 0 A {text} 0 0 1 10 0")[0] for text in (radii, "1 2"))
    for one, other in zip(small, enough, strict=True):
        assert one == pytest.approx(other, abs=1e-9)


@pytest.mark.parametrize(("large", "reach"), [(0, 1.0), (1, 2e20)])
def test_an_arc_of_a_huge_radius_is_a_line_or_all_but_the_whole_circle(large, reach):
    points = [point for curve in curves(f"M0 0 A 1e20 1e20 0 {large} 1 1 0")[0] for point in (curve[0], curve[3])]
    assert max(map(abs, points)) == pytest.approx(reach, rel=1e-3)


# --- texts ---


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        (r"a: 'x = \foo b'", r"\foo"),
        (r'a: "x = \\foo b"', r"\\foo"),
        (r'a: "\u00e9 \x41 \\foo b"', r"\\foo"),
        ("a: 'it''s \\foo'", r"\foo"),
        ("a: |\n  x =\n    \\foo b", r"\foo"),
        ("a: >-\n  x =\n\n  \\foo b", r"\foo"),
        ("a:\n  x =\n  \\foo b", r"\foo"),
        ('a: "x \\\n   \\\\foo b"', r"\\foo"),
    ],
)
def test_a_part_of_a_text_is_found_where_the_script_writes_it(text, wrong):
    node = compose(Source("s.yaml", text)).entries["a"]
    at = node.text.index(r"\foo")
    assert within(node, at, at + 4).text == wrong
    assert within(node, at, at + 4).start == text.index(wrong)


@pytest.mark.parametrize("group", [r"\frac{1}{", r"\sqrt{", "x^{", "{", r"\hat{"])
def test_a_formula_is_set_as_deep_as_is_allowed_and_refused_beyond(group):
    assert fault(group * DEEPEST + "x" + "}" * DEEPEST) is None
    assert printed(group * DEEPEST + "x" + "}" * DEEPEST, 12).max() > 100
    said, start, end = fault(group * 200 + "x" + "}" * 200)
    assert "nested" in said
    assert start < end


@pytest.mark.parametrize(
    ("tex", "at"),
    [
        (r"a = \foo b", r"\foo"),
        (r"\frac{1}{\foo}", r"\foo"),
        (r"a = \frac{1", r"\frac"),
        ("a } b", "}"),
        ("50 % a", "%"),
        (r"x \right)", r"\right"),
        ("x^", "^"),
        (r"\hspace{99999999} a", r"\hspace{99999999} a"),
        (r"\genfrac{(}{)}{1000000}{0}{1}{2}", r"\genfrac{(}{)}{1000000}{0}{1}{2}"),
        (" ", " "),
    ],
)
def test_a_formula_that_cannot_be_set_has_its_place(tex, at):
    said, start, end = fault(tex)
    assert tex[start:end] == at
    assert "\n" not in said


@pytest.mark.parametrize(
    "overlay", ["{{caption: {{text: '{}'}}}}", "{{formula: {{tex: '{}'}}}}", "{{graph: {{y: time, title: '{}'}}}}"]
)
def test_a_text_of_a_million_letters_is_refused(tmp_path, overlay):
    told = complaint(tmp_path, OVERLAY.format(overlay=overlay.format("a" * 10**6)))
    assert "error[limit-refused]: a text of 1,000,000 letters is longer" in told
    assert len(told) < 1_000


def test_a_name_of_megabytes_is_not_echoed():
    assert len(str(Diagnostic("unknown-name", f"nothing is called '{'a' * 5_000_000}'", None, "b" * 5_000_000))) < 5_000


@pytest.mark.parametrize(
    "text", ["a\nb", "a\x00b\tc\x1b[31m", "\u202ea\u200fb\u0301", "\u200b", "", "\U0001f468\u200d\U0001f600", "\u2028"]
)
def test_marks_and_controls_are_drawn_on_one_line(text):
    import numpy as np

    from sceneql.pictures.lettering import Letterer

    letters = Letterer(np.zeros((40, 200, 3), dtype=np.uint8), 0.3)
    letters.line((0, 0), text, 0.5)
    letters.edged((50, 20), text)
    letters.done()
    assert letters.extent(text)[1] == letters.extent("a")[1]
    assert letters.extent("a\u202eb") == letters.extent("ab")


# --- numbers and fields ---


@pytest.mark.parametrize(
    ("script", "said"),
    [
        ("models: {a: {diffusion: {size: 1 1e308 m, cell: 1 mm, coefficient: '1'}}}", "limit-refused"),
        ("models: {a: {diffusion: {size: 1 1e-300 m, cell: 1 mm, coefficient: '1'}}}", "a side is at least 1e-100 m"),
        (
            "objects: {o: sphere}\nmodels: {a: {diffusion: {domain: o, cell: 1e-300 m, coefficient: '1'}}}",
            "a cell is at least 1e-100 m",
        ),
        ("models: {a: {diffusion: {size: 1 1 m, cell: 1 m, coefficient: [1]}}}", "coefficient is one number"),
        (
            "models: {a: {diffusion: {size: 1 1 m, cell: 1 m, coefficient: 1, initial: [1, 2]}}}",
            "initial is one number",
        ),
        ("models: {a: {particles: {emit: {rate: 1e300 1/s, lifetime: 1e300 s, from: 0 0 0 m}}}}", "limit-refused"),
        ("models: {a: {mass_spring: {cloth: {cells: 1e308 12, size: 1 1 m}}}}", "out-of-range"),
        ("define: {k: 1}\nstudies: {s: {of: k, sweep: {define.k: 1e-300 .. 1e300}}}", ""),
        ("define: {k: 1}\nstudies: {s: {of: k, sweep: {define.k: 1 .. 1e999}}}", "a range has finite ends"),
        (
            f"define: {{k: 1}}\nstudies: {{s: {{of: k, sweep: {{define.k: '1 .. 2, {'9' * 5000} points'}}}}}}",
            "a range has 2 to 200",
        ),
        (f"define: {{k: 1}}\nstudies: {{s: {{of: k, sweep: {{define.k: '1 .. 2{' ' * 9000}x, y'}}}}}}", "sweep-shape"),
        (
            "templates: {t: {fields: {r: 1 m}, objects: {b: {sphere: {radius: r}}}}}\nparts: {p: {t: {r: null}}}",
            "the field 'r' of 't' has no value",
        ),
        ("objects:\n  - r:{ }1\n  a: 1\n- b", "error["),
    ],
)
def test_odd_numbers_and_empty_fields_are_told(tmp_path, script, said):
    told = complaint(tmp_path, f"{script}\noutputs: {{film: video}}\n")
    assert said in told
    assert "Traceback" not in told
