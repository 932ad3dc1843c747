"""The tree of located parts: each below the part on which its move places it, for any number of parts.

Parts that lie on a part are indented below it. A tree of more than DEEPEST levels is not indented along its longest
branch. Many parts that are placed alike share a line.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise
from typing import Final

from tol3d.assembly.model import Assembly
from tol3d.report.page import Branch

DEEPEST: Final = 8  # levels of indentation
ALIKE: Final = 4  # parts placed alike that share a line


@dataclass(frozen=True)
class Laid:
    """Placement of a part by a move.

    Args:
        part: its name.
        words: kind of the move, printed before the parts that it lies on.
        move: its name; "" for none.
        on: those parts, in the order in which the move names them.
        before: its previous placement.
    """

    part: str
    words: str
    move: str
    on: tuple[str, ...] = ()
    before: "Laid | None" = None

    @property
    def text(self) -> str:
        """In a line."""
        return f"{self.part}: {self.how}"

    @property
    def how(self) -> str:
        """All of it but the part."""
        own = " ".join([self.words, ", ".join(self.on)]).strip() + (f" (move {self.move})" if self.move else "")
        return own if self.before is None else f"{self.before.how}, then {own}"


def parts_tree(assembly: Assembly, further: Sequence[Laid] = ()) -> tuple[Branch, ...]:
    """Parts as trees, each with the parts that lie on it.

    Args:
        assembly: with parts placed by its moves.
        further: parts that lie on them by other means, such as shafts in bores.
    """
    laid = {part.name: Laid(part.name, "where it is drawn, by no move", "") for part in assembly.parts}
    laid |= {own.part: own for own in (*_laid(assembly), *further)}
    return _Tree.of(laid).shown()


def _laid(assembly: Assembly) -> Iterator[Laid]:
    """Placements of parts by moves, in order; welded parts follow a part that is moved again."""
    before: dict[str, Laid] = {}
    for part, words, move, on in _steps(assembly):
        own = Laid(part, words, move, on, before.get(part))
        if own.before is None or own.before.move != move:  # a body that is moved again and again is welded once
            before[part] = own
    yield from before.values()


def _steps(assembly: Assembly) -> Iterator[tuple[str, str, str, tuple[str, ...]]]:
    """Parts with the words and the name of the move that places them, and the parts below."""
    welded: dict[str, tuple[str, str, str, tuple[str, ...]]] = {}
    for move in assembly.moves:
        for other in move.joined[1:]:
            welded[other] = (other, move.acts.lies, move.name, move.joined[:1])
        named = dict.fromkeys(assembly.features[name].part for pair in move.feature_pairs for name in pair)
        for k, part in enumerate(move.parts):
            body = [part]
            for own in body:  # the loop extends it by parts welded to its parts
                body += [other for other, (*_, (leader,)) in welded.items() if leader == own and other not in body]
            on = move.carriers[k : k + 1] or tuple(other for other in named if other not in body)
            yield part, move.acts.lies, move.name, on
            yield from (welded[other] for other in body[1:])


@dataclass(frozen=True)
class _Tree:
    """Parts below the first of those that they lie on.

    Args:
        laid: placement of each part.
        below: the parts below each, in the order of the moves.
        height: levels below each.
        roots: parts that lie on no other one.
    """

    laid: Mapping[str, Laid]
    below: Mapping[str, Sequence[str]]
    height: Mapping[str, int]
    roots: Sequence[str]

    @classmethod
    def of(cls, laid: Mapping[str, Laid]) -> "_Tree":
        """The tree; a part that was moved again onto one that lies on itself is a root."""
        above: dict[str, str] = {}
        for part, own in laid.items():
            if own.on and not _reaches(above, own.on[0], part):
                above[part] = own.on[0]
        below: dict[str, list[str]] = {part: [] for part in laid}
        for part, parent in above.items():
            below[parent].append(part)
        roots = [part for part in laid if part not in above]
        order = list(roots)
        for part in order:
            order += below[part]
        height = dict.fromkeys(order, 0)
        for part in reversed(order):
            height[part] = max((1 + height[other] for other in below[part]), default=0)
        return cls(laid, below, height, roots)

    def shown(self) -> tuple[Branch, ...]:
        """The roots with what is below them."""
        return self._branches(self.roots)

    def _branches(self, parts: Sequence[str]) -> tuple[Branch, ...]:
        """Parts below one, with what is below them; alike ones with nothing below in one line."""
        found: list[Branch] = []
        for (alone, words, on), group in groupby(parts, key=self._likeness):
            names = list(group)
            if alone and len(names) >= ALIKE:
                found.append(Branch(f"{', '.join(names)}: each {words} {', '.join(on)}".rstrip()))
            else:
                found += [branch for name in names for branch in self._branch(name)]
        return tuple(found)

    def _likeness(self, part: str) -> tuple[bool, str, tuple[str, ...]]:
        own = self.laid[part]
        return not self.below[part] and own.before is None, own.words, own.on

    def _branch(self, part: str) -> Iterator[Branch]:
        """A part with what is below it, or those along its longest branch below each other at the same place."""
        if self.height[part] < DEEPEST:
            yield Branch(self.laid[part].text, self._branches(self.below[part]))
            return
        path = [part]
        while below := self.below[path[-1]]:
            path.append(max(below, key=lambda other: self.height[other]))
        links = [self._links(lower, upper) for upper, lower in pairwise(path)]
        for alike, group in groupby(range(len(path)), key=lambda k: links[k - 1] if k else ""):
            run = list(group)
            if alike and len(run) >= ALIKE:
                yield Branch(f"{' → '.join(path[k] for k in run)}: each {alike} the one before")
                run = []
            for k in run:
                beside = [other for other in self.below[path[k]] if other not in path[k + 1 : k + 2]]
                yield Branch(self.laid[path[k]].text, self._branches(beside))

    def _links(self, part: str, above: str) -> str:
        """Words for a part's single link to the one above, if it has one part at most below it; else nothing."""
        own = self.laid[part]
        alone = own.on == (above,) and own.before is None and len(self.below[part]) <= 1
        return own.words if alone else ""


def _reaches(above: Mapping[str, str], part: str, other: str) -> bool:
    """True if a part lies on another one, directly or through others, or is that part."""
    while part != other and part in above:
        part = above[part]
    return part == other
