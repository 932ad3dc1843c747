"""The values of ISO 10303-21 text: references, numbers, strings, enumerations, lists and typed values.

`read_records` parses the body of one instance with an explicit stack, so that no depth of brackets exhausts Python's.
Source: ISO 10303-21:2016, clauses 5 and 6.
"""

import math
import re
from dataclasses import dataclass
from enum import Enum
from typing import Final

from tol3d.cad.step.refused import StepError, shown

DEEPEST: Final = 64  # brackets in each other; files of CAD systems have at most 8, OCCT ends the process at 200 000
LONGEST_INTEGER: Final = 18  # characters up to which an integer is one; longer ones are read as decimals


class Reference(int):
    """The `#id` of another instance."""

    __str__ = int.__repr__

    def __repr__(self) -> str:
        return f"#{int(self)}"


class Missing(Enum):
    """A value that is not given."""

    UNSET = "$"
    DERIVED = "*"


@dataclass(frozen=True, slots=True)
class Enumeration:
    """A word between dots, such as `.MILLI.`."""

    word: str


@dataclass(frozen=True, slots=True)
class Binary:
    """Hexadecimal digits between double quotes."""

    digits: str


@dataclass(frozen=True, slots=True)
class Typed:
    """A keyword with its arguments: an entity, or a value of a stated type such as `LENGTH_MEASURE(2.5)`."""

    keyword: str
    arguments: "tuple[Value, ...]"


Value = Reference | int | float | str | Missing | Enumeration | Binary | Typed | tuple["Value", ...]

TOKEN = re.compile(
    r"""
    (?P<blank>(?:\s++|/\*(?:[^*]|\*(?!/))*+\*/)++)
    |(?P<reference>\#[0-9]{1,15}+)
    |(?P<number>[-+]?[0-9]++(?:\.[0-9]*+)?(?:[eE][-+]?[0-9]++)?)
    |(?P<string>'(?:[^']|'')*+')
    |(?P<sign>[(),$*])
    |(?P<keyword>!?[A-Za-z_][A-Za-z0-9_-]*+)
    |(?P<enumeration>\.[A-Za-z_][A-Za-z0-9_]*+\.)
    |(?P<binary>"[0-9A-Fa-f]*+")
    """,
    re.VERBOSE,
)

CONTROL = re.compile(
    r"\\X2\\((?:[0-9A-Fa-f]{4})*)\\X0\\|\\X4\\((?:[0-9A-Fa-f]{8})*)\\X0\\|\\X\\([0-9A-Fa-f]{2})|\\S\\(.)|\\P[A-I]\\|\\\\"
)


def decoded(written: str) -> str:
    r"""The text of a string between its quotes: doubled quotes, `\X2\ … \X0\` and the like resolved, line ends dropped.

    What is no directive stays as it stands: names are data.
    """
    text = written.replace("''", "'")
    if "\n" in text or "\r" in text:
        text = text.replace("\r", "").replace("\n", "")  # a string goes on over the end of a line
    return CONTROL.sub(directive, text) if "\\" in text else text


def directive(found: re.Match[str]) -> str:
    """One control directive's characters."""
    two, four, one, shifted = found.groups()
    if two is not None:
        return bytes.fromhex(two).decode("utf-16-be", "replace")
    if four is not None:
        return bytes.fromhex(four).decode("utf-32-be", "replace")
    if one is not None:
        return chr(int(one, 16))
    if shifted is not None:
        return chr(ord(shifted) | 0x80) if ord(shifted) < 0x80 else shifted
    return "\\" if found.group() == "\\\\" else ""


def number(written: str) -> int | float:
    """A number as written, of any length: ISO 10303-21 has no limit.

    Raises:
        StepError: it is beyond the range of a double.
    """
    if len(written) <= LONGEST_INTEGER and not any(sign in written for sign in ".eE"):
        return int(written)
    value = float(written)
    if not math.isfinite(value):
        raise StepError(f"expected a finite number, got {shown(written)}")
    return value


class Frame:
    """One open bracket while a body is read."""

    __slots__ = ("awaits", "items", "keyword")

    def __init__(self, keyword: str | None) -> None:
        self.keyword = keyword
        self.items: list[Value] = []
        self.awaits = "first"  # what may come: "first" value or ), "value" after a comma, "comma" or ) after a value


def read_records(body: str) -> tuple[Typed, ...]:
    """The records of one instance: one of a simple one, several of a complex one `(A(…)B(…))`.

    Raises:
        StepError: the body is not of the grammar; without the place, which the caller adds.
    """
    top = Frame(None)
    stack = [top]
    keyword: str | None = None
    position, end = 0, len(body)
    while position < end:
        found = TOKEN.match(body, position)
        if found is None:
            raise StepError(f"expected a value, got {shown(body[position : position + 30])}")
        position = found.end()
        kind, text = found.lastgroup, found.group()
        if kind == "blank":
            continue
        if keyword is not None and text != "(":
            raise StepError(f"expected ( after {shown(keyword)}, got {shown(text)}")
        frame = stack[-1]
        if text == "(":
            expect_value(frame, stack, text)
            stack.append(Frame(keyword))
            keyword = None
            if len(stack) > DEEPEST:
                raise StepError(f"expected at most {DEEPEST} brackets in each other")
        elif text == ")":
            if len(stack) == 1 or frame.awaits == "value":
                raise StepError("expected a value, got )")
            stack.pop()
            closed = tuple(frame.items)
            add(stack, closed if frame.keyword is None else Typed(frame.keyword, closed))
        elif text == ",":
            if len(stack) == 1 or frame.awaits != "comma":
                raise StepError("expected a value, got a comma")
            frame.awaits = "value"
        elif kind == "keyword":
            expect_value(frame, stack, text)
            keyword = text.upper()
        else:
            expect_value(frame, stack, text)
            add(stack, simple_value(kind, text))
    if len(stack) > 1 or keyword is not None:
        raise StepError("expected ) before the end")
    return records_of(top.items)


def expect_value(frame: Frame, stack: list[Frame], text: str) -> None:
    """Refuse a value where a comma must stand first; records of a complex instance stand side by side."""
    if frame.awaits == "comma" and not (len(stack) == 2 and frame.keyword is None):
        raise StepError(f"expected a comma or ), got {shown(text)}")


def add(stack: list[Frame], value: Value) -> None:
    """Take a finished value into the bracket that is open."""
    stack[-1].items.append(value)
    stack[-1].awaits = "comma"


def simple_value(kind: str | None, text: str) -> Value:
    """A value of one token."""
    if kind == "reference":
        return Reference(text[1:])
    if kind == "number":
        return number(text)
    if kind == "string":
        return decoded(text[1:-1])
    if kind == "enumeration":
        return Enumeration(text[1:-1].upper())
    if kind == "binary":
        return Binary(text[1:-1])
    return Missing(text)


def records_of(items: list[Value]) -> tuple[Typed, ...]:
    """The records of a body that was read: one, or those of a complex instance."""
    found = items[0] if len(items) == 1 else ()
    records = (found,) if isinstance(found, Typed) else found
    if not isinstance(records, tuple) or not records:
        raise StepError("expected one entity, or several in brackets")
    if any(not isinstance(record, Typed) for record in records):
        raise StepError("expected only entities in the brackets of a complex instance")
    return tuple(record for record in records if isinstance(record, Typed))
