"""What the command line prints on, and the exit codes it ends with."""

from typing import Final

from rich.console import Console

DONE, LIMITS_FAILED, WRONG_INPUT, FAULT, INTERRUPTED = 0, 1, 2, 3, 130

out_console: Final = Console(highlight=False, soft_wrap=False, markup=False)
err_console: Final = Console(stderr=True, highlight=False, soft_wrap=True, markup=False)


def warn(text: str) -> None:
    """A yellow line for what may spoil a result."""
    err_console.print(f"warning: {text}", style="yellow")


def tell(text: str) -> None:
    """A line for people and pipes: paths in it are never broken."""
    out_console.print(text, soft_wrap=True)
