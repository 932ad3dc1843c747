"""Check of a scene's text while it is written: errors and warnings for its editor, as `tol3d check --json` has them."""

from pathlib import Path

from tol3d.errors import InputError, Problem
from tol3d.scene import Scene
from tol3d.simulate import load_text, simulation_of

Marks = list[dict[str, str | int | None]]
"""Problems as data, see `Problem.data`; None is not known."""


def checked(text: str, source: Path) -> tuple[Scene | None, Marks, Marks]:
    """The scene of a text, its errors and its warnings; no program that it names is run.

    Args:
        text: of the scene, as it stands in the editor; nothing is written.
        source: path of its file, for messages and for files that it names.

    Returns:
        The scene, None if it cannot be read; errors, also those of its system; warnings of a scene without errors.
    """
    scene = None
    try:
        scene = load_text(text, source)
        warnings = simulation_of(scene).warnings
    except InputError as error:
        return scene, [problem.data() for problem in error.problems], []
    return scene, [], [Problem.of(warning).data("warning") for warning in warnings]
