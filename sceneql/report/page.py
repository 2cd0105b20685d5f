"""Reports as single static HTML pages with text, tables and plots."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from sceneql.files import refuse_unwritable, try_folder, whole
from sceneql.graph import SimulationGraph

EXTENSIONS = ("csv", "html", "json", "png", "svg")
"""Extensions of all files of reports."""

TEMPLATE = """\
<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{{ title }}</title>
<style>
  body { font: 15px/1.5 system-ui, sans-serif; color: #222; max-width: 64rem; margin: 2rem auto; padding: 0 1rem }
  h1 { font-size: 1.5rem } h2 { font-size: 1.1rem; margin-top: 2rem }
  img { max-width: 100% }
  .wide { overflow-x: auto }
  table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: 13px }
  th, td { padding: .15rem .7rem; text-align: right; border-bottom: 1px solid #ddd; white-space: nowrap }
  th:first-child, td:first-child { text-align: left }
  .stable { background: #d9f0e1 } .inaccurate { background: #fbf0cd } .failed { background: #f1cfc6 }
</style>
<h1>{{ title }}</h1>
{% for line in lines %}<p>{{ line }}</p>
{% endfor %}
{% for caption, data in plots %}<h2>{{ caption }}</h2>
<img alt="{{ caption }}" src="data:image/svg+xml;base64,{{ data }}">
{% endfor %}
{% for table in tables %}<h2>{{ table.caption }}</h2>
<div class="wide"><table>
<tr>{% for head in table.head %}<th>{{ head }}</th>{% endfor %}</tr>
{% for row in table.rows %}<tr>
{%- for text, style in row %}<td{% if style %} class="{{ style }}"{% endif %}>{{ text }}</td>{% endfor -%}
</tr>
{% endfor %}</table></div>
{% endfor %}
<p>Made by sceneql {{ version }}.</p>
</html>
"""


@dataclass(frozen=True, slots=True)
class Table:
    """A table of texts, each with its CSS class or ""."""

    caption: str
    head: Sequence[str]
    rows: Sequence[Sequence[tuple[str, str]]]


def write_page(
    path: Path, title: str, lines: Sequence[str], plots: Sequence[tuple[str, Path]], tables: Sequence[Table]
) -> None:
    """Write a page with paragraphs, SVGs by caption, and tables; texts are escaped."""
    from jinja2 import Environment

    from sceneql import __version__

    pictures = [(caption, b64encode(file.read_bytes()).decode("ascii")) for caption, file in plots]
    template = Environment(autoescape=True).from_string(TEMPLATE)
    text = template.render(title=title, lines=lines, plots=pictures, tables=tables, version=__version__)
    with whole(path) as stream:
        stream.write(text.encode())


def file_names(graph: SimulationGraph, kind: str, output: Path | None) -> Path:
    """The files' path without extension: ``<scene>.<kind>`` in a folder, or as the user named it.

    To be called before anything is run. Raises OSError where the files cannot be written, and Unsuitable where names
    are too long or those of files that the script reads.
    """
    stem = (output or Path()) / f"{graph.name}.{kind}" if output is None or output.is_dir() else output
    try_folder(stem.parent)
    for extension in EXTENSIONS:
        refuse_unwritable(beside(stem, extension), graph.origin.files, marks=r"(\.\w+)?")
    return stem


def beside(stem: Path, extension: str) -> Path:
    """The path of a file of the report: ``scene.bench`` and ``csv`` make ``scene.bench.csv``; one of `EXTENSIONS`."""
    return stem.with_name(f"{stem.name}.{extension}")
