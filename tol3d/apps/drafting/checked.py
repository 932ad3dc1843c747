"""A drafted scene checked as `tol3d check` does, so that it runs as it is written."""

import tempfile
from collections.abc import Sequence
from pathlib import Path

from tol3d.apps.drafting.draft import Draft, Seat, draft, settled
from tol3d.files import FileContent
from tol3d.simulate import Overrides, load, simulation_of

SCENE = "scene.yaml"


def scene_from(contents: Sequence[FileContent], seats: Sequence[Seat] = ()) -> tuple[str, Draft]:
    """A scene from STEP files that `tol3d check` accepts and `tol3d run` runs, and its draft.

    Raises:
        InputError: a file cannot be read, or a seat is of no part or face.
    """
    drafted = draft(contents, seats)
    with tempfile.TemporaryDirectory(prefix="tol3d-new-") as made:
        folder = Path(made)
        for own in contents:
            (folder / own.path.name).write_bytes(own.content)

        def check(text: str) -> None:
            (folder / SCENE).write_text(text, encoding="utf-8")
            simulation_of(load(folder / SCENE), Overrides())

        return settled(drafted, check), drafted
