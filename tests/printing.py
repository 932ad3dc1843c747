"""Output of a terminal of some width."""

import io

from rich.console import Console, RenderableType


def printed(shown: RenderableType, width: int = 140) -> str:
    """The text of something that rich prints."""
    page = io.StringIO()
    Console(file=page, width=width).print(shown)
    return page.getvalue()


def row_of(text: str, label: str) -> list[str]:
    """The words behind the label of a printed row."""
    return next(line for line in text.splitlines() if line.startswith(label)).removeprefix(label).split()
