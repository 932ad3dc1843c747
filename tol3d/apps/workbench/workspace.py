"""The folder that the app has open: its scenes by name, and what was changed in them by hand but not kept.

The page names scenes by this list alone, never by a path. What leads out of the folder is not followed.
"""

import hashlib
import json
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Final

from tol3d.apps.workbench.place import APP, inside
from tol3d.errors import InputError, unwritable
from tol3d.scene import hint
from tol3d.scene.bundled import bundled_scenes
from tol3d.study.runs.atomic_write import write_whole

VERSION: Final = 1
SUFFIXES: Final = (".yaml", ".yml")
LARGEST_SCENE: Final = 10_000_000  # bytes
LAST: Final = "opened.json"  # no scene's notes: their names have a scene's suffix in them
MOST_KEPT: Final = 3
"""What-ifs beside each other."""
MOST_UNDONE: Final = 20
"""Moves that can be undone after a reload."""

Told = Mapping[str, Any]
"""Words of a question of the page, or of its answer."""

WhatIf = Mapping[str, str]
"""Changes by the line of the scene that states the tolerance: "x1.5", or what `--set` takes: "±33 um"."""


@dataclass(frozen=True)
class Notes:
    """Moved tolerances of a scene that are not kept in its file.

    Args:
        now: changes that are being tried.
        beside: up to three others that are shown beside them.
        measure: the chosen one; "" for the first.
        past: what was tried before, the last one last, for undo.
    """

    now: WhatIf
    beside: tuple[WhatIf, ...] = ()
    measure: str = ""
    past: tuple[WhatIf, ...] = ()


@dataclass(frozen=True)
class Workspace:
    """A folder of scenes.

    Args:
        folder: resolved.
        first: name of the scene that was asked for; "" for a folder.
    """

    folder: Path
    first: str = ""

    @classmethod
    def of(cls, place: Path) -> "Workspace":
        """The folder, or the folder of a scene.

        Raises:
            InputError: there is neither.
        """
        if place.is_dir():
            found = cls(place.resolve())
            if not found.scenes:
                raise InputError(
                    f"{place}: expected a scene or a folder with scenes, got one without {SUFFIXES[0]} files; "
                    "`tol3d app spur_pair` begins with a copy of that scene, `tol3d scenes` lists them all"
                )
            return found
        if not place.exists():
            known = "" if place.suffix or len(place.parts) > 1 else hint(place.name, bundled_scenes())
            raise InputError(f"{place}: expected a scene or a folder of scenes, found nothing of that name{known}")
        if not place.is_file() or place.suffix not in SUFFIXES:
            raise InputError(f"{place}: expected a scene ({SUFFIXES[0]}) or a folder of scenes")
        return cls(place.resolve().parent, place.name)

    @cached_property
    def notes_folder(self) -> Path:
        """Folder of the notes; one that leads out of the workspace is refused.

        Raises:
            InputError: it does, or cannot be made.
        """
        place = inside(self.folder / APP, self.folder)
        try:
            place.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise unwritable(place, error, "what-ifs are kept there") from None
        return place

    @property
    def scenes(self) -> Mapping[str, Path]:
        """Its scenes by the names of their files, without links that lead out of the folder."""
        found = (path for path in sorted(self.folder.iterdir()) if path.suffix in SUFFIXES and path.is_file())
        inside = {path.name: path for path in found if path.resolve().parent == self.folder}
        return {name: path for name, path in inside.items() if path.stat().st_size <= LARGEST_SCENE}

    def scene(self, name: str) -> Path:
        """Path of a scene by its name in the list.

        Raises:
            InputError: it is not there.
        """
        known = self.scenes
        if name not in known:
            raise InputError(f"expected a scene of {self.folder.name}, got {name!r}")
        return known[name]

    @property
    def last(self) -> str:
        """Name of the scene that was opened last; "" where none is known, or it is not there any more."""
        with suppress(InputError, OSError, ValueError, KeyError, TypeError, RecursionError):
            told = json.loads((self.notes_folder / LAST).read_text("utf-8"))
            if told["version"] == VERSION and told["scene"] in self.scenes:
                return str(told["scene"])
        return ""

    def note_opened(self, scene: str) -> None:
        """Keep which scene was opened last.

        Raises:
            InputError: it cannot be written.
        """
        told = {"version": VERSION, "scene": scene}
        written(self.notes_folder / LAST, json.dumps(told, ensure_ascii=False).encode())

    def notes(self, scene: str) -> Notes:
        """Moved tolerances of a scene; none where they were written by another version, or are damaged."""
        try:
            told = json.loads((self.notes_folder / f"{scene}.json").read_text("utf-8"))
            if told["version"] != VERSION:
                return Notes({})
            beside, past = (
                tuple(_changes(own) for own in each)
                for each in (told["beside"][:MOST_KEPT], told.get("past", [])[-MOST_UNDONE:])
            )
            return Notes(_changes(told["now"]), beside, str(told["measure"]), past)
        except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
            return Notes({})

    def note(self, scene: str, notes: Notes) -> None:
        """Keep what was moved in a scene, all or nothing.

        Raises:
            InputError: it cannot be written.
        """
        told = {
            "version": VERSION,
            "now": dict(notes.now),
            "beside": [dict(own) for own in notes.beside],
            "measure": notes.measure,
            "past": [dict(own) for own in notes.past],
        }
        written(self.notes_folder / f"{scene}.json", json.dumps(told, ensure_ascii=False, indent=1).encode())


def is_bundled(text: str) -> bool:
    """True for the name of a bundled scene, where neither a file nor a folder here has it."""
    return text in bundled_scenes() and not Path(text).exists()


def written(path: Path, content: bytes) -> None:
    """Write a file, all or nothing.

    Raises:
        InputError: it cannot be.
    """
    try:
        write_whole(path, content)
    except OSError as error:
        raise unwritable(path, error, "close what holds it, or free the disk") from None


def digest(content: bytes) -> str:
    """Name of a file's content, by which a change made elsewhere is seen."""
    return hashlib.sha256(content).hexdigest()


def _changes(told: Any) -> WhatIf:
    return {str(key): str(value) for key, value in told.items()}
