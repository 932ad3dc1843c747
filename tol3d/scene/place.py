"""Place of a value of a scene in its file.

A value of a scene's text with the places of all that is in it, before anything is known of its meaning.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

from tol3d.errors import Problem, SceneError
from tol3d.files import Files

LONGEST_KEY = 80  # characters shown; names may be that long

KeyPath = tuple[str | int, ...]
"""Keys (and positions in lists) from the top of a scene to a value."""


class Place(NamedTuple):
    """A line and a column of a file, both from 1.

    Args:
        line, column: where.
        file: where an included file lies; "" for the scene's own.
    """

    line: int
    column: int
    file: str = ""


@dataclass(frozen=True)
class Origin:
    """The file that a scene was read from.

    Args:
        source: the file.
        text: its content.
        places: where the key of each key path stands (the value, for an item of a list).
        files: the files that it names, as they were when it was read.
        included: those of them that it includes.
        general: names of the tolerances that dimensions took from the general ones of the scene.
    """

    source: Path = Path("scene")
    text: str = ""
    places: Mapping[KeyPath, Place] = field(default_factory=dict)
    files: Files = field(default_factory=dict)
    included: tuple[str, ...] = ()
    general: tuple[str, ...] = ()

    def place(self, path: KeyPath) -> Place:
        """Place of the key path, or of the nearest key above it; the top of the file at last."""
        for length in range(len(path), 0, -1):
            if path[:length] in self.places:
                return self.places[path[:length]]
        return Place(1, 1)

    def message(self, path: KeyPath, sentence: str, place: Place | None = None) -> Problem:
        """`file:line: place: sentence`, on one line."""
        line, column, file = place or self.place(path)
        return Problem.at(file or self.source, printable(sentence), line=line, column=column, path=path_text(path))

    def order(self, path: KeyPath) -> tuple[str, int]:
        """Sort key of messages of key paths: those of the scene's own file first, by its lines."""
        place = self.place(path)
        return place.file, place.line

    def error(self, path: KeyPath, sentence: str, place: Place | None = None) -> SceneError:
        """Error with that message."""
        return SceneError(self.message(path, sentence, place))


def path_text(path: KeyPath) -> str:
    """A key path for people.

    >>> path_text(("tolerances", "oil film", "of", 0))
    'tolerances.oil film.of[0]'
    """
    text = ""
    for key in path:
        text += f"[{key}]" if isinstance(key, int) else f".{key_text(key)}"
    return text.removeprefix(".")


def key_text(key: str) -> str:
    """A key, shortened if it is long."""
    return printable(key if len(key) <= LONGEST_KEY else key[: LONGEST_KEY - 1] + "…")


def printable(text: str) -> str:
    """The text with an escape for each character that a terminal would not print, or would obey."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


Key = str | int
Children = Mapping[Key, tuple[Place, "Node"]]
"""Contents of a mapping or a list, in order, by keys or by positions, each with the place of its key."""


class Node(NamedTuple):
    """A value, the same node for every alias of it.

    Args:
        value: text, number, truth or None; an empty dict or list if it has children.
        place: of its start.
        children: its contents; empty for a scalar.
        size, height: values and levels in it, aliases written out.
    """

    value: Any
    place: Place
    children: Children = {}  # noqa: RUF012  # never changed
    size: int = 1
    height: int = 1

    def held(self, key: str) -> Children:
        """Contents of the value of a key; nothing where there is no such key."""
        return self.children[key][1].children if key in self.children else {}

    def held_value(self, key: str) -> Any:
        """The value of a key without its contents; None if there is no such key."""
        return self.children[key][1].value if key in self.children else None


def branch(value: dict[Any, Any] | list[Any], place: Place, children: Children) -> Node:
    """A mapping or a list.

    Args:
        value: an empty one of its type.
        place: of its start.
        children: its contents.
    """
    size, height = 1, 0
    for _, child in children.values():
        size += child.size
        height = max(height, child.height)
    return Node(value, place, children, size, height + 1)


def plain(node: Node) -> Any:
    """The values alone, each dict and list a new one."""
    if isinstance(node.value, dict):
        return {key: plain(child) for key, (_, child) in node.children.items()}
    if isinstance(node.value, list):
        return [plain(child) for _, child in node.children.values()]
    return node.value


@dataclass(frozen=True)
class Places(Mapping[KeyPath, Place]):
    """Place of the key of each key path (of the value, for an item of a list)."""

    top: Node

    def __getitem__(self, path: KeyPath) -> Place:
        """The place of a key path; KeyError if there is none."""
        place, node = self.top.place, self.top
        if not path:
            raise KeyError(path)
        for key in path:
            place, node = node.children[key]
        return place

    def __iter__(self) -> Iterator[KeyPath]:
        """All key paths, in the order of the file."""
        return _paths(self.top, ())

    def __len__(self) -> int:
        """Number of key paths."""
        return self.top.size - 1


def _paths(node: Node, above: KeyPath) -> Iterator[KeyPath]:
    for key, (_, child) in node.children.items():
        yield (*above, key)
        yield from _paths(child, (*above, key))
