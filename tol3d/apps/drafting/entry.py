"""Entries of a drafted scene, each with its alternatives, and the text that they make together."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Final, Literal

Section = Literal["parts", "tolerances", "moves", "measures"]
SECTIONS: Final[tuple[Section, ...]] = ("parts", "tolerances", "moves", "measures")

LAW: Final = "\0law"
"""Placeholder for the law of a zone in a wording; no text of a file can hold it."""
ALIAS: Final = "*zones"


@dataclass(frozen=True)
class Wording:
    """One way in which an entry may be written.

    Args:
        lines: YAML below the entry's name; for one line, the text after the name.
        comment: its source.
        lost: its loss, in words; "" for none.
    """

    lines: tuple[str, ...]
    comment: str = ""
    lost: str = ""


@dataclass(eq=False)
class Entry:
    """An entry of a scene; it takes its next wording where the one that it has is refused.

    Args:
        section: of the scene.
        name: as YAML reads it, quoted if need be.
        wordings: the best one first.
        source: the `#id` of its tolerance; None without one.
        label: its name in words, for the list of omissions.
        needs: entries without which it is of no use.
        refused: why it is left out; "" while it is not.
        losses: what its wordings lost so far.
        inspects: the `#id` of the tolerance whose limit a measure reads; None of others.
        below: those of the lower segments that it says too.
        blank: True for a line to fill in, which is written as a comment.
    """

    section: Section
    name: str
    wordings: Sequence[Wording]
    source: int | None = None
    label: str = ""
    needs: tuple["Entry", ...] = ()
    refused: str = ""
    losses: list[str] = field(default_factory=list)
    inspects: int | None = None
    below: tuple[int, ...] = ()
    blank: bool = False

    @property
    def stands(self) -> bool:
        """True if it is in the scene."""
        return not self.refused and all(need.stands for need in self.needs)

    @property
    def wording(self) -> Wording:
        """Current wording."""
        return self.wordings[0]

    def worsen(self, why: str) -> None:
        """Take the next wording, or leave the entry out."""
        if len(self.wordings) > 1:
            self.wordings = self.wordings[1:]
            self.losses += filter(None, [self.wording.lost])
        else:
            self.refused = why

    def lines(self) -> Iterator[str]:
        """Its lines in the scene."""
        words = self.wording
        remark = f"  # {words.comment}" if words.comment else ""
        if len(words.lines) == 1:
            yield f"  {'# ' if self.blank else ''}{self.name}: {words.lines[0]}{remark}"
            return
        yield f"  {self.name}:{remark}"
        for line in words.lines:
            yield f"    {line}"


@dataclass(frozen=True)
class Scene:
    """A drafted scene.

    Args:
        head: lines of comments and keys before the entries.
        law: the law of all zones, which the first of them names.
        entries: in the order in which they are written, section by section.
        tail: lines after them, such as the study and the omissions.
    """

    head: Sequence[str]
    law: str
    entries: Sequence[Entry]
    tail: Sequence[str] = ()

    def written(self) -> tuple[str, dict[int, Entry]]:
        """Its text, and the entry of each line, by the line's number from 1 on."""
        lines: list[str] = list(self.head)
        by_line: dict[int, Entry] = {}
        anchor = f"&zones {self.law}"
        for section in SECTIONS:
            standing = [entry for entry in self.entries if entry.section == section and entry.stands]
            if not standing:
                continue
            lines += ["", f"{section}:" if any(not entry.blank for entry in standing) else f"# {section}:"]
            for own in standing:
                for line in own.lines():
                    lines.append(line.replace(LAW, anchor))
                    anchor = ALIAS if LAW in line else anchor
                    by_line[len(lines)] = own
        return "\n".join([*lines, *self.tail]) + "\n", by_line
