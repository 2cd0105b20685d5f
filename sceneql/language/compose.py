"""The composer: a tree of YAML 1.2 core types from PyYAML's events, with a span on every key and value, and limits."""

from __future__ import annotations

import gc
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Final, NoReturn, cast

import yaml

from sceneql.language.broken_values import Fault, broken_halves, broken_near, report, swallowed
from sceneql.language.encoded import MOST_BYTES, too_large
from sceneql.language.lines import doubled, lacking, left_out, marked, no_script, twice, unparted
from sceneql.language.merged import merged_as
from sceneql.language.plain import cut_off, kind_of
from sceneql.language.repair import blanked, cut_short, joined, repaired
from sceneql.language.syntax import explain, place, unprintable
from sceneql.language.tree import Mapping, Node, Scalar, Sequence, broken, extent, hole
from sceneql.quantities.diagnostic import LIMITS, Diagnostic, Diagnostics, Note, ScriptError
from sceneql.quantities.literal import comma_meant
from sceneql.quantities.span import Source, Span

MOST_DEPTH: Final = 64
MOST_NODES: Final = 3_000_000
MOST_EXPANDED: Final = 1_000_000
MOST_ERRORS: Final = 100
MOST_REREAD: Final = 2_000_000
"""Largest number of characters that are read again, beyond the first reading, to go on behind faults."""

_PROPERTIES = re.compile(r"(?:[&!][^\s,\[\]{}]*(?:\s+#[^\n]*|\s)*)*")
_TAG = re.compile(r"!\S*")

_LARGE: Final = "keep large tables in data files of their own"
_DEEP: Final = "give the inner parts names of their own, and refer to them by name"


def compose(source: Source, found: Diagnostics | None = None) -> Mapping:
    """The tree of a script. Raises ScriptError with all errors, up to where reading has to stop.

    With ``found``, errors are recorded there, and the tree is that of the readable text (see `compose_node`);
    ScriptError is raised only where nothing can be read, or a limit is exceeded.
    """
    root = compose_node(source, found=found)
    if isinstance(root, Mapping):
        return root
    message = "a script is a mapping of sections, not a list or a single value"
    raise ScriptError([Diagnostic("script-shape", message, root.span, no_script(root.span.text))])


def compose_node(source: Source, start: int = 0, found: Diagnostics | None = None) -> Node:
    """The tree of the text from character ``start`` on, of any kind. Raises ScriptError like `compose`.

    With ``found``, broken values are read as they were meant, and holes stand for unreadable values; mappings that lack
    an entry are marked partial; of a text that stops being YAML, the complete entries before that point are kept.
    """
    if source.text.startswith("\ufeff"):
        source = Source(source.name, source.text[1:])
    if len(source.text) > MOST_BYTES:
        raise too_large(source)
    if (at := unprintable(source.text)) is not None:
        message = f"the control character U+{ord(source.text[at]):04X} cannot stand in a script"
        span = Span(source, at, at + 1)
        raise ScriptError([Diagnostic("control-character", message, span, "delete it")])
    faults: list[Fault] = []
    # The tree has no cycles, and the garbage collector would walk all of it again and again while it grows.
    with _collector_off():
        for attempt in range(MOST_ERRORS):
            composer = _Composer(source, faults)
            again, root = composer.attempt(start)
            faults = joined(faults, again)[:MOST_ERRORS]
            if not again or len(faults) == MOST_ERRORS or attempt * len(source.text) > MOST_REREAD:
                break
    wrong = composer.found
    if again:  # halves of cut expressions may look like duplicate keys
        wrong.found.clear()
    report(source, faults, wrong)
    if wrong.found and (found is None or root is None or again or any(d.code in LIMITS for d in wrong.found)):
        wrong.raise_errors()
    for diagnostic in wrong.found:
        cast(Diagnostics, found).add(diagnostic)
    return cast(Node, root)


@contextmanager
def _collector_off() -> Iterator[None]:
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


class _StopError(Exception):
    """Reading cannot go on; the reason has been recorded."""


class _Composer:
    """One reading of the source, with repairs in place of the known ``faults``."""

    def __init__(self, source: Source, faults: list[Fault]) -> None:
        self.source = source
        self.text = blanked(source.text, faults) if faults else source.text
        self.faults = {fault.start: fault for fault in faults}
        self.found = Diagnostics()
        self.halves: list[Scalar] = []
        self.colors: list[Fault] = []
        self.unparted: list[Fault] = []
        self.nameless: dict[int, Node] = {}
        self.odd: list[Mapping] = []
        self.root: Node | None = None
        self.keyed = False
        self.anchors: dict[str, Node] = {}
        self.expanded = 0
        self.measured: dict[int, tuple[int, int]] = {}
        self.stack: list[Mapping | Sequence] = []

    def attempt(self, start: int) -> tuple[list[Fault], Node | None]:
        """Faults besides the known ones, and the tree of the readable text, if any."""
        near: list[Fault] = []
        try:
            self.document(start)
        except yaml.YAMLError as error:
            flow, at = self.flow_start(), place(self.source, error)
            if "nesting depth" in str(getattr(error, "problem", "")):
                # The parser reads ahead and has its own depth limit, so it may stop before these levels are counted.
                span = Span(self.source, at - 1, at)
                self.found.error("too-deep", f"more than {MOST_DEPTH} levels of lists and mappings", span, help=_DEEP)
            else:
                near = broken_near(self.source, self.text, at, flow)
                if not near and flow is None and (line := left_out(self.source, self.text, error)) is not None:
                    near = [line]
                if not near:
                    self.found.add(explain(self.source, error, flow))
            self.cut_short(at)
        except _StopError:
            self.cut_short(len(self.text))
        lacking(self.root, [*self.faults.values()])
        torn = joined([*broken_halves(self.halves[:MOST_ERRORS], self.text), *self.colors, *self.unparted], near)
        for mapping in self.odd:
            mapping.partial = True
            for name in [name for name in ("", "<<") if name in mapping.keys and not mapping.keys[name].quoted]:
                del mapping.entries[name], mapping.keys[name]
        return torn, self.root

    def cut_short(self, at: int) -> None:
        """Keep the complete entries where reading stopped."""
        if self.stack:
            self.root = self.stack[0]
            cut_short(self.stack, self.keyed, at)
        elif isinstance(self.root, Mapping):
            self.root.partial = True

    def document(self, start: int) -> None:
        """Read the only document of the source. Raises _StopError or yaml.YAMLError where reading cannot go on."""
        text = self.text
        loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)(" " * start + text[start:])
        try:
            loader.get_event()
            if type(loader.get_event()) is yaml.StreamEndEvent:
                self.stop("empty-script", "the script is empty", 0, 1, "write `objects:` and the objects below it")
            root = self.root = self.tree(loader)
            loader.get_event()
            if type(event := loader.get_event()) is not yaml.StreamEndEvent:
                at = event.start_mark.index
                self.stop("several-documents", "a second document starts here", at, at + 3, "one file is one script")
        finally:
            loader.dispose()
        if isinstance(root, Scalar) and root.kind == "null":
            self.root = None
            self.stop("empty-script", "the script is empty", 0, 1, "write `objects:` and the objects below it")

    def tree(self, loader: yaml.SafeLoader) -> Node:
        """The node of the next events. Raises _StopError or yaml.YAMLError."""
        # One flat loop over local names: a script of 10 MB has 1.6 million events.
        source = self.source
        get: Callable[[], Any] = loader.get_event
        scalar_event, alias_event = yaml.ScalarEvent, yaml.AliasEvent
        open_mapping, open_sequence = yaml.MappingStartEvent, yaml.SequenceStartEvent
        stack, faults, nameless = self.stack, self.faults, self.nameless
        here: Any = None
        key: Any = None
        end = count = 0
        try:
            while True:
                event = get()
                kind = type(event)
                node: Any
                if kind is scalar_event:
                    text = event.value
                    end = event.end_mark.index
                    if event.style:
                        node = Scalar(text, "text", True, source, event.start_mark.index, end)
                        if event.style in "|>":
                            end = node.end = node.start + len(source.text[node.start : end].rstrip())
                    else:
                        node = Scalar(text, kind_of(text), False, source, event.start_mark.index, end)
                        if not text:
                            if key is not None and cut_off(key.text) and self.cut(key, here):
                                key = None
                                continue
                            self.empty(node)
                        elif faults and text[0] == "x":
                            node = self.meant(event, node)
                            if type(node) is Sequence and key is None and type(here) is Mapping:
                                node = hole(node.span)  # no key is a list
                            text = node.text if type(node) is Scalar else text
                        elif faults and any(node.start < at < end for at in faults):
                            node = hole(node.span)  # an error inside it was reported already
                        elif "(" in text and text.count("(") > text.count(")") and here is not None and here.flow:
                            self.halves.append(node)
                elif kind is open_mapping:
                    end = event.end_mark.index
                    node = Mapping({}, {}, event.flow_style, source, event.start_mark.index, end)
                elif kind is open_sequence:
                    end = event.end_mark.index
                    node = Sequence([], event.flow_style, source, event.start_mark.index, end)
                elif kind is alias_event:
                    start, end = event.start_mark.index, event.end_mark.index
                    node = self.alias(event.anchor, Span(source, start, end))
                else:
                    if here.flow:
                        end = event.end_mark.index
                    here.end = end
                    key = None
                    stack.pop()
                    if not stack:
                        return cast(Node, here)
                    if nameless and nameless.pop(id(here), None) is not None:
                        key = Scalar("", "text", False, source, here.start, end)
                    here = stack[-1]
                    continue

                count += 1
                if count > MOST_NODES:
                    self.stop("too-many-nodes", f"the script has more than {MOST_NODES:,} values", end - 1, end, _LARGE)
                if kind is not alias_event and (event.anchor is not None or event.tag is not None):
                    self.properties(event, node)
                if here is None:
                    if kind is scalar_event:
                        return cast(Node, node)
                elif type(here) is Sequence:
                    here.items.append(node)
                elif key is None:
                    if kind is scalar_event:
                        key = node
                        if not key.quoted and (text in ("", "<<") or text[-1] == ":" or "{" in text or "[" in text):
                            key = self.odd_key(key, here)
                        continue
                    self.nameless_key(node, here)
                    if kind is alias_event:
                        key = Scalar("", "text", False, source, node.start, end)
                        continue
                else:
                    text = key.text
                    if text in here.entries:
                        self.duplicate(key, here)
                    else:
                        here.entries[text] = node
                        here.keys[text] = key
                    key = None
                if kind is open_mapping or kind is open_sequence:
                    if len(stack) >= MOST_DEPTH:
                        self.stop(
                            "too-deep", f"more than {MOST_DEPTH} levels of lists and mappings", end - 1, end, _DEEP
                        )
                    here = node
                    stack.append(here)
        except (yaml.YAMLError, _StopError):
            self.keyed = key is not None
            raise

    def flow_start(self) -> int | None:
        """Offset of the outermost open flow collection; None if there is none."""
        return next((one.start for one in self.stack if one.flow), None)

    def empty(self, node: Scalar) -> None:
        """Record a color behind an empty value, which YAML took for a comment."""
        fault = swallowed(node, self.text)
        if fault is not None and len(self.colors) < MOST_ERRORS:
            self.colors.append(fault)

    def cut(self, key: Scalar, mapping: Mapping) -> bool:
        """Report a key that a comma has cut off the value before, which becomes a hole.

        Returns whether there is such a value.
        """
        if key.quoted or not mapping.flow or not mapping.entries:
            return False
        before = next(reversed(mapping.entries))
        if not broken(mapping.entries[before]):
            help = comma_meant(self.source.text, mapping.entries[before].start)
            self.error("decimal-comma", "a comma ends the value before this", key.span, help=help)
            mapping.entries[before] = hole(mapping.entries[before].span)
        return True

    def meant(self, event: Any, node: Scalar) -> Node:
        """The repaired value where a scalar stands for a fault; otherwise the scalar itself."""
        fault = self.faults.get(self.behind_properties(event))
        return node if fault is None else repaired(fault, self.source)

    def behind_properties(self, event: Any) -> int:
        """Offset of a node's text behind its anchor and tag."""
        at: int = event.start_mark.index
        properties = _PROPERTIES.match(self.text, at, event.end_mark.index)
        return at if properties is None else properties.end()

    def properties(self, event: Any, node: Node) -> None:
        """Record an anchor, report a tag, and set the node's start behind both."""
        text, at = self.text, event.start_mark.index
        node.start = self.behind_properties(event)
        if event.tag is not None and (tag := _TAG.search(text, at)) is not None:
            message = f"the tag {tag[0]} means nothing in a script"
            self.error("yaml-tag", message, Span(self.source, *tag.span()), help="delete it; a text goes in quotes")
        if event.anchor is not None:
            self.anchors[event.anchor] = node

    def alias(self, name: str, span: Span) -> Node:
        """The node of an anchor, shared; limits count it as if it stood there in full."""
        node = self.anchors.get(name)
        merged = self.text[: span.start].rstrip().endswith("<<:")  # which is reported
        if node is None and (merged or marked(name, self.source, self.faults.values())):
            return hole(span)
        if node is None:
            message = f"*{name} is an alias, and no value above is marked &{name}"
            help = f"write `{name}` without the star for a define; a text that begins with * goes in quotes"
            self.error("unknown-alias", message, span, help=help)
            if not self.stack:
                raise _StopError
            return hole(span)
        if any(node is collection for collection in self.stack):
            message = f"*{name} stands inside the value that it names"
            self.error("alias-cycle", message, span, help="a value cannot hold itself; remove the alias")
            return hole(span)
        depth, size = extent(node, self.measured)
        self.expanded += size
        if self.expanded > MOST_EXPANDED:
            message = f"aliases repeat more than {MOST_EXPANDED:,} values"
            self.stop("alias-expansion", message, span.start, span.end, "`repeat` makes many copies of a part")
        if len(self.stack) + depth > MOST_DEPTH:
            message = f"with what *{name} names, more than {MOST_DEPTH} levels of lists and mappings"
            self.stop("too-deep", message, span.start, span.end, _DEEP)
        return node

    def nameless_key(self, node: Node, mapping: Mapping) -> None:
        """Report a key that is no text, once for nested ones; its value is left out."""
        self.odd.append(mapping)
        if not self.nameless:
            alone = re.match(r"\{\{\s*([\w.]+)\s*\}\}", self.source.text[node.start - 1 : node.start + 80])
            help = f"a name stands by itself, without braces: write `{alone[1]}`" if alone else "write `name: value`"
            self.error("key-not-text", "a key is a word or text", Span(self.source, node.start, node.end), help=help)
        if not isinstance(node, Scalar):
            self.nameless[id(node)] = node

    def odd_key(self, key: Scalar, mapping: Mapping) -> Scalar:
        """Report a missing key or a merge key, whose values are left out, or a colon that a key has too many or lacks.

        Returns the key as it was meant.
        """
        if key.text.rstrip(":") and key.text[-1] == ":":
            key, diagnostic = doubled(key)
            self.add(diagnostic)
            return key
        if key.text not in ("", "<<"):
            if not mapping.flow and len(self.unparted) < MOST_ERRORS and (line := unparted(key)) is not None:
                self.unparted.append(line)
            return key
        self.odd.append(mapping)
        if broken(key):
            return key
        if key.text:
            help = merged_as(self.source.text, key.start)
            self.error("merge-key", "merge keys (<<) are not part of the language", key.span, help=help)
        else:
            self.error("key-not-text", "a key is missing before this colon", key.span, help="write `name: value`")
        return key

    def duplicate(self, key: Scalar, mapping: Mapping) -> None:
        """Report a key that its mapping holds already; the first stays."""
        if key.text in ("", "<<") and not key.quoted:
            return
        self.add(twice(key, mapping.keys[key.text], section=mapping is self.stack[0]))

    def error(self, code: str, message: str, span: Span, *, help: str, notes: list[Note] | None = None) -> None:
        """Record an error; raises _StopError where there are too many."""
        self.add(Diagnostic(code, message, span, help, tuple(notes or ())))

    def add(self, diagnostic: Diagnostic) -> None:
        """Record a diagnostic; raises _StopError where there are too many."""
        self.found.add(diagnostic)
        if len(self.found.found) >= MOST_ERRORS:
            raise _StopError

    def stop(self, code: str, message: str, start: int, end: int, help: str) -> NoReturn:
        """Record an error that ends the reading; raises _StopError."""
        self.found.error(code, message, Span(self.source, start, end), help=help)
        raise _StopError
