"""Plain values of a file with their places: the only module that reads YAML; splice.py asks where values stand.

Grammar: YAML 1.2 by the events of libyaml, in PyYAML, which are turned into values here in one pass, so
that no input costs more than the limits below, and every key keeps its line. Plain scalars follow the
core schema of YAML 1.2.2, 10.3.2 (PyYAML's own also takes `1_000`, `no` and dates).
"""

import difflib
import os
import re
import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Any, Final, NoReturn

import yaml
from yaml.reader import ReaderError

from tol3d.errors import Problem, SceneError
from tol3d.scene.place import Key, KeyPath, Node, Origin, Place, Places, branch, plain
from tol3d.units import shown

MAX_BYTES: Final = 4_000_000  # seven times a scene of 300 parts and 1800 tolerances, which takes a second to parse
MAX_DEPTH: Final = 40  # levels; the grammar needs nine, and pydantic and JSON would recurse
MAX_NODES: Final = 500_000  # values, aliases written out; that scene has 57 000, each some 3 kB and 50 us until it runs
KEPT_TEXTS: Final = 16  # whose values are kept; scanning one takes fifty times as long as copying them
MERGE: Final = "<<"  # the key of YAML 1.1 by which a mapping has the keys of others, as all parsers still read it
MAX_DIGITS: Final = 300  # a longer number is kept as text and refused by the field

BRACKETS: Final = re.compile(rf"(?:[\[{{]\s*){{{MAX_DEPTH + 1}}}")  # the scanner's work grows with their square

NULL: Final = frozenset(("", "~", "null", "Null", "NULL"))
TRUTH: Final = {"true": True, "True": True, "TRUE": True, "false": False, "False": False, "FALSE": False}
SPECIAL: Final = frozenset("~nNtTfF.+-0123456789")  # what plain scalars that are no text begin with
INTEGER: Final = re.compile(r"[-+]?[0-9]+")
OCTAL_OR_HEX: Final = re.compile(r"0o[0-7]+|0x[0-9a-fA-F]+")
FLOAT: Final = re.compile(r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?")
INFINITE_OR_NAN: Final = re.compile(r"([-+]?)\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)")

LOADER: Final[Any] = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # the second, slower one where libyaml is not there

HINTS: Final = {
    "mapping values are not allowed": 'a ":" too many or a wrong indent; text with ": " inside needs quotes',
    "tab character": "indent with spaces, not with tabs",
    "did not find expected key": "look at the indents: keys of one level start in one column",
    "could not find expected ':'": 'a key needs ":" and a space after it',
    "did not find expected ',' or": "a comma or a closing bracket is missing",
    "unexpected end of stream": "a quote is opened and never closed",
    "did not find expected node content": "a bracket is opened and never closed",
    r"'\t' that cannot start": "indent with spaces, not with tabs",
    "cannot start any token": "put text that starts with such a character into quotes",
}


def read_scene_text(path: Path) -> tuple[Node, Origin]:
    """Read a scene's file.

    Args:
        path: the file, UTF-8.

    Returns:
        The top-level mapping (keys are text; values dict, list, text, int, float, bool or None), and
        its source.

    Raises:
        SceneError: it cannot be read, is no YAML 1.2, repeats a key or exceeds a limit above.
    """
    return scene_text(path, _content(path))


def scene_text(path: Path, content: bytes, *, included: bool = False) -> tuple[Node, Origin]:
    """The same of a file that was read.

    Args:
        path: its path, for messages.
        content: its bytes.
        included: True if another file includes it, so that its places give its name.

    Raises:
        SceneError: as of read_scene_text.
    """
    origin = Origin(path, _decoded(path, content))
    top = _composed(_Source(origin.text, str(path) if included else "", origin))
    if not isinstance(top.value, dict):
        raise origin.error((), f"expected keys such as scene:, parts:, moves:, measures:, got {shown(plain(top))}")
    return top, replace(origin, places=Places(top))


def values_in(path: Path, content: bytes) -> Any:
    """Values of another file; keys that are numbers are as they are written.

    Raises:
        SceneError: as of read_scene_text.
    """
    origin = Origin(path, _decoded(path, content))
    return plain(_composed(_Source(origin.text, "", origin, any_keys=True)))


# the file ---------------------------------------------------------------------------------------


def _content(path: Path) -> bytes:
    if os.path.isdir(path):
        raise SceneError(Problem.at(path, f"expected a scene file, got a folder{_scene_inside(path)}"))
    if os.path.exists(path) and not os.path.isfile(path):  # a pipe would be waited for, a device may never end
        raise SceneError(Problem.at(path, "expected a scene file, got a pipe or a device"))
    try:
        with path.open("rb") as stream:
            content = stream.read(MAX_BYTES + 1)
    except FileNotFoundError:
        words = f"expected a scene file, found no file of that name{near_file(path)}"
        raise SceneError(Problem.at(path, words)) from None
    except (OSError, ValueError) as error:  # ValueError: a NUL in the name
        reason = getattr(error, "strerror", None) or error
        raise SceneError(Problem.at(path, f"expected a scene file that can be read, got: {reason}")) from None
    if len(content) > MAX_BYTES:
        words = f"expected a scene of at most {MAX_BYTES // 10**6} MB, got a larger file"
        raise SceneError(Problem.at(path, words, line=1))
    return content


def _decoded(path: Path, content: bytes) -> str:
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        words = f"expected UTF-8 text, got the byte 0x{content[error.start]:02x}, which is none"
        raise SceneError(Problem.at(path, words, line=line)) from None


def _scene_inside(folder: Path) -> str:
    names = sorted(entry.name for entry in folder.glob("*.yaml"))
    return f"; give a file in it, such as {folder / names[0]}" if names else ""


def near_file(path: Path) -> str:
    """The file of the nearest name beside one that is not there, to end a message; "" if none is near."""
    try:
        names = [entry.name for entry in path.parent.iterdir()]
    except OSError:
        return ""
    near = difflib.get_close_matches(path.name, names, n=1)
    return f"; did you mean {path.parent / near[0]}?" if near else ""


# its YAML ---------------------------------------------------------------------------------------


def _events(origin: Origin, text: str) -> Iterator[yaml.Event]:
    """Events of a text; any fault gives one message."""
    try:
        yield from yaml.parse(text, Loader=LOADER)
    except ReaderError as error:
        character = error.character if isinstance(error.character, int) else ord(error.character)
        line = text[: text.find(chr(character))].count("\n") + 1
        raise origin.error((), f"not YAML: the character U+{character:04X} is not allowed", Place(line, 1)) from None
    except yaml.MarkedYAMLError as error:
        mark, start = error.problem_mark or error.context_mark, error.context_mark
        place = Place(mark.line + 1, mark.column + 1) if mark else Place(1, 1)
        here = "".join(text.split("\n")[place.line - 1 : place.line])[place.column - 1 :][:1]
        problem = str(error.problem or error.context).replace("character that", f"character {here!r} that")
        advice = next((f"; {advice}" for words, advice in HINTS.items() if words in problem), "")
        begun = f", begun in line {start.line + 1}" if start and mark and start.line < mark.line else ""
        raise origin.error((), f"not YAML: {problem} (column {place.column}{begun}){advice}", place) from None


@dataclass(frozen=True)
class _Source:
    """A text, the same in any folder; only for the name of an included file, which its places give."""

    text: str
    file: str
    origin: Origin = field(compare=False)
    any_keys: bool = False


@lru_cache(maxsize=KEPT_TEXTS)
def _composed(source: _Source) -> Node:
    """The document of a text, not to be changed: a scene is read again by each replay and comparison."""
    if brackets := BRACKETS.search(source.text):
        place = Place(source.text.count("\n", 0, brackets.start()) + 1, 1)
        raise source.origin.error((), f"expected at most {MAX_DEPTH} levels of brackets and indents, got more", place)
    return _Composer(source, _events(source.origin, source.text)).document()


@dataclass
class _Composer:
    """One pass over the events of a document: values, places, limits."""

    source: _Source
    events: Iterator[yaml.Event]
    anchors: dict[str, Node] = field(default_factory=dict)
    nodes: int = 0

    def document(self) -> Node:
        """The only document of the file."""
        next(self.events)  # the start of the stream
        if not isinstance(next(self.events), yaml.DocumentStartEvent):
            raise self.source.origin.error(
                (), "expected a scene (scene:, parts:, moves:, measures:), got an empty file"
            )
        top = self._node(next(self.events), ())
        next(self.events)  # the end of the document
        following = next(self.events)
        if not isinstance(following, yaml.StreamEndEvent):
            self._refuse((), 'expected one scene in a file, got a second document ("---")', self._place(following))
        return top

    def _place(self, event: Any) -> Place:
        mark = event.start_mark
        return Place(mark.line + 1, mark.column + 1, self.source.file)

    def _refuse(self, path: KeyPath, sentence: str, place: Place) -> NoReturn:
        raise self.source.origin.error(path, sentence, place)

    def _node(self, event: Any, path: KeyPath) -> Node:
        place = self._place(event)
        if isinstance(event, yaml.AliasEvent):
            return self._alias(event, path)
        assert isinstance(
            event, yaml.ScalarEvent | yaml.SequenceStartEvent | yaml.MappingStartEvent
        )  # the parser's grammar
        if event.tag is not None:
            tag = shown(str(event.tag).replace("tag:yaml.org,2002:", "!!"))
            self._refuse(path, f"expected no tags, got {tag}; put text into quotes instead", place)
        if len(path) >= MAX_DEPTH:
            self._refuse(path[:3], f"expected at most {MAX_DEPTH} levels of brackets and indents, got more", place)
        self._count(1, path, place)
        if isinstance(event, yaml.ScalarEvent):
            node = Node(self._scalar(event, path), place)
        elif isinstance(event, yaml.SequenceStartEvent):
            node = self._list(path, place)
        else:
            node = self._mapping(path, place)
        if event.anchor is not None:
            self.anchors[event.anchor] = node
        return node

    def _count(self, nodes: int, path: KeyPath, place: Place) -> None:
        self.nodes += nodes
        if self.nodes > MAX_NODES:
            self._refuse(path[:3], f"expected at most {MAX_NODES} values (aliases count written out), got more", place)

    def _alias(self, event: Any, path: KeyPath) -> Node:
        place = self._place(event)
        node = self.anchors.get(event.anchor)
        if node is None:
            sentence = f"the alias *{event.anchor} has no anchor (&{event.anchor}) before it"
            self._refuse(path, sentence[:200], place)
        if len(path) + node.height > MAX_DEPTH:
            self._refuse(path[:3], f"expected at most {MAX_DEPTH} levels, aliases written out, got more", place)
        self._count(node.size, path, place)
        return node

    def _scalar(self, event: Any, path: KeyPath) -> Any:
        text: str = event.value
        if not text.isascii():
            text = unicodedata.normalize("NFC", text)  # so that names that look equal are equal
            if any("\ud800" <= c <= "\udfff" for c in text):
                self._refuse(path, "expected Unicode text, got half of a surrogate pair", self._place(event))
        return core_value(text) if event.implicit[0] else text

    def _list(self, path: KeyPath, place: Place) -> Node:
        children: dict[Key, tuple[Place, Node]] = {}
        while not isinstance(event := next(self.events), yaml.SequenceEndEvent):
            children[len(children)] = self._place(event), self._node(event, (*path, len(children)))
        return branch([], place, children)

    def _mapping(self, path: KeyPath, place: Place) -> Node:
        children: dict[Key, tuple[Place, Node]] = {}
        first: dict[str, Place] = {}
        while not isinstance(event := next(self.events), yaml.MappingEndEvent):
            key, here = self._key(event, path), self._place(event)
            if key in first:
                lines = f"first in line {first[key].line}, again in line {here.line}"
                self._refuse((*path, key), f"the key stands twice, {lines}; remove one", here)
            first[key] = here
            node = self._node(next(self.events), (*path, key))
            if key == MERGE and event.implicit[0]:
                for own, child in self._merged(node, path, here):
                    children.setdefault(own, child)
            else:
                children[key] = here, node
        return branch({}, place, children)

    def _merged(self, node: Node, path: KeyPath, place: Place) -> Iterator[tuple[Key, tuple[Place, Node]]]:
        """The keys that a merge key brings; of several mappings the first that has a key gives its value."""
        mappings = [node] if isinstance(node.value, dict) else [own for _, own in node.children.values()]
        if not mappings or not all(isinstance(mapping.value, dict) for mapping in mappings):
            words = "expected a mapping beside <<, or a list of them, such as <<: *block"
            self._refuse((*path, MERGE), f"{words}, got {shown(plain(node))}", place)
        return (entry for mapping in mappings for entry in mapping.children.items())

    def _key(self, event: Any, path: KeyPath) -> str:
        key = self._scalar(event, path) if isinstance(event, yaml.ScalarEvent) and event.tag is None else None
        if self.source.any_keys and key is not None:
            return str(event.value)
        if not isinstance(key, str):
            got = f"{shown(key)}; put it into quotes" if isinstance(event, yaml.ScalarEvent) else "something else"
            self._refuse(path, f"expected a key that is text, got {got}", self._place(event))
        return key


def core_value(text: str) -> str | int | float | bool | None:
    """A plain scalar by the core schema of YAML 1.2.2, 10.3.2.

    >>> core_value("1e-3"), core_value("no"), core_value("0x1F"), core_value("~")
    (0.001, 'no', 31, None)
    """
    if text and text[0] not in SPECIAL:
        return text
    if text in NULL:
        return None
    if text in TRUTH:
        return TRUTH[text]
    if len(text) > MAX_DIGITS:
        return text
    if INTEGER.fullmatch(text):
        return int(text)
    if OCTAL_OR_HEX.fullmatch(text):
        return int(text, 0)
    if FLOAT.fullmatch(text):
        return float(text)
    if special := INFINITE_OR_NAN.fullmatch(text):
        return float(f"{special[1]}inf") if special[1] is not None else float("nan")
    return text
