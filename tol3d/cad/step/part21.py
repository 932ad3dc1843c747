"""A STEP file as text (ISO 10303-21): its header and its instances, split at once and each parsed when asked for.

`read_part21` is the gate of every foreign file: files that pass have their end, well-formed brackets, finite numbers
and no reference that leads nowhere or back to itself (see gate.py). It never recurses and takes time in proportion to
the file's size. Source: ISO 10303-21:2016; anchors of edition 3 are skipped, references to other files are refused.
"""

import re
from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from itertools import chain
from pathlib import Path
from types import MappingProxyType
from typing import Final

from tol3d.cad.step.gate import check_data
from tol3d.cad.step.instance import Instance, Record
from tol3d.cad.step.refused import StepError, shown
from tol3d.cad.step.values import read_records

LARGEST_FILE: Final = 256 * 2**20  # bytes; the text and its split take about four times that in memory
MOST_INSTANCES: Final = 5_000_000

COMMENT = r"/\*(?:[^*]|\*(?!/))*+\*/"
BLANK = rf"(?:\s++|{COMMENT})*+"
BODY = rf"(?:[^';\"/]++|'(?:[^']|'')*+'|\"[^\"]*+\"|{COMMENT}|/)*+"
START = re.compile(rf"{BLANK}ISO-10303-21{BLANK};")
COMPRESSED: Final = ("\x1f\x8b", "PK\x03\x04")
"""First characters of files of gzip and zip."""
STATEMENT = re.compile(rf"{BLANK}({BODY});")
INSTANCE = re.compile(rf"{BLANK}#([0-9]{{1,15}}+){BLANK}={BLANK}({BODY});")
FIRST_KEYWORD = re.compile(r"[A-Za-z_][A-Za-z0-9_]*+")


@dataclass(frozen=True)
class Header:
    """Header of a file.

    Args:
        name: the file's name when it was written.
        description: free text.
        schemas: schema names, such as `AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF`, with their version in braces.
    """

    name: str
    description: str
    schemas: tuple[str, ...]


@dataclass(frozen=True)
class Part21:
    """A file whose text passed the gate.

    Args:
        name: the file's name, for errors.
        text: all of it, decoded.
        header: of the file.
        spans: from each `#id`, in the file's order, to where its body begins and ends in the text.
    """

    name: str
    text: str = field(repr=False)
    header: Header
    spans: MappingProxyType[int, tuple[int, int]] = field(repr=False)
    _parsed: dict[int, Instance] = field(default_factory=dict, repr=False, compare=False)

    def __contains__(self, identifier: int) -> bool:
        return identifier in self.spans

    @cached_property
    def _line_ends(self) -> list[int]:
        return [found.start() for found in re.finditer("\n", self.text)]

    @cached_property
    def ids(self) -> MappingProxyType[str, tuple[int, ...]]:
        """Instances of each entity, simple or in a complex one, in the file's order."""
        found: dict[str, list[int]] = {}
        for identifier, (start, end) in self.spans.items():
            first = FIRST_KEYWORD.match(self.text, start, end)
            words = [first.group().upper()] if first else [record.keyword for record in self[identifier].records]
            for word in words:
                found.setdefault(word, []).append(identifier)
        return MappingProxyType({word: tuple(ids) for word, ids in found.items()})

    def place(self, identifier: int) -> str:
        """File, line and `#id`, as errors begin."""
        return f"{self.name}:{self.line(self.spans[identifier][0])}: #{identifier}"

    def line(self, offset: int) -> int:
        """The line of an offset into the text, from 1."""
        return bisect_right(self._line_ends, offset - 1) + 1

    def __getitem__(self, identifier: int) -> Instance:
        """The instance of an `#id`.

        Raises:
            StepError: the file has none, or it is not of the grammar.
        """
        found = self._parsed.get(identifier)
        if found is None:
            if identifier not in self.spans:
                raise StepError(f"{self.name}: expected an instance #{identifier}, got none")
            start, end = self.spans[identifier]
            place = self.place(identifier)
            try:
                records = read_records(self.text[start:end])
            except StepError as error:
                raise StepError(f"{place}: {error}") from None
            found = self._parsed[identifier] = Instance(identifier, place, records)
        return found

    def of(self, *keywords: str) -> Iterator[Instance]:
        """The instances of these entities, in the file's order."""
        ids = set(chain.from_iterable(self.ids.get(word, ()) for word in keywords))
        return (self[each] for each in sorted(ids, key=self.rank.__getitem__))

    @cached_property
    def rank(self) -> MappingProxyType[int, int]:
        """Place of each `#id` in the file's order, from 0."""
        return MappingProxyType({identifier: rank for rank, identifier in enumerate(self.spans)})

    def records(self, keyword: str) -> Iterator[Record]:
        """The records of one entity, in the file's order."""
        return (each.needed(keyword) for each in self.of(keyword))


def read_part21(source: Path | bytes, name: str | None = None) -> Part21:
    """Read a file, or its bytes, through the gate.

    Args:
        source: its path, or its content.
        name: the name for errors; default: the file's own.

    Raises:
        StepError: it cannot be read, is no STEP file, is damaged or too large, or refers to other files.
    """
    name = name if name is not None else (source.name if isinstance(source, Path) else "STEP data")
    text = text_of(source, name)
    start = START.match(text)
    if start is None:
        packed = "; it is compressed: unpack it first" if text.startswith(COMPRESSED) else ""
        raise StepError(f"{name}: expected a STEP file that begins with ISO-10303-21; got {shown(text[:30])!r}{packed}")
    spans: dict[int, tuple[int, int]] = {}
    header: Header | None = None
    position = start.end()
    while True:
        opened, position = statement(text, position, name)
        if opened == "END-ISO-10303-21":
            break
        section = opened.split("(")[0].strip()
        if section == "HEADER":
            header, position = read_header(text, position, name)
        elif section == "DATA":
            position = read_data(text, position, name, spans)
        elif section in ("ANCHOR", "REFERENCE", "SIGNATURE"):
            position = skipped(text, position, name, section)
        else:
            raise StepError(f"{at(text, position, name)}: expected a section such as DATA, got {shown(opened)}")
    if header is None:
        raise StepError(f"{name}: expected a HEADER section, got none")
    if not spans:
        raise StepError(f"{name}: expected instances in a DATA section, got none")
    check_data(text, spans, lambda offset: at(text, offset, name))
    return Part21(name, text, header, MappingProxyType(spans))


def text_of(source: Path | bytes, name: str) -> str:
    """The text of a file: UTF-8 as edition 3 has it, else Latin-1, which editions before wrote at times."""
    if isinstance(source, bytes):
        data = source
    else:
        try:
            if source.stat().st_size > LARGEST_FILE:
                raise too_large(name)
            data = source.read_bytes()
        except (OSError, ValueError) as error:
            raise StepError(f"{name}: cannot be read ({getattr(error, 'strerror', None) or error})") from None
    if len(data) > LARGEST_FILE:
        raise too_large(name)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def too_large(name: str) -> StepError:
    """The error to raise for a file that takes too much memory."""
    return StepError(f"{name}: expected a file of at most {LARGEST_FILE >> 20} MiB")


def at(text: str, offset: int, name: str) -> str:
    """File and line of an offset, as errors begin."""
    return f"{name}:{text.count(chr(10), 0, offset) + 1}"


def statement(text: str, position: int, name: str) -> tuple[str, int]:
    """The next statement without its semicolon, and its end.

    Raises:
        StepError: the file is cut.
    """
    found = STATEMENT.match(text, position)
    if found is None:
        raise StepError(
            f"{at(text, position, name)}: expected the file to end with END-ISO-10303-21; "
            "it is cut, or a quote is missing"
        )
    return found.group(1).strip(), found.end()


def read_header(text: str, position: int, name: str) -> tuple[Header, int]:
    """The header section, and its end."""
    found: dict[str, Record] = {}
    while True:
        here = at(text, position, name)
        said, position = statement(text, position, name)
        if said == "ENDSEC":
            break
        try:
            record = read_records(said)[0]
        except StepError as error:
            if not said.startswith("FILE_SCHEMA"):
                continue  # names and descriptions, on which nothing depends
            raise StepError(f"{here}: in the header: {error}") from None
        found[record.keyword] = Record(Instance(0, here, (record,)), record.keyword, record.arguments)
    schema = found.get("FILE_SCHEMA")
    if schema is None:
        raise StepError(f"{name}: expected FILE_SCHEMA in the header, got none")
    return Header(first_text(found, "FILE_NAME"), first_text(found, "FILE_DESCRIPTION"), texts(schema)), position


def texts(record: Record) -> tuple[str, ...]:
    """The strings in a header entity's first argument."""
    listed = record.argument(0)
    return tuple(each for each in (listed if isinstance(listed, tuple) else (listed,)) if isinstance(each, str))


def first_text(found: dict[str, Record], keyword: str) -> str:
    """The first string of a header entity, empty if there is none."""
    return next(iter(texts(found[keyword])), "") if keyword in found and len(found[keyword]) else ""


def read_data(text: str, position: int, name: str, spans: dict[int, tuple[int, int]]) -> int:
    """Split a DATA section into `spans`; return its end."""
    while found := INSTANCE.match(text, position):
        identifier = int(found.group(1))
        if identifier in spans:
            raise StepError(
                f"{at(text, found.start(1), name)}: #{identifier} stands twice, first in line "
                + at(text, spans[identifier][0], name).rpartition(":")[2]
            )
        spans[identifier] = found.span(2)
        position = found.end()
        if len(spans) > MOST_INSTANCES:
            raise StepError(f"{name}: expected at most {MOST_INSTANCES} instances")
    said, after = statement(text, position, name)
    if said != "ENDSEC":
        raise StepError(f"{at(text, position, name)}: expected an instance such as #12=…; or ENDSEC; got {shown(said)}")
    return after


def skipped(text: str, position: int, name: str, section: str) -> int:
    """Go over a section whose content is not needed.

    Raises:
        StepError: it refers to other files.
    """
    while True:
        said, after = statement(text, position, name)
        if said == "ENDSEC":
            return after
        if section == "REFERENCE":
            raise StepError(
                f"{at(text, after, name)}: refers to another file, {shown(said)}: "
                "expected one file that holds everything; export the assembly into one"
            )
        position = after
