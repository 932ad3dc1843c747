"""Output of the command line, and its exit codes.

Any text goes to any terminal, file or pipe: characters that its encoding lacks are spelt out (σ as "sigma" on a
Western Windows), and control characters, which may come from a scene or a run of a stranger, are shown, not sent.
"""

import codecs
import re
import sys
import time
import unicodedata
from collections.abc import Iterable
from typing import Final

from rich.console import Console, ConsoleOptions, RenderableType
from rich.segment import Segment

BEGAN: Final = time.perf_counter() - time.process_time()  # s; of the command, whose start is work of this process
DONE, LIMITS_FAILED, WRONG_INPUT, FAULT, INTERRUPTED = 0, 1, 2, 3, 130
BROKEN_PIPE: Final = 141  # as shells tell of SIGPIPE: 128 + 13

PLAIN_SIGNS: Final = {
    "−": "-",
    "–": "-",
    "—": "-",
    "′": "'",
    "″": '"',
    "…": "...",
    "·": "-",
    "×": "x",
    "±": "+-",
    "µ": "u",
    "μ": "u",
    "≥": ">=",
    "≤": "<=",
    "≈": "~",
    "→": "->",
    "∥": "||",
    "∓": "-+",
    "°": "deg",
}
"""Signs of ours, for encodings without them."""

GREEK: Final = re.compile(r"GREEK (SMALL|CAPITAL) LETTER (?:FINAL )?([A-Z]+)")

PLAINLY: Final = "tol3d.plainly"  # name of the error handler of codecs
CONTROL_PICTURES: Final = 0x2400  # U+2400 is the picture of U+0000, and so on
LAST_C0: Final = 0x1F
DELETE, ITS_PICTURE = 0x7F, "\u2421"
MOVING: Final = frozenset(("Cc", "Cf", "Cs", "Zl", "Zp"))  # Unicode categories that no terminal should be sent


def _plainly(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return "".join(_plain(sign) for sign in error.object[error.start : error.end]), error.end


def _plain(sign: str) -> str:
    """A sign in ASCII: as we write it, the name of a Greek letter, its base letter, or a question mark."""
    if sign in PLAIN_SIGNS:
        return PLAIN_SIGNS[sign]
    if letter := GREEK.fullmatch(unicodedata.name(sign, "")):
        return letter[2].lower() if letter[1] == "SMALL" else letter[2].capitalize()
    base = unicodedata.normalize("NFKD", sign).encode("ascii", "ignore").decode()
    return base or "?"


def write_plainly() -> None:
    """Let standard output and error spell out what their encodings lack, whatever they are."""
    codecs.register_error(PLAINLY, _plainly)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors=PLAINLY)


def shown_controls(text: str) -> str:
    r"""A text whose control characters are shown as pictures, one sign each; line breaks stay.

    >>> shown_controls("a\x1b[2Jb")
    'a␛[2Jb'
    """
    if text.isprintable():
        return text
    return "".join(_shown(sign) for sign in text)


def _shown(sign: str) -> str:
    if sign == "\n" or unicodedata.category(sign) not in MOVING:
        return sign
    if ord(sign) <= LAST_C0:
        return chr(CONTROL_PICTURES + ord(sign))
    return ITS_PICTURE if ord(sign) == DELETE else "\ufffd"


def seconds() -> float:
    """Seconds since the command started."""
    return time.perf_counter() - BEGAN


class SafeConsole(Console):
    """A console on which no text can move the cursor, set a title, or write backwards."""

    def render(self, renderable: RenderableType, options: ConsoleOptions | None = None) -> Iterable[Segment]:
        """See Console; what rich itself sends to the terminal is marked as control and passes."""
        for segment in super().render(renderable, options):
            yield segment if segment.control else Segment(shown_controls(segment.text), segment.style)

    def on_broken_pipe(self) -> None:
        """Leave it to the command to end: rich would with 1, the code for failed limits."""
        raise BrokenPipeError


out_console: Final = SafeConsole(highlight=False, soft_wrap=False, markup=False)
err_console: Final = SafeConsole(stderr=True, highlight=False, soft_wrap=True, markup=False)


def warn(text: str) -> None:
    """A yellow warning line."""
    err_console.print(f"warning: {text}", style="yellow")


def tell(text: str) -> None:
    """A line for people and pipes: paths in it are never broken."""
    out_console.print(text, soft_wrap=True)
