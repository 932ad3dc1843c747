"""From a file to plain values with their places: the only module that reads YAML.

Grammar: YAML 1.2 by a parser's events, which are turned into values here in one pass, so that no
input costs more than the limits below, and every key keeps its line. libyaml's parser, in PyYAML,
reads most scenes, seven times as fast as ruamel.yaml's, which reads what libyaml stumbles over or
takes for something else, and whose messages are told. Plain scalars follow the core
schema of YAML 1.2.2, 10.3.2 (ruamel's own also takes `1_000` and dates).
"""

import copy
import difflib
import os
import re
import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any, Final, NoReturn

import yaml
from ruamel.yaml import YAML
from ruamel.yaml import events as ruamel_events
from ruamel.yaml.error import MarkedYAMLError
from ruamel.yaml.reader import ReaderError

from tol3d.errors import SceneError
from tol3d.scene.place import KeyPath, Origin, Place
from tol3d.units import shown

MAX_BYTES: Final = 1_000_000  # thirty times a scene of a hundred parts; parses in seconds
MAX_DEPTH: Final = 40  # levels; the grammar needs nine, and pydantic and JSON would recurse
MAX_NODES: Final = 20_000  # values with every alias written out; a scene of a hundred parts has some 3000
KEPT_TEXTS: Final = 16  # whose values are kept; scanning one takes fifty times as long as copying them
MAX_DIGITS: Final = 300  # a longer number is kept as text and refused by the field

BRACKETS: Final = re.compile(rf"(?:[\[{{]\s*){{{MAX_DEPTH + 1}}}")  # the scanner's work grows with their square

NULL: Final = frozenset(("", "~", "null", "Null", "NULL"))
TRUTH: Final = {"true": True, "True": True, "TRUE": True, "false": False, "False": False, "FALSE": False}
INTEGER: Final = re.compile(r"[-+]?[0-9]+")
OCTAL_OR_HEX: Final = re.compile(r"0o[0-7]+|0x[0-9a-fA-F]+")
FLOAT: Final = re.compile(r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?")
INFINITE_OR_NAN: Final = re.compile(r"([-+]?)\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)")

UNLIKE: Final = re.compile(r"[\t\x85\u2028\u2029]|^%|[|>][-+0-9]* *(?:#.*)?$", re.MULTILINE)  # where parsers differ
ALIAS: Final = (yaml.AliasEvent, ruamel_events.AliasEvent)
SCALAR: Final = (yaml.ScalarEvent, ruamel_events.ScalarEvent)
LIST: Final = (yaml.SequenceStartEvent, ruamel_events.SequenceStartEvent)
LIST_END: Final = (yaml.SequenceEndEvent, ruamel_events.SequenceEndEvent)
MAPPING: Final = (yaml.MappingStartEvent, ruamel_events.MappingStartEvent)
MAPPING_END: Final = (yaml.MappingEndEvent, ruamel_events.MappingEndEvent)
DOCUMENT: Final = (yaml.DocumentStartEvent, ruamel_events.DocumentStartEvent)
END: Final = (yaml.StreamEndEvent, ruamel_events.StreamEndEvent)

HINTS: Final = {
    "mapping values are not allowed": 'a ":" too many or a wrong indent; text with ": " inside needs quotes',
    r"character '\t'": "indent with blanks, not with tabs",
    "expected <block end>": "look at the indents: keys of one level start in one column",
    "could not find expected ':'": 'a key needs ":" and a blank behind it',
    "expected ',' or": "a comma or a closing bracket is missing",
    "unexpected end of stream": "a quote is opened and never closed",
    "found '<stream end>'": "a bracket is opened and never closed",
    "cannot start any token": "put text that starts with such a character into quotes",
    "undefined alias": "put the anchor (&name) before its use (*name)",
}


def read_scene_text(path: Path) -> tuple[dict[str, Any], Origin]:
    """Read a scene's file to plain values.

    Args:
        path: the file, UTF-8.

    Returns:
        The top-level mapping (keys are text; values dict, list, text, int, float, bool or None), and
        where it came from.

    Raises:
        SceneError: it cannot be read, is no YAML 1.2, repeats a key or exceeds a limit above.
    """
    text = _content(path)
    origin = Origin(path, text)
    if brackets := BRACKETS.search(text):
        place = Place(text.count("\n", 0, brackets.start()) + 1, 1)
        raise origin.error((), f"expected at most {MAX_DEPTH} levels of brackets and indents, got more", place)
    top = _composed(_Source(text, origin))
    if not isinstance(top.value, dict):
        raise origin.error((), f"expected keys such as scene:, parts:, moves:, measures:, got {shown(top.value)}")
    places: dict[KeyPath, Place] = {}
    _collect_places(top, (), places)
    return copy.deepcopy(top.value), Origin(path, text, places)


# the file ---------------------------------------------------------------------------------------


def _content(path: Path) -> str:
    if os.path.isdir(path):
        raise SceneError(f"{path}: expected a scene file, got a folder{_scene_inside(path)}")
    if os.path.exists(path) and not os.path.isfile(path):  # a pipe would be waited for, a device may never end
        raise SceneError(f"{path}: expected a scene file, got a pipe or a device")
    try:
        with path.open("rb") as stream:
            content = stream.read(MAX_BYTES + 1)
    except FileNotFoundError:
        raise SceneError(f"{path}: expected a scene file, found no file of that name{_near_file(path)}") from None
    except (OSError, ValueError) as error:  # ValueError: a NUL in the name
        reason = getattr(error, "strerror", None) or error
        raise SceneError(f"{path}: expected a scene file that can be read, got: {reason}") from None
    if len(content) > MAX_BYTES:
        raise SceneError(f"{path}:1: expected a scene of at most {MAX_BYTES // 10**6} MB, got a larger file")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        raise SceneError(
            f"{path}:{line}: expected UTF-8 text, got the byte 0x{content[error.start]:02x}, which is none"
        ) from None


def _scene_inside(folder: Path) -> str:
    names = sorted(entry.name for entry in folder.glob("*.yaml"))
    return f"; give a file in it, such as {folder / names[0]}" if names else ""


def _near_file(path: Path) -> str:
    try:
        names = [entry.name for entry in path.parent.iterdir()]
    except OSError:
        return ""
    near = difflib.get_close_matches(path.name, names, n=1)
    return f"; did you mean {path.parent / near[0]}?" if near else ""


# its YAML ---------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Node:
    """A value and the places of what is in it; `size` and `height` count aliases written out."""

    value: Any
    place: Place
    children: tuple[tuple[str | int, Place, "_Node"], ...] = ()
    size: int = 1
    height: int = 1


def _collect_places(node: _Node, path: KeyPath, places: dict[KeyPath, Place]) -> None:
    for key, place, child in node.children:
        places[(*path, key)] = place
        _collect_places(child, (*path, key), places)


def _place(event: Any) -> Place:
    return Place(event.start_mark.line + 1, event.start_mark.column + 1)


class _OtherParserError(Exception):
    """libyaml stumbles over a text: the other parser reads it, or says what is wrong."""


def _quick_events(text: str) -> Iterator[Any]:
    """libyaml's events.

    Raises:
        _OtherParserError: it is of no use for this text, or not there.
    """
    loader = getattr(yaml, "CSafeLoader", None)
    if loader is None or UNLIKE.search(text):
        raise _OtherParserError
    try:
        yield from yaml.parse(text, Loader=loader)
    except (yaml.YAMLError, ValueError, OverflowError):
        raise _OtherParserError from None


def _events(origin: Origin, text: str) -> Iterator[Any]:
    """The slower parser's events; whatever it trips over is one message."""
    try:
        yield from YAML(typ="safe", pure=True).parse(text)
    except ReaderError as error:
        line = text[: error.position].count("\n") + 1
        character = f"U+{ord(text[error.position]):04X}"
        raise origin.error((), f"not YAML: the character {character} is not allowed", Place(line, 1)) from None
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        place = Place(mark.line + 1, mark.column + 1) if mark else Place(1, 1)
        problem = " ".join(str(error.problem or error.context).split())
        advice = next((f"; {advice}" for words, advice in HINTS.items() if words in problem), "")
        raise origin.error((), f"not YAML: {problem} (column {place.column}){advice}", place) from None
    except (ValueError, OverflowError) as error:  # escapes beyond Unicode, such as "\UFFFFFFFF"
        raise origin.error((), f"not YAML: {error}") from None


@dataclass(frozen=True)
class _Source:
    """A text, the same wherever it lies."""

    text: str
    origin: Origin = field(compare=False)


@lru_cache(maxsize=KEPT_TEXTS)
def _composed(source: _Source) -> _Node:
    """The document of a text, not to be changed: a scene is read again by each replay and comparison."""
    try:
        return _Composer(source.origin, _quick_events(source.text)).document()
    except (_OtherParserError, SceneError):  # what is wrong is said by one parser
        return _Composer(source.origin, _events(source.origin, source.text)).document()


@dataclass
class _Composer:
    """One pass over the events of a document: values, places, limits."""

    origin: Origin
    events: Iterator[Any]
    anchors: dict[str, _Node] = field(default_factory=dict)
    nodes: int = 0

    def document(self) -> _Node:
        """The only document of the file."""
        next(self.events)  # the start of the stream
        if not isinstance(next(self.events), DOCUMENT):
            raise self.origin.error((), "expected a scene (scene:, parts:, moves:, measures:), got an empty file")
        top = self._node(next(self.events), ())
        next(self.events)  # the end of the document
        following = next(self.events)
        if not isinstance(following, END):
            self._refuse((), 'expected one scene in a file, got a second document ("---")', _place(following))
        return top

    def _refuse(self, path: KeyPath, sentence: str, place: Place) -> NoReturn:
        raise self.origin.error(path, sentence, place)

    def _node(self, event: Any, path: KeyPath) -> _Node:
        place = _place(event)
        if isinstance(event, ALIAS):
            return self._alias(event, path)
        assert isinstance(event, SCALAR + LIST + MAPPING)  # the parser's grammar
        if event.tag is not None:
            tag = shown(str(event.tag).replace("tag:yaml.org,2002:", "!!"))
            self._refuse(path, f"expected no tags, got {tag}; put text into quotes instead", place)
        if len(path) >= MAX_DEPTH:
            self._refuse(path[:3], f"expected at most {MAX_DEPTH} levels of brackets and indents, got more", place)
        self._count(1, path, place)
        if isinstance(event, SCALAR):
            node = _Node(self._scalar(event, path), place)
        elif isinstance(event, LIST):
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

    def _alias(self, event: Any, path: KeyPath) -> _Node:
        place = _place(event)
        node = self.anchors.get(event.anchor)
        if node is None:
            sentence = f"the alias *{event.anchor} has no anchor (&{event.anchor}) before it"
            self._refuse(path, sentence[:200], place)
        if len(path) + node.height > MAX_DEPTH:
            self._refuse(path[:3], f"expected at most {MAX_DEPTH} levels, aliases written out, got more", place)
        self._count(node.size, path, place)
        return node

    def _scalar(self, event: Any, path: KeyPath) -> Any:
        text = unicodedata.normalize("NFC", event.value)  # so that names that look equal are equal
        if any("\ud800" <= c <= "\udfff" for c in text):
            self._refuse(path, "expected Unicode text, got half of a surrogate pair", _place(event))
        return core_value(text) if event.implicit[0] else text

    def _list(self, path: KeyPath, place: Place) -> _Node:
        children: list[tuple[str | int, Place, _Node]] = []
        while not isinstance(event := next(self.events), LIST_END):
            children.append((len(children), _place(event), self._node(event, (*path, len(children)))))
        return self._branch([child.value for _, _, child in children], place, children)

    def _mapping(self, path: KeyPath, place: Place) -> _Node:
        children: list[tuple[str | int, Place, _Node]] = []
        first: dict[str, Place] = {}
        while not isinstance(event := next(self.events), MAPPING_END):
            key, here = self._key(event, path), _place(event)
            if key in first:
                lines = f"first in line {first[key].line}, again in line {here.line}"
                self._refuse((*path, key), f"the key stands twice, {lines}; remove one", here)
            first[key] = here
            children.append((key, here, self._node(next(self.events), (*path, key))))
        return self._branch({key: child.value for key, _, child in children}, place, children)

    def _key(self, event: Any, path: KeyPath) -> str:
        key = self._scalar(event, path) if isinstance(event, SCALAR) and event.tag is None else None
        if not isinstance(key, str):
            got = f"{shown(key)}; put it into quotes" if isinstance(event, SCALAR) else "something else"
            self._refuse(path, f"expected a key that is text, got {got}", _place(event))
        if key == "<<":
            self._refuse(path, "merge keys (<<) are not used here; write the keys out", _place(event))
        return key

    @staticmethod
    def _branch(value: Any, place: Place, children: list[tuple[str | int, Place, _Node]]) -> _Node:
        size = 1 + sum(child.size for _, _, child in children)
        height = 1 + max((child.height for _, _, child in children), default=0)
        return _Node(value, place, tuple(children), size, height)


def core_value(text: str) -> str | int | float | bool | None:
    """A plain scalar by the core schema of YAML 1.2.2, 10.3.2.

    >>> core_value("1e-3"), core_value("no"), core_value("0x1F"), core_value("~")
    (0.001, 'no', 31, None)
    """
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
