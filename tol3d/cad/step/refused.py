"""A STEP file that cannot be used: one line with its place."""

from tol3d.errors import InputError

LONGEST_SHOWN = 80  # characters of what the file says that an error shows; names of 10 kB occur


class StepError(InputError):
    """A STEP file is damaged, too large, refers to other files or has content that cannot be read; exit code 2."""


def shown(written: object) -> str:
    """Text of a file, on one line of printable characters, truncated if it is long."""
    text = "".join(each if each.isprintable() else "·" for each in str(written))
    return text if len(text) <= LONGEST_SHOWN else text[: LONGEST_SHOWN - 1] + "…"
