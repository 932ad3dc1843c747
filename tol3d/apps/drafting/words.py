"""Words of a drafted scene: a file's text is data, and can neither end a comment nor become YAML of its own."""

import math
import re
import unicodedata
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Final

from tol3d.cad.step import LONGEST_SHOWN
from tol3d.numerics.arrays import Array

PLAIN: Final = re.compile(r"[A-Za-z](?:[A-Za-z0-9_.()+ -]*[A-Za-z0-9_)])?")
"""Texts that YAML reads as they stand, but for its own words."""
YAML_WORDS: Final = frozenset(("true", "false", "yes", "no", "on", "off", "null", "y", "n", "nan", "inf"))
LONGEST: Final = 56  # characters of a name; a pattern's number and the part of a copy are put behind it
UNNAMEABLE: Final = frozenset("/\\:")  # what no name holds
UNNAMEABLE_FEATURE: Final = frozenset("/\\:.|-")
MARKS: Final = frozenset("{}[],#&*!>'\"%@`?")
"""Signs that would have a name quoted everywhere; it gets blanks in their place."""
ESCAPED: Final = re.compile(r"\\(?:(x[0-9a-f]{2}|u[0-9a-f]{4}|U[0-9a-f]{8})|(.))")


def scalar(text: str) -> str:
    """A text as YAML reads it back, on one line of printable ASCII or plain words."""
    if PLAIN.fullmatch(text) and text.lower() not in YAML_WORDS:
        return text
    return '"' + "".join(_escaped(sign) for sign in text) + '"'


def unquoted(written: str) -> str:
    r"""The text that `scalar` has written so.

    >>> unquoted(scalar('a "b"\tc\\d')), unquoted(scalar("plain words"))
    ('a "b"\tc\\d', 'plain words')
    """
    if not written.startswith('"'):
        return written
    return ESCAPED.sub(lambda own: own[2] or chr(int(own[1][1:], 16)), written[1:-1])


def _escaped(sign: str) -> str:
    if sign in '"\\':
        return "\\" + sign
    number = ord(sign)
    if 32 <= number < 127 or (sign.isprintable() and number < 0xD800 and number > 0xA0):
        return sign
    return f"\\x{number:02x}" if number < 256 else f"\\u{number:04x}" if number < 65536 else f"\\U{number:08x}"


def comment(text: str, longest: int = LONGEST_SHOWN) -> str:
    """Text of a file, fit for a comment: on one line, printable, truncated if it is long."""
    words = "".join(sign if sign.isprintable() else "·" for sign in text[: longest + 1])
    return " ".join((words if len(words) <= longest else words[: longest - 1] + "…").split())


def number(value: float) -> str:
    """A number with at most 10 digits, without a minus zero."""
    return f"{value + 0.0:.10g}" if abs(value) > 1e-12 else "0"


def length(value: float) -> str:
    """A length [mm], to a tenth of a nanometre: files have rounding of inches and of the CAD program behind that."""
    return f"{number(round(value, 7))} mm"


def place(at: Sequence[float] | Array) -> str:
    """A point [mm]."""
    return "[" + ", ".join(length(own) for own in at) + "]"


def direction(along: Sequence[float] | Array) -> str:
    """A direction, with the digits that keep right angles right."""
    return "[" + ", ".join(f"{own + 0.0:.13g}" if abs(own) > 1e-13 else "0" for own in along) + "]"


def across(normal: Sequence[float] | Array) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Two directions that are square to one and to each other: near the part's x (or y), and the third."""
    start = (1.0, 0.0, 0.0) if abs(normal[0]) < 0.9 else (0.0, 1.0, 0.0)
    along = sum(a * b for a, b in zip(start, normal, strict=True))
    rest = [a - along * b for a, b in zip(start, normal, strict=True)]
    size = math.sqrt(sum(own * own for own in rest))
    x = (rest[0] / size, rest[1] / size, rest[2] / size)
    a, b = normal, x
    return x, (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def cleaned(wish: str, forbidden: Iterable[str]) -> str:
    """A text as a name; "" if nothing of it is left."""
    dropped = {*forbidden, *MARKS}
    normal = unicodedata.normalize("NFC", wish[: 4 * LONGEST])
    text = "".join(sign if sign.isprintable() and sign not in dropped else " " for sign in normal)
    text = " ".join(text.split())[:LONGEST].strip(" .")
    return text + "_" if text.endswith((".x", ".y")) else text


@dataclass(frozen=True)
class Names:
    """Names that differ, as scenes want them.

    Args:
        forbidden: signs that they do not hold.
        taken: those that are given; grows.
    """

    forbidden: frozenset[str] = UNNAMEABLE
    taken: dict[str, int] = field(default_factory=dict)

    def new(self, wish: str, fallback: str, members: int = 1) -> str:
        """A name near a wish that no other has, nor will a member of it.

        Args:
            wish: the file's text.
            fallback: used where that is no name at all.
            members: their number, counted after its name.
        """
        base = cleaned(wish, self.forbidden) or cleaned(fallback, self.forbidden) or "unnamed"
        count, name = 1, base
        while self.clashes(name, members):
            count += 1
            name = f"{base} ({count})" if members == 1 else f"{base} ({count}) of"
        self.taken.update(dict.fromkeys(self.all_of(name, members), 1))
        return name

    def clashes(self, name: str, members: int) -> bool:
        """True if a name or one of its members is taken."""
        return any(own in self.taken for own in self.all_of(name, members))

    @staticmethod
    def all_of(name: str, members: int) -> list[str]:
        """A name with those of its members."""
        return [name, *(f"{name} {k}" for k in range(1, members + 1))] if members > 1 else [name]
