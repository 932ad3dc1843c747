"""Answer of an analysis, kept by the job that asked for it and shown again by the app, with the code of the reports."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from tol3d.analyses.answers import Answer
from tol3d.analyses.kept_pages import charts_of, page_of
from tol3d.analyses.subject import section_of, text_of_section
from tol3d.apps.workbench.attempt import ANSWER, NUMBERS
from tol3d.errors import RunError
from tol3d.files import UnreadableFileError, read_contained
from tol3d.report.chart import Charts
from tol3d.report.html.blocks import Markup
from tol3d.report.html.svg import illustrated
from tol3d.report.page import Page
from tol3d.study.runs import write_texts

NAMES: Final = {
    "what_if": "what-if",
    "effects": "effects",
    "changes": "changes",
    "allocate": "allocation",
    "rare": "rare",
    "methods": "methods",
    "sweep": "sweep",
}
"""Names of analyses, as runs keep them, by their functions."""

LARGEST: Final = 50_000_000  # bytes; as of a run's summary


@dataclass(frozen=True)
class KeptAnswer:
    """Answer as reports show it.

    Args:
        page: its lines and tables.
        charts: of it.
    """

    page: Page
    charts: Charts

    @property
    def html(self) -> Markup:
        """Its lines and tables, and its charts below."""
        return illustrated(self.page, self.charts)


def keep_answer(answer: Answer[Any], place: Path) -> None:
    """Write an answer into a folder: its findings as JSON, its numbers as CSV.

    Raises:
        InputError: they cannot be written.
    """
    write_texts({NUMBERS: answer.csv(), ANSWER: text_of_section(answer.found)}, place)


def kept_answer(path: Path, kind: str, scene: str) -> KeptAnswer:
    """An answer from its file, which a stranger may have made: checked, then shown from its numbers.

    Args:
        path: the file of its findings, see `Jobs.answer`.
        kind: of the job.
        scene: name of the scene, for headings.

    Raises:
        RunError: it is missing or damaged.
    """
    try:
        content = read_contained(path, path.parent, LARGEST)
    except UnreadableFileError as error:
        raise RunError(f"{path}: cannot be read ({error}); ask for it again") from None
    name = NAMES[kind]
    found = section_of(name, content, path)
    return KeptAnswer(page_of(name, found, scene), charts_of(name, found, scene))
