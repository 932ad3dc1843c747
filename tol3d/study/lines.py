"""Lines of a scene that state tolerances, each with the contributors that it makes.

A line holds for each feature of a pattern, for each part that is like its own, and as often as its file is included:
their deviations are drawn each for itself, but they are one tolerance, which is changed as a whole.
"""

import re
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final, Protocol, runtime_checkable

from tol3d.scene import Scene
from tol3d.scene.place import Place
from tol3d.system.contributor import Contributor
from tol3d.system.remembered import Remembered

TOP: Final = Place(1, 1)


@runtime_checkable
class OfLine(Protocol, metaclass=Remembered):
    """A Contributor that is one of several which a line of the scene makes."""

    @property
    def line(self) -> str:
        """Name of the line, which is its tolerance's or begins with it; "" for the contributor's own name."""
        ...


@dataclass(frozen=True)
class Line:
    """A line that states a tolerance.

    Args:
        name: of the tolerance; of a file that is included several times "thickness of ring.yaml"; of what a move says
            that of its contributor.
        contributors: names of those that it makes.
        entries: names of its tolerances in the scene, one for each time that its file is included; none of a move.
        in_file: name of the tolerance in an included file; "" of the scene's own.
    """

    name: str
    contributors: tuple[str, ...]
    entries: tuple[str, ...] = ()
    in_file: str = ""


def lines_of(scene: Scene, contributors: Iterable[Contributor]) -> tuple[Line, ...]:
    """The lines of a scene, in the order of their first contributors."""
    origin = scene.origin
    tolerances = {name: origin.place(("tolerances", name)) for name in scene.tolerances}
    moves = {name: origin.place(("moves", name)) for name in scene.moves}
    counts = Counter(place for place in (*tolerances.values(), *moves.values()) if place.file)
    files = {str(own.path): name for name, own in origin.files.items()}
    in_files: dict[Place, str] = {}
    found: dict[str, Line] = {}
    for own in contributors:
        stated = own.line if isinstance(own, OfLine) else ""
        line = stated or own.name
        entry = line if line in tolerances else _entry(stated, tolerances)
        move = "" if entry else max((name for name in moves if line.endswith(f" of {name}")), key=len, default="")
        name, in_file = entry or move, ""
        place = (tolerances if entry else moves).get(name, TOP)
        if counts[place] > 1:
            file = files[place.file]
            if place not in in_files:
                in_files[place] = _name_in_file(name, place, origin.files[file].content)
            before, _, after = line.partition(name) if entry else line.rpartition(name)
            in_file = f"{before}{in_files[place]}{after}"
            line = f"{in_file} of {file}"
        known = found.get(line, Line(line, ()))
        entries = (*known.entries, *([entry] if entry and entry not in known.entries else []))
        found[line] = Line(line, (*known.contributors, own.name), entries, in_file)
    return tuple(found.values())


def _entry(line: str, tolerances: Iterable[str]) -> str:
    """The tolerance whose name a line begins with, the longest of several: of "holes shift" that is "holes"."""
    return max((name for name in tolerances if line.startswith(f"{name} ")), key=len, default="")


def _name_in_file(entry: str, place: Place, content: bytes) -> str:
    """The name that an entry has in its file, which stands at its place: without those of the includes."""
    words, lines = entry.split(" "), content.decode("utf-8", "replace").splitlines()
    text = lines[place.line - 1][place.column - 1 :] if place.line <= len(lines) else ""
    shorter = (" ".join(words[k:]) for k in range(len(words) - 1, 0, -1))
    return next((name for name in shorter if re.match(rf"""["']?{re.escape(name)}["']?\s*:""", text)), entry)
