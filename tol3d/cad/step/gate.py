"""The checks that a STEP file's data must pass before anything reads them, each over the whole file at once.

Open CASCADE ends its process on 200 000 brackets in each other and on a coordinate 1E300, hangs on 1E400, and drops
faces without a word where a reference leads nowhere or a shell holds itself: such files are refused here.
"""

import re
from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from typing import Final

from tol3d.cad.step.refused import StepError, shown
from tol3d.cad.step.values import DEEPEST

LARGEST_NUMBER: Final = 1e12  # mm would be a million kilometres; no length, angle or area of a part
LARGEST_PROPERTY: Final = 1e100  # of what is no geometry, such as the time of a file in milliseconds
PROPERTIES: Final = re.compile(r"[\s(]*+[A-Z_]*(?:REPRESENTATION_ITEM|MEASURE|VIEW|CAMERA|PROPERTY|ATTRIBUTE)")

COVERED = re.compile(r"'(?:[^']|'')*+'|/\*(?:[^*]|\*(?!/))*+\*/|\"[0-9A-Fa-f]*+\"")
FOREIGN = re.compile(r"[^A-Za-z0-9_#=(),;.$*+\-\s'!]")
EXPONENT = re.compile(r"(?<![A-Za-z0-9_.#])[0-9]++(?:\.[0-9]*+)?[eE][-+]?[0-9]++")
LONG = re.compile(r"[(,+\-\s][0-9]{13,}+(?:\.[0-9]*+)?")
OF_ITSELF: Final = re.compile(r"(?:DIMENSIONAL_SIZE_WITH_DATUM_FEATURE|REPRESENTATION)\s*\(")
"""Entities that may name themselves: the first is its own dimension, by ISO 10303-47; the second, which holds no shape,
is a density as Open CASCADE 6 wrote it."""
REFERENCE = re.compile(r"#([0-9]++)")
NO_BRACKETS = re.compile(r"[^()]++")
OPEN_REFERENCE = re.compile(r"#(?![0-9])")

Place = Callable[[int], str]


def check_data(text: str, spans: Mapping[int, tuple[int, int]], place: Place) -> None:
    """Refuse data that a reader could choke on.

    Args:
        text: the file's text.
        spans: from each `#id` to where its body begins and ends in the text.
        place: file and line of an offset.

    Raises:
        StepError: a character, number, bracket or reference is wrong; with its place.
    """
    first = min(start for start, _ in spans.values())
    last = max(end for _, end in spans.values())
    bare = text[:first] + COVERED.sub(blanked, text[first:last])  # as long as the text: offsets stay
    check_characters(bare, first, place)
    check_numbers(bare, first, sorted(spans.values()), place)
    check_bodies(bare, spans, place)
    check_references(bare, spans, place)


def blanked(found: re.Match[str]) -> str:
    """A string as empty quotes and a comment as blanks, of the same length."""
    length = found.end() - found.start()
    return "'" + " " * (length - 2) + "'" if found.group()[0] == "'" else " " * length


def check_characters(bare: str, first: int, place: Place) -> None:
    """Refuse characters that only strings may have, and `#` without a number."""
    foreign = FOREIGN.search(bare, first) or OPEN_REFERENCE.search(bare, first)
    if foreign:
        raise StepError(f"{place(foreign.start())}: outside of strings, expected no {shown(foreign.group())!r} here")


def check_numbers(bare: str, first: int, bodies: Sequence[tuple[int, int]], place: Place) -> None:
    """Refuse numbers that no part has."""
    written = [(found.start(), found.group()[1:]) for found in LONG.finditer(bare, first)]
    written += [(found.start(), found.group()) for found in EXPONENT.finditer(bare, first)]
    for offset, each in written:
        size = float(each)
        body = bodies[bisect_right(bodies, (offset, len(bare))) - 1]
        largest = LARGEST_PROPERTY if size > LARGEST_NUMBER and PROPERTIES.match(bare, *body) else LARGEST_NUMBER
        if size > largest:
            raise StepError(f"{place(offset)}: expected a number up to {largest:g}, got {shown(each)}")


def check_bodies(bare: str, spans: Mapping[int, tuple[int, int]], place: Place) -> None:
    """Refuse instances that run into the next, or whose brackets do not close or stand too many in each other."""
    for identifier, (start, end) in spans.items():
        if bare.find("=", start, end) >= 0 or not bare[start:end].rstrip().endswith(")"):
            raise StepError(f"{place(start)}: #{identifier}: expected ); at its end")
        depth = deepest = 0
        if bare.count("(", start, end) <= DEEPEST and bare.count("(", start, end) == bare.count(")", start, end):
            continue  # cannot be too deep; their order is the parser's
        for run in NO_BRACKETS.split(bare[start:end]):
            for sign in run:
                depth += 1 if sign == "(" else -1
                deepest = max(deepest, depth)
        if depth != 0 or deepest > DEEPEST:
            why = "brackets that close" if depth else f"at most {DEEPEST} brackets in each other, got {deepest}"
            raise StepError(f"{place(start)}: #{identifier}: expected {why}")


def check_references(bare: str, spans: Mapping[int, tuple[int, int]], place: Place) -> None:
    """Refuse references that lead nowhere, or back to the instance that they started from."""
    uses: dict[int, list[int]] = {}
    for identifier, (start, end) in spans.items():
        named = [int(each) for each in REFERENCE.findall(bare, start, end)]
        for each in named:
            if each not in spans:
                raise StepError(f"{place(start)}: #{identifier} refers to #{each}, which the file does not have")
        if identifier in named and OF_ITSELF.match(bare, start):
            named = [each for each in named if each != identifier]
        if named:
            uses[identifier] = named
    ring = cycle(uses)
    if ring:
        told = " → ".join(f"#{each}" for each in (*ring[:6], ring[0]))
        raise StepError(f"{place(spans[ring[0]][0])}: #{ring[0]} holds itself ({told})")


def cycle(uses: Mapping[int, list[int]]) -> list[int]:
    """The first ring of references, empty if there is none; depth first with a stack of its own."""
    done: set[int] = set()
    for root in uses:
        if root in done:
            continue
        path: dict[int, None] = {root: None}  # in order
        stack = [iter(uses[root])]
        while stack:
            following = next((each for each in stack[-1] if each in uses and each not in done), None)
            if following is None:
                stack.pop()
                done.add(path.popitem()[0])
            elif following in path:
                names = list(path)
                return names[names.index(following) :]
            else:
                path[following] = None
                stack.append(iter(uses[following]))
    return []
