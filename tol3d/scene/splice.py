"""A scene's text with another value at a place: the characters of that value alone are replaced.

The text is walked by the parser's marks to the value's node. Comments, units, order and layout of all else stay, so
that a change of a number is a change of a line. What an alias, a merge or an anchor shares is changed at the asked
place alone. The new text is read again and compared with what was meant.
"""

import json
import re
from collections.abc import Iterator, Mapping
from copy import deepcopy
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import yaml

from tol3d.errors import InputError, SceneError
from tol3d.scene.place import KeyPath, path_text, plain
from tol3d.scene.text import LOADER, scene_text

INDENT: Final = 2
SECTION_AFTER: Final = "moves"
"""The section before which a new one is written."""

ANCHOR: Final = re.compile(r"&\S+\s+")


@dataclass(eq=False)
class _Piece:
    """A node of a text, from `start` to `end`, an anchor before it left out.

    Args:
        kind: "scalar", "map", "list" or "alias".
        style: quotes of a scalar; "{" of a map or list in brackets.
        anchor: name of its anchor, or of the one that an alias stands for.
        pairs: keys and values of a map, or None and items of a list.
    """

    kind: str
    start: int
    end: int
    style: str = ""
    anchor: str = ""
    value: str = ""
    before: int = 0
    pairs: list[tuple["_Piece | None", "_Piece"]] = field(default_factory=list)

    def child(self, key: str | int) -> "_Piece | None":
        """The value of a key, or the item at a position."""
        if self.kind == "list":
            return self.pairs[key][1] if isinstance(key, int) and key < len(self.pairs) else None
        return next((value for own, value in self.pairs if own is not None and own.value == str(key)), None)

    def all(self) -> Iterator["_Piece"]:
        """It and all in it, in the order of the text."""
        yield self
        for key, value in self.pairs:
            yield from key.all() if key is not None else ()
            yield from value.all()


def spliced(text: str, path: KeyPath, value: Any) -> str:
    """A scene's text with a value at a key path; keys that are not there are added.

    Args:
        text: of a scene.
        path: keys, and positions in lists.
        value: text, number, truth, or mappings and lists of them.

    Raises:
        InputError: the path leads into a value that holds none, or the text is written in a way that cannot be edited.
    """
    before = written_values(text)
    meant = deepcopy(before)
    here: Any = meant
    for depth, key in enumerate(path[:-1]):
        following = path[depth + 1]
        inside = _item(here, key)
        if not isinstance(inside, dict | list):
            if inside is not None or isinstance(following, int) or isinstance(here, list):
                raise InputError(f"{path_text(path)}: expected a field of a scene, but {key!r} holds none")
            here[key] = {}
        here = here[key]
    if isinstance(here, list) != isinstance(path[-1], int):
        raise InputError(f"{path_text(path)}: expected {'an item of a list' if isinstance(here, list) else 'a field'}")
    here[path[-1]] = value
    new = _put(text, before, meant, path)
    try:
        good = written_values(new) == meant
    except SceneError:
        good = False
    if not good:
        raise InputError(
            f"{path_text(path)}: the scene is written in a way that cannot be edited here; change it by hand"
        )
    return new


def written_values(text: str) -> Any:
    """The values of a scene's text, without those of included files."""
    top, _ = scene_text(Path("scene"), text.encode())
    return plain(top)


def _put(text: str, before: Any, meant: Any, path: KeyPath) -> str:
    """The text with the meant value at a path, by the shortest change that there is."""
    piece, shared = _pieces(text), list[_Piece]()
    old, new = before, meant
    for depth, key in enumerate(path):
        new, known = new[key], _item(old, key)
        child = piece.child(key)
        if child is None:  # not there, or there by a merge
            return _with_key(text, piece, str(key), new, depth)
        if child.kind == "alias":
            return text[: child.start] + flow_text(new) + text[child.end :]
        if child.anchor:
            shared.append(child)
        piece, old = child, known
    for own in shared:
        if (moved := _unshared(text, own)) is not None:
            return _put(moved, before, meant, path)
    if isinstance(old, dict) and isinstance(new, dict) and list(old) == list(new)[: len(old)] and old:
        for key in new:
            if key not in old or old[key] != new[key]:
                text = spliced(text, (*path, key), new[key])
        return text
    if piece.kind == "scalar" and not isinstance(new, dict | list):
        quoted = piece.style in ("'", '"') and isinstance(new, str)
        return (
            text[: piece.start] + (_quoted(new, piece.style) if quoted else flow_text(new)) + text[_end(text, piece) :]
        )
    for inner in piece.all():  # what goes, and others are aliases of
        if inner.anchor and inner.kind != "alias" and (moved := _unshared(text, inner, beyond=piece.end)) is not None:
            return _put(moved, before, meant, path)
    return _with_value(text, piece, new)


def _item(value: Any, key: str | int) -> Any:
    if isinstance(value, dict):
        return value.get(key)
    return value[key] if isinstance(value, list) and isinstance(key, int) and key < len(value) else None


def _with_value(text: str, piece: _Piece, new: Any) -> str:
    """The text with a whole value replaced, in brackets behind its key."""
    start, end = piece.start, _end(text, piece)
    if piece.kind != "scalar" and piece.style != "{":  # it may begin a line below its key
        start = len(text[:start].rstrip())
        return f"{text[:start]} {flow_text(new)}{text[end:]}"
    return text[:start] + ("" if text[start - 1 : start] in (" ", "\n", "") else " ") + flow_text(new) + text[end:]


def _with_key(text: str, piece: _Piece, key: str, value: Any, depth: int) -> str:
    """The text with a key more in a mapping: at the end of one in brackets, below the last line of others."""
    entry, newline = f"{flow_text(key)}: {flow_text(value)}", "\r\n" if "\r\n" in text else "\n"
    if piece.kind == "scalar":  # a key without a value
        return f"{text[: piece.start].rstrip()} {{{entry}}}{text[piece.start :]}"
    if piece.style == "{":
        inside = text[piece.start : piece.end - 1].rstrip()
        comma = "" if inside.endswith(("{", ",")) else ","
        space = "" if inside.endswith("{") else " "
        return text[: piece.start] + inside + comma + space + entry + text[piece.end - 1 :]
    first = piece.pairs[0][0] or piece.pairs[0][1]
    column = first.start - (text.rfind("\n", 0, first.start) + 1)
    if depth == 0:
        rows = (
            "".join(f"{newline}{' ' * INDENT}{flow_text(name)}: {flow_text(own)}" for name, own in value.items())
            if (isinstance(value, dict) and value)
            else f" {flow_text(value)}"
        )
        entry = f"{flow_text(key)}:{rows}"
        following = next((own for own, _ in piece.pairs if own is not None and own.value == SECTION_AFTER), None)
        if following is not None and column == 0:
            return f"{text[: following.start]}{entry}{newline}{text[following.start :]}"
    last = _end(text, piece.pairs[-1][1])
    line_end = text.find("\n", last)
    line_end = len(text) if line_end < 0 else line_end - text[last:line_end].endswith("\r")
    return f"{text[:line_end]}{newline}{' ' * column}{entry}{text[line_end:]}"


def _unshared(text: str, piece: _Piece, beyond: int = 0) -> str | None:
    """The text in which a value's anchor stands at the first alias of it beyond a place; None if there is no alias."""
    every = [own for own in _pieces(text).all() if own.kind == "alias" and own.anchor == piece.anchor]
    uses = [own for own in every if own.start >= beyond]
    if not uses:
        return None
    old, first = _node_text(text, piece), uses[0]
    moved = f"{text[: first.start]}&{piece.anchor} {old}{text[first.end :]}"
    lines = moved[piece.before : piece.start].removeprefix(f"&{piece.anchor}").lstrip(" ")  # to a value below its key
    before = moved[: piece.before]
    return (before.rstrip(" ") if lines else before) + lines + moved[piece.start :]


def _node_text(text: str, piece: _Piece) -> str:
    """A value in brackets, or as it is written if it stands on one line."""
    own = text[piece.start : _end(text, piece)]
    if piece.style == "{" or piece.kind == "scalar":
        return own
    return flow_text(written_values(f"x:\n{' ' * (piece.start - text.rfind(chr(10), 0, piece.start) - 1)}{own}\n")["x"])


def _end(text: str, piece: _Piece) -> int:
    """End of a value, without what follows it: that of the last one in it."""
    if piece.kind in ("map", "list") and piece.style != "{":
        return _end(text, piece.pairs[-1][1])
    return piece.start + len(text[piece.start : piece.end].rstrip())


# words --------------------------------------------------------------------------------------------


def flow_text(value: Any) -> str:
    """A value as YAML writes it on one line.

    >>> flow_text({"kind": "normal", "upper": "20 um", "of": ["a, b", 1.5, True]})
    '{kind: normal, upper: 20 um, of: ["a, b", 1.5, true]}'
    """
    if isinstance(value, Mapping):
        return f"{{{', '.join(f'{flow_text(key)}: {flow_text(own)}' for key, own in value.items())}}}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(flow_text, value))}]"
    if not isinstance(value, str):
        return json.dumps(value)
    try:
        alone = value == value.strip() and "\n" not in value
        is_plain = alone and written_values(f"x: {{y: {value}}}") == {"x": {"y": value}}
    except SceneError:
        is_plain = False
    return value if is_plain else _quoted(value, '"')


def _quoted(value: str, quote: str) -> str:
    return (
        "'" + value.replace("'", "''") + "'"
        if quote == "'" and "\n" not in value
        else json.dumps(value, ensure_ascii=False)
    )


# pieces -------------------------------------------------------------------------------------------


def _pieces(text: str) -> _Piece:
    """The document of a text, by the parser's marks."""
    events = iter([*yaml.parse(text, Loader=LOADER)][2:])
    return _piece(text, next(events), events)


def _piece(text: str, event: Any, events: Iterator[Any]) -> _Piece:
    start, end = event.start_mark.index, event.end_mark.index
    if isinstance(event, yaml.AliasEvent):
        return _Piece("alias", start, end, anchor=event.anchor)
    found = _Piece("scalar", start, end, before=start, anchor=event.anchor or "")
    if event.anchor and (own := ANCHOR.match(text, start)):
        found.start = own.end()
    if isinstance(event, yaml.ScalarEvent):
        found.value, found.style = event.value, event.style or ""
        return found
    found.kind, found.style = (
        "map" if isinstance(event, yaml.MappingStartEvent) else "list",
        "{" if event.flow_style else "",
    )
    closing = yaml.MappingEndEvent if found.kind == "map" else yaml.SequenceEndEvent
    while not isinstance(event := next(events), closing):
        key = _piece(text, event, events) if found.kind == "map" else None
        found.pairs.append((key, _piece(text, next(events) if key is not None else event, events)))
    found.end = event.end_mark.index
    return found
