"""Place of a value of a scene in its file."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from tol3d.errors import SceneError
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

    def message(self, path: KeyPath, sentence: str, place: Place | None = None) -> str:
        """`file:line: place: sentence`, on one line."""
        line, _, file = place or self.place(path)
        words = (f"{file or self.source}:{line}", path_text(path), printable(sentence))
        return ": ".join(part for part in words if part)

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
