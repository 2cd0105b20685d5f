"""Help for merge keys of YAML, ``<<: *base``: the part that is like another one, by `use`."""

from __future__ import annotations

import re

_MERGED = re.compile(r"<<\s*:\s*\*(\w+)[ \t]*,?[ \t]*([^{}\[\]\n]*(?:\[[^\[\]\n]*\][^{}\[\]\n]*)*)(\}?)")
_OWNERS = re.compile(r"(\w+)\s*:\s*\{?\s*(?:(\w+)\s*:\s*\{?\s*)?\Z")
_SHARED = "use `defaults` for fields that many parts share, or `templates` for a part made several times"


def merged_as(text: str, at: int) -> str:
    """The help for the merge key at ``at`` of a script."""
    merged = _MERGED.match(text, at)
    anchor = None if merged is None else re.search(rf"&{merged[1]}\b", text)
    above = None if merged is None else re.search(rf"^\s+{merged[1]}\s*:", text[:at], re.MULTILINE)
    whole = _OWNERS.search(text[max(0, at - 200) : at])
    if merged is not None and anchor is None and above is not None and whole is not None and merged[3]:
        more = f", {merged[2].strip().rstrip(',')}" if merged[2].strip() else ""
        owner = whole[1]
        return f"a part like another one has its name, and what differs: write `{owner}: {{use: {merged[1]}{more}}}`"
    before = None if anchor is None else _OWNERS.search(text[max(0, anchor.start() - 200) : anchor.start()])
    own = _OWNERS.search(text[max(0, at - 200) : at])
    if merged is None or before is None or own is None or own[2] is None or before[2] is None:
        return _SHARED
    rest = f", {merged[2].strip().rstrip(',')}" if merged[2].strip() and merged[3] else ""
    more = "" if merged[3] else ", with the fields that differ behind it in the braces"
    return f"a part like another one has its name, and what differs: write `{own[1]}: {{use: {before[1]}{rest}}}`{more}"
