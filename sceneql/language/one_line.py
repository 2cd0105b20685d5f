"""A value as a script writes it in one line, in braces and brackets: for messages that repeat it."""

from __future__ import annotations

from sceneql.language.tree import Mapping, Node, Sequence


def one_line(node: Node) -> str:
    """The text of a value, in braces and brackets where it stands over several lines; dots for a text of several."""
    text = node.span.text
    whole = not isinstance(node, Mapping | Sequence) or text[:1] in ("{", "[")
    if whole and "\n" not in text:
        return text
    if isinstance(node, Mapping):
        return f"{{{', '.join(f'{name}: {one_line(value)}' for name, value in node.entries.items())}}}"
    if isinstance(node, Sequence):
        return f"[{', '.join(map(one_line, node.items))}]"
    return "..."
